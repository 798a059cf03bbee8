//! Tosses of a real cube, compared with simulations of the same tosses: 570 that were published with their first and
//! last states.
//!
//! Pfrommer, Halm and Posa, "ContactNets: Learning Discontinuous Contact Dynamics with Smooth, Implicit
//! Representations", CoRL 2020. Width, mass, moment of inertia, friction and restitution are the authors' values;
//! nothing is fitted to the tosses here.

mod plot;
mod published;
mod thrown;

use crate::report::{table, thousands};
use crate::{Result, Work};
use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed};
use plaus_sim::Preset;
use plaus_sim::rigid::Start;
use published::{FRICTION, RESTITUTION, Toss, tosses};
use rand::RngExt;
use thrown::{Conditions, End, Summary, ends};

const SEED: u64 = 570;

/// How far starts are moved to see how errors of measurement grow: in m, and in rad.
const NUDGE: (f64, f64) = (1e-3, 0.009);

const HEAD: [&str; 9] = [
    "",
    "distance, % of the width",
    "median",
    "same face up, %",
    "angle, °",
    "angle if the same face is up, °",
    "path along the floor, widths",
    "time to rest, s",
    "not at rest",
];

pub(crate) fn make(work: &mut Work) -> Result<()> {
    if let Some(part) = &work.part {
        return Err(format!("tosses have no part `{part}`: all is made together").into());
    }
    let mut all = tosses()?;
    all.truncate(work.size(all.len(), 12));
    let real = Summary::of(&all, &real(&all));
    let mut rows = vec![{
        let mut cells = vec!["the real cube".to_owned()];
        cells.extend(vec!["–".to_owned(); 5]);
        cells.extend([real.travel.shown(), real.time.shown(), "–".to_owned()]);
        cells
    }];
    let mut found = Vec::new();
    for preset in Preset::ALL {
        work.say(format_args!("tosses: {} at {}", thousands(all.len() as u64), preset.name()));
        let ends = ends(&all, Conditions::of(preset), |_, start| start)?;
        rows.push(row(preset.name(), &Summary::of(&all, &ends)));
        found.push(ends);
    }
    varied(work, &all, &mut rows)?;
    let nudged = nudged(&all, &found[1])?;
    plot::make(work, &all, &found)?;
    describe(work, all.len(), &rows, nudged);
    Ok(())
}

fn row(name: &str, summary: &Summary) -> Vec<String> {
    let mut cells = vec![name.to_owned()];
    cells.extend(summary.cells());
    cells
}

/// The real ends, in the form of simulated ones.
fn real(tosses: &[Toss]) -> Vec<End> {
    let end = |toss: &Toss| End { x: toss.end, turn: toss.end_turn, is_at_rest: true, time: toss.rest };
    tosses.iter().map(end).collect()
}

/// Varies what was not measured with the tosses: friction and restitution; also takes velocities as they are given.
fn varied(work: &Work, tosses: &[Toss], rows: &mut Vec<Vec<String>>) -> Result<()> {
    let standard = Conditions::of(Preset::Standard);
    let sets = [
        ("velocities as given", Conditions { as_given: true, ..standard }),
        ("friction 0.16", Conditions { friction: 0.16, ..standard }),
        ("friction 0.20", Conditions { friction: 0.20, ..standard }),
        ("restitution 0", Conditions { restitution: 0.0, ..standard }),
        ("restitution 0.25", Conditions { restitution: 0.25, ..standard }),
    ];
    for (name, set) in sets {
        work.say(format_args!("tosses: standard, {name}"));
        let found = ends(tosses, set, |_, start| start)?;
        rows.push(row(&format!("standard, {name}"), &Summary::of(tosses, &found)));
    }
    Ok(())
}

/// The ends of starts that are moved and turned a little at random, compared with the ends without that: mean distance
/// in percent of the width, and the share with the same face up.
fn nudged(tosses: &[Toss], ends_before: &[End]) -> Result<(f64, f64)> {
    let nudge = |k: usize, start: Start| {
        let mut rng = Seed(SEED).chain(0).at(k as u64, Purpose::START);
        let mut vector = || DVec3::new(rng.random(), rng.random(), rng.random()) * 2.0 - 1.0;
        // Upwards only, so that no toss starts in the floor; the given length is the root mean square.
        let (by, turn) = (vector() * NUDGE.0, vector() * NUDGE.1);
        Start {
            position: start.position + by.with_z(by.z.abs()),
            orientation: DQuat::from_scaled_axis(turn) * start.orientation,
            ..start
        }
    };
    let found = ends(tosses, Conditions::of(Preset::Standard), nudge)?;
    let as_real: Vec<Toss> =
        tosses.iter().zip(ends_before).map(|(toss, end)| Toss { end: end.x, end_turn: end.turn, ..*toss }).collect();
    let summary = Summary::of(&as_real, &found);
    Ok((summary.off.value, 100.0 * summary.same.value))
}

fn describe(work: &mut Work, count: usize, rows: &[Vec<String>], (off, same): (f64, f64)) {
    let mut text = table(&HEAD, rows.iter().cloned());
    text += &format!(
        "\n{count} tosses of a cube of 10.48 cm, simulated from the published first states to rest. Friction \
         {FRICTION}, restitution {RESTITUTION}, mass and moment of inertia are the publication's: nothing is fitted. \
         Off: distance of the centres at rest along the floor. Turned off: angle between the two orientations; 90° and \
         more where another face is up. Published velocities are means over the 1/148 s before a frame; ours are those \
         at the frame, save in the row that says so.\n\n\
         How much of it is chance: starts moved by up to {} mm and turned by up to {:.1}° about each axis, at \
         standard, end {off:.1} % of the width away from those that are not, in the mean; {same:.1} % with the same \
         face up.\n\n\
         The publication (Pfrommer, Halm and Posa 2020) gives errors of its learned models along the whole way and as \
         a plot, no number for the ends. An earlier version of this simulator had, at standard and with velocities as \
         given, 27.8 % of the width and 82 % with the same face up.\n",
        1e3 * NUDGE.0,
        NUDGE.1.to_degrees(),
    );
    work.report.section("Tosses of a real cube", &text);
}
