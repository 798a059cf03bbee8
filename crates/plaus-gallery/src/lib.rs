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
//! It shows those that [differ most](plaus_run::solutions::most_different); `features` are what `map` lays out in the
//! plane. `pack` turns closed-form pieces into bytes, and `page` makes a page from the bytes. The page's own program is
//! in the package's folder `web`. A page may carry the sampler: [`live`] is what it does there.

mod features;
#[cfg(feature = "run")]
pub mod label;
pub mod live;
mod map;
mod models;
mod pack;
#[cfg(feature = "run")]
mod page;
mod sounds;
#[cfg(feature = "run")]
mod whole;
mod words;

#[cfg(feature = "run")]
mod made;
#[cfg(feature = "run")]
pub use made::{Gallery, HEAD, Options, gallery};
#[cfg(feature = "run")]
pub use page::playground;
