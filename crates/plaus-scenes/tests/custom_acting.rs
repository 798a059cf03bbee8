//! What acts on a body of a user's world, compared with closed forms, for many draws of laws; and which bodies sleep.

use plaus_dist::{Purpose, Seed, math};
use plaus_mcmc::Target;
use plaus_scenes::{Scenario, Scene, World, custom::Custom};

/// The scene of a text, and draws of its prior.
fn scene(text: &str) -> Custom {
    let scenario = Scenario::read("acting.toml", text, &[]).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let World::Custom(config) = scenario.world else { panic!("another world") };
    Custom::new(&config).unwrap()
}

fn draws(scene: &Custom) -> impl Iterator<Item = <Custom as Target>::Draw> + '_ {
    (0..20).map(|nth| scene.start(&mut Seed(11).chain(0).at(nth, Purpose::START)))
}

/// With rate c and acceleration a, the distance is `(v − a/c)(1 − e^(−ct))/c + a t/c`. The numbers are in the order of
/// their keys. Places at the ends of legs are exact to rounding. Between them they deviate by up to half a gap, at most
/// 1e-5 m in all presets.
#[test]
fn ways_under_gravity_a_force_and_damping_are_those_of_the_closed_form() {
    let world = scene(
        "[world.custom]\nduration_s = 0.7\nfixed = []\n\
         [[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 50 } }\n\
         velocity_m_s = [{ normal = [1, 1] }, 0, { normal = [0, 1] }]\n\
         gravity_scale = { uniform = [-1, 2] }\nforce_n = [{ normal = [0, 1] }, 0, 0]\n\
         damping = { uniform = [0.5, 3] }\n",
    );
    let mass = 1000.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.05_f64.powi(3);
    let (mut worst, mut of_twin) = (0.0_f64, f64::INFINITY);
    for draw in draws(&world) {
        let [vx, vz, scale, force, damping] = draw.numbers[..] else { panic!("{draw:?}") };
        let animation = world.animate(&draw).unwrap();
        for time in [0.1, 0.35, 0.7] {
            let way =
                |v: f64, a: f64| (v - a / damping) * (1.0 - math::exp(-damping * time)) / damping + a * time / damping;
            let undamped = vx * time + 0.5 * force / mass * time * time;
            let place = animation.motion.tracks[0].position(time);
            // An animation has y up.
            let (dx, dz) = (place.x - way(vx, force / mass), place.y - way(vz, -9.806_65 * scale));
            worst = worst.max(dx.abs()).max(dz.abs());
            if time == 0.7 {
                of_twin = of_twin.min((place.x - undamped).abs());
            }
        }
    }
    assert!(worst < 1e-4, "{worst}");
    assert!(of_twin > 10.0 * worst, "a way without damping is not told from it: {of_twin}");
}

/// A ball about a fixed axis: `ω' = T/I − d ω`, with `I = 2/5 m r²`.
#[test]
fn turns_under_a_torque_and_angular_damping_are_those_of_the_closed_form() {
    let world = scene(
        "[world.custom]\nduration_s = 0.5\nfixed = []\ngravity = 0\n\
         [[world.custom.bodies]]\nname = 'ball'\nshape = { ball = { radius_mm = 50 } }\n\
         spin_deg_s = [0, 0, { uniform = [50, 150] }]\n\
         angular_damping = { uniform = [0.5, 3] }\ntorque_n_m = [0, 0, { uniform = [0.0005, 0.001] }]\n",
    );
    let mut of_twin = 0.0_f64;
    let inertia = 0.4 * 1000.0 * 4.0 / 3.0 * std::f64::consts::PI * 0.05_f64.powi(5);
    for draw in draws(&world) {
        let [spin, torque, damping] = draw.numbers[..] else { panic!("{draw:?}") };
        let (spin, gain, time) = (spin.to_radians(), torque / inertia, 0.5);
        let angle = (spin - gain / damping) * (1.0 - math::exp(-damping * time)) / damping + gain * time / damping;
        let track = &world.animate(&draw).unwrap().motion.tracks[0];
        let turn = track.orientation(time) * track.orientation(0.0).inverse();
        let found = 2.0 * math::atan2(turn.xyz().length(), turn.w.abs());
        // In the middle of a leg, the simulator's turn of a ball may be off by 1e-3.
        assert!((found - angle).abs() < 1e-3, "{found} for {angle}");
        of_twin = of_twin.max((found - spin * time).abs());
    }
    // In some draws torque and damping nearly cancel. Over all draws, a turn without them is far off.
    assert!(of_twin > 0.1, "a turn without torque and damping is not told from it: {of_twin}");
}

/// A compound whose pieces are turned against its own axes, so that its principal axes are others: along its own x axis
/// a thrust F leads it round a circle of radius F/(m Ω²) where it spins about z. A force of the world does not.
#[test]
fn a_thrust_that_turns_with_a_body_leads_it_round_a_circle() {
    let ends = |key: &str| {
        let world = scene(&format!(
            "[world.custom]\nduration_s = 1.3\nfixed = []\ngravity = 0\n\
             [[world.custom.bodies]]\nname = 'boat'\nspin_deg_s = [0, 0, 360]\n\
             velocity_m_s = [0, {{ uniform = [-1, 0] }}, 0]\n\
             shape = {{ compound = {{ pieces = [{{ shape = {{ box = {{ size_mm = [40, 20, 20] }} }}, \
             turn_deg = [0, 0, 30] }}] }} }}\n{key} = [{{ uniform = [0.05, 0.1] }}, 0, 0]\n"
        ));
        let mass = 1000.0 * 0.04 * 0.02 * 0.02;
        draws(&world)
            .map(|draw| {
                let [vy, force] = draw.numbers[..] else { panic!("{draw:?}") };
                let (rate, time, a) = (std::f64::consts::TAU, 1.3, force / mass);
                let (sin, cos) = math::sin_cos(rate * time);
                let there = [a / rate.powi(2) * (1.0 - cos), vy * time + a / rate * (time - sin / rate)];
                let place = world.animate(&draw).unwrap().motion.tracks[0].position(time);
                // An animation has y up.
                (place.x - there[0]).abs().max((-place.z - there[1]).abs())
            })
            .fold(0.0, f64::max)
    };
    // Legs stray by up to half a gap, at most 1e-5 m.
    assert!(ends("own_force_n") < 1e-5, "{}", ends("own_force_n"));
    assert!(ends("force_n") > 0.1);
}

/// A sleeping ball hangs in the air, although a neighbour falls past it. One that is hit falls too.
#[test]
fn sleeping_bodies_stay_until_they_are_hit() {
    let height = |aside: f64| {
        let world = scene(&format!(
            "[world.custom]\nduration_s = 3\n\
             [[world.custom.bodies]]\nname = 'apple'\nasleep = true\nshape = {{ ball = {{ radius_mm = 40 }} }}\n\
             at_mm = [0, 0, 1000]\n\
             [[world.custom.bodies]]\nname = 'stone'\nshape = {{ ball = {{ radius_mm = 30 }} }}\n\
             at_mm = [{aside}, 0, 1500]\n"
        ));
        let draw = draws(&world).next().unwrap();
        world.animate(&draw).unwrap().motion.tracks[0].position(3.0).y
    };
    assert_eq!(height(200.0), 1.0);
    assert!(height(10.0) < 0.2, "{}", height(10.0));
}

/// Two balls meet head-on. In a common group each goes on, and where it ends is that of free flight to rounding; in
/// groups of their own, or in none, they exchange their velocities.
#[test]
fn bodies_of_one_group_pass_through_each_other() {
    let ends = |[one, other]: [&str; 2]| {
        let ball = |name: &str, x: i32, v: i32, groups: &str| {
            format!(
                "[[world.custom.bodies]]\nname = '{name}'\nshape = {{ ball = {{ radius_mm = 50 }} }}\n\
                 at_mm = [{x}, 0, 0]\nvelocity_m_s = [{v}, 0, 0]\nno_contact = [{groups}]\n"
            )
        };
        let bodies = ball("a", -200, 1, one) + &ball("b", 200, -1, other);
        let world = scene(&format!("[world.custom]\nduration_s = 0.4\ngravity = 0\nfixed = []\n{bodies}"));
        let animation = world.animate(&draws(&world).next().unwrap()).unwrap();
        [0, 1].map(|body| animation.motion.tracks[body].position(0.4).x)
    };
    for groups in [["'x'", "'x'"], ["'x', 'y'", "'z', 'y'"]] {
        let [a, b] = ends(groups);
        assert!((a - 0.2).abs() < 1e-9 && (b + 0.2).abs() < 1e-9, "{groups:?}: {a} {b}");
    }
    for groups in [["'x'", "'y'"], ["'x'", ""], ["", ""]] {
        let [a, b] = ends(groups);
        assert!(a < 0.0 && b > 0.0, "{groups:?}: {a} {b}");
    }
}

/// A ball that rolls down a plane without sliding has the acceleration `g sin a/(1 + I/(m r²))`: 5/7 of `g sin a` if it
/// is solid, 3/5 if it is thin and hollow. A solid one is no hollow one.
#[test]
fn a_hollow_ball_rolls_as_slowly_as_its_inertia_says() {
    let (radius, lean) = (0.05_f64, 10.0_f64.to_radians());
    let mass = 1000.0 * 4.0 / 3.0 * std::f64::consts::PI * radius.powi(3);
    let (sin, cos) = math::sin_cos(lean);
    let after = |share: f64| {
        let moment = share * mass * radius * radius;
        let world = scene(&format!(
            "[world.custom]\nduration_s = 1\n\
             [[world.custom.fixed]]\nname = 'slope'\nshape = {{ plane = {{}} }}\nturn_deg = [0, 10, 0]\n\
             [[world.custom.bodies]]\nname = 'ball'\nshape = {{ ball = {{ radius_mm = 50 }} }}\n\
             at_mm = [{}, 0, {}]\ninertia = {{ moments_kg_m2 = [{moment}, {moment}, {moment}] }}\n",
            50.0 * sin,
            50.0 * cos,
        ));
        let animation = world.animate(&draws(&world).next().unwrap()).unwrap();
        animation.motion.tracks[0].position(1.0).distance(animation.motion.tracks[0].position(0.0))
    };
    let way = |share: f64| 0.5 * 9.806_65 * sin / (1.0 + share);
    for share in [0.4, 2.0 / 3.0] {
        // To the gap at which it touches, 1e-5 m, and the time in which it settles.
        assert!((after(share) - way(share)).abs() < 1e-3, "{share}: {} {}", after(share), way(share));
    }
    assert!((after(0.4) - way(2.0 / 3.0)).abs() > 0.02);
}

/// In flight a body turns about its principal axis of the largest moment for ever; about another axis it does not. Its
/// centre of gravity is where `centre_mm` says.
#[test]
fn a_loaded_body_turns_about_its_own_axes() {
    let tilted = |axis: [f64; 3]| {
        let [x, y, z] = axis.map(|part| 720.0 * part);
        scene(&format!(
            "[world.custom]\nduration_s = 2\nfixed = []\ngravity = 0\n\
             [[world.custom.bodies]]\nname = 'stone'\nshape = {{ box = {{ size_mm = [80, 50, 60] }} }}\n\
             at_mm = [100, 200, 300]\nturn_deg = [0, 0, 90]\nspin_deg_s = [{x}, {y}, {z}]\n\
             inertia = {{ centre_mm = [5, 0, -7], moments_kg_m2 = [1e-4, 2e-4, 2.5e-4], axes_deg = [30, 0, 0] }}\n"
        ))
    };
    // About x and then about z: the third axis of the moments in the world.
    let (sin, cos) = math::sin_cos(30.0_f64.to_radians());
    let own = [sin, 0.0, cos];
    let wobbles = |axis: [f64; 3]| {
        let world = tilted(axis);
        let animation = world.animate(&draws(&world).next().unwrap()).unwrap();
        let track = &animation.motion.tracks[0];
        // An animation has y up.
        let place = track.position(1.0) - glam::DVec3::new(0.1, 0.293, -0.205);
        assert!(place.length() < 1e-12, "{place}");
        let axis = glam::DVec3::new(axis[0], axis[2], -axis[1]).normalize();
        let fixed = track.orientation(0.0).conjugate() * axis;
        let off = |k: u32| (track.orientation(0.1 * f64::from(k)) * fixed).distance(axis);
        (0..=20).map(off).fold(0.0, f64::max)
    };
    let steady = wobbles(own);
    assert!(steady < 1e-6, "{steady}");
    assert!(wobbles([0.0, 0.0, 1.0]) > 0.1);
}

/// What cannot be is refused, at its key.
#[test]
fn impossible_inertias_are_refused() {
    for (shape, inertia, key) in [
        ("ball = { radius_mm = 5 }", "moments_kg_m2 = [1, 1, 2.1]", "inertia.moments_kg_m2[2]"),
        ("ball = { radius_mm = 5 }", "moments_kg_m2 = [1, { uniform = [1, 3] }, 1]", "inertia.moments_kg_m2[1]"),
        ("ball = { radius_mm = 5 }", "axes_deg = [0, 0, 1]", "inertia.axes_deg"),
        (
            "revolution = { foot_mm = 5, rim_mm = 1, outline_mm = [[3, 6], [5, 7], [7, 6]], top_mm = 11 }",
            "centre_mm = [0, 0, 1]",
            "inertia",
        ),
        ("box = { size_mm = [5, 5, 5] }, pips = true", "centre_mm = [0, 0, 1]", "inertia.centre_mm"),
    ] {
        let (shape, pips) = shape.split_once(", pips").map_or((shape, ""), |(shape, _)| (shape, "pips = true\n"));
        let text =
            format!("[[world.custom.bodies]]\nname = 'a'\nshape = {{ {shape} }}\n{pips}inertia = {{ {inertia} }}\n");
        let error = Scenario::read("a.toml", &text, &[]).unwrap_err().to_string();
        assert!(error.contains(&format!("world.custom.bodies[0].{key}")) || error.contains(key), "{key}: {error}");
    }
}
