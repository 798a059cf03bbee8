//! Checks of the text of a layer before the library reads it.

use super::lexer::{Lexer, Token};

/// Most brackets within each other: of prims, and of what is said of them.
const DEEPEST: usize = 220;

/// Longest text, in bytes: what is read of it takes nine times as much memory.
const LONGEST: usize = 32 << 20;

/// Words before the type of an attribute.
const BEFORE_TYPES: [&str; 9] =
    ["custom", "uniform", "varying", "config", "add", "append", "prepend", "delete", "reorder"];

/// What is between two brackets, or outside all.
#[derive(Debug, Default)]
struct Block {
    open: u8,
    line: usize,
    /// Whether it holds values, and how many so far; `is_plain` while they are numbers or words.
    is_value: bool,
    is_plain: bool,
    count: usize,
    /// How many it must hold.
    needed: Option<usize>,
    /// How many numbers are between the parentheses of a value of the last type that it named.
    of_type: Option<usize>,
    /// A type was the last word: the next is the name of what has it.
    is_named_next: bool,
    is_spline: bool,
    is_spline_next: bool,
}

/// How many numbers are between the parentheses of a value: 3 of `point3f`. A matrix has so many in each row.
fn count(kind: &str) -> Option<usize> {
    if matches!(kind, "quath" | "quatf" | "quatd") {
        return Some(4);
    }
    let kind = kind.strip_suffix(|last: char| last.is_ascii_alphabetic()).unwrap_or(kind);
    let (word, digit) = kind.split_at_checked(kind.len().checked_sub(1)?)?;
    let is_word = word.ends_with(|last: char| last.is_ascii_alphabetic());
    digit.parse().ok().filter(|count| is_word && (2..=4).contains(count))
}

/// Whether the library may read a text: it is UTF-8, begins as it should, its brackets are not too deep, and hold as
/// many numbers as they must: the library takes what happens to be in memory for numbers that are missing.
///
/// # Errors
/// Why not, in words.
pub(super) fn check(bytes: &[u8]) -> Result<(), String> {
    if bytes.len() > LONGEST {
        return Err(format!("as text it may have at most {LONGEST} bytes: save it as .usdc"));
    }
    let text = std::str::from_utf8(bytes).map_err(|error| {
        let line = bytes[..error.valid_up_to()].iter().filter(|&&byte| byte == b'\n').count() + 1;
        format!("line {line}: a byte that is not UTF-8")
    })?;
    if !text.starts_with("#usda ") && !text.starts_with("#sdf ") {
        return Err("it does not begin with #usda 1.0".into());
    }
    let mut lexer = Lexer::new(text);
    let mut blocks = vec![Block::default()];
    // The last two.
    let mut before = [Token::Text; 2];
    loop {
        let Some(token) = lexer.next()? else { return Ok(()) };
        let here = blocks.len() - 1;
        match token {
            Token::Mark(open @ (b'(' | b'[' | b'{')) => {
                if here >= DEEPEST {
                    return Err(format!("line {}: more than {DEEPEST} brackets within each other", lexer.line));
                }
                let inner = blocks[here].inner(open, lexer.line, before);
                blocks.push(inner);
            }
            Token::Mark(close @ (b')' | b']' | b'}')) => {
                let ended = blocks.pop().filter(|_| here > 0);
                ended.ok_or_else(|| format!("line {}: a bracket ends that does not begin", lexer.line))?.end(close)?;
            }
            _ => blocks[here].hold(token, before[1]),
        }
        before = [before[1], token];
    }
}

impl Block {
    /// The one that begins here after two tokens.
    fn inner(&mut self, open: u8, line: usize, [first, last]: [Token<'_>; 2]) -> Self {
        self.is_plain = false;
        if open != b'[' {
            self.is_named_next = false;
        }
        let after_sign = matches!(last, Token::Mark(b'=' | b':'));
        let mut inner = Self { open, line, is_plain: true, ..Self::default() };
        match open {
            b'{' => {
                inner.of_type = self.of_type;
                inner.is_spline = after_sign && std::mem::take(&mut self.is_spline_next);
            }
            b'(' if self.is_spline => {
                inner.is_value = true;
                inner.needed = match (first, last) {
                    (_, Token::Word("loop:")) | (Token::Word("loop"), Token::Mark(b':')) => Some(5),
                    (_, Token::Word("pre")) | (Token::Word("post"), Token::Word(_)) => Some(2),
                    _ => None,
                };
            }
            _ => {
                inner.is_value = open == b'[' || after_sign || self.is_value;
                if inner.is_value {
                    (inner.of_type, inner.needed) = (self.of_type, self.of_type.filter(|_| open == b'('));
                }
            }
        }
        inner
    }

    fn end(&self, close: u8) -> Result<(), String> {
        let Self { open, line, count, .. } = self;
        if !matches!((open, close), (b'(', b')') | (b'[', b']') | (b'{', b'}')) {
            return Err(format!("line {line}: a bracket that begins here ends as another"));
        }
        match self.needed.filter(|needed| self.is_value && self.is_plain && needed != count) {
            Some(needed) => Err(format!("line {line}: {needed} numbers are needed between parentheses, not {count}")),
            None => Ok(()),
        }
    }

    /// Takes in what is no bracket, and comes after `before`.
    fn hold(&mut self, token: Token<'_>, before: Token<'_>) {
        match token {
            Token::Word(_) | Token::Number | Token::Text => self.count += 1,
            Token::Mark(b',' | b';' | b'+' | b'-') => {}
            _ => self.is_plain = false,
        }
        let Token::Word(word) = token else {
            self.is_named_next = false;
            return;
        };
        match before {
            Token::Mark(b'.') => self.is_spline_next = word == "spline",
            _ if self.is_value || self.is_spline => {}
            Token::Mark(b'=' | b':' | b'+' | b'-') => {}
            _ if self.is_named_next => (self.is_named_next, self.is_spline_next) = (false, false),
            _ if BEFORE_TYPES.contains(&word) => {}
            _ => (self.of_type, self.is_named_next, self.is_spline_next) = (count(word), true, false),
        }
    }
}
