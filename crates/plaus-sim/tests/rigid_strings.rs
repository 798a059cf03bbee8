//! Strings, and drums on which they wind: winches, spools, bodies that are tied together.

use crate::common::{G, M};
use crate::rigid_joints::world;
use glam::{DQuat, DVec3};
use plaus_dist::math;
use plaus_sim::rigid::{
    BodySpec, Interpolation, Joint, Key, Keyframes, Phase, RigidBodyState, RigidWorld, RigidWorldDesc, Start,
    StaticShape, Track, Winding,
};
use plaus_sim::scenery::Plane;
use plaus_sim::shape::Shape;
use plaus_sim::{Accuracy, Law, Laws, Outcome, Preset, Scratch, State, WorldError};

/// Numbers spread evenly between two others, from a seed.
pub(crate) struct Numbers(pub(crate) u64);

impl Numbers {
    pub(crate) fn within(&mut self, low: f64, high: f64) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        low + (high - low) * ((self.0 >> 11) as f64 / (1_u64 << 53) as f64)
    }

    pub(crate) fn vector(&mut self) -> DVec3 {
        DVec3::new(self.within(-1.0, 1.0), self.within(-1.0, 1.0), self.within(-1.0, 1.0))
    }
}

pub(crate) const BIG: f64 = 0.04;

/// Mass and moment of inertia of a ball.
pub(crate) fn ball(radius: f64) -> [f64; 2] {
    let mass = Shape::Ball(radius).mass_properties(1000.0);
    [mass.mass, mass.inertia.x]
}

/// The bodies of a world at a time.
pub(crate) fn after(world: &RigidWorld, starts: &[Start], time: f64) -> Vec<RigidBodyState> {
    let mut state = world.state(starts).unwrap();
    world.run(&mut state, &mut Scratch::default(), time, &mut ()).unwrap();
    state.bodies().iter().enumerate().map(|(k, body)| world.at(k, body, time)).collect()
}

pub(crate) fn energy(world: &RigidWorld, bodies: &[RigidBodyState]) -> f64 {
    bodies.iter().enumerate().map(|(k, body)| world.energy(k, body)).sum()
}

/// A gap between surfaces that touch, for a body of this size: what a string's length may be off by.
pub(crate) fn gap(size: f64, preset: Preset) -> f64 {
    Accuracy::preset(preset).gap * size
}

pub(crate) fn rotated(turn: DQuat, start: &Start) -> Start {
    Start {
        position: turn * start.position,
        orientation: turn * start.orientation,
        velocity: turn * start.velocity,
        spin: turn * start.spin,
        time: start.time,
    }
}

/// How far the middle of a step is from where a body is that is accelerated by `a`: between its ends, the step is
/// straight. The size of the bodies is a ball's radius.
pub(crate) fn bend(a: f64, size: f64, preset: Preset) -> f64 {
    let h = crate::rigid_joints::step(size, preset);
    a * h * h / 8.0
}

/// A weight on a string around a drum on a hinge falls with `a = m g / (m + I / r²)`. A twin has the drum's own radius
/// in place of the string's.
#[test]
fn a_weight_turns_a_drum() {
    let mut numbers = Numbers(2);
    for preset in Preset::ALL {
        for _ in 0..6 {
            let (r, small, way) = (numbers.within(0.01, 0.035), numbers.within(0.01, 0.03), numbers.within(0.1, 0.3));
            let ([_, i], [m, _]) = (ball(BIG), ball(small));
            let starts = [Start::at_rest(DVec3::ZERO), Start::at_rest(DVec3::new(r, 0.0, -0.1))];
            let mut world = world(&[Shape::Ball(BIG), Shape::Ball(small)], G, preset);
            world.join(Joint::hinge(DVec3::ZERO, DVec3::Y, 0, &starts[0])).unwrap();
            let winding = Winding { axis: DVec3::Y, radius: r, length: 0.5 };
            let string = Joint::wound(DVec3::ZERO, starts[1].position, &winding, 0, &starts[0]);
            world.join(string.to(1, &starts[1])).unwrap();
            let a = m * G / (m + i / (r * r));
            let time = (2.0 * way / a).sqrt();
            let found = after(&world, &starts, time);
            let off = (found[1].path.x - (starts[1].position - DVec3::Z * way)).length();
            let turned = (found[0].spin - DVec3::Y * (a * time / r)).length() * r / (a * time);
            let allowed = bend(a, BIG, preset) + 2.0 * gap(BIG, preset) + 1e-12;
            assert!(off < allowed && turned < 1e-8, "{preset:?} {r}: {off:e} of {allowed:e}, {turned:e}");
            let twin = 0.5 * m * G / (m + i / (BIG * BIG)) * time * time - way;
            assert!(twin > 10.0 * allowed, "the ball's own radius");
        }
    }
}

/// A drum and a weight on its string, in free space: they turn about each other, in three dimensions, and the string
/// unwinds. Momentum and angular momentum are constant to rounding, and energy to 2 % of the square of the preset's
/// step.
#[test]
fn bodies_on_a_string_keep_what_they_have() {
    let mut numbers = Numbers(4);
    for preset in Preset::ALL {
        for _ in 0..3 {
            let radii = [BIG, numbers.within(0.02, 0.04)];
            let spin = numbers.vector().normalize() * numbers.within(3.0, 6.0);
            let to = spin.normalize().any_orthonormal_vector() * 0.2 + numbers.vector() * 0.01;
            let drift = numbers.vector();
            let starts =
                [DVec3::ZERO, to].map(|x| Start { velocity: drift + spin.cross(x), spin, ..Start::at_rest(x) });
            let mut world = world(&radii.map(Shape::Ball), 0.0, preset);
            let winding = Winding { axis: spin + numbers.vector() * 0.3, radius: 0.02, length: 0.3 };
            world.join(Joint::wound(DVec3::ZERO, to, &winding, 0, &starts[0]).to(1, &starts[1])).unwrap();
            let totals = |bodies: &[RigidBodyState]| {
                let mut all = (DVec3::ZERO, DVec3::ZERO);
                for (body, r) in bodies.iter().zip(radii) {
                    let [m, i] = ball(r);
                    all.0 += body.path.v * m;
                    all.1 += body.path.x.cross(body.path.v) * m + body.spin * i;
                }
                all
            };
            let first = after(&world, &starts, 0.0);
            let last = after(&world, &starts, 1.0);
            let ((p, l), (q, k)) = (totals(&first), totals(&last));
            let lost = (energy(&world, &last) / energy(&world, &first) - 1.0).abs();
            let [p, l] = [(p - q).length() / p.length(), (l - k).length() / l.length()];
            assert!(p < 1e-13 && l < 1e-12, "{preset:?}: {p:e} {l:e}");
            let step = Accuracy::preset(preset).step;
            assert!(lost < 0.02 * step * step, "{preset:?}: {lost:e}");
            let unwound = (last[0].path.x - last[1].path.x).length() - to.length();
            assert!(unwound > 0.01, "it turned as one body: {unwound}");
        }
    }
}

/// A ball as a spool on a plane that it rolls on, and a driven ball that pulls the string at an angle.
fn spool(r: f64, angle: f64, a: f64, preset: Preset) -> (RigidWorld, Vec<Start>) {
    let (s, c) = math::sin_cos(angle);
    let middle = DVec3::Z * BIG;
    // The string leaves the drum below, and turns it backwards as it is pulled off.
    let leaves = middle + DVec3::new(s, 0.0, -c) * r;
    let end = leaves + DVec3::new(c, 0.0, s);
    let mut world = RigidWorld::new(RigidWorldDesc {
        bodies: [BIG, 0.01].map(|r| BodySpec::solid(Shape::Ball(r), 1000.0, M)).to_vec(),
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap())],
        laws: Laws::uniform(Law::new(10.0, 0.0)).unwrap(),
        gravity: DVec3::NEG_Z * G,
        accuracy: Accuracy::preset(preset),
        ..RigidWorldDesc::default()
    })
    .unwrap();
    // Rolling by x, it takes the end of the string along, and winds up x r / R.
    let way = DVec3::X - DVec3::new(c, 0.0, s) * (r / BIG);
    let key = |time: f64| Key { time, value: end + way * (0.5 * a * time * time), slopes: [way * (a * time); 2] };
    let position = Track { between: Interpolation::Cubic, keys: (0..=50).map(|k| key(0.01 * f64::from(k))).collect() };
    world.drive(1, &Keyframes { position, rotation: Track::fixed(DQuat::IDENTITY) }).unwrap();
    let starts = vec![Start::at_rest(middle), Start::at_rest(end)];
    let winding = Winding { axis: DVec3::NEG_Y, radius: r, length: 0.5 };
    world.join(Joint::wound(middle, end, &winding, 0, &starts[0]).to(1, &starts[1])).unwrap();
    (world, starts)
}

/// A spool that rolls on a table is pulled by its string: where the string is flatter than `cos θ = r / R`, it rolls
/// after it, and where it is steeper, away from it. Its string's end is moved so that `θ` stays and it rolls with a
/// given acceleration, along which it goes. Moved the other way, the string is slack, and it stays.
#[test]
fn a_spool_turns_round_at_the_critical_angle() {
    for preset in [Preset::Standard, Preset::Fine] {
        for (r, beyond) in [(0.02, -0.3), (0.02, 0.3), (0.03, -0.15), (0.03, 0.15), (0.012, -0.4), (0.012, 0.1)] {
            let angle = math::acos(r / BIG) + beyond;
            for sense in [1.0, -1.0] {
                let pulls = beyond * sense < 0.0;
                let (world, starts) = spool(r, angle, 0.5 * sense, preset);
                let found = &after(&world, &starts, 0.5)[0];
                let expected = if pulls { 0.5 * 0.5 * sense * 0.25 } else { 0.0 };
                // Driven bodies follow their path to the step's error; the closing of the string's length needs a way
                // along the table that is longer by 1 / |cos θ − r / R|.
                let lever = (math::cos(angle) - r / BIG).abs();
                let allowed = (bend(0.5, BIG, preset) + 4.0 * gap(BIG, preset)) * 4.0 / lever;
                let off = (found.path.x - starts[0].position).x - expected;
                assert!(off.abs() < allowed, "{preset:?} {r} {beyond} {sense}: {off:e} of {allowed:e}");
            }
        }
    }
}

/// A winch that turns at a steady rate hauls its weight up by `r ω`, and lets it down again the other way.
#[test]
fn a_winch_hauls_a_weight() {
    let (r, rate) = (0.02, 3.0);
    let starts = [Start::at_rest(DVec3::ZERO), Start::at_rest(DVec3::new(r, 0.0, -0.5))];
    let mut world = world(&[BIG, 0.02].map(Shape::Ball), G, Preset::Standard);
    let key = |time: f64, turns: f64| Key { time, value: DQuat::from_rotation_y(turns), slopes: [DQuat::IDENTITY; 2] };
    let turns: Vec<_> = (0..=12).map(|k| key(f64::from(k) * 0.25, -rate * 0.25 * f64::from(k.min(12 - k)))).collect();
    let rotation = Track { between: Interpolation::Linear, keys: turns };
    world.drive(0, &Keyframes { position: Track::fixed(DVec3::ZERO), rotation }).unwrap();
    let winding = Winding { axis: DVec3::Y, radius: r, length: 0.05 };
    world.join(Joint::wound(DVec3::ZERO, starts[1].position, &winding, 0, &starts[0]).to(1, &starts[1])).unwrap();
    for (time, up) in [(0.7, 0.7), (1.5, 1.5), (2.0, 1.0), (2.9, 0.1)] {
        let z = after(&world, &starts, time)[1].path.x.z;
        // The jerks at the start and at the turn make it bob by less than v²/g.
        let allowed = r * rate * r * rate / G + 1e-4;
        assert!((z + 0.5 - up * r * rate).abs() < allowed, "{time}: {z}");
    }
}

/// A ball falls beside the nail to which a slack string ties it. Where the string becomes taut, what the ball has along
/// it is lost, and what it has across stays: energy shows it. A string that breaks at less than that impulse passes it
/// on, and lets the ball fall on; one that breaks at more swings it.
#[test]
fn a_string_becomes_taut() {
    let mut numbers = Numbers(6);
    let m = ball(BIG)[0];
    for preset in Preset::ALL {
        for _ in 0..3 {
            let (x, length) = (numbers.within(0.1, 0.25), numbers.within(0.3, 0.5));
            let start = Start::at_rest(DVec3::new(x, 0.0, 0.0));
            let drop = (length * length - x * x).sqrt();
            let (time, speed) = ((2.0 * drop / G).sqrt(), (2.0 * G * drop).sqrt());
            let radial = speed * drop / length;
            let falls = |breaks: f64| {
                let mut world = world(&[Shape::Ball(BIG)], G, preset);
                let string = Joint::string(start.position, DVec3::ZERO, 0, &start).with_length(length);
                world.join(string.that_breaks_at(breaks)).unwrap();
                let found = after(&world, &[start], time + 0.1);
                (energy(&world, &found) / m, found[0].path.x)
            };
            let allowed = (0.01 * G * bend(G, BIG, preset) / BIG + 10.0 * G * gap(BIG, preset)).sqrt();
            for (part, breaks) in [(f64::INFINITY, false), (1.02, false), (0.98, true)] {
                let (kept, place) = falls(part * m * radial);
                let expected = -0.5 * radial * radial;
                assert!((kept - expected).abs() < 1e-3 + allowed, "{preset:?} {part}: {kept} {expected}");
                assert_eq!(place.length() > length + 1e-3, breaks, "{preset:?} {part}");
            }
        }
    }
}

/// Balls on a slack string hit each other as if there were none; and one lies still on a floor beside what it is tied
/// to.
#[test]
fn tied_bodies_meet_and_rest() {
    let starts = [
        Start { velocity: DVec3::X * 0.5, ..Start::at_rest(DVec3::ZERO) },
        Start { velocity: DVec3::X * -0.5, ..Start::at_rest(DVec3::X * 0.2) },
    ];
    let mut free = world(&[Shape::Ball(BIG), Shape::Ball(BIG)], 0.0, Preset::Standard);
    let string = Joint::string(DVec3::ZERO, DVec3::X * 0.2, 0, &starts[0]).with_length(0.3).to(1, &starts[1]);
    free.join(string).unwrap();
    let met = after(&free, &starts, 0.2);
    assert!((met[0].path.v + DVec3::X * 0.5).length() < 1e-6, "{}", met[0].path.v);
    // Apart by 0.08 m at 0.12 s, they part at 1 m/s until the string is taut.
    let taut = after(&free, &starts, 0.5);
    assert!((taut[1].path.x - taut[0].path.x).length() < 0.3 + 1e-6 && taut[0].path.v.length() < 1e-6);
    let mut floor = RigidWorld::new(RigidWorldDesc {
        bodies: vec![BodySpec::solid(crate::rigid_joints::cuboid(0.05, 0.05, 0.05), 1000.0, M)],
        parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap())],
        laws: Laws::uniform(Law::new(0.5, 0.3)).unwrap(),
        ..RigidWorldDesc::default()
    })
    .unwrap();
    let start = Start::at_rest(DVec3::Z * 0.1);
    floor.join(Joint::string(start.position, DVec3::Z * 0.1, 0, &start).with_length(0.2)).unwrap();
    let mut state: State<RigidBodyState> = floor.state(&[start]).unwrap();
    assert_eq!(floor.run(&mut state, &mut Scratch::default(), 5.0, &mut ()).unwrap(), Outcome::AllAtRest);
    assert_eq!(state.bodies()[0].phase, Phase::Rest);
    // A weight that hangs rests too.
    let mut hangs = world(&[Shape::Ball(BIG)], G, Preset::Standard);
    hangs.join(Joint::string(start.position, DVec3::Z, 0, &start)).unwrap();
    let mut state = hangs.state(&[start]).unwrap();
    assert_eq!(hangs.run(&mut state, &mut Scratch::default(), 5.0, &mut ()).unwrap(), Outcome::AllAtRest);
}

/// Drums and weights tossed about on a floor and tied to each other and to nails, whichever way their strings come to
/// lie, end without a fault, and have no more energy than at the start: but for 1 %, which unguarded steps may add.
#[test]
fn tossed_drums_make_no_energy() {
    let mut numbers = Numbers(8);
    for preset in [Preset::Draft, Preset::Standard] {
        for nth in 0..8 {
            let shapes = [Shape::Ball(BIG), crate::rigid_joints::cuboid(0.06, 0.03, 0.02), Shape::Ball(0.02)];
            let mut world = RigidWorld::new(RigidWorldDesc {
                bodies: shapes.iter().map(|shape| BodySpec::solid(shape.clone(), 1000.0, M)).collect(),
                parts: vec![StaticShape::Plane(Plane::new(DVec3::ZERO, DVec3::Z, M).unwrap())],
                laws: Laws::uniform(Law::new(0.4, 0.4)).unwrap(),
                accuracy: Accuracy { events: 1_000_000, ..Accuracy::preset(preset) },
                ..RigidWorldDesc::default()
            })
            .unwrap();
            let starts: Vec<Start> = (0..3)
                .map(|k| Start {
                    velocity: numbers.vector() * 2.0,
                    spin: numbers.vector() * 10.0,
                    ..Start::at_rest(DVec3::new(0.2 * f64::from(k), 0.0, 0.5) + numbers.vector() * 0.05)
                })
                .collect();
            let nail = DVec3::new(0.1, 0.1, 0.9);
            for (drum, other, to) in
                [(0, Some(1), starts[1].position), (1, None, nail), (2, Some(0), starts[0].position)]
            {
                let winding = Winding {
                    axis: numbers.vector(),
                    radius: numbers.within(0.01, 0.03),
                    length: numbers.within(0.0, 0.5),
                };
                let start = &starts[drum];
                let joint = Joint::wound(start.position, to, &winding, drum, start);
                world.join(other.map_or(joint, |k| joint.to(k, &starts[k]))).unwrap();
            }
            let mut state = world.state(&starts).unwrap();
            let mut scratch = Scratch::default();
            let begun = energy(&world, state.bodies());
            for k in 1..=30 {
                let time = 0.1 * f64::from(k);
                let outcome = world.run(&mut state, &mut scratch, time, &mut ()).unwrap();
                assert!(matches!(outcome, Outcome::TimeReached | Outcome::AllAtRest), "{preset:?} {nth}: {outcome:?}");
                let now: f64 = (0..3).map(|k| world.energy(k, &world.at(k, &state.bodies()[k], time))).sum();
                assert!(now < 1.01 * begun, "{preset:?} {nth} at {time}: {now} of {begun}");
            }
        }
    }
}

/// Turned about the vertical and moved, a world with a yo-yo that swings goes as before, to rounding.
#[test]
fn strings_have_no_place_of_their_own() {
    let mut numbers = Numbers(7);
    let (turn, way) = (DQuat::from_rotation_z(numbers.within(0.0, 6.0)), numbers.vector());
    let start = Start { velocity: DVec3::new(0.3, 0.2, 0.0), ..Start::at_rest(DVec3::new(0.02, 0.0, -0.15)) };
    let run = |turn: DQuat, way: DVec3| {
        let mut begin = rotated(turn, &start);
        begin.position += way;
        let mut world = world(&[Shape::Ball(BIG)], G, Preset::Standard);
        let winding = Winding { axis: turn * DVec3::Y, radius: 0.02, length: 0.6 };
        world.join(Joint::wound(begin.position, way, &winding, 0, &begin)).unwrap();
        after(&world, &[begin], 0.4)[0].path.x
    };
    let (here, there) = (run(DQuat::IDENTITY, DVec3::ZERO), run(turn, way));
    let off = (turn * here + way - there).length();
    assert!(off < 1e-9, "{off:e}");
}

/// What is wrong with a string is told.
#[test]
fn bad_strings_are_refused() {
    let start = Start::at_rest(DVec3::ZERO);
    let string = Joint::string(DVec3::ZERO, DVec3::Z, 0, &start);
    let field = |result: Result<_, WorldError>| match result {
        Err(WorldError::BadJoint { field, .. }) => field,
        other => panic!("{other:?}"),
    };
    let refused = |joint: Joint| field(world(&[Shape::Ball(BIG)], G, Preset::Draft).join(joint).map(|_| ()));
    for length in [0.0, -1.0, f64::NAN, f64::INFINITY] {
        assert_eq!(refused(string.with_length(length)), "length of a string");
    }
    let winding = Winding { axis: DVec3::Y, radius: 0.0, length: 0.1 };
    assert_eq!(refused(Joint::wound(DVec3::ZERO, DVec3::Z, &winding, 0, &start)), "radius of a drum");
    let mut short = world(&[Shape::Ball(BIG)], G, Preset::Draft);
    short.join(string.with_length(0.9)).unwrap();
    assert_eq!(field(short.state(&[start]).map(|_| ())), "distance in m along a string at the start");
}
