//! Worlds in files for physics engines: what is written of a world is read as that world.

use glam::{DMat3, DQuat, DVec3};
use plaus_dist::math::sin_cos;
use plaus_dist::{Purpose, Seed};
use plaus_export::{Clip, Cut, Engines, Label, Style, glb};
use plaus_mcmc::Target;
use plaus_scenes::animation::{Animation, AxisKind, Collider, Form, Physics, Solid};
use plaus_scenes::custom::Custom;
use plaus_scenes::{Assets, Scenario, Scene, World, import};
use std::fmt::Write;

/// Lengths in m, angles, speeds and the like: numbers in single precision and with six digits after the point.
const ROUNDED: f64 = 3e-6;
/// Masses and moments, of what they are: those of shapes with such lengths.
const WEIGHED: f64 = 2e-5;

/// Uniform numbers from 0 to 1, by Knuth's linear congruential generator (MMIX).
struct Uniform(u64);

impl Uniform {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn below(&mut self, count: usize) -> usize {
        (self.next() * count as f64) as usize
    }

    /// With three digits after the point.
    fn between(&mut self, low: f64, high: f64) -> f64 {
        ((low + (high - low) * self.next()) * 1e3).round() / 1e3
    }

    fn three(&mut self, low: f64, high: f64) -> String {
        let [x, y, z] = [0; 3].map(|_| self.between(low, high));
        format!("[{x}, {y}, {z}]")
    }
}

/// A shape of a body: of every kind that a file has exactly.
fn shape(kind: usize, u: &mut Uniform) -> String {
    let mut size = || u.between(30.0, 90.0);
    match kind {
        0 => format!("ball = {{ radius_mm = {} }}", size()),
        1 => format!("box = {{ size_mm = [{}, {}, {}] }}", size(), size(), size()),
        2 => format!("cylinder = {{ radius_mm = {}, height_mm = {} }}", size(), size()),
        3 => format!("cone = {{ radius_mm = {}, height_mm = {} }}", size(), size()),
        4 => format!("capsule = {{ radius_mm = {}, length_mm = {} }}", size(), size()),
        5 => format!("ellipsoid = {{ size_mm = [{}, {}, {}] }}", size(), size(), size()),
        6 => format!("die = {{ sides = 8, size_mm = {} }}", size()),
        7 => {
            let points: Vec<String> = (0..9).map(|_| u.three(-60.0, 90.0)).collect();
            format!("hull = {{ points_mm = [{}] }}", points.join(", "))
        }
        _ => {
            let piece = |kind: usize, u: &mut Uniform| {
                let (shape, at, turn) = (shape(kind, u), u.three(-60.0, 60.0), u.three(-180.0, 180.0));
                format!(
                    "{{ shape = {{ {shape} }}, at_mm = {at}, turn_deg = {turn}, density = {} }}",
                    u.between(0.5, 3.0)
                )
            };
            let pieces = [u.below(6), 2 + u.below(4)].map(|kind| piece(kind, u));
            format!("compound = {{ pieces = [{}] }}", pieces.join(", "))
        }
    }
}

/// A world of bodies of every shape, in the air, with all that a file for engines can say.
fn world(u: &mut Uniform) -> String {
    let mut text = format!("[world.custom]\nduration_s = 0.2\ngravity = {}\n", u.between(1.0, 20.0));
    for name in ["wood", "rubber", "ice"] {
        let [friction, restitution] = [u.between(0.05, 1.2), u.between(0.0, 1.0)];
        let _ = write!(text, "[[world.custom.materials]]\nname = \"{name}\"\ndensity = {}\n", u.between(200.0, 3000.0));
        let _ = write!(text, "friction = {friction}\nrestitution = {restitution}\n");
        if name == "wood" {
            let _ = writeln!(text, "static_friction = {}", 1.5 * friction);
        }
    }
    let material = |u: &mut Uniform| ["wood", "rubber", "ice"][u.below(3)];
    let _ = write!(text, "[[world.custom.fixed]]\nname = \"floor\"\nshape = {{ plane = {{}} }}\n");
    let _ = write!(text, "material = \"{}\"\nturn_deg = [{}, 0, 20]\n", material(u), u.between(-5.0, 5.0));
    for (name, kind) in [("block", 1), ("post", 2), ("stone", 7)] {
        let (shape, x) = (shape(kind, u), u.between(-400.0, 400.0));
        let _ = write!(text, "[[world.custom.fixed]]\nname = \"{name}\"\nshape = {{ {shape} }}\n");
        let _ = write!(text, "at_mm = [{x}, 900, 300]\nturn_deg = {}\n", u.three(-180.0, 180.0));
        let _ = writeln!(text, "material = \"{}\"", material(u));
    }
    for body in 0..9_i32 {
        let shape = shape(body as usize, u);
        let _ = write!(text, "[[world.custom.bodies]]\nname = \"b{body}\"\nshape = {{ {shape} }}\n");
        let _ = writeln!(text, "at_mm = [{}, {}, 1500]", 600 * (body % 3), 600 * (body / 3) - 600);
        let _ = write!(text, "turn_deg = {}\nmaterial = \"{}\"\n", u.three(-180.0, 180.0), material(u));
        let _ = write!(text, "velocity_m_s = {}\nspin_deg_s = {}\n", u.three(-0.5, 0.5), u.three(-90.0, 90.0));
        if u.below(3) == 0 {
            let _ = writeln!(text, "gravity_scale = {}", u.between(-1.0, 2.0));
        }
        if u.below(2) == 0 {
            let low = 1e-4 * (1.0 + u.between(0.0, 1.0));
            let [b, c] = [0; 2].map(|_| low * (1.0 + u.between(0.0, 0.9)));
            let _ =
                write!(text, "inertia = {{ centre_mm = {}, moments_kg_m2 = [{low}, {b}, {c}], ", u.three(-9.0, 9.0));
            let _ = writeln!(text, "axes_deg = {} }}", u.three(-80.0, 80.0));
        }
        let groups = ["", "\"g\"", "\"h\"", "\"g\", \"h\""][u.below(4)];
        let _ = writeln!(text, "no_contact = [{groups}]");
    }
    for (nth, kind) in ["ball", "weld", "hinge", "slider"].into_iter().enumerate() {
        let (body, to) = (2 * nth, if u.below(2) == 0 { String::new() } else { format!("b{}", 2 * nth + 1) });
        let axial = |unit: [&str; 3], u: &mut Uniform| {
            let [low, high] = [u.between(-50.0, -1.0), u.between(1.0, 50.0)];
            let [stiff, rest, damping] = [u.between(0.1, 5.0), u.between(-20.0, 20.0), u.between(0.0, 0.1)];
            format!(
                "axis = {}, limits_{} = [{low}, {high}], spring = {{ stiffness_{} = {stiff}, rest_{} = {rest}, \
                 damping_{} = {damping} }}",
                u.three(0.1, 1.0),
                unit[0],
                unit[1],
                unit[0],
                unit[2]
            )
        };
        let said = match kind {
            "hinge" => axial(["deg", "n_m_per_rad", "n_m_s_per_rad"], u),
            "slider" => axial(["mm", "n_per_m", "n_s_per_m"], u),
            _ => String::new(),
        };
        let _ = write!(text, "[[world.custom.joints]]\nname = \"j{nth}\"\nbody = \"b{body}\"\nto = \"{to}\"\n");
        let _ = write!(text, "at_mm = {}\nkind = {{ {kind} = {{ {said} }} }}\n", u.three(200.0, 900.0));
    }
    text
}

/// A scenario's scene, the world that it starts in, and the motion.
fn scene(text: &str, files: &Assets) -> (Physics, Animation) {
    let scenario = Scenario::read_with("a.toml", text, &[], files).unwrap_or_else(|error| panic!("{error}\n{text}"));
    let World::Custom(config) = scenario.world else { panic!() };
    let scene = Custom::new(&config).unwrap();
    let draw = scene.start(&mut Seed(1).chain(0).at(0, Purpose::START));
    (scene.physics(&draw).unwrap().unwrap(), scene.animate(&draw).unwrap())
}

/// What is read of what is written, with nothing uncertain, and what is then said to be left out.
fn back(physics: &Physics, animation: &Animation) -> (Physics, Animation, Vec<String>) {
    let label = Label::new("a");
    let style = Style { engines: Engines::Alone, ..Style::default() };
    let clip = Clip::new(animation, &label, Cut::new(60.0, None, animation).unwrap()).styled(style);
    let mut writer = glb::Writer::default();
    writer.add(&clip.with_physics(Some(physics))).unwrap();
    writer.add_physics(physics);
    let mut files = Assets::default();
    files.insert("a.glb", writer.finish().unwrap());
    let made = import::scenario("a.glb", false, None, &files).unwrap_or_else(|error| panic!("{error}"));
    let mut text = String::new();
    for (nth, part) in made.text.split("{ normal = [").enumerate() {
        let Some((mean, rest)) = part.split_once(',').filter(|_| nth > 0) else {
            text += part;
            continue;
        };
        text += mean;
        text += rest.split_once("] }").unwrap().1;
    }
    // As short as its original.
    let (physics, animation) = scene(&text.replace("duration_s = 10", "duration_s = 0.2"), &files);
    (physics, animation, made.left_out)
}

/// Corners of what is drawn of scenery.
fn corners(animation: &Animation, name: &str) -> Vec<DVec3> {
    let Some(prop) = animation.scenery.iter().find(|prop| prop.name == name) else { return Vec::new() };
    match &prop.form {
        Form::Block { centre, half, orientation } => {
            let side = |k: u32, axis: u32| if k >> axis & 1 == 1 { 1.0 } else { -1.0 };
            let corner = |k| *centre + *orientation * (*half * DVec3::new(side(k, 0), side(k, 1), side(k, 2)));
            (0..8).map(corner).collect()
        }
        Form::Mesh { vertices, .. } => vertices.clone(),
        Form::Plane { centre, .. } => vec![*centre],
        Form::Heightfield { origin, step, columns, heights } => {
            let corner = |(k, height): (u32, &f64)| {
                let [x, z] = [k % columns, k / columns].map(f64::from);
                *origin + DVec3::new(x * step[0], *height, z * step[1])
            };
            (0..).zip(heights).map(corner).collect()
        }
    }
}

/// How far something, of which these corners are drawn, reaches in a direction.
fn support(all: &[Collider], drawn: &[DVec3], way: DVec3) -> f64 {
    let one = |collider: &Collider| {
        let own = collider.turn.conjugate() * way;
        let across = (own.x * own.x + own.z * own.z).sqrt();
        collider.at.dot(way)
            + match &collider.solid {
                Solid::Ball(radius) => *radius,
                Solid::Box(edges) => 0.5 * edges.dot(own.abs()),
                Solid::Cylinder([bottom, top], height) => {
                    (top * across + 0.5 * height * own.y).max(bottom * across - 0.5 * height * own.y)
                }
                Solid::Capsule(radius, length) => radius + 0.5 * length * own.y.abs(),
                Solid::Hull(corners, _) => corners.iter().map(|corner| corner.dot(own)).fold(f64::MIN, f64::max),
                // All that counts of it is its upper side.
                Solid::Plane => 1e3 * own.y,
                Solid::Drawn => drawn.iter().map(|corner| corner.dot(own)).fold(f64::MIN, f64::max),
            }
    };
    all.iter().map(one).fold(f64::MIN, f64::max)
}

fn tensor(moments: DVec3, axes: DQuat) -> DMat3 {
    let axes = DMat3::from_quat(axes);
    axes * DMat3::from_diagonal(moments) * axes.transpose()
}

/// What of a world is otherwise in another, in words.
#[expect(clippy::too_many_lines, reason = "one comparison for each thing that a world has")]
fn differs((a, drawn): (&Physics, &Animation), (b, its_drawn): (&Physics, &Animation)) -> Vec<String> {
    let mut off = Vec::new();
    let mut check = |is_same: bool, what: String| off.extend((!is_same).then_some(what));
    let near = |a: DVec3, b: DVec3| a.distance(b) < ROUNDED * (1.0 + a.length());
    let ways: Vec<DVec3> = (0..40_u32)
        .map(|k| {
            let angle = |part: f64| sin_cos(f64::from(k) * part);
            DVec3::new(angle(0.7).0, angle(1.3).1, angle(2.1).0).normalize()
        })
        .collect();
    let same_shape = |a: &[Collider], b: &[Collider], name: &str| {
        let (own, other) = (corners(drawn, name), corners(its_drawn, name));
        ways.iter().all(|&way| {
            let (own, other) = (support(a, &own, way), support(b, &other, way));
            (own - other).abs() < ROUNDED * (1.0 + own.abs())
        })
    };
    let place = |name: &str| b.bodies.iter().position(|body| body.name == name).unwrap_or_else(|| panic!("no {name}"));
    check(a.bodies.len() == b.bodies.len() && a.joints.len() == b.joints.len(), "numbers".into());
    for body in &a.bodies {
        let (name, other) = (&body.name, &b.bodies[place(&body.name)]);
        check(near(body.at, other.at), format!("place of {name}: {} {}", body.at, other.at));
        check(body.turn.dot(other.turn).abs() > 1.0 - ROUNDED * ROUNDED, format!("turn of {name}"));
        check(near(body.velocity, other.velocity), format!("velocity of {name}"));
        check(near(body.spin, other.spin), format!("spin of {name}"));
        check((body.gravity - other.gravity).abs() < ROUNDED, format!("gravity of {name}"));
        check((body.mass / other.mass - 1.0).abs() < WEIGHED, format!("mass of {name}: {} {}", body.mass, other.mass));
        let [own, its] = [tensor(body.moments, body.axes), tensor(other.moments, other.axes)];
        let far = (own - its).to_cols_array().iter().map(|x| x.abs()).fold(0.0, f64::max);
        check(far < WEIGHED * body.moments.max_element(), format!("inertia of {name}: {own} {its}"));
        check(same_shape(&body.colliders, &other.colliders, name), format!("shape of {name}"));
    }
    for still in &a.scenery {
        let other = b.scenery.iter().find(|other| other.name == still.name);
        check(
            other.is_some_and(|other| same_shape(&still.colliders, &other.colliders, &still.name)),
            format!("shape of {}", still.name),
        );
    }
    let materials = |world: &Physics| -> Vec<(String, usize)> {
        let bodies = world.bodies.iter().map(|body| (body.name.clone(), body.material));
        let mut all: Vec<_> = bodies.chain(world.scenery.iter().map(|one| (one.name.clone(), one.material))).collect();
        all.sort();
        all
    };
    let (mine, its) = (materials(a), materials(b));
    for (one, other) in mine.iter().zip(&its) {
        for (two, that) in mine.iter().zip(&its) {
            let [law, its] = [a.laws[one.1][two.1], b.laws[other.1][that.1]];
            let is_same = (0..3).all(|k| (law[k] - its[k]).abs() < ROUNDED);
            check(is_same, format!("law of {} and {}: {law:?} {its:?}", one.0, two.0));
        }
    }
    let passes = |world: &Physics, x: &str, y: &str| {
        let index = |name: &str| world.bodies.iter().position(|body| body.name == name).unwrap();
        world.no_contact.iter().any(|group| group.contains(&index(x)) && group.contains(&index(y)))
    };
    // What a joint holds together never touches.
    let held = |x: &str, y: &str| {
        let is = |index: Option<usize>, name: &str| index.is_some_and(|index| a.bodies[index].name == name);
        a.joints.iter().any(|joint| {
            let [one, other] = [Some(joint.body), joint.other];
            (is(one, x) && is(other, y)) || (is(one, y) && is(other, x))
        })
    };
    for (nth, x) in a.bodies.iter().enumerate() {
        for y in a.bodies[..nth].iter().filter(|y| !held(&x.name, &y.name)) {
            check(
                passes(a, &x.name, &y.name) == passes(b, &x.name, &y.name),
                format!("whether {} meets {}", x.name, y.name),
            );
        }
    }
    for joint in &a.joints {
        let Some(other) = b.joints.iter().find(|other| other.name == joint.name) else { panic!("no {}", joint.name) };
        check(near(joint.at, other.at), format!("place of {}", joint.name));
        let ends = |world: &Physics, joint: &plaus_scenes::animation::Joint| {
            [Some(joint.body), joint.other].map(|index| index.map(|index| world.bodies[index].name.clone()))
        };
        check(ends(a, joint) == ends(b, other), format!("ends of {}", joint.name));
        let is_same = match (&joint.axis, &other.axis) {
            (AxisKind::Weld, AxisKind::Weld) | (AxisKind::Ball, AxisKind::Ball) => true,
            (AxisKind::Hinge(a), AxisKind::Hinge(b)) | (AxisKind::Slider(a), AxisKind::Slider(b)) => {
                let two = |a: &[f64], b: &[f64]| a.iter().zip(b).all(|(a, b)| (a - b).abs() < ROUNDED);
                let limits = [a, b].map(|axis| axis.limits.unwrap_or_default());
                let springs = [a, b].map(|axis| axis.spring.unwrap_or_default());
                near(a.along, b.along) && two(&limits[0], &limits[1]) && two(&springs[0], &springs[1])
            }
            _ => false,
        };
        check(is_same, format!("kind of {}: {:?} {:?}", joint.name, joint.axis, other.axis));
    }
    off
}

/// Requires that bodies move as they did, until what touches makes rounding grow.
fn moves_alike(shown: &Animation, again: &Animation, text: &str) {
    let end = shown.motion.impacts.iter().map(|hit| hit.time).fold(0.2, f64::min);
    // The foot of a pin is a bit higher where its hull has fewer corners.
    for track in shown.motion.tracks.iter().filter(|track| !track.name.starts_with("pin_")) {
        let other = again.motion.tracks.iter().find(|other| other.name == track.name).unwrap();
        for k in 0..=10 {
            let time = 0.1 * end * f64::from(k);
            let apart = track.position(time).distance(other.position(time));
            // Steps of joints follow the preset, within which they may be taken at other times.
            assert!(apart < 1e-4, "{} is off by {apart} m at {time} s\n{text}", track.name);
        }
    }
}

/// What makes another world of one; it is given how vectors are turned.
type Fault = fn(&mut Physics, &dyn Fn(DVec3) -> DVec3);

/// A world that is written and read is itself, and moves as it did, until what touches makes rounding grow. Twins are
/// caught: with velocities along another axis, moments about others, materials in another order, limits the other way
/// round, without the groups that pass through each other, and with solids along another axis.
#[test]
fn a_world_that_is_written_is_read_as_itself() {
    let mut uniform = Uniform(5);
    let swapped = |v: DVec3| DVec3::new(v.x, v.z, v.y);
    let faults: [Fault; 6] = [
        |world, swapped| world.bodies.iter_mut().for_each(|body| body.velocity = swapped(body.velocity)),
        |world, swapped| world.bodies.iter_mut().for_each(|body| body.moments = swapped(body.moments)),
        |world, _| world.bodies.iter_mut().for_each(|body| body.material = 1 + body.material % 3),
        |world, _| {
            for joint in &mut world.joints {
                if let AxisKind::Hinge(axis) | AxisKind::Slider(axis) = &mut joint.axis {
                    axis.limits = axis.limits.map(|[low, high]| [-high, -low]);
                }
            }
        },
        |world, _| world.no_contact.clear(),
        |world, _| {
            for collider in world.bodies.iter_mut().flat_map(|body| &mut body.colliders) {
                collider.turn *= DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
            }
        },
    ];
    for (nth, fault) in faults.into_iter().enumerate() {
        let text = world(&mut uniform);
        let (own, shown) = scene(&text, &Assets::default());
        assert_eq!((own.left_out.as_slice(), glb::other_pairs(&own)), (&[][..], 0), "{text}");
        let (read, moves, left_out) = back(&own, &shown);
        let off = differs((&own, &shown), (&read, &moves));
        assert!(off.is_empty() && left_out.is_empty(), "{off:#?}\n{left_out:#?}\n{text}");
        moves_alike(&shown, &moves, &text);
        let mut twin = own.clone();
        fault(&mut twin, &swapped);
        let (read, moves, _) = back(&twin, &shown);
        assert!(!differs((&own, &shown), (&read, &moves)).is_empty(), "fault {nth}");
    }
}

/// The scenes of the paper are read as they are written too, but for what is said to be left out. Twins are caught:
/// with velocities along another axis, with masses twice as large, with half the restitution, and without the first
/// part of the scenery.
#[test]
fn scenes_that_are_written_are_read_as_themselves() {
    let swapped = |v: DVec3| DVec3::new(v.x, v.z, v.y);
    let faults: [Fault; 4] = [
        |world, swapped| world.bodies.iter_mut().for_each(|body| body.velocity = swapped(body.velocity) + DVec3::X),
        |world, _| world.bodies.iter_mut().for_each(|body| body.mass *= 2.0),
        |world, _| world.laws.iter_mut().flatten().for_each(|law| law[1] *= 0.5),
        |world, _| drop(world.scenery.remove(0)),
    ];
    for (text, left_out) in [
        ("[world.ball2d]", "table: the random normals of bounces: it is level"),
        ("[world.bowling]\npins = [6, 7]\nleave = [6]", "pins: their hollows: the convex hulls of their outlines"),
        ("[world.dice]\ndice = 2\ntogether = true\ndie = { rounding_mm = 0 }", "table: that its friction differs"),
        ("[world.dice]\ndice = 2", "that each die has a table of its own"),
        ("[world.dice]\ntable = { bumps_mm = 0 }\ndie = { edge_x_mm = 20 }", "dice: the rounding of their edges"),
        ("[world.spelling]\nbitmap = '##'", "floor: how round its bowls are"),
    ] {
        let stage = Scenario::read("a.toml", text, &[]).unwrap_or_else(|error| panic!("{error}")).stage().unwrap();
        // The first draw whose simulation comes to an end.
        let draws = (0..50).map(|nth| stage.start(&mut Seed(3).chain(0).at(nth, Purpose::START)));
        let mut motions = draws.filter_map(|draw| Some((stage.animate(&draw).ok()?, draw)));
        let (shown, draw) = motions.next().unwrap();
        let own = stage.physics(&draw).unwrap().unwrap();
        assert_eq!(own.bodies.len(), shown.motion.tracks.len(), "{text}");
        assert!(own.left_out.iter().any(|what| what.starts_with(left_out)), "{text}: {:#?}", own.left_out);
        let (read, moves, mut unread) = back(&own, &shown);
        unread.retain(|what| !what.ends_with("it has a mesh but no collider, so nothing can touch it"));
        let mut off = differs((&own, &shown), (&read, &moves));
        // No rule of the extension gives all of a bowling alley's pairs.
        let is_law = |what: &String| what.starts_with("law of");
        assert_eq!(glb::other_pairs(&own) > 0, off.iter().any(is_law), "{text}");
        off.retain(|what| !is_law(what));
        // A hull that is read has fewer corners: those of a pin are within a millimetre of it.
        for (pin, other) in own.bodies.iter().zip(&read.bodies).filter(|(body, _)| body.name.starts_with("pin_")) {
            for way in [DVec3::X, DVec3::Y, DVec3::NEG_Y, DVec3::Z] {
                let apart = support(&pin.colliders, &[], way) - support(&other.colliders, &[], way);
                assert!(pin.name == other.name && apart.abs() < 1e-3, "{}: {way} {apart}", pin.name);
            }
        }
        off.retain(|what| !what.starts_with("shape of pin_"));
        assert!(off.is_empty(), "{text}\n{off:#?}");
        assert!(unread.is_empty(), "{text}\n{unread:#?}");
        // Sharp edges meet the table earlier, and what is dropped later falls at once.
        let is_sharp = own.left_out.iter().all(|what| !what.contains("rounding"));
        if is_sharp && shown.motion.tracks.iter().all(|track| track.pieces[0].start <= 0.0) {
            moves_alike(&shown, &moves, text);
        }
        for (nth, fault) in faults.iter().enumerate() {
            let mut twin = own.clone();
            fault(&mut twin, &swapped);
            let (read, moves, _) = back(&twin, &shown);
            assert!(!differs((&own, &shown), (&read, &moves)).is_empty(), "{text}: fault {nth}");
        }
    }
}
