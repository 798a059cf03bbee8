//! Bowling: figures 3 and 4, what the paper did not show (different strikes, paths of the ball, pins that fall), and how soon shots are found.

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

use crate::{Result, Work};

/// A part of the scene's figures, by name: `--only bowling/first`. What takes long comes last; the report can be read before.
type Part = (&'static str, fn(&mut Work) -> Result<()>);

const PARTS: &[Part] = &[
    ("lane", lane::make),
    ("pictures", pictures::make),
    ("strikes", strikes::make),
    ("paths", paths::make),
    ("falls", falls::make),
    ("first", first::make),
    ("moves", moves::make),
    ("seven-ten", seven_ten::make),
];

pub(crate) fn make(work: &mut Work) -> Result<()> {
    let wanted = work.part.clone();
    if let Some(wanted) = wanted.as_ref().filter(|wanted| !PARTS.iter().any(|(name, _)| name == wanted)) {
        let known: Vec<&str> = PARTS.iter().map(|(name, _)| *name).collect();
        return Err(format!("bowling has no part `{wanted}`, only {}", known.join(", ")).into());
    }
    for (name, part) in PARTS.iter().filter(|(name, _)| wanted.as_deref().is_none_or(|wanted| wanted == *name)) {
        work.say(format_args!("part {name}"));
        part(work)?;
        work.write_report()?;
    }
    Ok(())
}
