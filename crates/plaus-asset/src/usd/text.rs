//! Checks of the text of a layer before the library reads it.

/// Most brackets within each other: of prims, and of what is said of them.
const DEEPEST: usize = 220;

/// Longest text, in bytes: what is read of it takes nine times as much memory.
const LONGEST: usize = 32 << 20;

/// Whether the library may read a text: it is UTF-8, begins as it should, and its brackets are not too deep.
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
    let (mut depth, mut line, mut at) = (0_usize, 1, 0);
    let bytes = text.as_bytes();
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'\n' => line += 1,
            b'#' => {
                at += bytes[at..].iter().position(|&byte| byte == b'\n').unwrap_or(bytes.len() - at);
                continue;
            }
            quote @ (b'"' | b'\'') => {
                let (end, lines) = string(bytes, at, quote);
                line += lines;
                at = end;
                continue;
            }
            b'(' | b'[' | b'{' => {
                depth += 1;
                if depth > DEEPEST {
                    return Err(format!("line {line}: more than {DEEPEST} brackets within each other"));
                }
            }
            b')' | b']' | b'}' => depth = depth.saturating_sub(1),
            _ => {}
        }
        at += 1;
    }
    Ok(())
}

/// Where a string ends that begins here, and how many lines it has.
fn string(bytes: &[u8], start: usize, quote: u8) -> (usize, usize) {
    let is_long = bytes.get(start..start + 3) == Some(&[quote; 3]);
    let (mut at, mut lines) = (start + if is_long { 3 } else { 1 }, 0);
    while let Some(&byte) = bytes.get(at) {
        match byte {
            b'\\' => at += 1,
            b'\n' if !is_long => return (at, lines),
            b'\n' => lines += 1,
            _ if byte == quote && !is_long => return (at + 1, lines),
            _ if byte == quote && bytes.get(at..at + 3) == Some(&[quote; 3]) => return (at + 3, lines),
            _ => {}
        }
        at += 1;
    }
    (bytes.len(), lines)
}
