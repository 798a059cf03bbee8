//! Pieces that look for distinct solutions together.
//!
//! A run that looks for K solutions ends at the first iteration by which its chains together have recorded K. No piece
//! knows that iteration. Each piece continues until its own chains and those of the other pieces, as far as it knows,
//! have recorded K; this is never too early. So the end of the run follows from what all pieces recorded, not from
//! which piece was faster. The pieces are cut at the last end of a block that is before this iteration and in the
//! trails of all pieces; the rest, less than a block, is sampled again.

use super::pieces::{Piece, Pieces};
use super::{Merging, copy_chain, refuse, seal};
use crate::checkpoint;
use crate::error::{Error, RunFileError};
use crate::folder::Folder;
use crate::read::{Run, RunReader};
use crate::sample::{More, Sampling, resume};
use crate::watch::Unwatched;
use crate::{noted, tally, trail};
use plaus_mcmc::{Ending, Sighting, parallel};
use rayon::ThreadPool;
use std::collections::BTreeSet;

/// The iteration that recorded the last solution asked for; `None` if none were asked for, or if the pieces reached the
/// end of the plan without it.
///
/// # Errors
///
/// [`Error`] if a piece has to be continued before that is known.
pub(super) fn end(pieces: &Pieces, pool: &ThreadPool) -> Result<Option<u64>, Error> {
    let Some(wanted) = pieces.manifest.plan.solutions else { return Ok(None) };
    let done = |piece: &Piece| Ok(pieces.checkpoints(piece)?.first().map_or(0, |one| one.end_iteration));
    let ends = pieces.all.iter().map(done).collect::<Result<Vec<u64>, Error>>()?;
    let least = ends.iter().copied().min().unwrap_or(0);
    let mut all: Vec<Sighting> = Vec::new();
    for piece in &pieces.all {
        let found = parallel::install(pool, || Ok::<_, Error>(seen_in(&Run::open(&piece.folder)?.reader()?)?))?;
        all.extend(found.into_iter().filter(|one| one.first.iteration < least));
    }
    let distinct = noted::taken(all);
    let last = usize::try_from(wanted).ok().and_then(|wanted| distinct.firsts().get(wanted.checked_sub(1)?));
    if last.is_none() && least < pieces.manifest.plan.end() {
        let behind = pieces.all.iter().zip(&ends).find(|(_, end)| **end == least);
        return Err(behind.map_or_else(
            || Error::Request("there are no pieces to merge".to_owned()),
            |(piece, _)| {
                let found = distinct.count();
                let what = format!(
                    "by iteration {least}, where this piece ends, all pieces together have {found} of the {wanted} \
                 distinct solutions: continue it with `plaus resume`"
                );
                refuse(&piece.folder, what)
            },
        ));
    }
    Ok(last.map(|first| first.iteration))
}

/// The first sighting of each class by each chain of a run.
fn seen_in(run: &RunReader<'_>) -> Result<Vec<Sighting>, RunFileError> {
    let found = run.each_chain(|chain| Ok(tally::firsts(run, chain)?.sightings().collect::<Vec<_>>()))?;
    Ok(found.into_iter().flatten().collect())
}

/// Makes the run that ends once iteration `last` is recorded; gives the number of bytes of records copied.
pub(super) fn merge(
    pieces: &Pieces,
    last: u64,
    out: &Folder,
    merging: &Merging<'_>,
    pool: &ThreadPool,
) -> Result<u64, Error> {
    let cut = common_round(pieces, last)?;
    let mut bytes = 0;
    out.make(merging.disk, |draft| -> Result<(), Error> {
        let mut frames = Vec::new();
        for piece in pieces.all.iter().filter(|_| cut > 0) {
            merging.pulse.go_on()?;
            let (copied, stored) = parallel::install(pool, || copy(pieces, piece, cut, draft, merging))?;
            bytes += copied;
            frames.extend(stored);
        }
        seal(pieces, draft, &frames, merging.disk)?;
        let sampling = Sampling { threads: merging.threads, disk: merging.disk, watch: &mut Unwatched, further: None };
        match resume(draft, More::default(), sampling)? {
            Ending::EnoughSolutions => Ok(()),
            ending => Err(Error::Sampling(format!(
                "the pieces' last block was sampled again, and ended differently: {ending:?}"
            ))),
        }
    })?;
    Ok(bytes)
}

/// The last round that ends at iteration `last` or before and that all pieces have in their trails; 0 if there is none.
fn common_round(pieces: &Pieces, last: u64) -> Result<u64, Error> {
    let mut common: Option<BTreeSet<u64>> = None;
    for piece in &pieces.all {
        let rounds = trail::rounds(&piece.folder.trail(), pieces.run)?;
        let ends: BTreeSet<u64> = rounds.into_iter().map(|round| round.0).filter(|&end| end <= last).collect();
        common = Some(match common {
            Some(before) => &before & &ends,
            None => ends,
        });
    }
    Ok(common.and_then(|ends| ends.last().copied()).unwrap_or(0))
}

/// Copies the chains of a piece up to a round; gives the bytes of records, and the checkpoints there.
fn copy(
    pieces: &Pieces,
    piece: &Piece,
    cut: u64,
    draft: &Folder,
    merging: &Merging<'_>,
) -> Result<(u64, Vec<u8>), Error> {
    let path = piece.folder.trail();
    let rounds = trail::rounds(&path, pieces.run)?;
    let Some(&(_, begin, end)) = rounds.iter().find(|round| round.0 == cut) else {
        return Err(refuse(&piece.folder, format!("its trail has no round that ends at iteration {cut}")));
    };
    let checkpoints = trail::read(&path, begin, end)?;
    let one_of = |one: &checkpoint::Checkpoint| -> Result<u64, Error> {
        copy_chain(pieces, piece, one.chain, (one.records, one.snapshot.end_iteration), draft, merging)?;
        let records = draft.records(one.chain);
        merging.disk.sync(&records).map_err(RunFileError::io(&records, "write"))?;
        Ok(one.records)
    };
    let bytes = parallel::try_map(checkpoints.len(), |k| one_of(&checkpoints[k]))?.into_iter().sum();
    Ok((bytes, checkpoint::encode(draft, &checkpoints)?))
}
