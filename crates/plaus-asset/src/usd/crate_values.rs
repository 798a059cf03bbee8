//! Checks of the values of a binary layer.

use super::crate_file::{self, At, Crate};

/// Most values within each other, and most in all.
const DEEPEST: usize = 16;
const MOST_STEPS: usize = 1 << 23;

/// Compressed lists have at least so many numbers.
const LEAST_COMPRESSED: usize = 4;

/// How the numbers of a list may be compressed.
#[derive(Debug, Clone, Copy, PartialEq)]
enum Pressed {
    Integers,
    Floats,
    Never,
}

/// Of a type that may have lists: the bytes of one, and how lists are compressed.
fn list_of(kind: u64) -> Option<(usize, Pressed)> {
    Some(match kind {
        1 | 2 => (1, Pressed::Never),
        3 | 4 => (4, Pressed::Integers),
        5 | 6 => (8, Pressed::Integers),
        7 => (2, Pressed::Floats),
        8 => (4, Pressed::Floats),
        9 | 48 | 56 => (8, Pressed::Floats),
        11 | 21 => (4, Pressed::Never),
        13 => (32, Pressed::Never),
        14 => (72, Pressed::Never),
        15 => (128, Pressed::Never),
        16 | 27 => (32, Pressed::Never),
        17 | 19 | 28 | 30 => (16, Pressed::Never),
        18 | 20 | 22 | 29 => (8, Pressed::Never),
        23 => (24, Pressed::Never),
        24 | 26 => (12, Pressed::Never),
        25 => (6, Pressed::Never),
        _ => return None,
    })
}

/// Whether the library may read a binary layer.
///
/// # Errors
/// Why not, in words.
pub(super) fn check(bytes: &[u8]) -> Result<(), String> {
    let (mut file, values) = crate_file::read(bytes)?;
    let mut reader = Values::new(&mut file);
    for value in values {
        reader.check(value, 0).map_err(|why| format!("one of its values: {why}"))?;
    }
    Ok(())
}

/// Values of a file.
#[derive(Debug)]
struct Values<'a, 'b> {
    file: &'a mut Crate<'b>,
    steps: usize,
}

/// What a value consists of.
#[derive(Debug, Clone, Copy)]
struct Value {
    kind: u64,
    is_list: bool,
    is_inline: bool,
    is_pressed: bool,
    said: u64,
}

impl Value {
    fn of(bits: u64) -> Self {
        let is = |bit: u32| bits >> bit & 1 == 1;
        let said = bits & ((1 << 48) - 1);
        Self { kind: bits >> 48 & 0xff, is_list: is(63), is_inline: is(62), is_pressed: is(61), said }
    }
}

impl<'a, 'b> Values<'a, 'b> {
    fn new(file: &'a mut Crate<'b>) -> Self {
        Self { file, steps: 0 }
    }

    fn step(&mut self, count: usize) -> Result<(), String> {
        self.steps = self.steps.saturating_add(count);
        if self.steps > MOST_STEPS { Err(format!("it has more than {MOST_STEPS} parts")) } else { Ok(()) }
    }

    /// Refuses a value that the library cannot read safely.
    fn check(&mut self, bits: u64, depth: usize) -> Result<(), String> {
        self.step(1)?;
        if depth > DEEPEST {
            return Err(format!("more than {DEEPEST} values within each other"));
        }
        let value = Value::of(bits);
        let mut at = At { bytes: self.file.bytes, at: usize::try_from(value.said).unwrap_or(usize::MAX) };
        match value.kind {
            10 | 12 | 57 if value.is_list => self.indices(&mut at, self.file.strings, "string"),
            _ if value.is_list || value.kind == 48 => self.list(value, &mut at),
            10 => {
                let index = if value.is_inline { value.said as u32 } else { at.four()? };
                self.within(index, self.file.strings, "string")
            }
            11 | 53 => {
                let index = if value.is_inline { value.said & 0xffff_ffff } else { at.eight()? };
                self.file.token(usize::try_from(index).unwrap_or(usize::MAX))
            }
            12 | 57 => {
                let index = if value.is_inline { value.said as u32 } else { at.four()? };
                let count = if value.is_inline { self.file.tokens.len() } else { self.file.strings };
                self.within(index, count, "string")
            }
            // They cannot be inline, which the library finds itself.
            31..=41 | 45..=50 | 54 | 55 | 58 if value.is_inline => Ok(()),
            31 => self.dictionary(&mut at, depth),
            32..=39 | 54 | 55 => self.edits(value.kind, &mut at, depth),
            40 => self.indices(&mut at, self.file.paths, "path"),
            41 => self.indices(&mut at, self.file.tokens.len(), "token"),
            50 => self.indices(&mut at, self.file.strings, "string"),
            45 => {
                let count = at.count(8)?;
                self.step(count)?;
                (0..2 * count).try_for_each(|_| self.within(at.four()?, self.file.strings, "string"))
            }
            46 => self.samples(&mut at, depth),
            47 => self.payload(&mut at),
            49 => at.count(16).map(|_| ()),
            58 => {
                let count = at.count(8)?;
                self.step(count)?;
                (0..2 * count).try_for_each(|_| self.within(at.four()?, self.file.paths, "path"))
            }
            _ => Ok(()),
        }
    }

    fn within(&self, index: u32, count: usize, what: &str) -> Result<(), String> {
        if (index as usize) < count { Ok(()) } else { Err(format!("{what} {index} of {count}")) }
    }

    /// A count and as many indices.
    fn indices(&mut self, at: &mut At<'_>, most: usize, what: &str) -> Result<(), String> {
        let count = at.count(4)?;
        self.step(count)?;
        (0..count).try_for_each(|_| self.within(at.four()?, most, what))
    }

    fn list(&mut self, value: Value, at: &mut At<'_>) -> Result<(), String> {
        // Of other types there are no lists, which the library finds itself.
        let Some((size, pressed)) = list_of(value.kind) else { return Ok(()) };
        if value.is_inline || (value.is_pressed && pressed == Pressed::Never) {
            return Err("a list is inline, or compressed where that cannot be".into());
        }
        if value.said == 0 {
            return Ok(());
        }
        if self.file.version < 0x0500 {
            at.four()?;
        }
        let count = match self.file.version < 0x0700 {
            true => at.four()? as usize,
            false => usize::try_from(at.eight()?).unwrap_or(usize::MAX),
        };
        let since = if pressed == Pressed::Floats { 0x0600 } else { 0x0500 };
        let is_pressed = value.is_pressed && self.file.version >= since && count >= LEAST_COMPRESSED;
        if !is_pressed {
            let start = *at;
            at.take(count.checked_mul(size).ok_or("a list is too long")?)?;
            if value.kind != 11 {
                return Ok(());
            }
            let mut tokens = start;
            self.step(count)?;
            return (0..count).try_for_each(|_| self.within(tokens.four()?, self.file.tokens.len(), "token"));
        }
        match pressed {
            Pressed::Integers => self.file.integers(at, count, size == 8).map(|_| ()),
            _ => match at.byte()? {
                b'i' => self.file.integers(at, count, false).map(|_| ()),
                b't' => {
                    let table = at.four()? as usize;
                    at.take(table.checked_mul(size).ok_or("a table is too long")?)?;
                    let indices = self.file.integers(at, count, false)?;
                    indices.into_iter().try_for_each(|index| self.within(index as u32, table, "number"))
                }
                _ => Ok(()),
            },
        }
    }

    /// Six lists, those of them that its first byte names.
    fn edits(&mut self, kind: u64, at: &mut At<'_>, depth: usize) -> Result<(), String> {
        let head = at.byte()?;
        for bit in [1, 2, 5, 6, 3, 4] {
            if head >> bit & 1 == 0 {
                continue;
            }
            match kind {
                32 => self.indices(at, self.file.tokens.len(), "token")?,
                33 | 54 => self.indices(at, self.file.strings, "string")?,
                34 => self.indices(at, self.file.paths, "path")?,
                36..=39 => {
                    let size = if matches!(kind, 36 | 38) { 4 } else { 8 };
                    let count = at.count(size)?;
                    _ = at.take(count * size)?;
                }
                35 => {
                    let count = at.count(32)?;
                    for _ in 0..count {
                        self.ends(at)?;
                        at.take(16)?;
                        self.entries(at, depth)?;
                    }
                }
                _ => {
                    let count = at.count(8)?;
                    self.step(count)?;
                    (0..count).try_for_each(|_| self.payload(at))?;
                }
            }
        }
        Ok(())
    }

    /// The file and the prim of an arc.
    fn ends(&self, at: &mut At<'_>) -> Result<(), String> {
        self.within(at.four()?, self.file.strings, "string")?;
        self.within(at.four()?, self.file.paths, "path")
    }

    fn payload(&mut self, at: &mut At<'_>) -> Result<(), String> {
        self.ends(at)?;
        if self.file.version >= 0x0800 {
            at.take(16)?;
        }
        Ok(())
    }

    /// Goes to where an offset from here leads.
    fn jump(&self, at: &mut At<'_>) -> Result<(), String> {
        let from = at.at;
        let offset = at.eight()? as i64;
        let to =
            i64::try_from(from).ok().and_then(|from| from.checked_add(offset)).and_then(|to| usize::try_from(to).ok());
        at.at = to.filter(|&to| to <= self.file.bytes.len()).ok_or("an offset leads out of the file")?;
        Ok(())
    }

    fn dictionary(&mut self, at: &mut At<'_>, depth: usize) -> Result<(), String> {
        self.entries(at, depth)
    }

    /// A count, and as many keys with values elsewhere.
    fn entries(&mut self, at: &mut At<'_>, depth: usize) -> Result<(), String> {
        let count = at.count(12)?;
        for _ in 0..count {
            self.step(1)?;
            self.within(at.four()?, self.file.strings, "string")?;
            self.jump(at)?;
            let bits = at.eight()?;
            self.check(bits, depth + 1)?;
        }
        Ok(())
    }

    fn samples(&mut self, at: &mut At<'_>, depth: usize) -> Result<(), String> {
        self.jump(at)?;
        let times = at.eight()?;
        self.check(times, depth + 1)?;
        self.jump(at)?;
        let count = at.count(8)?;
        for _ in 0..count {
            let bits = at.eight()?;
            self.check(bits, depth + 1)?;
        }
        Ok(())
    }
}
