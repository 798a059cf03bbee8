//! Random drops into bins: nothing tunnels, nothing freezes, marbles at rest are supported, and labels do not matter.
//! The example `spelling_drops` does the same 10⁵ times.

use super::watch::Watch;
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_scenes::spelling::{Bins, drops};
use plaus_sim::marbles::{Phase, Start};
use plaus_sim::{Accuracy, Outcome, Preset, Scratch};

fn check(preset: Preset, runs: u64) {
    let bins = Bins::default();
    let mut world = bins.world(10, Accuracy::preset(preset), 2.0).unwrap();
    let mut scratch = Scratch::default();
    let mut resting = 0;
    for run in 0..runs {
        let mut stream = Seed(11).chain(0).at(run, Purpose::START);
        let mut uniform = || open_unit(&mut stream);
        world.move_vertices(&bins.perturbed(0.0001, &mut uniform)).unwrap();
        let mut state = world.state(&drops(&bins, 10, 0.1, &mut uniform)).unwrap();
        let mut watch = Watch::new(&bins, 10);
        let outcome = world.run(&mut state, &mut scratch, 2.0, &mut watch).unwrap();
        assert!(matches!(outcome, Outcome::AllAtRest | Outcome::TimeReached), "run {run}: {outcome:?}");
        assert_eq!(watch.tunnelled(), 0, "run {run}");
        for (k, b) in state.bodies().iter().enumerate().filter(|(_, b)| b.phase == Phase::Rest) {
            let below = |c: &plaus_sim::scenery::Surface| world.scenery().project(*c, b.path.x).normal.z > 0.0;
            assert!(
                b.contacts().iter().any(below) || state.links().of(k as u32).next().is_some(),
                "run {run}: marble {k} hovers"
            );
            resting += 1;
        }
    }
    // One marble in a hundred still rolls after two seconds.
    assert!(resting as f64 > 0.97 * 10.0 * runs as f64, "{resting}");
}

#[test]
fn standard_drops() {
    check(Preset::Standard, 300);
}

#[test]
fn draft_drops() {
    check(Preset::Draft, 300);
}

#[test]
fn fine_drops() {
    check(Preset::Fine, 60);
}

/// Ten marbles dropped into two bins lie on and roll over each other. Whatever their labels, they do the same to the
/// last bit.
#[test]
fn relabelling_ten_marbles_in_contact_permutes_the_result() {
    const COUNT: usize = 10;
    let bins = Bins { columns: 2, rows: 1, ..Bins::default() };
    let world = bins.world(COUNT, Accuracy::default(), 2.0).unwrap();
    let mut linked = 0;
    for run in 0..5 {
        let mut stream = Seed(11).chain(0).at(run, Purpose::START);
        let starts = drops(&bins, COUNT, 0.05, || open_unit(&mut stream));
        let dropped = |starts: &[Start]| {
            let mut state = world.state(starts).unwrap();
            let outcome = world.run(&mut state, &mut Scratch::default(), 2.0, &mut ()).unwrap();
            (outcome, state)
        };
        let (outcome, plain) = dropped(&starts);
        linked += plain.links().len();
        // Reversed, and every third: both far from the order of the drops.
        for order in [(0..COUNT).rev().collect::<Vec<_>>(), (0..COUNT).map(|k| (3 * k + 1) % COUNT).collect()] {
            let shuffled: Vec<Start> = order.iter().map(|&k| starts[k]).collect();
            let (same, state) = dropped(&shuffled);
            assert_eq!(outcome, same, "draw {run}");
            for (k, &label) in order.iter().enumerate() {
                assert_eq!(plain.bodies()[label].path, state.bodies()[k].path, "marble {label} of draw {run}");
                assert_eq!(plain.bodies()[label].spin, state.bodies()[k].spin, "marble {label} of draw {run}");
            }
        }
    }
    assert!(linked > 5 * COUNT / 2, "too few lasting contacts: {linked}");
}
