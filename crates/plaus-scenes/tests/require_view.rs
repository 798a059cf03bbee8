//! What a camera sees, in random worlds, beside rays that parry3d casts.

use crate::require_bounds::requirement;
use glam::{DQuat, DVec3};
use parry3d_f64::glamx::DPose3 as Pose;
use parry3d_f64::query::Ray;
use parry3d_f64::shape::SharedShape;
use plaus_dist::{Purpose, Seed, Stream};
use plaus_mcmc::{Goal, State, Target};
use plaus_scenes::animation::{Animation, Form, Look, Piece, Prop, Shape, Track, Turn, upright};
use plaus_scenes::require::{Cast, FAR, Probe};
use plaus_scenes::{Scenario, Scene};
use rand::RngExt;

/// Something at a place, as parry3d has it.
type Placed = (SharedShape, Pose);

/// Whether something is in the way between two points.
fn is_between(things: &[Placed], from: DVec3, to: DVec3) -> bool {
    let way = to - from;
    let ray = Ray::new(from, way);
    things.iter().any(|(shape, pose)| shape.cast_ray(pose, &ray, 1.0, false).is_some())
}

fn number(stream: &mut Stream, low: f64, high: f64) -> f64 {
    stream.random_range(low..high)
}

fn vector(stream: &mut Stream, most: f64) -> DVec3 {
    DVec3::from_array(std::array::from_fn(|_| number(stream, -most, most)))
}

fn turn(stream: &mut Stream) -> DQuat {
    DQuat::from_xyzw(number(stream, -1.0, 1.0), number(stream, -1.0, 1.0), number(stream, -1.0, 1.0), 0.3).normalize()
}

/// A shape as it is drawn, and as parry3d has it.
fn shape(stream: &mut Stream, kind: u32) -> (Shape, SharedShape, DQuat) {
    let size = number(stream, 0.05, 0.3);
    let upended = DQuat::from_rotation_x(std::f64::consts::FRAC_PI_2);
    match kind {
        0 => (Shape::ball(size), SharedShape::ball(size), DQuat::IDENTITY),
        1 => {
            let half = DVec3::new(size, number(stream, 0.02, 0.3), number(stream, 0.02, 0.3));
            let cuboid = SharedShape::cuboid(half.x, half.y, half.z);
            (Shape::Cuboid { half, pips: None }, cuboid, DQuat::IDENTITY)
        }
        2 => {
            let half = number(stream, 0.02, 0.3);
            (Shape::Disc { radius: size, thickness: 2.0 * half }, SharedShape::cylinder(half, size), upended)
        }
        3 => {
            let half = number(stream, 0.02, 0.3);
            let profile = vec![[size, -half], [0.0, half]];
            (Shape::Revolution { profile, stripes: Vec::new() }, SharedShape::cone(half, size), upended)
        }
        _ => {
            let vertices: Vec<DVec3> = (0..4).map(|_| vector(stream, size)).collect();
            let [a, b, c, d] = [0, 1, 2, 3].map(|k: usize| vertices[k]);
            let is_left = (b - a).cross(c - a).dot(d - a) > 0.0;
            let triangles = vec![[0, 2, 1], [0, 1, 3], [1, 2, 3], [2, 0, 3]];
            let flipped = |[a, b, c]: [u32; 3]| if is_left { [a, b, c] } else { [a, c, b] };
            let triangles: Vec<[u32; 3]> = triangles.into_iter().map(flipped).collect();
            let mesh = SharedShape::trimesh(vertices.clone(), triangles.clone()).unwrap();
            (Shape::Solid { vertices, triangles }, mesh, DQuat::IDENTITY)
        }
    }
}

/// A body that is looked at, `size` times as large, at a place; others and scenery around; and these for parry3d, the
/// body that is looked at first.
fn world(stream: &mut Stream, nth: u32, shrunk: f64) -> (Animation, Vec<Placed>) {
    let (mut tracks, mut scenery, mut all) = (Vec::new(), Vec::new(), Vec::new());
    for k in 0..9 {
        let (drawn, solid, tilt) = if k == 0 && shrunk > 0.0 {
            (Shape::ball(shrunk), SharedShape::ball(shrunk), DQuat::IDENTITY)
        } else {
            shape(stream, (nth + k) % 5)
        };
        let (at, turn) = (vector(stream, if k == 0 { 0.4 } else { 1.0 }), turn(stream));
        // One sees through the last.
        let look = if k == 8 { Look::GLASS } else { Look::STONE };
        match (k, &drawn) {
            (1 | 2, Shape::Cuboid { half, .. }) => {
                let form = Form::Block { centre: at, half: *half, orientation: turn };
                scenery.push(Prop::new(format!("block_{k}"), look, form));
            }
            (1 | 2, Shape::Solid { vertices, triangles }) => {
                let vertices = vertices.iter().map(|vertex| at + turn * *vertex).collect();
                let form = Form::Mesh { vertices, triangles: triangles.clone() };
                scenery.push(Prop::new(format!("mesh_{k}"), look, form));
            }
            _ => {
                let piece = Piece::resting(0.0, at).turning(Turn::still(turn));
                tracks.push(Track::new(format!("b{k}"), drawn, look, vec![piece]));
            }
        }
        if look != Look::GLASS {
            all.push((solid, Pose::from_parts(at, turn * tilt)));
        }
    }
    let plane = Form::Plane { centre: DVec3::ZERO, normal: DVec3::Y, half: 9.0 };
    scenery.push(Prop::new("plane", Look::STONE, plane));
    let (heights, form) = field(stream);
    scenery.push(Prop::new("field", Look::STONE, form));
    all.push(heights);
    (Animation::new(1.0, tracks, Vec::new()).with_scenery(scenery), all)
}

/// Random heights far below.
fn field(stream: &mut Stream) -> (Placed, Form) {
    let (columns, rows, step) = (6_u32, 5_u32, [0.4, 0.5]);
    let heights: Vec<f64> = (0..columns * rows).map(|_| number(stream, -0.4, 0.4)).collect();
    let origin = DVec3::new(-1.0, -0.9, -1.0);
    let corner = |k: u32| {
        origin + DVec3::new(f64::from(k % columns) * step[0], heights[k as usize], f64::from(k / columns) * step[1])
    };
    let cells = (1..rows).flat_map(|row| (1..columns).map(move |column| row * columns + column));
    let triangles = cells.flat_map(|d| {
        let [a, b, c] = [d - columns - 1, d - 1, d - columns];
        [[a, b, d], [a, d, c]]
    });
    let mesh = SharedShape::trimesh((0..columns * rows).map(corner).collect(), triangles.collect()).unwrap();
    ((mesh, Pose::IDENTITY), Form::Heightfield { origin, step, columns, heights })
}

fn cast() -> Cast {
    Cast { bodies: (0..9).map(|k| format!("b{k}")).collect(), ..Cast::default() }
}

/// A camera about 3 m away that looks to near the middle, as keys, with its place and the place that it looks at.
fn camera(stream: &mut Stream) -> (String, [DVec3; 2]) {
    let [at, to] = [3.0 * vector(stream, 1.0).normalize(), vector(stream, 0.5)];
    // The scenario's z points up.
    let said = |v: DVec3| format!("[{}, {}, {}]", 1e3 * v.x, -1e3 * v.z, 1e3 * v.y);
    (format!("camera = {{ at_mm = {}, look_at_mm = {}, fov_deg = 16 }}, aspect = 1.5", said(at), said(to)), [at, to])
}

/// Whether the picture of such a camera has a point in it.
fn is_framed([at, to]: [DVec3; 2], point: DVec3) -> bool {
    let view = glam::dcamera::rh::view::look_at_mat4(at, to, DVec3::Y);
    let seen =
        glam::dcamera::rh::proj::opengl::perspective(16_f64.to_radians(), 1.5, 0.1, 100.0) * view * point.extend(1.0);
    seen.w > 0.0 && seen.x.abs() <= seen.w && seen.y.abs() <= seen.w
}

/// Of a point, it is seen or not: exactly as parry3d says. Twins that forget what hides it, or the picture's edge, are
/// caught.
#[test]
fn a_point_is_in_view_if_nothing_is_between() {
    let mut stream = Seed(5).chain(0).at(0, Purpose::START);
    let (mut seen, mut twins) = ([0; 2], [0; 2]);
    for nth in 0..3000 {
        let (shown, things) = world(&mut stream, nth, 1e-7);
        let (said, camera) = camera(&mut stream);
        let one = requirement(&format!("in_view = {{ body = 'b0', {said} }}"));
        let is_seen = one.reach(&Probe::whole(&shown.motion, &cast()).among(&shown.scenery)).most.met();
        let point = shown.motion.tracks[0].position(0.0);
        let (hidden, framed) = (is_between(&things[1..], camera[0], point), is_framed(camera, point));
        assert_eq!(is_seen, framed && !hidden, "{nth}: {said}");
        seen[usize::from(is_seen)] += 1;
        twins[0] += u32::from(framed != is_seen);
        twins[1] += u32::from(hidden == is_seen);
    }
    assert!(seen.iter().chain(&twins).all(|count| *count > 300), "{seen:?} {twins:?}");
}

/// The share of a body that is seen, beside a picture of it with 120 × 120 rays.
#[test]
fn the_share_in_view_is_that_of_a_picture() {
    const SIDE: u32 = 120;
    let mut stream = Seed(6).chain(0).at(0, Purpose::START);
    let (mut off, mut twin, mut part, mut count) = (0.0, 0.0, 0, 0.0);
    for nth in 0..240 {
        let (shown, things) = world(&mut stream, nth, 0.0);
        let (said, camera) = camera(&mut stream);
        let one = requirement(&format!("in_view = {{ body = 'b0', {said}, at_least = 0.01, scale = 1 }}"));
        let margin = one.reach(&Probe::whole(&shown.motion, &cast()).among(&shown.scenery)).most.margin;
        let share = (margin + 0.01).max(0.0);
        let (at, reach) = (shown.motion.tracks[0].position(0.0), shown.motion.tracks[0].shape.reach());
        let (right, up) = (at - camera[0]).normalize().any_orthonormal_pair();
        let [mut all, mut visible] = [0.0; 2];
        for k in 0..SIDE * SIDE {
            let [x, y] =
                [k % SIDE, k / SIDE].map(|k| reach * 1.1 * ((2.0 * f64::from(k) + 1.0) / f64::from(SIDE) - 1.0));
            let way = at + x * right + y * up - camera[0];
            let ray = Ray::new(camera[0], way);
            let Some(hit) = things[0].0.cast_ray(&things[0].1, &ray, 2.0, true) else { continue };
            let point = camera[0] + hit * way;
            all += 1.0;
            let is_seen = is_framed(camera, point) && !is_between(&things[1..], camera[0], point);
            visible += f64::from(u8::from(is_seen));
        }
        let wanted = visible / all;
        // Both are sums over points: 60 or so of the body, and at least 100 of the picture.
        assert!((share - wanted).abs() < 0.2, "{nth}: {share} {wanted} {all}");
        off += (share - wanted).abs();
        twin += (1.0 - wanted).abs();
        part += u32::from(wanted > 0.1 && wanted < 0.9);
        count += 1.0;
    }
    assert!(off < 0.02 * count && twin > 0.2 * count, "{} {}", off / count, twin / count);
    assert!(part > 40, "{part}");
}

/// A ball of 50 mm behind a wall that is 400 mm wide, or beside the picture: the farther, the smaller the margin.
#[test]
fn margins_lead_out_of_hiding_and_into_the_picture() {
    let margin = |x: f64, is_walled: bool, how: &str| {
        let ball = vec![Piece::resting(0.0, upright(DVec3::new(x, 0.0, 0.0)))];
        let track = Track::new("b0", Shape::ball(0.05), Look::STONE, ball);
        let wall = Prop::block("wall", Look::WOOD, upright(DVec3::new(0.0, -0.5, 0.0)), DVec3::new(0.2, 3.0, 0.01));
        let shown = Animation::new(1.0, vec![track], Vec::new());
        let shown = shown.with_scenery(if is_walled { vec![wall] } else { Vec::new() });
        let camera = "camera = { at_mm = [0, -2000, 0], look_at_mm = [0, 0, 0] }";
        let one = requirement(&format!("in_view = {{ body = 'b0', {camera}, {how} }}"));
        one.reach(&Probe::whole(&shown.motion, &cast()).among(&shown.scenery)).most.margin
    };
    for (is_walled, from, to) in [(true, 0.0, 0.5), (false, 9.0, 0.5)] {
        let steps = (0..=60).map(|k| from + (to - from) * f64::from(k) / 60.0);
        let margins: Vec<f64> = steps.map(|x| margin(x, is_walled, "how = 'at_end'")).collect();
        assert!(margins.windows(2).all(|pair| pair[0] <= pair[1]), "{margins:?}");
        assert!(margins[0] < -6.0 && margins[60] == 5.0, "{margins:?}");
    }
    for (x, is_seen) in [(0.0, false), (0.25, false), (0.3, true), (0.5, true), (0.83, false)] {
        assert_eq!(margin(x, x < 0.6, "when = { at_s = 0.5 }") >= 0.0, is_seen, "{x}");
        assert_eq!(margin(x, x < 0.6, "at_least = 0.5, how = 'never'") >= 0.0, !is_seen, "{x}");
    }
    assert!(margin(0.25, true, "how = 'never'") < 0.0, "a part of it is seen");
    assert!(margin(0.5, false, "edge = 0.1") >= 0.0 && margin(0.7, false, "edge = 0.1") < 0.0);
    assert_eq!(margin(0.5, false, "how = 'always', when = { from_s = 2 }"), 5.0);
}

/// A ball that crosses a picture behind a post at 1 m/s, from x = −1 m.
#[test]
fn a_window_is_looked_at_frame_by_frame() {
    let pass = vec![Piece::ballistic(0.0, DVec3::NEG_X, DVec3::X, DVec3::ZERO)];
    let track = Track::new("b0", Shape::ball(0.01), Look::STONE, pass);
    let late = Track::new("b1", Shape::ball(0.01), Look::STONE, vec![Piece::resting(0.5, DVec3::ZERO)]).appearing(true);
    let post = Prop::block("post", Look::WOOD, DVec3::new(0.0, 0.0, 0.1), DVec3::new(0.1, 1.0, 0.01));
    let shown = Animation::new(2.0, vec![track, late], Vec::new()).with_scenery(vec![post]);
    let cast = Cast { optional: vec!["b1".into()], ..cast() };
    for (text, is_met) in [
        ("body = 'b0', how = 'always', when = { from_s = 0.8 }", false),
        ("body = 'b0', how = 'always', when = { from_s = 1.2, to_s = 1.7 }", true),
        ("body = 'b0', how = 'always', when = { from_s = 1.2, to_s = 2.0 }", false),
        ("body = 'b0', how = 'sometimes', when = { from_s = 0.95, to_s = 1.04 }", false),
        ("body = 'b0', how = 'sometimes', when = { from_s = 0.5, to_s = 1.04 }", true),
        ("body = 'b0', how = 'never', when = { from_s = 0.95, to_s = 1.04 }", true),
        ("body = 'b0', when = { frame = 24 }", false),
        ("body = 'b0', when = { frame = 30 }", true),
        ("body = 'b1', how = 'never', when = { to_s = 0.4 }", true),
        ("body = 'b1', how = 'always'", false),
    ] {
        let camera = "camera = { at_mm = [0, -4000, 0], look_at_mm = [0, 0, 0], fov_deg = 14 }";
        let one = requirement(&format!("in_view = {{ {text}, {camera} }}"));
        assert_eq!(one.reach(&Probe::whole(&shown.motion, &cast).among(&shown.scenery)).most.met(), is_met, "{text}");
    }
    let one = requirement(
        "in_view = { body = 'b0', camera = { at_mm = [0, -4000, 0] }, how = 'sometimes', when = { from_s = 1 } }",
    );
    let times = one.times(&Probe::whole(&shown.motion, &cast).among(&shown.scenery));
    assert!(times[0].found.is_some_and(|time| (1.08..1.15).contains(&time)), "{times:?}");
    assert_eq!(one.reach(&Probe::until(&shown.motion, &cast, 0.5).among(&shown.scenery)).least.margin, -FAR);
}

/// In a world of one's own the scenery hides, and the world's view is the camera.
#[test]
fn scenery_of_a_world_hides_what_is_behind_it() {
    let text = |wall: &str, view: &str, of: &str| {
        format!(
            "[world.custom]\nduration_s = 0.1\ngravity = 0\n{view}\n[[world.custom.fixed]]\nname = 'wall'\n\
             shape = {{ box = {{ size_mm = [600, 20, 1000] }} }}\n{wall}\n[[world.custom.bodies]]\nname = 'ball'\n\
             shape = {{ ball = {{ radius_mm = 30 }} }}\nat_mm = [{{ uniform = [-600, 600] }}, 0, 300]\n\
             [[require]]\nin_view = {{ {of} }}\n"
        )
    };
    let met = |text: &str| {
        let scenario = Scenario::read("a.toml", text, &[]).unwrap_or_else(|error| panic!("{error}"));
        let (stage, mut scratch) = (scenario.stage().unwrap(), Default::default());
        let one = |nth| {
            let draw = stage.start(&mut Seed(2).chain(0).at(nth, Purpose::START));
            let x = stage.motion(&draw).unwrap().tracks[0].position(0.0).x;
            let state = State::evaluate(&stage, draw, &mut scratch).unwrap();
            (x, stage.class(state.by_ref()).is_some())
        };
        (0..60).map(one).collect::<Vec<(f64, bool)>>()
    };
    let wall = "at_mm = [0, -300, 300]";
    let view = "view = { from = [0, -1, 0], box_mm = [[-1000, -100, 0], [1000, 100, 900]] }";
    for (x, is_met) in met(&text(wall, view, "")) {
        assert!(is_met == (x.abs() > 0.3) || (0.3..0.36).contains(&x.abs()), "{x} {is_met}");
    }
    assert!(met(&text("at_mm = [0, 300, 300]", view, "")).iter().all(|(_, is_met)| *is_met), "the wall is behind");
    assert!(met(&text("at_mm = [0, -300, 300]\npresent = 0", view, "")).iter().all(|(_, is_met)| *is_met), "no wall");
    for (view, of, said) in [
        ("", "", "box_mm"),
        ("", "camera = { at_mm = [0, 0, 0] }", "it is where it looks"),
        (view, "when = { to_s = 0.1 }", "in a window, `how` is"),
    ] {
        let error = match Scenario::read("a.toml", &text(wall, view, of), &[]) {
            Ok(scenario) => scenario.stage().map(drop).unwrap_err().to_string(),
            Err(error) => error.to_string(),
        };
        assert!(error.contains(said), "{error}");
    }
}
