//! The balls that spell: figures 5 to 8, the claims of section 5.3, and the use of the moves and savings.

mod accelerators;
pub(crate) mod chains;
mod change_all;
mod confirmed;
mod lambda;
mod pictures;
mod speed;
mod traces;
mod words;

use crate::{Make, Result, Work};
use chains::Word;
use plaus_scenes::spelling::{Config, Letters};

/// The paper's first word: ten of 7 × 5 bins, λ = e⁵.
fn hi(change: impl FnOnce(&mut Config)) -> Result<Word> {
    let mut config = Config::default();
    change(&mut config);
    Word::new(&config)
}

/// The paper's second word: thirty of 15 × 7 bins, λ = e^7.25.
fn acm(change: impl FnOnce(&mut Config)) -> Result<Word> {
    hi(|config| {
        (config.text, config.letters) = (Some("ACM".into()), Letters::Tall);
        change(config);
    })
}

/// Parts of the scene's figures by name, as in `--only spelling/words`. Slow parts come last.
const PARTS: &[(&str, Make)] = &[
    ("traces", traces::make),
    ("pictures", pictures::make),
    ("speed", speed::make),
    ("change-all", change_all::make),
    ("lambda", lambda::make),
    ("confirmed", confirmed::make),
    ("accelerators", accelerators::make),
    ("words", words::make),
];

pub(crate) fn make(work: &mut Work) -> Result<()> {
    work.make_parts("spelling", PARTS)
}
