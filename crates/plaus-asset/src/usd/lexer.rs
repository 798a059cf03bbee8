//! The words of the text of a layer, cut as the library cuts them.

/// A word, a number, or whatever else stands by itself.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(super) enum Token<'a> {
    /// A name, a keyword, or several names with colons.
    Word(&'a str),
    Number,
    Text,
    /// A path, or that of a file.
    Path,
    Mark(u8),
}

/// Goes through a text.
pub(super) struct Lexer<'a> {
    text: &'a str,
    at: usize,
    pub(super) line: usize,
}

impl<'a> Lexer<'a> {
    pub(super) fn new(text: &'a str) -> Self {
        Self { text, at: 0, line: 1 }
    }

    fn byte(&self, at: usize) -> Option<u8> {
        self.text.as_bytes().get(at).copied()
    }

    fn begins(&self, what: &str) -> bool {
        self.text.as_bytes()[self.at..].starts_with(what.as_bytes())
    }

    /// Goes on to `end`.
    fn go(&mut self, end: usize) {
        let passed = &self.text.as_bytes()[self.at..end];
        let is_end = |k: usize| passed[k] == b'\n' || passed[k] == b'\r' && self.byte(self.at + k + 1) != Some(b'\n');
        self.line += (0..passed.len()).filter(|&k| is_end(k)).count();
        self.at = end;
    }

    /// Goes on to behind the next `mark`, which may be as near as `from`.
    fn close(&mut self, from: usize, mark: &str) -> Option<()> {
        let rest = self.text.as_bytes().get(self.at + from..)?;
        let found = rest.windows(mark.len()).position(|here| here == mark.as_bytes())?;
        self.go(self.at + from + found + mark.len());
        Some(())
    }

    /// Goes on to behind a text between single quotes.
    fn close_short(&mut self, quote: u8) -> Option<()> {
        let mut at = self.at + 1;
        while let Some(byte) = self.byte(at) {
            match byte {
                // A line end cannot follow it.
                b'\\' if matches!(self.byte(at + 1), None | Some(b'\n')) => return None,
                b'\\' => at += 1,
                _ if byte == quote => {
                    self.go(at + 1);
                    return Some(());
                }
                _ => {}
            }
            at += 1;
        }
        None
    }

    fn skip(&mut self, is_in: impl Fn(u8) -> bool) {
        let mut end = self.at;
        while self.byte(end).is_some_and(&is_in) {
            end += 1;
        }
        self.go(end);
    }

    /// How far a number reaches from `at`, if there is one.
    fn number(&self) -> Option<usize> {
        let digits = |mut at: usize| {
            while self.byte(at).is_some_and(|byte| byte.is_ascii_digit()) {
                at += 1;
            }
            at
        };
        let start = self.at + usize::from(matches!(self.byte(self.at), Some(b'+' | b'-')));
        let mut end = digits(start);
        if self.byte(end) == Some(b'.') && (end > start || start > self.at) {
            let more = digits(end + 1);
            end = if more > end + 1 { more } else { end };
        }
        if end == start {
            return None;
        }
        if matches!(self.byte(end), Some(b'e' | b'E')) {
            let power = end + 1 + usize::from(matches!(self.byte(end + 1), Some(b'+' | b'-')));
            let more = digits(power);
            end = if more > power { more } else { end };
        }
        Some(end)
    }

    /// The next one; None at the end.
    ///
    /// # Errors
    /// Why there is none, in words: something does not end.
    pub(super) fn next(&mut self) -> Result<Option<Token<'a>>, String> {
        let is_name = |byte: u8| byte.is_ascii_alphanumeric() || byte == b'_';
        while let Some(byte) = self.byte(self.at) {
            let line = self.line;
            let open = |what: &str| format!("line {line}: {what} that begins here does not end");
            match byte {
                b'#' => self.skip(|byte| byte != b'\n' && byte != b'\r'),
                b'/' if self.begins("/*") => self.close(2, "*/").ok_or_else(|| open("a comment"))?,
                b' ' | b'\t' | b'\r' | b'\n' | 0x0c => self.go(self.at + 1),
                b'"' | b'\'' => {
                    let long = if byte == b'"' { "\"\"\"" } else { "'''" };
                    let closed = if self.begins(long) { self.close(3, long) } else { self.close_short(byte) };
                    closed.ok_or_else(|| open("a text"))?;
                    return Ok(Some(Token::Text));
                }
                b'@' => {
                    let closed = if self.begins("@@@") { self.close(3, "@@@") } else { self.close(1, "@") };
                    closed.ok_or_else(|| open("the path of a file"))?;
                    return Ok(Some(Token::Path));
                }
                b'<' => {
                    self.close(1, ">").ok_or_else(|| open("a path"))?;
                    return Ok(Some(Token::Path));
                }
                b'a'..=b'z' | b'A'..=b'Z' | b'_' => {
                    let start = self.at;
                    self.skip(is_name);
                    if self.byte(self.at) == Some(b':') {
                        self.skip(|byte| is_name(byte) || byte == b':');
                    }
                    return Ok(Some(Token::Word(&self.text[start..self.at])));
                }
                _ => {
                    let number = self.number();
                    self.go(number.unwrap_or(self.at + 1));
                    return Ok(Some(if number.is_some() { Token::Number } else { Token::Mark(byte) }));
                }
            }
        }
        Ok(None)
    }
}
