//! Joints of a user's world: beside a closed form, in arrays, with limits, and when they break.

use glam::DVec3;
use plaus_dist::{Purpose, Seed, math};
use plaus_mcmc::Target;
use plaus_scenes::animation::Animation;
use plaus_scenes::{Scenario, Scene, World, custom::Custom};
use std::f64::consts::{FRAC_PI_2, PI};

const GRAVITY: f64 = 9.806_65;

fn scene(text: &str) -> Custom {
    let scenario = Scenario::read("joints.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let World::Custom(config) = scenario.world else { panic!("another world") };
    Custom::new(&config).unwrap()
}

fn start(scene: &Custom, nth: u64) -> <Custom as Target>::Draw {
    scene.start(&mut Seed(5).chain(0).at(nth, Purpose::START))
}

fn motion(text: &str) -> Animation {
    let scene = scene(text);
    scene.animate(&start(&scene, 0)).unwrap()
}

/// A rope from a peg to a bucket, and the same written out: as arrays of links and joints.
#[test]
fn a_rope_is_a_row_of_links_and_joints() {
    let world = |rope: &str| {
        format!(
            "[world.custom]\nduration_s = 0.4\n[[world.custom.materials]]\nname = 'hemp'\ndensity = 900\n\
             [[world.custom.fixed]]\nname = 'peg'\nshape = {{ ball = {{ radius_mm = 5 }} }}\nat_mm = [0, 0, 600]\n\
             [[world.custom.bodies]]\nname = 'bucket'\nshape = {{ ball = {{ radius_mm = 20 }} }}\n\
             at_mm = [240, 0, 320]\n{rope}"
        )
    };
    let rope = "[[world.custom.ropes]]\nname = 'rope'\nlinks = 6\nradius_mm = 4\nmaterial = 'hemp'\n\
                ends_mm = [[0, 0, 500], [240, 0, 320]]\nfirst_to = 'peg'\nlast_to = 'bucket'\n";
    let lean = math::atan2(240.0, -180.0).to_degrees();
    let written = format!(
        "[[world.custom.bodies]]\nname = 'rope'\ncount = 6\nmaterial = 'hemp'\n\
         shape = {{ capsule = {{ radius_mm = 4, length_mm = 50 }} }}\n\
         at_mm = ['40 * (i + 0.5)', 0, '500 - 30 * (i + 0.5)']\nturn_deg = [0, {lean}, 0]\n\
         [[world.custom.joints]]\nname = 'rope_knot'\ncount = 5\nbody = 'rope_{{i+1}}'\nto = 'rope_{{i+2}}'\n\
         at_mm = ['40 * (i + 1)', 0, '500 - 30 * (i + 1)']\nkind = {{ ball = {{}} }}\n\
         [[world.custom.joints]]\nname = 'rope_first'\nbody = 'rope_1'\nto = 'peg'\nat_mm = [0, 0, 500]\n\
         kind = {{ ball = {{}} }}\n\
         [[world.custom.joints]]\nname = 'rope_last'\nbody = 'rope_6'\nto = 'bucket'\nat_mm = [240, 0, 320]\n\
         kind = {{ ball = {{}} }}\n"
    );
    let (short, long) = (motion(&world(rope)), motion(&world(&written)));
    assert_eq!(short.tracks.len(), 7);
    for (one, other) in short.tracks.iter().zip(&long.tracks) {
        assert_eq!((&one.name, &one.shape, one.look), (&other.name, &other.shape, other.look));
        // The same but for the rounding of sums.
        for time in [0.0, 0.1, 0.4] {
            let off = one.position(time).distance(other.position(time));
            assert!(off < 1e-9, "{} at {time} s: {off}", one.name);
        }
    }
    let fell = short.tracks[0].position(0.0).y - short.tracks[0].position(0.4).y;
    assert!(fell > 0.05, "the bucket swings down: {fell}");
    for (bad, place, said) in [
        (rope.replace("radius_mm = 4", "radius_mm = 30"), "ends_mm", "50 mm long: more than 60"),
        (rope.replace("'peg'", "'pegg'"), "world.custom.ropes[0]", "there is no body \"pegg\""),
        (rope.replace("'hemp'", "'jute'"), "world.custom.ropes[0]", "no material \"jute\""),
    ] {
        let error = Scenario::read("rope.toml", &world(&bad), &[]).expect_err(&bad).to_string();
        assert!(error.contains(place) && error.contains(said), "{error}");
    }
}

/// The complete elliptic integral K(k) by the arithmetic-geometric mean (Abramowitz & Stegun 17.6).
fn complete_elliptic(k: f64) -> f64 {
    let (mut a, mut g) = (1.0_f64, (1.0 - k * k).sqrt());
    for _ in 0..40 {
        (a, g) = (0.5 * (a + g), (a * g).sqrt());
    }
    FRAC_PI_2 / a
}

/// A ball on a hinge 0.3 m from it, let go at an angle: after a quarter of the period `4 √(I/(m g L)) K(sin(θ/2))`, and
/// after five quarters, it is below the hinge. The drift of a step is straight and the joint's place is kept at its
/// ends only; at the reference preset that is far below the 1e-4 of the arm allowed here. The period of small swings is
/// told from it.
#[test]
fn a_pendulum_has_the_period_of_the_elliptic_integral() {
    let world = scene(
        "[world.custom]\nduration_s = 2.6\nfixed = []\naccuracy = 'reference'\n\
         [[world.custom.quantities]]\nname = 'angle'\nvalue = { uniform = [30, 150] }\n\
         [[world.custom.bodies]]\nname = 'bob'\nshape = { ball = { radius_mm = 50 } }\n\
         at_mm = ['-300 * sin(angle)', 0, '-300 * cos(angle)']\n\
         [[world.custom.joints]]\nname = 'nail'\nbody = 'bob'\nkind = { hinge = { axis = [0, 1, 0] } }\n",
    );
    let (arm, radius) = (0.3, 0.05);
    let slow = ((0.4 * radius * radius + arm * arm) / (GRAVITY * arm)).sqrt();
    let mut of_twin = 0.0_f64;
    for nth in 0..12 {
        let draw = start(&world, nth);
        let angle = draw.numbers[0].to_radians();
        let period = 4.0 * slow * complete_elliptic(math::sin(0.5 * angle));
        let track = &world.animate(&draw).unwrap().tracks[0];
        for quarters in [1.0, 5.0] {
            let time = 0.25 * quarters * period;
            if time < 2.6 {
                let aside = track.position(time).x;
                assert!(aside.abs() < 1e-4 * arm, "{:.1}°: {aside} m after {quarters} quarters", draw.numbers[0]);
            }
        }
        of_twin = of_twin.max(track.position(0.5 * PI * slow).x.abs());
    }
    assert!(of_twin > 0.1 * arm, "the period of small swings is not told from it: {of_twin}");
}

/// An array of links is what its members would be, written one by one; and neighbours stay together.
#[test]
fn a_chain_of_links_is_an_array() {
    let link = "shape = { capsule = { radius_mm = 5, length_mm = 40 } }\n";
    let array = format!(
        "[world.custom]\nduration_s = 1\nfixed = []\n\
         [[world.custom.bodies]]\nname = 'link'\ncount = 4\n{link}at_mm = [0, 0, '-25 - 50 * i']\n\
         velocity_m_s = ['i', 0, 0]\n\
         [[world.custom.joints]]\nname = 'hook'\nbody = 'link_1'\nkind = {{ ball = {{}} }}\n\
         [[world.custom.joints]]\nname = 'eye'\ncount = 3\nbody = 'link_{{i+1}}'\nto = 'link_{{i+2}}'\n\
         at_mm = [0, 0, '-50 * (i + 1)']\nkind = {{ ball = {{}} }}\n"
    );
    let mut single = "[world.custom]\nduration_s = 1\nfixed = []\n".to_owned();
    for k in 0..4 {
        let z = -25 - 50 * k;
        single += &format!(
            "[[world.custom.bodies]]\nname = 'link_{}'\n{link}at_mm = [0, 0, {z}]\nvelocity_m_s = [{k}, 0, 0]\n",
            k + 1
        );
    }
    single += "[[world.custom.joints]]\nname = 'hook'\nbody = 'link_1'\nkind = { ball = {} }\n";
    for k in 1..4 {
        let (next, z) = (k + 1, -50 * k);
        single += &format!(
            "[[world.custom.joints]]\nname = 'eye_{k}'\nbody = 'link_{k}'\nto = 'link_{next}'\nat_mm = [0, 0, {z}]\n\
             kind = {{ ball = {{}} }}\n"
        );
    }
    let (one, other) = (motion(&array), motion(&single));
    for time in [0.0, 0.2, 0.5, 0.9] {
        let mut above = DVec3::ZERO;
        for (a, b) in one.tracks.iter().zip(&other.tracks) {
            assert_eq!(a.position(time), b.position(time), "at {time} s");
            // The way from the end of one link to the beginning of the next. An animation has y up.
            let half = a.orientation(time) * DVec3::new(0.0, 0.0, 0.025);
            let ends = [a.position(time) + half, a.position(time) - half];
            let gap = ends.map(|end| (end - above).length());
            // Between the ends of a step, joints are apart by at most a thousandth of their arm at this preset.
            let near = if gap[0] < gap[1] { 0 } else { 1 };
            assert!(gap[near] < 1e-3 * 0.05, "{gap:?} m apart at {time} s");
            above = ends[1 - near];
        }
    }
}

/// A flap that falls is stopped at its limit, and one with more friction than its weight has moment does not fall.
#[test]
fn hinges_have_limits_and_friction() {
    let flap = |hinge: &str| {
        let animation = motion(&format!(
            "[world.custom]\nduration_s = 2\nfixed = []\n\
             [[world.custom.bodies]]\nname = 'flap'\nshape = {{ box = {{ size_mm = [200, 100, 10] }} }}\n\
             at_mm = [100, 0, 0]\n\
             [[world.custom.joints]]\nname = 'pin'\nbody = 'flap'\n\
             kind = {{ hinge = {{ axis = [0, 1, 0], {hinge} }} }}\n"
        ));
        let place = animation.tracks[0].position(2.0);
        math::atan2(place.y, place.x).to_degrees()
    };
    // About +y a positive angle turns +x down.
    let fallen = flap("limits_deg = [-10, 60]");
    assert!((fallen + 60.0).abs() < 0.1, "{fallen}°");
    let moment = 1000.0 * 0.2 * 0.1 * 0.01 * GRAVITY * 0.1;
    let held = flap(&format!("friction_n_m = {}", 1.01 * moment));
    let let_go = flap(&format!("friction_n_m = {}", 0.5 * moment));
    assert!(held.abs() < 0.1, "{held}°");
    assert!(let_go < -10.0, "{let_go}°");
}

/// A shelf on a weld: a ball that drops on it tears it off if its impulse is more than the weld bears.
#[test]
fn welds_break_at_their_impulse() {
    let fallen = |weld: &str| {
        let animation = motion(&format!(
            "[world.custom]\nduration_s = 1\nfixed = []\n\
             [[world.custom.bodies]]\nname = 'shelf'\nshape = {{ box = {{ size_mm = [200, 100, 10] }} }}\n\
             [[world.custom.bodies]]\nname = 'ball'\nshape = {{ ball = {{ radius_mm = 30 }} }}\nat_mm = [0, 0, 300]\n\
             [[world.custom.joints]]\nname = 'glue'\nbody = 'shelf'\nat_mm = [-100, 0, 0]\nkind = {{ weld = {{ {weld} }} }}\n"
        ));
        let broken: Vec<_> = animation.breaks.iter().map(|one| (one.joint.as_str(), one.time)).collect();
        let fallen = -animation.tracks[0].position(1.0).y;
        // When the ball hits the shelf, and not otherwise.
        let hit = animation.impacts[0].time;
        assert_eq!(broken, if fallen > 0.1 { vec![("glue", hit)] } else { Vec::new() });
        fallen
    };
    // m v (1 + e) of the ball on a wall: 0.113 kg, 2.3 m/s, e 0.5.
    let mass = 1000.0 * 4.0 / 3.0 * PI * 0.03_f64.powi(3);
    let impulse = 1.5 * mass * (2.0 * GRAVITY * 0.265_f64).sqrt();
    assert!(fallen("").abs() < 1e-3, "{}", fallen(""));
    assert!(fallen(&format!("breaks_at_n_s = {}", 1.01 * impulse)).abs() < 1e-3);
    assert!(fallen(&format!("breaks_at_n_s = {}", 0.9 * impulse)) > 0.5);
}
