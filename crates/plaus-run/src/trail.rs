//! Where a piece could be cut: checkpoints of all its chains after every round, one appended frame for each round.
//!
//! Each piece that looks for distinct solutions goes further than the run will, because the end of the run follows from
//! all pieces together. A merge cuts each piece at the last end of a block before the run's end that all pieces have,
//! and samples the rest again. First solutions are noted as well, for the other pieces: see `siblings`.

use crate::checkpoint::Checkpoint;
use crate::codec::{self, Frames, Kind};
use crate::disk::Disk;
use crate::error::{RunFileError, RunFileProblem};
use crate::folder::Folder;
use plaus_mcmc::Sighting;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use std::fs::File;
use std::io::{ErrorKind, Seek, SeekFrom};
use std::ops::Range;
use std::path::Path;

const KIND: Kind = Kind::new(*b"trai", 3, "a trail of checkpoints");

/// The beginning of a frame: the run, and one past the last iteration.
type Head = (u64, u64);

/// The next parts of a frame: the piece's first chain, its number of chains, and solutions that were new to their chain
/// in this round.
type Next = (u64, u64, u32, u32, Vec<Sighting>);

/// What a trail tells of its piece.
#[derive(Debug, Default)]
pub(crate) struct News {
    /// Solutions that were new to their chain.
    pub(crate) seen: Vec<Sighting>,
    /// Where the frames read end, in bytes.
    pub(crate) until: u64,
    /// The piece's chains, and one past the last iteration that they made; `None` if there is no frame.
    pub(crate) reached: Option<(Range<u32>, u64)>,
}

#[derive(Serialize, Deserialize)]
struct Stored {
    run: u64,
    end_iteration: u64,
    first_chain: u32,
    chains: u32,
    news: Vec<Sighting>,
    checkpoints: Vec<Checkpoint>,
}

/// Adds a round.
pub(crate) fn append(
    folder: &Folder,
    disk: &dyn Disk,
    run: u64,
    news: &[Sighting],
    checkpoints: Vec<Checkpoint>,
) -> Result<(), RunFileError> {
    let Some(first) = checkpoints.first() else { return Ok(()) };
    let path = folder.trail();
    let (end_iteration, first_chain) = (first.snapshot.end_iteration, first.chain);
    let chains = checkpoints.len() as u32;
    let stored = Stored { run, end_iteration, first_chain, chains, news: news.to_vec(), checkpoints };
    let frame = codec::encode(KIND, &stored).map_err(|error| RunFileError::new(&path, error.into()))?;
    disk.append(&path, &frame).map_err(RunFileError::io(&path, "write"))
}

/// The iterations at which rounds end, from the first on, with the start and end of each round's frame in the file.
/// Empty if there is no trail.
///
/// # Errors
///
/// [`RunFileError`] if the file is another run's. Damage ends the list: a trail may end in the middle of a frame.
pub(crate) fn rounds(path: &Path, run: u64) -> Result<Vec<(u64, u64, u64)>, RunFileError> {
    let mut rounds = Vec::new();
    walk::<Head>(path, run, 0, |(of, end_iteration), begin, end| {
        rounds.push((end_iteration, begin, end));
        of
    })?;
    Ok(rounds)
}

/// What rounds tell whose frames begin at byte `from` or after it.
///
/// # Errors
/// As [`rounds`].
pub(crate) fn news_from(path: &Path, run: u64, from: u64) -> Result<News, RunFileError> {
    let mut news = News { until: from, ..News::default() };
    walk::<Next>(path, run, from, |(of, end_iteration, first, chains, seen), _, end| {
        news.seen.extend(seen);
        news.reached = Some((first..first.saturating_add(chains), end_iteration));
        news.until = end;
        of
    })?;
    Ok(news)
}

/// Passes the beginning of each frame from byte `from` on, and its place, to `look`, which returns the frame's run.
fn walk<T: DeserializeOwned>(
    path: &Path,
    run: u64,
    from: u64,
    mut look: impl FnMut(T, u64, u64) -> u64,
) -> Result<(), RunFileError> {
    let mut file = match File::open(path) {
        Err(error) if error.kind() == ErrorKind::NotFound => return Ok(()),
        file => file.map_err(RunFileError::io(path, "read"))?,
    };
    let length = file.metadata().map_err(RunFileError::io(path, "read"))?.len();
    file.seek(SeekFrom::Start(from)).map_err(RunFileError::io(path, "read"))?;
    let mut frames = Frames::<(), _>::new(KIND, file, length.saturating_sub(from));
    loop {
        let begin = from + frames.offset();
        let Some(Ok(frame)) = frames.next_raw() else { return Ok(()) };
        let Ok(head) = codec::head::<T>(KIND, frame) else { return Ok(()) };
        if look(head, begin, from + frames.offset()) != run {
            return Err(RunFileError::new(path, RunFileProblem::Mixed("this trail belongs to another run".into())));
        }
    }
}

/// Number of bytes of the rounds that end at `iteration` or before.
///
/// # Errors
/// As [`rounds`].
pub(crate) fn length_until(path: &Path, run: u64, iteration: u64) -> Result<u64, RunFileError> {
    let rounds = rounds(path, run)?;
    Ok(rounds.iter().take_while(|round| round.0 <= iteration).last().map_or(0, |round| round.2))
}

/// The checkpoints of all chains after the round whose frame lies at the bytes from `begin` to `end`.
///
/// # Errors
/// [`RunFileError`] if the frame is damaged.
pub(crate) fn read(path: &Path, begin: u64, end: u64) -> Result<Vec<Checkpoint>, RunFileError> {
    let mut file = File::open(path).map_err(RunFileError::io(path, "read"))?;
    file.seek(SeekFrom::Start(begin)).map_err(RunFileError::io(path, "read"))?;
    let mut frames = Frames::<Stored, _>::new(KIND, file, end - begin);
    match frames.next() {
        Some(Ok(stored)) => Ok(stored.checkpoints),
        _ => Err(RunFileError::new(path, RunFileProblem::Mixed("the trail changed while it was read".into()))),
    }
}
