//! A `.gltf` with its buffers as one GLB.

use super::AssetError;
use crate::MOST_BYTES;
use crate::xml::Open;
use serde_json::{Value, json};
use std::borrow::Cow;

/// A `.gltf` as a GLB, with all of its buffers, from files beside it or from `data:` addresses; pictures are not read.
/// A GLB stays what it is. `open` reads a file by its path from the `.gltf`'s folder.
///
/// # Errors
///
/// [`AssetError::Broken`] if it is no JSON, or names a buffer that cannot be read or is shorter than the file says;
/// [`AssetError::TooLong`] if the buffers together are too long.
pub fn packed<'a>(bytes: &'a [u8], open: Open<'_>) -> Result<Cow<'a, [u8]>, AssetError> {
    if bytes.starts_with(b"glTF") {
        return Ok(Cow::Borrowed(bytes));
    }
    let broken = |what: String| AssetError::Broken(format!("it is not a valid glTF: {what}"));
    let text = bytes.strip_prefix(b"\xef\xbb\xbf").unwrap_or(bytes);
    let mut file: Value = serde_json::from_slice(text).map_err(|error| broken(error.to_string()))?;
    if !file.is_object() {
        return Err(broken("it begins with no `{`".into()));
    }
    let mut blob: Vec<u8> = Vec::new();
    let mut starts = Vec::new();
    for (index, buffer) in file["buffers"].as_array().into_iter().flatten().enumerate() {
        let wrong = |what: String| AssetError::Broken(format!("buffer {index}: {what}"));
        let Some(uri) = buffer["uri"].as_str() else {
            return Err(wrong("it has no `uri`: only the first buffer of a GLB may have none".into()));
        };
        let data = match uri.strip_prefix("data:") {
            Some(data) => inlined(data).ok_or_else(|| wrong("its `data:` address is not base64".into()))?,
            None if uri.contains("://") => {
                return Err(wrong(format!("{uri} is not on this computer: save it beside the file, and name that")));
            }
            None => {
                let path = unescaped(uri);
                open(&path).map_err(|why| wrong(format!("{path}: {why}")))?
            }
        };
        let length = buffer["byteLength"].as_u64().unwrap_or(0);
        if (data.len() as u64) < length {
            return Err(wrong(format!("it has {} bytes, and {length} are said: export the file again", data.len())));
        }
        blob.resize(blob.len().next_multiple_of(8), 0);
        starts.push(blob.len() as u64);
        if blob.len() + data.len() > MOST_BYTES {
            return Err(AssetError::TooLong { bytes: (blob.len() + data.len()) as u64 });
        }
        blob.extend(data);
    }
    for (index, view) in file["bufferViews"].as_array_mut().into_iter().flatten().enumerate() {
        let start = view["buffer"].as_u64().and_then(|buffer| starts.get(usize::try_from(buffer).ok()?));
        let Some(start) = start.filter(|_| view.is_object()) else {
            return Err(broken(format!("buffer view {index} names a buffer that it does not have")));
        };
        let at = view["byteOffset"].as_u64().unwrap_or(0).saturating_add(*start);
        view["byteOffset"] = at.into();
        view["buffer"] = 0.into();
    }
    if !starts.is_empty() {
        file["buffers"] = json!([{ "byteLength": blob.len() }]);
    }
    joined(&file, blob).map(Cow::Owned)
}

/// A GLB of its JSON and its only buffer.
pub(crate) fn joined(file: &Value, mut blob: Vec<u8>) -> Result<Vec<u8>, AssetError> {
    let broken = |what: String| AssetError::Broken(format!("it is not a valid glTF: {what}"));
    let mut text = serde_json::to_vec(file).map_err(|error| broken(error.to_string()))?;
    text.resize(text.len().next_multiple_of(4), b' ');
    blob.resize(blob.len().next_multiple_of(4), 0);
    let whole = 12 + 8 + text.len() + if blob.is_empty() { 0 } else { 8 + blob.len() };
    let number = |n: usize| u32::try_from(n).map(u32::to_le_bytes).map_err(|_| AssetError::TooLong { bytes: n as u64 });
    let mut glb = [*b"glTF", 2_u32.to_le_bytes(), number(whole)?, number(text.len())?, *b"JSON"].concat();
    glb.extend(text);
    if !blob.is_empty() {
        glb.extend([&number(blob.len())?[..], b"BIN\0", &blob].concat());
    }
    Ok(glb)
}

/// The bytes of a `data:` address, behind its first word; `None` if it is not in base64.
fn inlined(data: &str) -> Option<Vec<u8>> {
    let (kind, text) = data.split_once(',')?;
    if !kind.ends_with(";base64") {
        return None;
    }
    let value = |letter: u8| {
        Some(u32::from(match letter {
            b'A'..=b'Z' => letter - b'A',
            b'a'..=b'z' => letter - b'a' + 26,
            b'0'..=b'9' => letter - b'0' + 52,
            b'+' | b'-' => 62,
            b'/' | b'_' => 63,
            _ => return None,
        }))
    };
    let text = text.trim_end_matches('=').as_bytes();
    let mut bytes = Vec::with_capacity(text.len() / 4 * 3 + 3);
    for group in text.chunks(4) {
        if group.len() == 1 {
            return None;
        }
        let mut bits = 0;
        for k in 0..4 {
            bits = bits << 6 | group.get(k).map_or(Some(0), |&letter| value(letter))?;
        }
        bytes.extend_from_slice(&bits.to_be_bytes()[1..group.len()]);
    }
    Some(bytes)
}

/// A path without its escapes, such as `%20` for a space.
fn unescaped(uri: &str) -> String {
    let mut bytes = Vec::with_capacity(uri.len());
    let mut rest = uri.as_bytes();
    while let [first, more @ ..] = rest {
        let digits = if *first == b'%' { more.get(..2) } else { None };
        let byte = digits.and_then(|two| u8::from_str_radix(std::str::from_utf8(two).ok()?, 16).ok());
        bytes.push(byte.unwrap_or(*first));
        rest = if byte.is_some() { &more[2..] } else { more };
    }
    String::from_utf8(bytes).unwrap_or_else(|_| uri.to_owned())
}
