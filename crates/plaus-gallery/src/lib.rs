//! The gallery: distinct solutions of a run as one page that plays them in 3D, from disk and offline.
//!
//! ```no_run
//! use plaus_gallery::{Options, gallery};
//! use plaus_run::{Folder, Run};
//!
//! let run = Run::open(&Folder::new("runs/ball2d"))?;
//! let made = gallery(&run.reader()?, &Options::default())?;
//! std::fs::write("gallery.html", made.html)?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! It shows those that [differ most](solutions::most_different); [`features`] are what [`map`] lays out in the plane.
//! `pack` turns closed-form pieces into bytes, and `page` makes a page from the bytes. The page's own program is in the
//! package's folder `web`.

pub mod features;
pub mod map;
mod models;
mod pack;
mod page;
mod sounds;
mod words;

use features::Features;
use plaus_run::replay::replay_each_until;
use plaus_run::{Error, RunReader, SampleId, solutions};
use plaus_scenes::Until;

/// What to show.
#[derive(Debug, Clone)]
pub struct Options {
    /// Largest number of solutions on the page.
    pub count: usize,
    /// The run's folder, in the form that commands to copy show.
    pub run: String,
    /// Where each animation ends.
    pub until: Until,
}

impl Default for Options {
    fn default() -> Self {
        Self { count: 64, run: "RUN".to_owned(), until: Until::Rest }
    }
}

/// A page.
#[derive(Debug, Clone)]
pub struct Gallery {
    /// Its complete text.
    pub html: String,
    /// Number of solutions on it.
    pub shown: usize,
    /// Number of distinct solutions of the run.
    pub distinct: usize,
}

/// The beginning of every gallery: exports replace only files that begin with it.
pub const HEAD: &str = page::HEAD;

/// Makes a page of a run's distinct satisfying solutions.
///
/// # Errors
/// [`Error`] if no sample satisfies the constraint, or the run cannot be read.
pub fn gallery(run: &RunReader<'_>, options: &Options) -> Result<Gallery, Error> {
    let chosen = solutions::most_different(run, options.count)?;
    if chosen.distinct == 0 {
        return Err(Error::Request(
            "no sample of the run satisfies the constraint: there is nothing to show".to_owned(),
        ));
    }
    let ids: Vec<SampleId> = chosen.solutions.iter().map(|solution| solution.sample).collect();
    let replays = replay_each_until(run, &ids, options.until, |replay| replay)?;
    let features = Features::of(replays.iter().map(|replay| features::Paths::of(&replay.animation)).collect());
    let maps = map::Maps { outcomes: map::of(&features.outcomes), paths: map::of(&features.paths) };
    let (distinct, candidates) = (chosen.distinct, chosen.compared);
    let packed = pack::pack(run, &replays, &maps, &pack::About { options, distinct, candidates });
    Ok(Gallery { html: page::html(run.run().manifest(), &packed), shown: replays.len(), distinct })
}
