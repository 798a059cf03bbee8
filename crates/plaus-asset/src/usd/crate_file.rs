//! Checks of a binary layer before the library reads it: that all counts, indices and offsets lie within it, that
//! nothing is in itself, and that nothing becomes much larger than the file. The library takes that for granted.

use std::collections::BTreeSet;

/// How a binary layer begins.
pub(super) const MAGIC: &[u8] = b"PXR-USDC";

/// Versions that the library reads: the first three numbers of the file's.
const VERSIONS: std::ops::RangeInclusive<u32> = 0x00_0400..=0x00_0cff;
/// Most numbers of one list, and most of all that is decompressed, in bytes.
const MOST_NUMBERS: usize = 1 << 23;
const MOST_UNPACKED: usize = 1 << 28;
/// Most paths, letters of all of them together, and names in one.
const MOST_PATHS: usize = 1 << 20;
const MOST_LETTERS: usize = 1 << 26;
const DEEPEST: usize = 256;

/// A place in a file.
#[derive(Debug, Clone, Copy)]
pub(super) struct At<'a> {
    pub(super) bytes: &'a [u8],
    pub(super) at: usize,
}

impl<'a> At<'a> {
    pub(super) fn take(&mut self, count: usize) -> Result<&'a [u8], String> {
        let end = self.at.checked_add(count);
        let found = end.and_then(|end| self.bytes.get(self.at..end));
        let found = found.ok_or_else(|| format!("it ends at byte {}, and more is said to follow", self.bytes.len()))?;
        self.at += count;
        Ok(found)
    }

    fn number<const N: usize>(&mut self) -> Result<[u8; N], String> {
        self.take(N)?.try_into().map_err(|_| "it is too short".to_owned())
    }

    pub(super) fn byte(&mut self) -> Result<u8, String> {
        Ok(u8::from_le_bytes(self.number()?))
    }

    pub(super) fn four(&mut self) -> Result<u32, String> {
        Ok(u32::from_le_bytes(self.number()?))
    }

    pub(super) fn eight(&mut self) -> Result<u64, String> {
        Ok(u64::from_le_bytes(self.number()?))
    }

    /// A count of things, each of so many bytes in the file, at least.
    pub(super) fn count(&mut self, size: usize) -> Result<usize, String> {
        let count = usize::try_from(self.eight()?).unwrap_or(usize::MAX);
        let rest = self.bytes.len() - self.at;
        match count.checked_mul(size) {
            Some(length) if length <= rest => Ok(count),
            _ => Err(format!("byte {}: {count} things do not fit into what follows", self.at)),
        }
    }
}

/// A file, as far as it is known.
#[derive(Debug)]
pub(super) struct Crate<'a> {
    pub(super) bytes: &'a [u8],
    /// The first three numbers of its version.
    pub(super) version: u32,
    /// The lengths of its tokens.
    pub(super) tokens: Vec<usize>,
    pub(super) strings: usize,
    pub(super) paths: usize,
    /// How many bytes may still be decompressed.
    left: usize,
}

/// A binary layer whose structure the library may read, and its values, each once, however many fields have it.
///
/// # Errors
/// Why it may not, in words.
pub(super) fn read(bytes: &[u8]) -> Result<(Crate<'_>, BTreeSet<u64>), String> {
    let mut head = At { bytes, at: 8 };
    let version = head.take(8)?;
    let version = u32::from(version[0]) << 16 | u32::from(version[1]) << 8 | u32::from(version[2]);
    if !VERSIONS.contains(&version) {
        let [major, minor, patch] = [version >> 16, version >> 8 & 0xff, version & 0xff];
        return Err(format!("its version is {major}.{minor}.{patch}: save it again as version 0.4 to 0.12"));
    }
    let mut list = At { bytes, at: usize::try_from(head.eight()?).unwrap_or(usize::MAX) };
    let mut file = Crate { bytes, version, tokens: Vec::new(), strings: 0, paths: 0, left: MOST_UNPACKED };
    let count = list.count(32)?;
    let mut sections = Vec::new();
    for _ in 0..count {
        let name = list.take(16)?;
        let end = name.iter().position(|&byte| byte == 0).unwrap_or(16);
        let start = usize::try_from(list.eight()?).unwrap_or(usize::MAX);
        list.take(8)?;
        sections.push((&name[..end], start));
    }
    // The first of a name counts.
    let section = |name: &[u8]| sections.iter().find(|(known, _)| *known == name).map(|&(_, at)| At { bytes, at });
    let said = |name: &str, why: String| format!("its section {name}: {why}");
    if let Some(mut at) = section(b"TOKENS") {
        file.tokens(&mut at).map_err(|why| said("TOKENS", why))?;
    }
    if let Some(mut at) = section(b"STRINGS") {
        file.strings(&mut at).map_err(|why| said("STRINGS", why))?;
    }
    let mut fields = Vec::new();
    if let Some(mut at) = section(b"FIELDS") {
        fields = file.fields(&mut at).map_err(|why| said("FIELDS", why))?;
    }
    if let Some(mut at) = section(b"FIELDSETS") {
        file.list(&mut at).map_err(|why| said("FIELDSETS", why))?;
    }
    if let Some(mut at) = section(b"PATHS") {
        file.paths(&mut at).map_err(|why| said("PATHS", why))?;
    }
    if let Some(mut at) = section(b"SPECS") {
        let count = file.counted(&mut at).map_err(|why| said("SPECS", why))?;
        for _ in 0..3 {
            file.integers(&mut at, count, false).map_err(|why| said("SPECS", why))?;
        }
    }
    Ok((file, fields.into_iter().collect()))
}

impl Crate<'_> {
    /// A count of compressed things.
    fn counted(&self, at: &mut At<'_>) -> Result<usize, String> {
        let count = usize::try_from(at.eight()?).unwrap_or(usize::MAX);
        if count <= MOST_NUMBERS { Ok(count) } else { Err(format!("{count} numbers: at most {MOST_NUMBERS} are read")) }
    }

    /// Decompresses up to so many bytes.
    fn unpacked(&mut self, at: &mut At<'_>, most: usize) -> Result<Vec<u8>, String> {
        let length = at.count(1)?;
        let input = at.take(length)?;
        match input.first() {
            None => return Err("what is compressed is empty".into()),
            Some(0) => {}
            Some(_) => return Err("something in it is compressed in chunks, as it is too large: split it up".into()),
        }
        let left = self.left.checked_sub(most).ok_or("decompressed, it is too large: at most 256 MiB are read")?;
        self.left = left;
        let mut output = vec![0; most];
        let size = lz4_flex::block::decompress_into(&input[1..], &mut output).map_err(|error| error.to_string())?;
        output.truncate(size);
        Ok(output)
    }

    /// Compressed integers; `is_wide` if they have eight bytes. What they are is told of narrow ones.
    pub(super) fn integers(&mut self, at: &mut At<'_>, count: usize, is_wide: bool) -> Result<Vec<i32>, String> {
        if count > MOST_NUMBERS {
            return Err(format!("{count} numbers: at most {MOST_NUMBERS} are read"));
        }
        let codes = (2 * count).div_ceil(8);
        let most = if count == 0 { 0 } else { 4 + codes + 4 * count };
        let data = self.unpacked(at, most)?;
        if count == 0 {
            return Ok(Vec::new());
        }
        let head = if is_wide { 8 } else { 4 };
        if data.len() < head + codes {
            return Err("its compressed numbers are too few".into());
        }
        if is_wide {
            return Ok(Vec::new());
        }
        let mut numbers = At { bytes: &data, at: head + codes };
        let usual = At { bytes: &data, at: 0 }.four()? as i32;
        let (mut all, mut last) = (Vec::with_capacity(count), 0_i32);
        for k in 0..count {
            let step = match data[head + k / 4] >> (2 * (k % 4)) & 3 {
                0 => usual,
                1 => i32::from(numbers.byte()? as i8),
                2 => i32::from(i16::from_le_bytes(numbers.number()?)),
                _ => numbers.four()? as i32,
            };
            last = last.wrapping_add(step);
            all.push(last);
        }
        Ok(all)
    }

    fn list(&mut self, at: &mut At<'_>) -> Result<Vec<i32>, String> {
        let count = self.counted(at)?;
        self.integers(at, count, false)
    }

    fn tokens(&mut self, at: &mut At<'_>) -> Result<(), String> {
        let count = self.counted(at)?;
        let most = usize::try_from(at.eight()?).unwrap_or(usize::MAX);
        let text = self.unpacked(at, most)?;
        if text.len() != most || text.last().is_some_and(|&last| last != 0) {
            return Err("its text has another length than it says, or does not end".into());
        }
        let all = text.split(|&byte| byte == 0).map(<[u8]>::len);
        self.tokens = all.take(text.iter().filter(|&&byte| byte == 0).count()).collect();
        if self.tokens.len() == count { Ok(()) } else { Err(format!("it has not {count} tokens, as it says")) }
    }

    fn strings(&mut self, at: &mut At<'_>) -> Result<(), String> {
        self.strings = at.count(4)?;
        for _ in 0..self.strings {
            let token = at.four()? as usize;
            self.token(token)?;
        }
        Ok(())
    }

    /// Refuses a token that there is not.
    pub(super) fn token(&self, index: usize) -> Result<(), String> {
        if index < self.tokens.len() { Ok(()) } else { Err(format!("token {index} of {}", self.tokens.len())) }
    }

    /// The values of all fields.
    fn fields(&mut self, at: &mut At<'_>) -> Result<Vec<u64>, String> {
        let count = self.counted(at)?;
        for token in self.integers(at, count, false)? {
            self.token(token as u32 as usize)?;
        }
        let data = self.unpacked(at, 8 * count)?;
        if data.len() != 8 * count {
            return Err(format!("it has not {count} values, as it says"));
        }
        Ok(data.chunks_exact(8).filter_map(|eight| eight.try_into().ok()).map(u64::from_le_bytes).collect())
    }

    fn paths(&mut self, at: &mut At<'_>) -> Result<(), String> {
        self.paths = usize::try_from(at.eight()?).unwrap_or(usize::MAX);
        if self.paths > MOST_PATHS {
            return Err(format!("{} paths: at most {MOST_PATHS} are read", self.paths));
        }
        let count = self.counted(at)?;
        let (indices, tokens) = (self.integers(at, count, false)?, self.integers(at, count, false)?);
        let jumps = self.integers(at, count, false)?;
        if count == 0 {
            return Ok(());
        }
        let mut seen = vec![false; count];
        let mut letters = 0;
        // Where a branch begins, and the length and depth of what is above it.
        let mut open = vec![(0, 0, 0)];
        while let Some((mut index, mut above, mut depth)) = open.pop() {
            loop {
                if index >= count || std::mem::replace(&mut seen[index], true) {
                    return Err("its tree of paths goes round, or beyond its end".into());
                }
                let is_root = depth == 0;
                let (path, length) = if is_root {
                    (index, 1)
                } else {
                    let token = tokens[index].unsigned_abs() as usize;
                    self.token(token)?;
                    (indices[index] as u32 as usize, above + 1 + self.tokens[token])
                };
                letters += length;
                if path >= self.paths || indices[index] as u32 as usize >= self.paths {
                    return Err(format!("path {path} of {}", self.paths));
                }
                if letters > MOST_LETTERS || depth > DEEPEST {
                    return Err(format!("its paths are too long: at most {DEEPEST} names are read"));
                }
                let (has_child, has_sibling) = (jumps[index] > 0 || jumps[index] == -1, jumps[index] >= 0);
                let own = if is_root { (1, 1) } else { (above, depth) };
                if has_child {
                    if has_sibling {
                        open.push((index + jumps[index] as usize, own.0, own.1));
                    }
                    // What is below the root, or what is beside it, is one deep.
                    (above, depth) = if is_root { (1, 1) } else { (length, depth + 1) };
                } else {
                    (above, depth) = own;
                }
                if !has_child && !has_sibling {
                    break;
                }
                index += 1;
            }
        }
        Ok(())
    }
}
