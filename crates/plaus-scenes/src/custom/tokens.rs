//! Words of arithmetic: numbers, names and signs.

use std::fmt;

/// What may stand in a formula.
const OTHER: &str = "arithmetic may use numbers, names, + - * / %, brackets and functions";

/// A part of a formula.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(super) enum Token<'a> {
    Number(f64),
    Name(&'a str),
    /// One of `+ - * / % ( ) ,`.
    Sign(char),
}

impl fmt::Display for Token<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Number(value) => write!(f, "\"{value}\""),
            Self::Name(name) => write!(f, "{name:?}"),
            Self::Sign(sign) => write!(f, "\"{sign}\""),
        }
    }
}

/// The parts of a formula, in order.
///
/// # Errors
/// What is wrong with it, in words.
pub(super) fn tokens(text: &str) -> Result<Vec<Token<'_>>, String> {
    let (mut all, mut rest) = (Vec::new(), text.trim_start());
    while let Some(first) = rest.chars().next() {
        let length = match first {
            '+' | '-' | '*' | '/' | '%' | '(' | ')' | ',' => {
                all.push(Token::Sign(first));
                1
            }
            '0'..='9' => {
                let length = digits(rest);
                let suffix = &rest[length..];
                let suffix = &suffix[..name(suffix)];
                if !suffix.is_empty() {
                    let number = &rest[..length];
                    return Err(format!(
                        "{number}{suffix}: write decimal numbers without units; they are in the unit of the key"
                    ));
                }
                let number = rest[..length].replace('_', "");
                all.push(Token::Number(number.parse().map_err(|_| format!("{number} is not a number"))?));
                length
            }
            '^' => return Err("for a power write pow(a, b)".into()),
            '<' | '>' | '=' | '&' | '|' | '!' => return Err("the operators are + - * / %".into()),
            _ => match name(rest) {
                0 => return Err(OTHER.into()),
                length => {
                    all.push(Token::Name(&rest[..length]));
                    length
                }
            },
        };
        rest = rest[length..].trim_start();
    }
    Ok(all)
}

/// How long the name is with which a text begins, in bytes.
fn name(text: &str) -> usize {
    text.find(|c: char| !(c.is_alphanumeric() || c == '_')).unwrap_or(text.len())
}

/// How long the number is with which a text begins, such as `1`, `0.5`, `1_000` or `1e-3`, in bytes.
fn digits(text: &str) -> usize {
    let bytes = text.as_bytes();
    let run = |from: usize| {
        let is_digit = |byte: &&u8| byte.is_ascii_digit() || **byte == b'_';
        from + bytes[from..].iter().take_while(is_digit).count()
    };
    let mut end = run(0);
    if bytes.get(end) == Some(&b'.') {
        end = run(end + 1);
    }
    if matches!(bytes.get(end), Some(b'e' | b'E')) {
        let from = end + 1 + usize::from(matches!(bytes.get(end + 1), Some(b'+' | b'-')));
        if bytes.get(from).is_some_and(u8::is_ascii_digit) {
            end = run(from);
        }
    }
    end
}
