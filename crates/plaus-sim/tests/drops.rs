//! Random drops into bins: nothing tunnels, nothing freezes, and marbles at rest are supported. `examples/drops.rs`
//! does the same 10⁵ times.

use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::marbles::Phase;
use plaus_sim::worlds::{Bins, Watch, drops};
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
            let below = |c: &plaus_sim::scenery::Surface| world.scenery().foot(*c, b.path.x).normal.z > 0.0;
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
