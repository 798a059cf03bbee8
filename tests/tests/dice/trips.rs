//! Results of throws: dice at rest, answers to the constraints' questions, and chains that find solutions.

use super::plain::scene;
use plaus_dist::{Purpose, Seed, math};
use plaus_mcmc::{Chain, Goal, State, Target};
use plaus_scenes::dice::{Constraint, Dice, End, FaceUp, FirstImpact, Mark, Passes, PoseAt, RestAt, Work};
use plaus_scenes::{Rules, Scene};

fn thrown(scene: &Dice, count: u64) -> Vec<super::plain::Thrown> {
    let mut work = Work::default();
    let draws = (0..count).map(|k| scene.start(&mut Seed(2).chain(0).at(k, Purpose::START)));
    draws.map(|draw| State::evaluate(scene, draw, &mut work).unwrap()).collect()
}

/// On bumps of any height every throw has one of the defined ends. On a table with small bumps most dice come to lie
/// with a face up, at the height of half an edge.
#[test]
fn every_throw_ends() {
    for state in thrown(&scene(|_| ()), 60) {
        let trip = &state.outcome.trips[0];
        if trip.end == End::AtRest {
            assert!((1..=6).contains(&state.outcome.faces[0]));
            // Bumps of 0.1 mm move its centre by a few times as much.
            assert!((trip.position.z - 0.008).abs() < 0.6e-3, "{}", trip.position.z);
        }
    }
    let rest = thrown(&scene(|_| ()), 60).iter().filter(|state| state.outcome.complete()).count();
    assert!(rest > 40, "{rest}");
    let rough = scene(|config| (config.table.bumps_mm, config.throw.z_mm) = (12.0, 200.0));
    for state in thrown(&rough, 6) {
        assert!(state.log_constraint.is_zero() == (state.outcome.trips[0].end != End::AtRest));
    }
}

/// What a constraint measures on the way agrees with the animation, which a different observer makes.
#[test]
fn constraints_see_what_animations_show() {
    let demands = |time_s: f64| {
        vec![
            Constraint::PoseAt(PoseAt { time_s, velocity_sd: 0.1, angle_sd_deg: 5.0, ..PoseAt::default() }),
            Constraint::Passes(Passes::default()),
            Constraint::FirstImpact(FirstImpact::default()),
            Constraint::RestAt(RestAt::default()),
            Constraint::FaceUp(FaceUp { angle_sd_deg: 10.0, ..FaceUp::default() }),
        ]
    };
    for time in [0.05, 0.2, 0.45, 3.0] {
        let scene = scene(|config| config.constraints = demands(time));
        let state = thrown(&scene, 20).into_iter().find(|state| state.outcome.complete()).unwrap();
        let animation = scene.animate(&state.draw).unwrap();
        let (track, trip) = (&animation.motion.tracks[0], &state.outcome.trips[0]);
        // An animation's y points up, and its z points against the simulator's y.
        let at = |time: f64| {
            let p = track.position(time);
            glam::DVec3::new(p.x, -p.z, p.y)
        };
        assert!(trip.frames[0].position.distance(at(time)) < 1e-9);
        assert!(trip.position.distance(at(animation.motion.duration)) < 1e-9);
        let point = glam::DVec3::new(-0.05, 0.0, 0.04);
        let steps = (0..=40_000).map(|k| animation.motion.duration * f64::from(k) / 40_000.0);
        let nearest = steps.map(|time| at(time).distance(point)).fold(f64::INFINITY, f64::min);
        // Chords of 2 ms deviate from a parabola by 5 µm.
        assert!((trip.nearest[0] - nearest).abs() < 2e-5, "{} {nearest}", trip.nearest[0]);
        assert_eq!(trip.impacts[0][0], animation.motion.impacts[0].time);
        let logs: Vec<f64> = state.outcome.marks.iter().map(|mark: &Mark| mark.log).collect();
        let off = math::hypot(trip.position.x, trip.position.y) * 1e3;
        assert!((logs[3] + 0.5 * math::square(off / 4.0)).abs() < 1e-9);
        let late = (trip.impacts[0][0] - 0.12) / 0.01;
        assert!((logs[2] + 0.5 * late * late).abs() < 1e-9);
        assert!((state.log_constraint.value() - logs.iter().sum::<f64>()).abs() < 1e-9);
    }
}

/// The requested face comes up at the requested place, whichever face it is; and a pose in flight is met.
#[test]
fn chains_find_solutions() {
    let pose = PoseAt { time_s: 0.1, x_mm: -60.0, z_mm: 40.0, sigma_mm: 4.0, ..PoseAt::default() };
    let demands = [
        vec![
            Constraint::RestAt(RestAt { x_mm: 30.0, y_mm: -20.0, ..RestAt::default() }),
            Constraint::FaceUp(FaceUp { face: 3, ..FaceUp::default() }),
        ],
        vec![Constraint::PoseAt(pose)],
    ];
    for constraints in demands {
        let scene = scene(|config| config.constraints = constraints);
        let moves = scene.moves(&Rules::exact()).unwrap();
        let mut chain = Chain::start(&scene, &moves, Seed(2).chain(0)).unwrap();
        let found = (0..5000).any(|_| {
            chain.step().unwrap();
            scene.class(chain.state().by_ref()).is_some()
        });
        assert!(found, "{:?}", scene.config().constraints);
    }
}
