//! Laws over random worlds of every pair of shapes and every way to say a shape: a fixed few of them.
//! `cargo xtask fuzz-worlds` examines as many as there is time for.

use crate::fuzz::Law;
use plaus_sim::Preset;
use std::ops::Range;

/// Examines worlds at presets in turn, and demands that wrong twins are refused, but for one in twenty whose motion
/// does not show what is wrong.
fn holds(law: Law, seeds: Range<u64>, presets: &[Preset]) {
    let (mut report, mut twins) = (Vec::new(), [0; 2]);
    for seed in seeds {
        let preset = presets[seed as usize % presets.len()];
        let Some(verdict) = law.examine(seed, preset) else { continue };
        if verdict.is_breach() {
            report.push(format!("seed {seed} {}: {}", preset.name(), verdict.found));
        }
        if let Some(caught) = verdict.twin {
            twins = [twins[0] + 1, twins[1] + u64::from(caught)];
        }
    }
    assert!(report.is_empty(), "{}: {} worlds\n{}", law.name(), report.len(), report.join("\n"));
    assert!(
        twins[0] > 0 && 20 * twins[1] >= 19 * twins[0],
        "{}: {} of {} twins refused",
        law.name(),
        twins[1],
        twins[0]
    );
}

const QUICK: [Preset; 2] = [Preset::Draft, Preset::Standard];
const FINE: [Preset; 2] = [Preset::Fine, Preset::Reference];

#[test]
fn nothing_passes_through_anything() {
    holds(Law::Through, 0..40, &QUICK);
}

#[test]
fn overlaps_stay_below_the_gap() {
    holds(Law::Overlap, 0..40, &QUICK);
}

#[test]
fn every_run_ends() {
    holds(Law::Ends, 0..40, &QUICK);
}

#[test]
fn energy_never_grows() {
    holds(Law::Energy, 0..40, &QUICK);
}

#[test]
fn momentum_is_kept() {
    holds(Law::Momentum, 0..60, &QUICK);
}

#[test]
fn what_is_held_stays() {
    holds(Law::Held, 0..60, &QUICK);
}

#[test]
fn nothing_trips_over_a_seam() {
    holds(Law::Seams, 0..40, &QUICK);
}

#[test]
fn the_same_world_moves_the_same() {
    holds(Law::Frames, 0..40, &QUICK);
}

#[test]
fn a_box_is_a_box_however_said() {
    holds(Law::Sayings, 0..40, &QUICK);
}

#[test]
fn a_finer_preset_is_no_worse() {
    holds(Law::Presets, 0..24, &FINE);
}
