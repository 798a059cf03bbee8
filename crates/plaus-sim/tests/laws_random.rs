//! Conservation, Coulomb's bound and energy over random worlds of every shape, at every preset; and wrong twins of the
//! records, which the same checks must refuse. Thousands of worlds: the example `laws`.

use crate::laws::campaign::{Case, tally};
use plaus_sim::Preset;

/// Worlds of each case and preset: every kind of body, or pair of kinds, comes up.
const WORLDS: u64 = 24;

fn holds(case: Case) {
    let mut report = Vec::new();
    let mut twins = [0; 2];
    for preset in Preset::ALL {
        let t = tally(case, preset, 0..WORLDS);
        twins = [twins[0] + t.twins[0], twins[1] + t.twins[1]];
        if !t.broken.is_empty() {
            let (throw, kind, worst, size) = t.broken[0];
            let count = t.broken.len();
            let [most, largest] = t.worst;
            report.push(format!(
                "{}: {count} of {WORLDS} broken, first world {throw} ({kind:?}) by {worst:.1e} bounds ({size:.1e}), \
                 worst by {most:.1e} bounds ({largest:.1e})",
                preset.name()
            ));
        }
    }
    assert!(report.is_empty(), "{}\n{}", case.name(), report.join("\n"));
    assert!(
        // A chatter so late in its step that the half kick was due leaves nothing to refuse: 1 of 69.
        twins[0] >= 2 * WORLDS && 20 * twins[1] >= 19 * twins[0],
        "{}: {} of {} twins refused",
        case.name(),
        twins[1],
        twins[0]
    );
}

#[test]
fn a_floor_without_friction_takes_no_horizontal_momentum() {
    holds(Case::Sliding);
}

#[test]
fn a_floor_without_friction_takes_no_spin_about_the_vertical() {
    holds(Case::Turning);
}

#[test]
fn no_body_is_braked_by_more_than_coulomb_allows() {
    holds(Case::Braking);
}

#[test]
fn no_impact_has_more_friction_than_coulomb_allows() {
    holds(Case::Impacts);
}

#[test]
fn energy_never_grows() {
    holds(Case::Energy);
}

#[test]
fn two_bodies_keep_their_momentum() {
    holds(Case::Meeting);
}

#[test]
fn two_bodies_gain_no_energy() {
    holds(Case::MeetingEnergy);
}

#[test]
fn bodies_that_rub_on_ice_keep_their_momentum() {
    holds(Case::Riding);
}
