//! Frames: how values are stored so that damage is noticed before any value is used.
//!
//! A frame is
//!
//! | bytes | what |
//! | --- | --- |
//! | 8 | magic `\x89plaus\r\n`: a copy through a text mode breaks it visibly |
//! | 4 | kind, four ASCII letters |
//! | 4 | version of that kind, little-endian |
//! | 8 | length of the payload, little-endian |
//! | … | payload: bincode 2, standard configuration (little-endian, variable-length whole numbers) |
//! | 32 | BLAKE3 of everything before |
//!
//! A file is one frame, or frames one after the other. No other module of the project uses bincode. Its bytes are
//! frozen and specified, but it is no longer maintained, so only one file should have to change to replace it.
//!
//! ```
//! use plaus_run::codec::{Kind, decode, encode};
//! const GREETING: Kind = Kind::new(*b"helo", 1, "a greeting");
//! let bytes = encode(GREETING, &("hello", 7_u32))?;
//! assert_eq!(decode::<(String, u32)>(GREETING, &bytes)?, ("hello".to_owned(), 7));
//!
//! let mut broken = bytes.clone();
//! broken[30] ^= 1;
//! assert!(decode::<(String, u32)>(GREETING, &broken).is_err());
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

mod error;

pub use error::{EncodeError, FrameError, FrameProblem};

use bincode::config::{Configuration, Limit, LittleEndian, Varint};
use serde::Serialize;
use serde::de::DeserializeOwned;
use std::fs::File;
use std::io::Read;
use std::marker::PhantomData;

const MAGIC: [u8; 8] = *b"\x89plaus\r\n";
const HEADER: usize = 24;
const TRAILER: usize = 32;
/// Longest payload, in bytes. Hostile lengths fail here instead of in an allocation.
pub const LONGEST_PAYLOAD: usize = 1 << 30;

const CONFIG: Configuration<LittleEndian, Varint, Limit<LONGEST_PAYLOAD>> =
    bincode::config::standard().with_limit::<LONGEST_PAYLOAD>();

/// What a frame holds.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Kind {
    tag: [u8; 4],
    version: u32,
    name: &'static str,
}

impl Kind {
    /// A kind of frame: four ASCII letters, the version this build writes and reads, and a name for messages.
    #[must_use]
    pub const fn new(tag: [u8; 4], version: u32, name: &'static str) -> Self {
        Self { tag, version, name }
    }
}

/// Appends a frame that holds `value` to `out`. On an error `out` is as before.
///
/// # Errors
/// [`EncodeError`] if the value is too long or cannot be serialised.
pub fn append<T: Serialize + ?Sized>(kind: Kind, value: &T, out: &mut Vec<u8>) -> Result<(), EncodeError> {
    let start = out.len();
    out.extend_from_slice(&MAGIC);
    out.extend_from_slice(&kind.tag);
    out.extend_from_slice(&kind.version.to_le_bytes());
    out.extend_from_slice(&[0; 8]);
    let written = bincode::serde::encode_into_std_write(value, out, CONFIG);
    let checked = match written {
        Ok(bytes) if bytes <= LONGEST_PAYLOAD => Ok(bytes),
        Ok(bytes) => Err(EncodeError::TooLong { bytes }),
        Err(error) => Err(EncodeError::Value(error.to_string())),
    };
    match checked {
        Ok(bytes) => {
            out[start + HEADER - 8..start + HEADER].copy_from_slice(&(bytes as u64).to_le_bytes());
            let hash = blake3::hash(&out[start..]);
            out.extend_from_slice(hash.as_bytes());
            Ok(())
        }
        Err(error) => {
            out.truncate(start);
            Err(error)
        }
    }
}

/// One frame that holds `value`.
///
/// # Errors
/// As [`append`].
pub fn encode<T: Serialize + ?Sized>(kind: Kind, value: &T) -> Result<Vec<u8>, EncodeError> {
    let mut out = Vec::new();
    append(kind, value, &mut out)?;
    Ok(out)
}

/// The value of a file of one frame.
///
/// # Errors
/// [`FrameError`] if `bytes` are anything but one whole frame of `kind`.
pub fn decode<T: DeserializeOwned>(kind: Kind, bytes: &[u8]) -> Result<T, FrameError> {
    decode_from(kind, bytes, bytes.len() as u64)
}

/// The value of a file of one frame; reads no more than the frame's stated length.
///
/// # Errors
/// As [`decode`], and if the operating system refuses.
pub fn decode_file<T: DeserializeOwned>(kind: Kind, file: File) -> Result<T, FrameError> {
    let length = file.metadata().map_err(|error| FrameError { offset: 0, problem: error.into() })?.len();
    decode_from(kind, file, length)
}

fn decode_from<T: DeserializeOwned>(kind: Kind, input: impl Read, length: u64) -> Result<T, FrameError> {
    let mut frames = Frames::<T, _>::new(kind, input, length);
    let truncated = FrameProblem::Truncated { needed: (HEADER + TRAILER) as u64, present: length };
    let value = frames.next().unwrap_or(Err(FrameError { offset: 0, problem: truncated }))?;
    match length - frames.offset {
        0 => Ok(value),
        bytes => Err(FrameError { offset: frames.offset, problem: FrameProblem::Trailing { bytes } }),
    }
}

/// Bytes read from a file at a time, unless a frame is longer.
const AT_A_TIME: u64 = 1 << 18;

/// The values of a file of frames of one kind, in order. After an error it ends.
#[derive(Debug)]
pub struct Frames<T, R> {
    kind: Kind,
    input: R,
    /// Offset of the next frame in the file, and in the window.
    offset: u64,
    next: usize,
    end: u64,
    /// Bytes read from the file and still needed.
    window: Vec<u8>,
    value: PhantomData<T>,
}

impl<T: DeserializeOwned, R: Read> Frames<T, R> {
    /// Reads frames of `kind` from the first `length` bytes of `input`, many at a time: it needs no buffer of its own.
    pub fn new(kind: Kind, input: R, length: u64) -> Self {
        Self { kind, input, offset: 0, next: 0, end: length, window: Vec::new(), value: PhantomData }
    }

    /// Offset of the next frame; after a damaged frame, the offset of that frame.
    pub fn offset(&self) -> u64 {
        self.offset
    }

    /// The next frame's bytes, with a verified checksum but an unread value; `None` at the end. After an error it ends.
    pub fn next_raw(&mut self) -> Option<Result<&[u8], FrameError>> {
        if self.offset == self.end {
            return None;
        }
        let offset = self.offset;
        match self.read_raw() {
            Ok(length) => Some(Ok(&self.window[self.next - length..self.next])),
            Err(problem) => {
                self.end = self.offset;
                Some(Err(FrameError { offset, problem }))
            }
        }
    }

    /// The bytes of the frames given last, one after the other; `None` while the next frame is also in memory, so that
    /// frames are passed on in large parts. If it is called after every frame, the parts contain all frames.
    pub fn passed(&self) -> Option<&[u8]> {
        let present = &self.window[self.next..];
        let at_hand = self.check_header(present).is_ok_and(|length| frame_of(length) <= present.len() as u64);
        (!at_hand || self.offset == self.end).then(|| &self.window[..self.next])
    }

    fn read(&mut self) -> Result<T, FrameProblem> {
        let length = self.read_raw()?;
        let frame = &self.window[self.next - length..self.next];
        let value = decode_payload(self.kind.name, &frame[HEADER..length - TRAILER]);
        if value.is_err() {
            self.offset -= length as u64;
        }
        value
    }

    /// Brings the next frame into the window, verifies it, and moves past it; gives its length.
    fn read_raw(&mut self) -> Result<usize, FrameProblem> {
        let present = self.end - self.offset;
        let truncated = |needed| Err(FrameProblem::Truncated { needed, present });
        let overhead = frame_of(0);
        if present < overhead {
            return truncated(overhead);
        }
        self.fill(HEADER)?;
        let length = frame_of(self.check_header(&self.window[self.next..])?);
        if present < length {
            return truncated(length);
        }
        let length = length as usize; // at most LONGEST_PAYLOAD and a little
        self.fill(length)?;
        let (content, trailer) = self.window[self.next..self.next + length].split_at(length - TRAILER);
        if blake3::hash(content).as_bytes() != trailer {
            return Err(FrameProblem::Checksum);
        }
        self.next += length;
        self.offset += length as u64;
        Ok(length)
    }

    /// Makes sure that `bytes` bytes after the start of the next frame are in the window, which grows only by bytes
    /// that exist.
    fn fill(&mut self, bytes: usize) -> Result<(), FrameProblem> {
        if self.window.len() - self.next >= bytes {
            return Ok(());
        }
        self.window.drain(..self.next);
        self.next = 0;
        let unread = self.end - self.offset - self.window.len() as u64;
        let wanted = (bytes - self.window.len()) as u64;
        self.input.by_ref().take(wanted.max(AT_A_TIME).min(unread)).read_to_end(&mut self.window)?;
        let present = self.window.len();
        if present < bytes {
            return Err(FrameProblem::Truncated { needed: bytes as u64, present: present as u64 });
        }
        Ok(())
    }

    /// The length of the payload of the frame that begins with `bytes`.
    fn check_header(&self, bytes: &[u8]) -> Result<u64, FrameProblem> {
        let Some(header) = bytes.first_chunk::<HEADER>() else {
            return Err(FrameProblem::Truncated { needed: HEADER as u64, present: bytes.len() as u64 });
        };
        let field = |from: usize| std::array::from_fn::<u8, 4, _>(|i| header[from + i]);
        if header[..8] != MAGIC {
            return Err(FrameProblem::Magic);
        }
        let (tag, found) = (field(8), u32::from_le_bytes(field(12)));
        let Kind { tag: expected, version: known, name } = self.kind;
        if tag != expected {
            let found = tag.escape_ascii().to_string();
            return Err(FrameProblem::Kind { expected: name, found });
        }
        if found != known {
            return Err(FrameProblem::Version { name, known, found });
        }
        let length = u64::from(u32::from_le_bytes(field(16))) | u64::from(u32::from_le_bytes(field(20))) << 32;
        if length > LONGEST_PAYLOAD as u64 {
            return Err(FrameProblem::TooLong { length });
        }
        Ok(length)
    }
}

/// The length of a frame with this length of payload.
fn frame_of(payload: u64) -> u64 {
    (HEADER + TRAILER) as u64 + payload
}

impl<T: DeserializeOwned, R: Read> Iterator for Frames<T, R> {
    type Item = Result<T, FrameError>;

    fn next(&mut self) -> Option<Self::Item> {
        if self.offset == self.end {
            return None;
        }
        let offset = self.offset;
        Some(self.read().map_err(|problem| {
            self.end = self.offset;
            FrameError { offset, problem }
        }))
    }
}

/// The beginning of a frame's value, if its first fields are those of `T`. The frame must come from
/// [`Frames::next_raw`].
///
/// # Errors
/// [`FrameProblem`] if it does not begin with these.
pub fn head<T: DeserializeOwned>(kind: Kind, frame: &[u8]) -> Result<T, FrameProblem> {
    let payload = frame.get(HEADER..frame.len().saturating_sub(TRAILER)).unwrap_or_default();
    let decoded = bincode::serde::decode_from_slice::<T, _>(payload, CONFIG);
    decoded
        .map(|(value, _)| value)
        .map_err(|error| FrameProblem::Payload { name: kind.name, reason: error.to_string() })
}

fn decode_payload<T: DeserializeOwned>(name: &'static str, payload: &[u8]) -> Result<T, FrameProblem> {
    match bincode::serde::decode_from_slice::<T, _>(payload, CONFIG) {
        Ok((value, used)) if used == payload.len() => Ok(value),
        Ok((_, used)) => {
            Err(FrameProblem::Payload { name, reason: format!("{} bytes are left over", payload.len() - used) })
        }
        Err(error) => Err(FrameProblem::Payload { name, reason: error.to_string() }),
    }
}

#[cfg(test)]
mod tests;
