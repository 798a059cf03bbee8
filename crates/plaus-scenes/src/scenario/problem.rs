//! What is wrong with a scenario, and where.

use std::fmt;
use std::ops::Range;

/// Most problems of one scenario that are shown and get advice; further ones are counted.
pub const SHOWN: usize = 20;

/// A scenario that cannot be sampled, with every problem found in it, in the order of the file.
///
/// [`Display`](fmt::Display) gives one line for each problem: `file:line:column: key: message; help`. After [`SHOWN`]
/// of them it says how many more there are.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct ScenarioError {
    /// The name of the file.
    pub name: String,
    /// Its text, which the spans refer to.
    pub text: String,
    /// At least one.
    pub problems: Vec<Problem>,
}

/// One thing that is wrong.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Problem {
    /// The key at fault, dotted from the root, e.g. `world.ball2d.sigma_d`; empty if the text is not TOML.
    pub key: String,
    /// What is wrong, with the allowed range if there is one.
    pub message: String,
    /// How to mend it: the nearest known name, or the place where the key belongs.
    pub help: Option<String>,
    /// Bytes of the text; `None` for `--set`, and for tables that the file lacks.
    pub span: Option<Range<usize>>,
    /// Line of the span's start, from 1.
    pub line: Option<usize>,
    /// Column of the span's start in characters, from 1; a byte order mark does not count.
    pub column: Option<usize>,
    /// Where the value comes from.
    pub source: Source,
}

/// Where a value comes from.
#[derive(Debug, Clone, PartialEq, Eq, PartialOrd, Ord)]
pub enum Source {
    /// The scenario file.
    File,
    /// An override, as given: `key=value`.
    Override(String),
}

impl std::error::Error for ScenarioError {}

impl fmt::Display for ScenarioError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        for (index, problem) in self.problems.iter().take(SHOWN).enumerate() {
            if index > 0 {
                writeln!(f)?;
            }
            match (&problem.source, problem.line, problem.column) {
                (Source::Override(said), _, _) => write!(f, "--set {said}: ")?,
                (Source::File, Some(line), Some(column)) => write!(f, "{}:{line}:{column}: ", self.name)?,
                (Source::File, ..) => write!(f, "{}: ", self.name)?,
            }
            write!(f, "{problem}")?;
        }
        match self.problems.len().saturating_sub(SHOWN) {
            0 => Ok(()),
            more => write!(f, "\n{}: and {more} more problems", self.name),
        }
    }
}

/// `key: message; help`, without the place.
impl fmt::Display for Problem {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        if !self.key.is_empty() {
            write!(f, "{}: ", self.key)?;
        }
        f.write_str(&self.message)?;
        match &self.help {
            Some(help) => write!(f, "; {help}"),
            None => Ok(()),
        }
    }
}

impl Problem {
    /// A problem without a place in the text.
    pub(super) fn new(key: impl Into<String>, message: impl Into<String>) -> Self {
        Self {
            key: key.into(),
            message: message.into(),
            help: None,
            span: None,
            line: None,
            column: None,
            source: Source::File,
        }
    }

    /// The same with advice.
    pub(super) fn with_help(self, help: Option<String>) -> Self {
        Self { help, ..self }
    }

    /// The same, with a place in the text. [`ScenarioError::new`] fills in lines and columns.
    pub(super) fn at(self, source: &Source, span: Option<Range<usize>>) -> Self {
        let span = span.filter(|_| *source == Source::File);
        Self { source: source.clone(), span, ..self }
    }
}

impl ScenarioError {
    /// Gives each problem its line and column, and sorts them: those in the file, those about what it lacks, those of
    /// overrides.
    pub(super) fn new(name: &str, text: &str, mut problems: Vec<Problem>) -> Self {
        let start = |problem: &Problem| problem.span.as_ref().map_or(usize::MAX, |span| span.start);
        problems.sort_by(|a, b| a.source.cmp(&b.source).then(start(a).cmp(&start(b))));
        let mut cursor = Cursor::new(text);
        for problem in &mut problems {
            if let Some(span) = &mut problem.span {
                *span = inside(text, span.clone());
                let (line, column) = cursor.advance(span.start);
                (problem.line, problem.column) = (Some(line), Some(column));
            }
        }
        problems.dedup();
        Self { name: name.into(), text: text.into(), problems }
    }

    /// The text of a file called `name`, for [`Scenario::read`](super::Scenario::read).
    ///
    /// # Errors
    ///
    /// [`ScenarioError`] if `bytes` are not UTF-8; its text is then as much of them as can be read.
    pub fn decode(name: &str, bytes: Vec<u8>) -> Result<String, Self> {
        String::from_utf8(bytes).map_err(|error| {
            let start = error.utf8_error().valid_up_to();
            let byte = error.as_bytes().get(start).copied().unwrap_or_default();
            let problem = Problem::new("", format!("byte {start} (0x{byte:02x}) is not UTF-8 text"))
                .with_help(Some("a scenario is a TOML file".into()))
                .at(&Source::File, Some(start..start + 1));
            Self::new(name, &String::from_utf8_lossy(error.as_bytes()), vec![problem])
        })
    }
}

/// The line of a byte, from 1.
pub(super) fn line_of(text: &str, byte: usize) -> usize {
    Cursor::new(text).advance(byte).0
}

/// The part of `span` that lies in `text`, on character boundaries.
fn inside(text: &str, span: Range<usize>) -> Range<usize> {
    let start = text.floor_char_boundary(span.start);
    start..text.ceil_char_boundary(span.end.max(start))
}

/// Goes through a text once and keeps track of the position: lines and columns, both from 1. Columns count characters;
/// a byte order mark does not count.
struct Cursor<'a> {
    text: &'a str,
    offset: usize,
    line: usize,
    column: usize,
}

impl<'a> Cursor<'a> {
    fn new(text: &'a str) -> Self {
        Self { text, offset: 0, line: 1, column: 1 }
    }

    /// Line and column of a byte at a character's boundary, not before the last one asked for.
    fn advance(&mut self, offset: usize) -> (usize, usize) {
        let passed = self.text.get(self.offset..offset).unwrap_or_default();
        for character in passed.strip_prefix('\u{feff}').filter(|_| self.offset == 0).unwrap_or(passed).chars() {
            match character {
                '\n' => (self.line, self.column) = (self.line + 1, 1),
                _ => self.column += 1,
            }
        }
        self.offset = self.offset.max(offset);
        (self.line, self.column)
    }
}
