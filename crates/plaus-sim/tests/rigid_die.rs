//! Dice on tables: rest, fairness, energy, scale, restart, extremes, faults.

use crate::common::bumps::noise;
use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed, open_unit};
use plaus_sim::field::{Grid, Spline};
use plaus_sim::rigid::{BodySpec, Phase, RigidBodyState, RigidWorld, RigidWorldDesc, Start, StaticShape, Table};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::{Cuboid, Shape};
use plaus_sim::trace::Observer;
use plaus_sim::worlds::DieOnTable;
use plaus_sim::{Accuracy, Law, Laws, Material, Outcome, Preset, Scratch, State, WorldError};

fn throws(count: u64) -> impl Iterator<Item = Start> {
    let die = DieOnTable::default();
    (0..count).map(move |k| {
        let mut stream = Seed(11).chain(0).at(k, Purpose::START);
        die.throw(|| open_unit(&mut stream))
    })
}

fn corners(body: &RigidBodyState) -> impl Iterator<Item = DVec3> + '_ {
    let half = 0.008;
    (0..8).map(move |k| {
        let side = |bit: u32| if k >> bit & 1 == 1 { half } else { -half };
        body.path.x + body.turn * DVec3::new(side(0), side(1), side(2))
    })
}

#[test]
fn a_die_lands_flat_and_stays() {
    let die = DieOnTable::default();
    let world = die.world(noise).unwrap();
    let mut scratch = Scratch::default();
    for start in throws(100) {
        let mut state = world.state(&[start]).unwrap();
        assert_eq!(world.run(&mut state, &mut scratch, 20.0, &mut ()).unwrap(), Outcome::AllAtRest);
        let body = state.bodies()[0].clone();
        // Four corners on the table: none in it, none farther off than the preset's gap of 1e-5 half edges.
        let mut heights: Vec<f64> = corners(&body).map(|c| c.z).collect();
        heights.sort_by(f64::total_cmp);
        assert!(heights[0] > -1e-15, "{heights:?}");
        assert!(heights[3] <= 1e-5 * 0.008, "{heights:?}");
        assert!(heights[4] > 0.0159);
        // Not a bit of drift in a minute.
        let later = world.at(0, &body, state.time() + 60.0);
        assert_eq!((later.path.x, later.turn), (body.path.x, body.turn));
    }
}

#[test]
fn a_bumpy_table_ends_in_rest_on_three_points_or_more() {
    for bumps in [0.1, 0.3, 1.5] {
        let die = DieOnTable { bumps, ..DieOnTable::default() };
        let mut scratch = Scratch::default();
        for start in throws(25) {
            let start = Start { position: start.position + DVec3::new(0.0, 0.0, 0.1), ..start };
            let world = die.world(noise).unwrap();
            let mut state = world.state(&[start]).unwrap();
            let outcome = world.run(&mut state, &mut scratch, 20.0, &mut ()).unwrap();
            // Bumps higher than the die may wedge it for ever in slow motion; that is also an outcome.
            if bumps < 1.0 {
                assert_eq!(outcome, Outcome::AllAtRest);
            }
            let body = &state.bodies()[0];
            let StaticShape::Table(table) = &world.parts()[0] else { unreachable!() };
            if body.phase == Phase::Rest {
                assert!(body.touching().len() >= 3);
            }
            for c in corners(body) {
                // No corner is in the table by more than the preset's gap of 1e-5 half edges.
                assert!(
                    c.z - table.height.value(c.x, c.y) > -1e-5 * 0.008,
                    "{} at {c}",
                    c.z - table.height.value(c.x, c.y)
                );
            }
        }
    }
}

/// 1,200 throws: χ² with five degrees of freedom exceeds 35.9 once in a million. The example throws as many as you
/// like.
#[test]
fn a_fair_die_shows_each_face_equally_often() {
    let die = DieOnTable { accuracy: Accuracy::preset(Preset::Draft), ..DieOnTable::default() };
    let count = |die: &DieOnTable| {
        let world = die.world(noise).unwrap();
        let mut scratch = Scratch::default();
        let mut faces = [0_u32; 6];
        for start in throws(1200) {
            let mut state = world.state(&[start]).unwrap();
            world.run(&mut state, &mut scratch, 20.0, &mut ()).unwrap();
            let up = state.bodies()[0].turn.conjugate() * DVec3::Z;
            let axis = (0..3).max_by(|&a, &b| up[a].abs().total_cmp(&up[b].abs())).unwrap();
            faces[2 * axis + usize::from(up[axis] > 0.0)] += 1;
        }
        faces
    };
    let chi =
        |faces: [u32; 6]| faces.iter().map(|&f| (f64::from(f) - 200.0) * (f64::from(f) - 200.0) / 200.0).sum::<f64>();
    let faces = count(&die);
    assert!(chi(faces) < 35.9, "{faces:?}");
    // The wrong twin: a slightly flat cuboid is caught.
    let flat = count(&DieOnTable { edges: DVec3::new(0.0135, 0.016, 0.016), ..die });
    assert!(chi(flat) > 35.9, "{flat:?}");
}

struct Energy<'w> {
    world: &'w RigidWorld,
    last: f64,
    scale: f64,
}

impl Observer<RigidWorld> for Energy<'_> {
    fn motion(&mut self, index: usize, body: &RigidBodyState) {
        let now = self.world.energy(index, body);
        // An overlap that a step left in the table is pushed out again, which lifts the body: by less than a thousandth
        // of its size at the standard preset, and never into motion.
        assert!(now <= self.last + 1e-3 * self.scale, "{} to {now} at {}: {body:?}", self.last, body.path.t);
        self.last = now;
    }
}

#[test]
fn energy_never_grows() {
    for (bumps, e, friction) in
        [(0.0, 0.5, 0.35), (0.0, 1.0, 0.0), (0.0, 0.0, 1e8), (0.0, 0.9, 1e-8), (0.2, 0.5, 0.35), (0.2, 0.0, 2.0)]
    {
        let die = DieOnTable {
            bumps,
            law: Law::new(friction, e),
            accuracy: Accuracy { events: 500, ..Accuracy::default() },
            ..DieOnTable::default()
        };
        let world = die.world(noise).unwrap();
        for start in throws(12) {
            let mut state = world.state(&[start]).unwrap();
            let scale = 0.0049 * 9.81 * 0.008;
            let mut energy = Energy { world: &world, last: f64::INFINITY, scale };
            let outcome = world.run(&mut state, &mut Scratch::default(), 5.0, &mut energy).unwrap();
            assert!(!matches!(outcome, Outcome::NotFinite { .. }), "{outcome:?} for e {e}, μ {friction}");
        }
    }
}

/// Lengths × 4, times × 2: every number of the result is that of the small world, scaled exactly.
#[test]
fn scaling_keeps_the_bits() {
    for bumps in [0.0, 0.2] {
        for start in throws(10) {
            let run = |scale: f64, time: f64| {
                let edges = DVec3::splat(0.016 * scale);
                let die = DieOnTable { edges, bumps, ..DieOnTable::default() };
                let world = die.world(noise).unwrap();
                let start = Start {
                    position: start.position * scale,
                    velocity: start.velocity * (scale / time),
                    spin: start.spin / time,
                    ..start
                };
                let mut state = world.state(&[start]).unwrap();
                world.run(&mut state, &mut Scratch::default(), 20.0, &mut ()).unwrap();
                (state.bodies()[0].path.x / scale, state.bodies()[0].turn, state.time() / time, state.counts())
            };
            assert_eq!(run(1.0, 1.0), run(4.0, 2.0));
        }
    }
}

#[test]
fn a_saved_state_goes_on_to_the_same_bits() {
    let die = DieOnTable { bumps: 0.2, ..DieOnTable::default() };
    for start in throws(5) {
        let world = die.world(noise).unwrap();
        let mut whole = world.state(&[start]).unwrap();
        world.run(&mut whole, &mut Scratch::default(), 20.0, &mut ()).unwrap();
        for pause in [0.05, 0.2, 0.35] {
            let mut state = world.state(&[start]).unwrap();
            world.run(&mut state, &mut Scratch::default(), pause, &mut ()).unwrap();
            let saved = serde_json::to_string(&state).unwrap();
            let mut state: State<RigidBodyState> = serde_json::from_str(&saved).unwrap();
            let fresh = die.world(noise).unwrap();
            fresh.run(&mut state, &mut Scratch::default(), 20.0, &mut ()).unwrap();
            let (a, b) = (&whole.bodies()[0], &state.bodies()[0]);
            assert_eq!((a.path.x, a.turn, whole.time()), (b.path.x, b.turn, state.time()));
        }
    }
}

#[test]
fn lazy_fields_touch_little_and_faults_are_errors() {
    let die = DieOnTable { bumps: 0.1, ..DieOnTable::default() };
    let world = die.world(noise).unwrap();
    let start = throws(1).next().unwrap();
    let mut state = world.state(&[start]).unwrap();
    world.run(&mut state, &mut Scratch::default(), 20.0, &mut ()).unwrap();
    let StaticShape::Table(table) = &world.parts()[0] else { unreachable!() };
    let touched = table.height.touched_count();
    assert!((16..2000).contains(&touched), "{touched}");

    let bad = die.world(|_, j| if j == 2 { f64::NAN } else { 0.0 }).unwrap();
    let mut state = bad.state(&[start]).unwrap();
    let result = bad.run(&mut state, &mut Scratch::default(), 20.0, &mut ());
    assert!(matches!(result, Err(WorldError::BadControlPoint { j: 2, .. })), "{result:?}");
}

#[test]
fn bad_worlds_are_refused() {
    let plane = || vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, Material(0)).unwrap())];
    let world = |bodies, parts| {
        RigidWorld::new(RigidWorldDesc {
            bodies,
            parts,
            laws: Laws::uniform(Law::new(0.3, 0.5)).unwrap(),
            gravity: DVec3::new(0.0, 0.0, -9.81),
            accuracy: Accuracy::default(),
            skin: 1.0,
            sink: f64::NEG_INFINITY,
            duration: 1.0,
        })
    };
    let die = |density| BodySpec::solid(Shape::Cuboid(Cuboid::new(DVec3::ONE, 0.0).unwrap()), density, Material(0));
    assert!(matches!(
        world(vec![die(1.0), die(-1.0)], plane()),
        Err(WorldError::BadBody { body: 1, field: "mass", .. })
    ));
    let mut other = die(1.0);
    other.material = Material(7);
    assert!(matches!(world(vec![other], plane()), Err(WorldError::UnknownMaterial { .. })));
    let grid = Grid { origin: [0.0; 2], spacing: 1.0 };
    let mut table = Table::new(Spline::new("height", grid, [0.0, 0.0], |_, _| 0.0).unwrap(), Material(0));
    table.restitution = Some(Spline::new("restitution", grid, [0.0, 1.5], |_, _| 0.5).unwrap());
    assert!(matches!(
        world(vec![die(1.0)], vec![StaticShape::Table(Box::new(table))]),
        Err(WorldError::BadSurface { .. })
    ));

    let good = world(vec![die(1.0)], plane()).unwrap();
    assert!(matches!(
        good.state(&[Start::at_rest(DVec3::new(0.0, 0.0, 0.4))]),
        Err(WorldError::OverlapsScenery { body: 0, .. })
    ));
    assert!(matches!(
        good.state(&[Start::at_rest(DVec3::NAN)]),
        Err(WorldError::BadBody { body: 0, field: "position", .. })
    ));
    let turned = Start { orientation: DQuat::from_xyzw(0.0, 0.0, 0.0, 0.0), ..Start::at_rest(DVec3::Z) };
    assert!(matches!(good.state(&[turned]), Err(WorldError::BadBody { body: 0, field: "orientation", .. })));
    assert!(matches!(good.state(&[]), Err(WorldError::WrongState { .. })));
}
