//! Bowling: figures 3 and 4; what the paper did not show (different strikes, paths of the ball, pins that fall); and
//! how soon shots are found.

mod falls;
mod first;
mod lane;
mod moves;
mod paths;
mod pictures;
mod plan;
mod seven_ten;
mod shots;
mod strikes;

use crate::{Make, Result, Work};

/// Parts of the scene's figures by name, as in `--only bowling/first`. Slow parts come last.
const PARTS: &[(&str, Make)] = &[
    ("lane", lane::make),
    ("pictures", pictures::make),
    ("strikes", strikes::make),
    ("paths", paths::make),
    ("falls", falls::make),
    ("first", first::make),
    ("rates", first::rates),
    ("moves", moves::make),
    ("seven-ten", seven_ten::make),
];

pub(crate) fn make(work: &mut Work) -> Result<()> {
    work.make_parts("bowling", PARTS)
}
