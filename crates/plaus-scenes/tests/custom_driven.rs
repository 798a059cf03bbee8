//! Bodies that follow keys: their origin is where the keys have it, in animations too, and they turn about it.

use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::Target;
use plaus_scenes::animation::{Animation, Shape, Track};
use plaus_scenes::custom::Custom;
use plaus_scenes::{Scenario, Scene, World};

/// The animation of a world in which nothing is uncertain.
fn seen(text: &str) -> Animation {
    let scenario = Scenario::read("a.toml", text, &[]).unwrap_or_else(|error| panic!("{error}"));
    let World::Custom(config) = scenario.world else { panic!("another world") };
    let scene = Custom::new(&config).unwrap();
    scene.animate(&scene.start(&mut Seed(1).chain(0).at(0, Purpose::START))).unwrap()
}

/// Corners of a body as they are seen at a time, in the axes of the scenario.
fn corners(track: &Track, time: f64) -> Vec<DVec3> {
    let Shape::Solid { vertices, .. } = &*track.shape else { panic!("{:?}", track.shape) };
    let (at, turn) = (track.position(time), track.orientation(time));
    vertices.iter().map(|&corner| at + turn * corner).map(|v| DVec3::new(v.x, -v.z, v.y)).collect()
}

/// Animations tell where the point is that a scenario gives places for, and what things are made of; without that, the
/// place of a lopsided body is another one.
#[test]
fn animations_tell_origins_and_materials() {
    let shapes = [
        ("can", "cylinder = { radius_mm = 20, height_mm = 50 }", false),
        ("hat", "cone = { radius_mm = 20, height_mm = 60 }", true),
        ("stone", "hull = { points_mm = [[0, 0, 0], [40, 0, 0], [0, 50, 0], [0, 0, 60]] }", true),
        (
            "pin",
            "revolution = { foot_mm = 12, rim_mm = 2, outline_mm = [[15, 18], [50, 24], [70, 9]], top_mm = 90 }",
            true,
        ),
        ("arm", "compound = { pieces = [{ shape = { box = { size_mm = [80, 8, 40] } }, at_mm = [40, 0, 0] }] }", true),
    ];
    let body = |(k, (name, shape, _)): (usize, &(&str, &str, bool))| {
        format!(
            "[[world.custom.bodies]]\nname = '{name}'\nmaterial = 'pewter'\nshape = {{ {shape} }}\n\
             at_mm = [{}, 20, 300]\nturn_deg = [50, 20, 70]\n",
            200 * k
        )
    };
    let bodies: String = shapes.iter().enumerate().map(body).collect();
    let film = seen(&format!(
        "[world.custom]\nduration_s = 0.1\n[[world.custom.materials]]\nname = 'pewter'\nfinish = 'metal'\n{bodies}\
         [[world.custom.driven]]\nname = 'paddle'\nshape = {{ {} }}\nkeys = [{{ at_s = 0, at_mm = [0, -300, 100] }}]\n",
        shapes[4].1
    ));
    for (k, (name, _, is_lopsided)) in shapes.iter().enumerate() {
        let track = &film.motion.tracks[k];
        let off = |origin: DVec3| {
            let at = track.position(0.0) + track.orientation(0.0) * origin;
            (at - DVec3::new(0.2 * k as f64, 0.3, -0.02)).length()
        };
        assert!(off(track.origin) < 1e-12, "{name}: {}", off(track.origin));
        assert_eq!(off(DVec3::ZERO) > 1e-3, *is_lopsided, "{name}");
        assert_eq!(track.origin == DVec3::ZERO, !is_lopsided, "{name}");
        assert_eq!(track.look.name(), "pewter");
    }
    let paddle = &film.motion.tracks[shapes.len()];
    assert_eq!((paddle.origin, paddle.position(0.0)), (DVec3::ZERO, DVec3::new(0.0, 0.1, 0.3)));
    assert_eq!(film.look_of("floor").unwrap().name(), "grey stone");
}

/// A flipper of which one end is the origin, that keys turn by 60° within 20 ms, and a ball on its way.
fn flipper(between: &str) -> Animation {
    seen(&format!(
        "[world.custom]\nduration_s = 0.3\ngravity = 0\nfixed = []\n\
         [[world.custom.materials]]\nname = 'm'\nfriction = 0\nrestitution = 0.8\n\
         [[world.custom.driven]]\nname = 'flipper'\nmaterial = 'm'\nbetween = '{between}'\n\
         shape = {{ compound = {{ pieces = [\n\
             {{ shape = {{ box = {{ size_mm = [80, 8, 40] }} }}, at_mm = [40, 0, 0] }} ] }} }}\n\
         keys = [ {{ at_s = 0.1, at_mm = [0, 0, 0] }}, {{ at_s = 0.12, at_mm = [0, 0, 0], turn_deg = [0, 0, 60] }} ]\n\
         [[world.custom.bodies]]\nname = 'ball'\nmaterial = 'm'\nshape = {{ ball = {{ radius_mm = 13.5 }} }}\n\
         at_mm = ['62 * cos(50)', '62 * sin(50)', 0]\n"
    ))
}

/// Its origin stays where it is, at its keys and between them, and a ball leaves with `1 + e` times the speed of the
/// point that strikes it.
#[test]
fn a_flipper_turns_about_its_origin() {
    let film = flipper("linear");
    let [ball, flipper] = &film.motion.tracks[..] else { panic!("{:?}", film.motion.tracks) };
    let begin = corners(flipper, 0.0);
    for time in [0.1, 0.104, 0.11, 0.1175, 0.12, 0.2] {
        let angle = 60_f64.to_radians() * ((time - 0.1) / 0.02_f64).clamp(0.0, 1.0);
        for (corner, now) in begin.iter().zip(corners(flipper, time)) {
            let off = (DQuat::from_rotation_z(angle) * *corner - now).length();
            assert!(off < 1e-9, "{time}: {corner} is at {now}");
        }
    }
    let speed = (ball.position(0.25) - ball.position(0.2)).length() / 0.05;
    // The ball touches the face, 4 mm off the axis, where its centre is 17.5 mm off.
    let expected = 1.8 * 60_f64.to_radians() / 0.02 * (62_f64 * 62.0 - 17.5 * 17.5).sqrt() * 1e-3;
    // It is met a gap early, of 1e-5 of 4 mm.
    assert!((speed / expected - 1.0).abs() < 1e-5, "{speed} for {expected}");
    // Smoothly, it turns about its origin too; animations are off by a fiftieth of a millimetre.
    let film = self::flipper("smooth");
    let begin = corners(&film.motion.tracks[1], 0.0);
    for (time, part) in [(0.105, 5.0 / 32.0), (0.11, 0.5), (0.115, 27.0 / 32.0)] {
        // The components of the quaternion are on a cubic.
        let q = DQuat::IDENTITY * (1.0 - part) + DQuat::from_rotation_z(60_f64.to_radians()) * part;
        for (corner, now) in begin.iter().zip(corners(&film.motion.tracks[1], time)) {
            let off = (q.normalize() * *corner - now).length();
            assert!(off < 2e-5, "{time}: {corner} is at {now}");
        }
    }
}

/// What the keys of any shape say is where its origin is: a cone on its tip, a hull about a corner, a solid of
/// revolution about its foot. As for bodies at rest, whose place says the same.
#[test]
fn keys_place_every_shape_as_a_place_does() {
    for shape in [
        "cone = { radius_mm = 20, height_mm = 50 }",
        "hull = { points_mm = [[0, 0, 0], [30, 0, 0], [0, 20, 0], [0, 0, 50]] }",
        "revolution = { foot_mm = 10, rim_mm = 3, outline_mm = [[10, 16], [40, 20], [70, 12], [90, 14]], top_mm = 106 }",
        "box = { size_mm = [10, 20, 30] }",
    ] {
        let world = |what: &str| {
            seen(&format!(
                "[world.custom]\nduration_s = 0.3\ngravity = 0\nfixed = []\n\
                 [[world.custom.bodies]]\nname = 'far'\nshape = {{ ball = {{ radius_mm = 9 }} }}\nat_mm = [0, 0, 900]\n\
                 [[world.custom.{what}\n"
            ))
        };
        let still = world(&format!(
            "bodies]]\nname = 'a'\nshape = {{ {shape} }}\nat_mm = [10, 20, 30]\nturn_deg = [40, 50, 60]"
        ));
        let driven = world(&format!(
            "driven]]\nname = 'a'\nshape = {{ {shape} }}\n\
             keys = [{{ at_s = 0, at_mm = [0, 0, 0] }}, {{ at_s = 0.2, at_mm = [10, 20, 30], turn_deg = [40, 50, 60] }}]"
        ));
        let place = |film: &Animation| {
            let track = &film.motion.tracks[1];
            let shift = match &*track.shape {
                Shape::Solid { vertices, .. } => vertices[0],
                Shape::Revolution { profile, .. } => DVec3::Z * profile[0][1],
                _ => DVec3::ZERO,
            };
            track.position(0.25) + track.orientation(0.25) * shift
        };
        assert!((place(&still) - place(&driven)).length() < 1e-9, "{shape}");
    }
}

/// A plank that gains 2 m/s² for 1 s, then keeps 2 m/s, then loses 4 m/s², to rounding; linear and smooth keys are
/// elsewhere. A block on it slides back by `(a − µ g) t²/2`, or not at all if friction holds it: as its contact is
/// found in steps, to their error, which is below 1 mm.
#[test]
fn accelerated_keys_have_constant_accelerations() {
    let film = |between: &str, friction: f64| {
        seen(&format!(
            "[world.custom]\nduration_s = 2.7\nfixed = []\ngravity = 10\n\
             [[world.custom.materials]]\nname = 'm'\nfriction = {friction}\nrestitution = 0\n\
             [[world.custom.driven]]\nname = 'plank'\nmaterial = 'm'\nbetween = '{between}'\n\
             shape = {{ box = {{ size_mm = [2000, 200, 20] }} }}\n\
             keys = [ {{ at_s = 0, at_mm = [0, 0, -10] }}, {{ at_s = 1, at_mm = [1000, 0, -10] }},\n\
                      {{ at_s = 2, at_mm = [3000, 0, -10] }}, {{ at_s = 2.5, at_mm = [3500, 0, -10] }} ]\n\
             [[world.custom.bodies]]\nname = 'block'\nmaterial = 'm'\n\
             shape = {{ box = {{ size_mm = [50, 50, 20] }} }}\n\
             at_mm = [0, 0, 10]\n"
        ))
    };
    let way = |t: f64| match t {
        ..1.0 => t * t,
        ..2.0 => 2.0 * t - 1.0,
        ..2.5 => 3.0 + 2.0 * (t - 2.0) - 2.0 * (t - 2.0) * (t - 2.0),
        _ => 3.5,
    };
    let off = |film: &Animation| {
        let plank = &film.motion.tracks[1];
        (0..27).map(|k| 0.1 * f64::from(k)).map(|t| (plank.position(t).x - way(t)).abs()).fold(0.0, f64::max)
    };
    let (slips, sticks) = (film("accelerated", 0.1), film("accelerated", 0.5));
    assert!(off(&slips) < 1e-9, "{}", off(&slips));
    assert!(off(&film("linear", 0.1)) > 0.1 && off(&film("smooth", 0.1)) > 0.05);
    let block = |film: &Animation, t| film.motion.tracks[0].position(t).x - way(t);
    for t in [0.3, 0.6, 0.9] {
        assert!((block(&slips, t) + 0.5 * t * t).abs() < 1e-3, "{t}: {}", block(&slips, t));
        assert!(block(&sticks, t).abs() < 1e-3, "{t}: {}", block(&sticks, t));
    }
}
