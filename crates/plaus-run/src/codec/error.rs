//! Why a frame cannot be written or read.

use super::LONGEST_PAYLOAD;
use std::io;

/// A value that cannot be stored.
#[derive(Debug, thiserror::Error)]
#[non_exhaustive]
pub enum EncodeError {
    /// The payload is too long for one frame.
    #[error(
        "{bytes} bytes in one frame, but at most {LONGEST_PAYLOAD} are possible: a smaller `checkpoint_every` makes smaller frames"
    )]
    TooLong {
        /// Its length.
        bytes: usize,
    },
    /// The value's own serialisation failed.
    #[error("cannot be stored: {0}")]
    Value(String),
}

/// A frame that cannot be read.
#[derive(Debug, thiserror::Error)]
#[error("at byte {offset}: {problem}")]
pub struct FrameError {
    /// Where in the file the frame begins.
    pub offset: u64,
    /// What is wrong with it.
    pub problem: FrameProblem,
}

/// What is wrong with a frame.
#[derive(Debug, thiserror::Error)]
pub enum FrameProblem {
    /// The file cannot be read.
    #[error("cannot read: {0}")]
    Io(#[from] io::Error),
    /// It does not begin like a frame.
    #[error("no frame of plaus begins here")]
    Magic,
    /// It holds something else.
    #[error("expected {expected}, found a frame of kind `{found}`")]
    Kind {
        /// The expected kind.
        expected: &'static str,
        /// The tag found.
        found: String,
    },
    /// Another version of plaus wrote it.
    #[error("format version {found} of {name}, but this plaus reads version {known}")]
    Version {
        /// The kind of the frame.
        name: &'static str,
        /// The version this build reads.
        known: u32,
        /// The version found.
        found: u32,
    },
    /// The file ends inside the frame.
    #[error("the file ends inside this frame: {present} bytes are there, {needed} are needed")]
    Truncated {
        /// Length of the frame.
        needed: u64,
        /// Bytes present.
        present: u64,
    },
    /// The length is absurd.
    #[error("its header says {length} bytes, but at most {LONGEST_PAYLOAD} are possible")]
    TooLong {
        /// The stated length.
        length: u64,
    },
    /// The frame changed after it was written.
    #[error("the checksum does not match: bytes were changed after they were written")]
    Checksum,
    /// The checksum is right, but the payload is not a value of this kind.
    #[error("the payload is not valid as {name}: {reason}")]
    Payload {
        /// What it should be.
        name: &'static str,
        /// Why it is not.
        reason: String,
    },
    /// Bytes follow where nothing should.
    #[error("{bytes} unexpected bytes follow")]
    Trailing {
        /// Number of bytes.
        bytes: u64,
    },
}
