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
    assert_eq!(short.motion.tracks.len(), 7);
    for (one, other) in short.motion.tracks.iter().zip(&long.motion.tracks) {
        assert_eq!((&one.name, &one.shape, one.look), (&other.name, &other.shape, other.look));
        // The same but for the rounding of sums.
        for time in [0.0, 0.1, 0.4] {
            let off = one.position(time).distance(other.position(time));
            assert!(off < 1e-9, "{} at {time} s: {off}", one.name);
        }
    }
    let fell = short.motion.tracks[0].position(0.0).y - short.motion.tracks[0].position(0.4).y;
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
        let track = &world.animate(&draw).unwrap().motion.tracks[0];
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
        for (a, b) in one.motion.tracks.iter().zip(&other.motion.tracks) {
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
        let place = animation.motion.tracks[0].position(2.0);
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

/// A drawer on a slider: its spring carries it where its weight says, `m g/k` below the rest, and it gets there as a
/// damped oscillator does; with limits or friction it stays. A motor moves it as its keys say.
#[test]
fn sliders_have_springs_limits_friction_and_motors() {
    let track = |slider: &str| {
        motion(&format!(
            "[world.custom]\nduration_s = 3\nfixed = []\n\
             [[world.custom.bodies]]\nname = 'drawer'\nshape = {{ box = {{ size_mm = [200, 100, 50] }} }}\n\
             [[world.custom.joints]]\nname = 'rail'\nbody = 'drawer'\nat_mm = [100, 0, 0]\n\
             kind = {{ slider = {{ axis = [0, 0, 2], {slider} }} }}\n"
        ))
        .motion
        .tracks
        .swap_remove(0)
    };
    // 1 kg; an animation has y up.
    let (omega, delta) = (12.0_f64, 3.0_f64);
    let spring = format!(
        "spring = {{ stiffness_n_per_m = {}, rest_mm = 30, damping_n_s_per_m = {} }}",
        omega * omega,
        2.0 * delta
    );
    let sprung = track(&spring);
    let middle = 0.03 - GRAVITY / (omega * omega);
    let rate = (omega * omega - delta * delta).sqrt();
    for time in [0.1, 0.35, 0.8, 2.0] {
        let (sin, cos) = math::sin_cos(rate * time);
        let exact = middle * (1.0 - math::exp(-delta * time) * (cos + delta / rate * sin));
        let found = sprung.position(time).y;
        assert!((found - exact).abs() < 1e-4, "{found} for {exact} at {time} s");
    }
    let at_end = |slider: &str| track(slider).position(3.0).y;
    let fallen = at_end("limits_mm = [-80, 10]");
    assert!((fallen + 0.08).abs() < 1e-4, "{fallen}");
    assert!(at_end(&format!("friction_n = {}", 1.01 * GRAVITY)).abs() < 1e-4);
    assert!(at_end(&format!("friction_n = {}", 0.9 * GRAVITY)) < -1.0);
    let keys = "motor = { most_n = 100, between = 'smooth', \
                keys = [{ at_s = 0.5, at_mm = 0 }, { at_s = 1, at_mm = 60 }, { at_s = 2, at_mm = -20 }] }";
    let moved = track(keys);
    for (time, place) in [(0.4, 0.0), (1.0, 0.06), (2.5, -0.02)] {
        assert!((moved.position(time).y - place).abs() < 1e-4, "{} at {time} s", moved.position(time));
    }
    assert!(at_end("motor = { most_n = 9, speed_m_s = 0.1 }") < -1.0);
    let raised = at_end("motor = { most_n = 20, speed_m_s = 0.1 }");
    assert!((raised - 0.3).abs() < 2e-3, "{raised}");
}

/// A door with a closer, a spring and a damper on its hinge, shuts as a damped oscillator does; a motor turns it at a
/// steady speed.
#[test]
fn hinges_have_springs_and_motors() {
    let turned = |hinge: &str, time: f64| {
        let animation = motion(&format!(
            "[world.custom]\nduration_s = 3\nfixed = []\n\
             [[world.custom.bodies]]\nname = 'door'\nshape = {{ box = {{ size_mm = [400, 20, 500] }} }}\n\
             at_mm = [200, 0, 0]\n\
             [[world.custom.joints]]\nname = 'pin'\nbody = 'door'\n\
             kind = {{ hinge = {{ axis = [0, 0, 1], {hinge} }} }}\n"
        ));
        let place = animation.motion.tracks[0].position(time);
        math::atan2(-place.z, place.x)
    };
    let inertia = 4.0 * ((0.16 + 0.0004) / 12.0 + 0.04);
    let (omega, delta) = (3.0_f64, 3.5_f64);
    let closer = format!(
        "spring = {{ stiffness_n_m_per_rad = {}, rest_deg = -80, damping_n_m_s_per_rad = {} }}",
        inertia * omega * omega,
        2.0 * inertia * delta
    );
    let rate = (delta * delta - omega * omega).sqrt();
    for time in [0.2, 0.6, 1.5] {
        let (up, down) = (math::exp(rate * time), math::exp(-rate * time));
        let (sin, cos) = (0.5 * (up - down), 0.5 * (up + down));
        let exact = -80_f64.to_radians() * (1.0 - math::exp(-delta * time) * (cos + delta / rate * sin));
        let found = turned(&closer, time);
        assert!((found - exact).abs() < 5e-4, "{found} for {exact} at {time} s");
    }
    let swung = turned("motor = { most_n_m = 50, speed_deg_s = 40 }", 2.0);
    assert!((swung.to_degrees() - 80.0).abs() < 0.5, "{}", swung.to_degrees());
}

/// A shelf on a weld: a ball that drops on it tears it off if its impulse is more than the weld bears. So it does from
/// a hinge that friction holds level, whose impulse follows from the shelf's centre of percussion.
#[test]
fn joints_break_at_their_impulse() {
    let fallen = |weld: &str| {
        let animation = motion(&format!(
            "[world.custom]\nduration_s = 1\nfixed = []\n\
             [[world.custom.bodies]]\nname = 'shelf'\nshape = {{ box = {{ size_mm = [200, 100, 10] }} }}\n\
             [[world.custom.bodies]]\nname = 'ball'\nshape = {{ ball = {{ radius_mm = 30 }} }}\nat_mm = [0, 0, 300]\n\
             [[world.custom.joints]]\nname = 'glue'\nbody = 'shelf'\nat_mm = [-100, 0, 0]\nkind = {weld}\n"
        ));
        let broken: Vec<_> = animation.motion.breaks.iter().map(|one| (one.joint.as_str(), one.time)).collect();
        let fallen = -animation.motion.tracks[0].position(1.0).y;
        // When the ball hits the shelf, and not otherwise.
        let hit = animation.motion.impacts[0].time;
        assert_eq!(broken, if fallen > 0.1 { vec![("glue", hit)] } else { Vec::new() });
        fallen
    };
    // m v (1 + e) of the ball on a wall: 0.113 kg, 2.3 m/s, e 0.5.
    let mass = 1000.0 * 4.0 / 3.0 * PI * 0.03_f64.powi(3);
    let impulse = 1.5 * mass * (2.0 * GRAVITY * 0.265_f64).sqrt();
    let weld = |breaks: &str| fallen(&format!("{{ weld = {{ {breaks} }} }}"));
    assert!(weld("").abs() < 1e-3, "{}", weld(""));
    assert!(weld(&format!("breaks_at_n_s = {}", 1.01 * impulse)).abs() < 1e-3);
    assert!(weld(&format!("breaks_at_n_s = {}", 0.9 * impulse)) > 0.5);
    // About the hinge at its edge, the shelf of mass M and length l has the moment of inertia M l²/3, and is hit at
    // l/2: it gives way as a mass of 4/3 M, and its centre moves with 3/4 of what hits it, so the hinge bears 1/4.
    let shelf = 4.0 / 3.0 * 0.2;
    let impulse = 0.25 * impulse * shelf / (shelf + mass);
    let hinge = |part: f64| {
        fallen(&format!("{{ hinge = {{ axis = [0, 1, 0], friction_n_m = 100, breaks_at_n_s = {} }} }}", part * impulse))
    };
    assert!(hinge(0.9) > 0.3 && hinge(1.1) < 0.1, "{} {}", hinge(0.9), hinge(1.1));
}

/// What is wrong with a joint is told with its place, its key, and what would be right.
#[test]
fn bad_joints_are_told() {
    let two = "most_n = 1, keys = [{ at_s = 1, at_mm = 1 }, { at_s = 1, at_mm = 2 }]";
    for (kind, place, key, what) in [
        ("slidr = {}", "slidr", "joints[0].kind", "slider"),
        ("slider = {}", "slider", "joints[0].kind", "axis"),
        ("slider = { axis = [0, 0, 0] }", "[0, 0, 0]", "kind.slider.axis", "needs a length"),
        ("slider = { axis = [0, 0, 1], limits_deg = [0, 1] }", "limits_deg", "slider", "limits_mm"),
        ("slider = { axis = [0, 0, 1], limits_mm = [5, 20] }", "[5, 20]", "limits_mm", "where the body starts"),
        ("slider = { axis = [0, 0, 1], friction_n = -1 }", "-1", "friction_n", "out of range"),
        ("slider = { axis = [0, 0, 1], friction_n = { normal = [1, 1] } }", "friction_n", "friction_n", "at least 0"),
        ("slider = { axis = [0, 0, 1], spring = { stiffness_n_per_m = -3 } }", "-3", "spring.stiff", "out of range"),
        ("hinge = { axis = [0, 0, 1], spring = { rest_deg = 190 } }", "190", "spring.rest_deg", "−180 and 180"),
        ("hinge = { axis = [0, 0, 1], motor = { most_n_m = 1 } }", "motor", "hinge.motor", "it has neither"),
        (&format!("slider = {{ axis = [0, 0, 1], motor = {{ speed_m_s = 1, {two} }} }}"), "motor", "motor", "not both"),
        (&format!("slider = {{ axis = [0, 0, 1], motor = {{ {two} }} }}"), "1, at_mm = 2", "keys[1].at_s", "0 s after"),
        ("slider = { axis = [0, 0, 1], motor = { speed_m_s = 1 } }", "motor", "motor", "most_n"),
        ("ball = { breaks_at_n_s = 0 }", "0", "breaks_at_n_s", "out of range"),
    ] {
        let text = format!(
            "[[world.custom.bodies]]\nname = 'ball'\nshape = {{ ball = {{ radius_mm = 30 }} }}\n\
             [[world.custom.joints]]\nname = 'j'\nbody = 'ball'\nkind = {{ {kind} }}\n"
        );
        let error = Scenario::read("bad.toml", &text, &[]).expect_err(&text);
        let [problem] = &error.problems[..] else { panic!("{error}") };
        let line = text.lines().nth(problem.line.unwrap() - 1).unwrap();
        let there: String = line.chars().skip(problem.column.unwrap() - 1).collect();
        assert!(there.starts_with(place), "{there}\n{text}\n{error}");
        assert!([key, what].iter().all(|part| error.to_string().contains(part)), "{error}: {key}, {what}");
    }
}

/// A bead on a hoop of radius R: a ball that a hinge about the hoop's middle holds. Small oscillations take
/// `2π √((R² + 2 r²/5)/(g R))`, by its share of the amplitude's square, 1/16, longer. On a hoop that turns about the
/// vertical with ω, it stays where `cos θ = g/(ω² R)`.
#[test]
fn a_bead_on_a_hoop_swings_and_rises_as_it_should() {
    let (radius, small) = (0.2_f64, 0.01_f64);
    let hoop = |angle: f64, length: f64, more: &str| {
        let to = if more.is_empty() { "" } else { "to = 'hoop'\n" };
        motion(&format!(
            "[world.custom]\nduration_s = 3\naccuracy = 'fine'\nfixed = []\n\
             [[world.custom.bodies]]\nname = 'bead'\nshape = {{ ball = {{ radius_mm = 10 }} }}\n\
             at_mm = ['{length} * sin({angle})', 0, '-{length} * cos({angle})']\n{more}\n\
             [[world.custom.joints]]\nname = 'wire'\nbody = 'bead'\nat_mm = [0, 0, 0]\n\
             kind = {{ hinge = {{ axis = [0, 1, 0] }} }}\n{to}"
        ))
    };
    let amplitude = 4.0_f64.to_radians();
    let square = radius * radius + 0.4 * small * small;
    let period = 2.0 * PI * (square / (GRAVITY * radius)).sqrt() * (1.0 + amplitude * amplitude / 16.0);
    let off = |length: f64| {
        let film = hoop(4.0, length, "");
        // Where it is fastest, half way.
        let x = |t: f64| film.motion.tracks[0].position(t).x;
        x(2.25 * period).abs() / (amplitude * radius)
    };
    // The next term of the period is 11/3072 of the amplitude's fourth power; the steps leave less than 1e-5.
    assert!(off(200.0) < 1e-4, "{}", off(200.0));
    assert!(off(202.0) > 0.05, "{}", off(202.0));
    let rate = 9.0_f64;
    let turning = |angle: f64| {
        let keys: String = (0..12)
            .map(|k| {
                format!(
                    "{{ at_s = {}, at_mm = [0, 0, 0], turn_deg = [0, 0, {}] }},",
                    0.25 * f64::from(k),
                    0.25 * f64::from(k) * rate.to_degrees()
                )
            })
            .collect();
        let speed = rate * radius * math::sin(angle);
        let more = format!(
            "velocity_m_s = [0, {speed}, 0]\nspin_deg_s = [0, 0, {}]\n\
             [[world.custom.driven]]\nname = 'hoop'\nshape = {{ ball = {{ radius_mm = 5 }} }}\nkeys = [{keys}]\n",
            rate.to_degrees()
        );
        let film = hoop(angle.to_degrees(), 200.0, &more);
        let heights = (0..25).map(|k| film.motion.tracks[0].position(0.1 * f64::from(k)).y);
        heights.map(|y| (y + radius * math::cos(angle)).abs()).fold(0.0, f64::max)
    };
    let balance = math::acos(GRAVITY / (rate * rate * radius));
    assert!(turning(balance) < 1e-3, "{}", turning(balance));
    assert!(turning(balance + 0.2) > 0.01, "{}", turning(balance + 0.2));
}
