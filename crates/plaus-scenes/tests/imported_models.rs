//! Worlds made from models in MJCF: places, masses and joints beside MuJoCo's own, which `xtask/python/mjcf_poses.py`
//! wrote, what is listed as left out, and what is refused.

use glam::{DMat3, DQuat, DVec3};
use plaus_asset::model::{self, Model, Solid};
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::Target;
use plaus_scenes::animation::{Form, Shape as Drawn};
use plaus_scenes::custom::{Config, Custom};
use plaus_scenes::{Assets, Physical, Scenario, Scene, World, import};
use plaus_sim::rigid::Start;
use serde_json::Value;

const FRAMES: &str = include_str!("models/frames.xml");
const JOINTS: &str = include_str!("models/joints.xml");

/// MuJoCo's numbers have twelve digits after the point.
const EXACT: f64 = 1e-11;
/// MuJoCo has the corners of meshes in single precision; scenarios have millionths of a millimetre and of a
/// degree.
const ROUNDED: f64 = 1e-6;

fn files(model: &str) -> Assets {
    let mut files = Assets::default();
    files.insert("model.xml", model.as_bytes());
    files.insert("arm.xml", include_bytes!("models/arm.xml").as_slice());
    files.insert("shapes/wedge.stl", include_bytes!("models/shapes/wedge.stl").as_slice());
    files.insert("shapes/prism.obj", include_bytes!("models/shapes/prism.obj").as_slice());
    files
}

fn read(model: &str) -> Model {
    let arm = include_bytes!("models/arm.xml").to_vec();
    let mut open = |file: &str| if file == "arm.xml" { Ok(arm.clone()) } else { Err("none".into()) };
    plaus_asset::read_model(model.as_bytes(), &mut open).unwrap_or_else(|error| panic!("{error}"))
}

/// The world made of a model.
pub(crate) fn imported(model: &str) -> (import::Imported, Config) {
    let files = files(model);
    let made = import::scenario("model.xml", false, None, &files).unwrap_or_else(|error| panic!("{error}"));
    let scenario =
        Scenario::read_with("a.toml", &made.text, &[], &files).unwrap_or_else(|error| panic!("{error}\n{}", made.text));
    let World::Custom(config) = scenario.world else { panic!() };
    (made, *config)
}

/// A model with this inside of its `<worldbody>`.
pub(crate) fn bodies(inside: &str) -> String {
    format!("<mujoco><worldbody>{inside}</worldbody></mujoco>")
}

fn refused(model: &str) -> String {
    import::scenario("model.xml", false, None, &files(model)).unwrap_err().to_string()
}

pub(crate) fn truth(name: &str) -> Value {
    serde_json::from_str::<Value>(include_str!("models/poses.json")).unwrap()[name].clone()
}

fn vector(value: &Value) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|k| value[k].as_f64().unwrap()))
}

fn list(value: &Value) -> impl Iterator<Item = (&str, &Value)> {
    value.as_object().unwrap().iter().map(|(name, value)| (name.as_str(), value))
}

/// How far the bodies, shapes and joints of a model are from where MuJoCo has them, in m, and for axes in radians.
pub(crate) fn off(model: &Model, truth: &Value) -> f64 {
    let mut most = 0.0_f64;
    for (name, said) in list(&truth["bodies"]) {
        let body = model.bodies.iter().find(|body| body.name == name).unwrap();
        let turn: [f64; 4] = std::array::from_fn(|k| said["turn"][k].as_f64().unwrap());
        let turn = DQuat::from_xyzw(turn[1], turn[2], turn[3], turn[0]);
        most = most.max(body.at.distance(vector(&said["at"]))).max(1.0 - body.turn.dot(turn).abs());
    }
    for (name, said) in list(&truth["joints"]) {
        let named = |joint: &&model::Joint| joint.name.as_deref() == Some(name);
        let joint = model.bodies.iter().flat_map(|body| &body.joints).find(named).unwrap();
        most = most.max(joint.at.distance(vector(&said["at"])));
        if joint.kind == model::JointKind::Hinge {
            most = most.max(joint.axis.distance(vector(&said["axis"])));
        }
    }
    for (name, said) in list(&truth["geoms"]).filter(|(_, said)| !said["at"].is_null()) {
        let named = |geom: &&model::Geom| geom.name.as_deref() == Some(name);
        let geom = model.bodies.iter().flat_map(|body| &body.geoms).find(named).unwrap();
        let axes = DMat3::from_quat(geom.turn);
        let far = (0..3).map(|k| axes.col(k).distance(vector(&said["axes"][k]))).fold(0.0, f64::max);
        most = most.max(geom.at.distance(vector(&said["at"]))).max(far);
    }
    most
}

/// Nested bodies and frames, all ways to say a rotation, classes, includes: everything is where MuJoCo has it. Of
/// models that differ in one word, the numbers are others.
#[test]
fn everything_is_where_mujoco_has_it() {
    let (frames, joints) = (truth("frames"), truth("joints"));
    assert!(off(&read(FRAMES), &frames) < EXACT, "{}", off(&read(FRAMES), &frames));
    assert!(off(&read(JOINTS), &joints) < EXACT, "{}", off(&read(JOINTS), &joints));
    for (text, truth, from, to) in [
        (FRAMES, &frames, "<mujoco model=\"frames\">", "<mujoco><compiler eulerseq=\"XYZ\"/>"),
        (FRAMES, &frames, "<mujoco model=\"frames\">", "<mujoco><compiler angle=\"radian\"/>"),
        (FRAMES, &frames, "axisangle=\"0 1 1 -50\"", "axisangle=\"0 1 1 50\""),
        (FRAMES, &frames, "fromto=\"0 0 0 0.1 0.2 0.5\"", "fromto=\"0.1 0.2 0.5 0 0 0\""),
        (JOINTS, &joints, "zYx", "zyx"),
        (JOINTS, &joints, "axis=\"0.2 1 0.1\"", "axis=\"0.2 1 0\""),
    ] {
        let twin = text.replace(from, to);
        assert_ne!(twin, text, "{from}");
        assert!(off(&read(&twin), truth) > 1e-3, "{from} to {to}");
    }
}

/// The six numbers of a body alone in its world: mass, centre of gravity, and moments of inertia in order. They are
/// found by what energy motions have.
pub(crate) fn weighed(config: &Config, body: usize) -> (f64, DVec3, [f64; 3]) {
    let alone =
        Config { bodies: vec![config.bodies[body].clone()], joints: Vec::new(), fixed: Vec::new(), ..config.clone() };
    let world = Custom::new(&alone).unwrap().world().unwrap().unwrap();
    let Physical::Rigid(rigid) = world.world else { panic!() };
    let energy = |velocity: DVec3, spin: DVec3| {
        let start = Start { position: DVec3::ZERO, orientation: DQuat::IDENTITY, velocity, spin, time: 0.0 };
        rigid.energy(0, &rigid.state(&[start]).unwrap().bodies()[0])
    };
    let mass = 2.0 * energy(DVec3::X, DVec3::ZERO);
    let mut moments = [DVec3::X, DVec3::Y, DVec3::Z].map(|spin| 2.0 * energy(DVec3::ZERO, spin));
    moments.sort_by(f64::total_cmp);
    (mass, world.places[0], moments)
}

/// Each body of a scenario has the mass, the centre of gravity and the moments of inertia that MuJoCo computes, parts
/// without joints and their densities included.
#[test]
fn bodies_weigh_what_they_weigh_in_mujoco() {
    for (name, text) in [("frames", FRAMES), ("joints", JOINTS)] {
        let (_, config) = imported(text);
        let truth = truth(name);
        assert_eq!(config.bodies.len(), truth["moving"].as_object().unwrap().len());
        for (name, said) in list(&truth["moving"]) {
            let index = config.bodies.iter().position(|body| body.name == name).unwrap();
            let (mass, centre, moments) = weighed(&config, index);
            let right = said["mass"].as_f64().unwrap();
            assert!((mass / right - 1.0).abs() < ROUNDED, "{name}: {mass} {right}");
            assert!(centre.distance(vector(&said["centre"])) < ROUNDED, "{name}: {centre} {}", said["centre"]);
            // An ellipsoid is a polyhedron of its volume. For a ball, a sum over its 80 faces gives 0.080 % more
            // inertia; for what is stretched from it, it is the same share.
            let allowed = if name == "egg" { 1e-3 } else { ROUNDED };
            for (k, moment) in moments.into_iter().enumerate() {
                let right = said["moments"][k].as_f64().unwrap();
                assert!((moment / right - 1.0).abs() < allowed, "{name}: {moments:?} {}", said["moments"]);
            }
        }
    }
}

/// The corners of all boxes and meshes are drawn where MuJoCo has them.
#[test]
fn corners_are_where_mujoco_has_them() {
    for (name, text) in [("frames", FRAMES), ("joints", JOINTS)] {
        let (_, config) = imported(text);
        let scene = Custom::new(&config).unwrap();
        // Where the file has them.
        let middles = scene.world().unwrap().unwrap().places;
        let mut corners: Vec<DVec3> = Vec::new();
        let animation = scene.animate(&scene.start(&mut Seed(1).chain(0).at(0, Purpose::START))).unwrap();
        for (track, middle) in animation.motion.tracks.iter().zip(middles) {
            let turn = track.orientation(0.0);
            let place = |corner: DVec3| {
                let there = turn * corner;
                middle + DVec3::new(there.x, -there.z, there.y)
            };
            match &*track.shape {
                Drawn::Solid { vertices, .. } => corners.extend(vertices.iter().map(|&corner| place(corner))),
                Drawn::Cuboid { half, .. } => corners.extend(eight(*half).map(place)),
                _ => {}
            }
        }
        for prop in &animation.scenery {
            match &prop.form {
                Form::Mesh { vertices, .. } => corners.extend(vertices.iter().map(|v| DVec3::new(v.x, -v.z, v.y))),
                Form::Block { centre, half, orientation } => corners.extend(eight(*half).map(|corner| {
                    let there = *centre + *orientation * corner;
                    DVec3::new(there.x, -there.z, there.y)
                })),
                _ => {}
            }
        }
        let model = read(text);
        let geoms = model.bodies.iter().flat_map(|body| &body.geoms);
        let boxes = geoms.filter_map(|geom| match geom.solid {
            Solid::Box(half) => Some((geom, half)),
            _ => None,
        });
        let of_boxes: Vec<DVec3> =
            boxes.flat_map(|(geom, half)| eight(half).map(|k| geom.at + geom.turn * k)).collect();
        let of_meshes = list(&truth(name)["geoms"])
            .flat_map(|(_, said)| said["corners"].as_array().cloned().unwrap_or_default())
            .map(|corner| vector(&corner))
            .collect::<Vec<_>>();
        assert!(of_boxes.len() >= 16 && of_meshes.len() >= 5);
        for corner in of_boxes.iter().chain(&of_meshes) {
            let near = corners.iter().map(|other| other.distance(*corner)).fold(f64::INFINITY, f64::min);
            // One corner of the mesh that the model itself gives is inside of the others.
            let inside = name == "frames" && corner.distance(DVec3::new(-0.944_894, -1.457_596, 3.011_473)) < 1e-5;
            assert!(near < ROUNDED || inside, "{name}: {corner} {near}");
        }
    }
}

fn eight(half: DVec3) -> [DVec3; 8] {
    let sign = |k: usize, axis: usize| if k >> axis & 1 == 1 { 1.0 } else { -1.0 };
    std::array::from_fn(|k| half * DVec3::new(sign(k, 0), sign(k, 1), sign(k, 2)))
}

/// Joints: hinges with limits from where they start, ball joints, and what each holds to what. What joints hold to
/// something free sways with it.
#[test]
fn joints_are_taken_over() {
    let (made, config) = imported(JOINTS);
    let joints: Vec<[&str; 3]> =
        config.joints.iter().map(|one| [&one.name, &one.body, &one.to].map(String::as_str)).collect();
    assert_eq!(
        joints,
        [["shoulder", "upper", "base"], ["elbow", "lower", "upper"], ["hinges", "door", ""], ["cord", "bell", "door"],]
    );
    // From −0.2 to 1.9 rad, of which it has 0.5 at the start.
    let degrees = [-0.7_f64, 1.4].map(|end| (end.to_degrees() * 1e6).round() / 1e6);
    for line in [
        &format!("limits_deg = [{}, {}] }} }}", degrees[0], degrees[1])[..],
        "friction_n_m = 0.02",
        "kind = { ball = {} }",
        "gravity = 3.7",
        "name = \"start_of_base_x\"\nvalue = { normal = [0, 5] }",
        "at_mm = [\"start_of_base_x + 257.178224\", \"start_of_base_y + 3322.694748\", 2047.195985]",
    ] {
        assert!(made.text.contains(line), "{line}\n{}", made.text);
    }
    assert_eq!(made.left_out, ["lower: the friction of each shape: all have the largest, 0.9"]);
}

/// Two materials have the larger of their coefficients of friction, as in MuJoCo, and nothing bounces.
#[test]
fn contact_is_as_in_mujoco() {
    let (made, _) = imported(&bodies(
        "<geom type='plane' size='1 1 1' friction='0.3'/><body pos='0 0 1'><freejoint/><geom size='0.1' \
         friction='0.8'/></body><body pos='0 0 2' gravcomp='0.75'><freejoint/><geom size='0.1' condim='1'/></body>",
    ));
    for line in [
        "friction = 0.3\nrestitution = 0\n",
        "friction = 0\nrestitution = 0\n",
        "gravity_scale = 0.25",
        "gravity = 9.81",
    ] {
        assert!(made.text.contains(line), "{line}\n{}", made.text);
    }
    let flags = "<flag gravity='disable' energy='enable' contact='disable'/>";
    let body = bodies("<body><freejoint/><geom size='0.1'/></body>");
    let options = format!("<mujoco><option gravity='0 0 -3'>{flags}</option>");
    let (weightless, _) = imported(&body.replace("<mujoco>", &options));
    assert!(weightless.text.contains("gravity = 0\n"), "{}", weightless.text);
    assert_eq!(weightless.left_out, ["contact of <flag> (line 1)"]);
    let pairs: Vec<&str> = made.text.split("[[world.custom.pairs]]").skip(1).collect();
    let frictions = pairs.iter().map(|pair| pair.split("friction = ").nth(1).unwrap().lines().next().unwrap());
    assert_eq!(frictions.collect::<Vec<_>>(), ["0.8", "0.3", "0.8"]);
}

/// How a body moves: by one joint, by several that are nearly one, not at all.
#[test]
fn several_joints_become_the_nearest_one() {
    let hinge = |axis: &str, at: &str| format!("<joint axis='{axis}' pos='{at}'/>");
    let slide = |axis: &str| format!("<joint type='slide' axis='{axis}'/>");
    let three = |one: &dyn Fn(&str) -> String| ["1 0 0", "0 1 0", "0 0 1"].map(one).concat();
    let at_once = |axis: &str| hinge(axis, "0 0 0.2");
    for (joints, kind, left_out) in [
        (three(&at_once), Some("ball = {}"), "thing: the axes, limits and friction of its 3 hinges"),
        (hinge("1 0 0", "0 0 0") + &hinge("1 0 0", "0 0 1"), Some("hinge = { axis = [1, 0, 0] }"), "1 of its 2 hinges"),
        (slide("1 0 0") + &at_once("0 1 0"), Some("hinge = { axis = [0, 1, 0] }"), "what slides: its 1 slide joint"),
        ("<joint range='0 0'/>".into(), Some("weld = {}"), ""),
        ("<joint range='-180 180'/>".into(), Some("hinge = { axis = [0, 0, 1] }"), "it turns freely"),
        ("<joint range='10 20'/>".into(), Some("limits_deg = [0, 20]"), "it starts beyond them"),
        (three(&slide) + "<joint type='ball'/>", None, "its 4 joints: it is free"),
    ] {
        let (made, config) = imported(&bodies(&format!("<body name='thing'>{joints}<geom size='0.1'/></body>")));
        assert_eq!(config.bodies.len(), 1, "{joints}");
        assert_eq!(config.joints.len(), usize::from(kind.is_some()), "{joints}");
        assert!(kind.is_none_or(|kind| made.text.contains(kind)), "{kind:?} {}", made.text);
        assert!(made.left_out.iter().any(|line| line.contains(left_out)) || left_out.is_empty(), "{:?}", made.left_out);
    }
    let (made, config) = imported(&bodies(&format!("<body name='lift'>{}<geom size='0.1'/></body>", slide("0 0 1"))));
    assert_eq!((config.bodies[0].name.as_str(), config.joints.len(), made.left_out.len()), ("lift", 1, 0));
    assert!(made.text.contains("kind = { slider = { axis = [0, 0, 1] } }"), "{}", made.text);
}

/// Everything that is not taken over is named, with its line where it is said.
#[test]
fn what_is_left_out_is_listed() {
    let (made, config) = imported(include_str!("models/left_out.xml"));
    for what in [
        "timestep of <option> (line 2)",
        "solref of <geom> (line 3)",
        "<hfield> (line 5)",
        "<texture> (line 6)",
        "contype of <geom> (line 14)",
        "<site> (line 18)",
        "<camera> (line 19)",
        "<composite> (line 20)",
        "<motor> in <actuator> (lines 34, 35)",
        "<weld> in <equality> (line 38)",
        "gravity 1 0 -9: only the part that points down is used",
        "world: its shape, hfield",
        "mesh \"far\": far.msh is not an OBJ or STL file",
        "cart: its mesh",
        "cart: its plane: what moves cannot have one",
        "shapes that touch nothing, but for their mass, of cart",
        "puppet: mocap: it stands still",
        "ghost: that it has no shape: a ball of 1000 mm of its mass",
        "nothing: its joints: it has neither a shape nor a mass",
    ] {
        assert!(made.text.contains(what), "{what}: {}", made.text);
    }
    assert_eq!((made.left_out.len(), made.harmless.len()), (16, 4), "{:#?} {:#?}", made.left_out, made.harmless);
    assert_eq!((&*config.bodies[0].name, &*config.bodies[1].name, config.bodies.len()), ("cart", "ghost", 2));
    assert!((weighed(&config, 0).0 - 2.0).abs() < 1e-6, "its mass is given");
}

/// Scenery inside of which a joint holds a body is left out. Bodies that joints hold inside each other are an error.
#[test]
fn what_begins_inside_each_other_is_parted() {
    let post = "<geom name='post' type='box' size='0.05 0.05 0.5' pos='0 0 0.5'/>";
    let rod = |name: &str, to: &str, inside: &str| {
        format!(
            "<body name='{name}' pos='0 0 1'><joint axis='0 1 0'/><geom type='capsule' fromto='0 0 0 {to}' size='0.03'/>{inside}</body>"
        )
    };
    let (made, config) = imported(&bodies(&(post.to_owned() + &rod("rod", "0.5 0 0", ""))));
    assert_eq!((config.fixed.len(), config.bodies.len()), (0, 1));
    assert!(made.left_out[0].contains("post: a joint holds it and rod inside each other"), "{:?}", made.left_out);
    let two = rod("rod", "0.5 0 0", "") + &rod("other", "0.5 0.01 0", "");
    assert!(refused(&bodies(&two)).contains("begins inside"), "{}", refused(&bodies(&two)));
    // What is free is moved, with all that joints hold to it.
    let free = "<body name='cart' pos='0.2 0 1'><freejoint/><geom size='0.1'/><body name='arm' pos='0 0 0.2'>\
                <joint axis='0 1 0'/><geom size='0.05'/></body></body>";
    let (made, config) = imported(&bodies(&(rod("rod", "0.5 0 0", "") + free)));
    let height = |body: usize| format!("{:?}", config.bodies[body].at_mm[2]);
    assert!(made.text.matches("# moved by ").count() == 2, "{} {} {}", height(1), height(2), made.text);
    let joint = config.joints.iter().find(|joint| joint.body == "arm").unwrap();
    assert_eq!(joint.at_mm[2], config.bodies[2].at_mm[2]);
}

/// A pile that sinks into the floor and into itself, as soft contact leaves it, is moved by what it overlaps, and no
/// more; also where things touch at their sides, so that most draws with places of their own would have one inside
/// another.
#[test]
fn a_pile_is_moved_by_its_overlaps() {
    let cube = |name: &str, at: [f64; 3]| {
        let [x, y, z] = at;
        format!("<body name='{name}' pos='{x} {y} {z}'><freejoint/><geom type='box' size='0.03 0.03 0.03'/></body>")
    };
    let floor = "<geom type='plane' size='1 1 .1'/>";
    let stack = cube("a", [0.0, 0.0, 0.0299]) + &cube("b", [0.0, 0.0, 0.0899]);
    let (made, config) = imported(&bodies(&(floor.to_owned() + &stack)));
    for (body, height) in [30.0, 90.0].into_iter().enumerate() {
        assert_eq!(format!("{:?}", config.bodies[body].at_mm[2]), format!("Fixed({height:?})"), "{}", made.text);
    }
    assert_eq!(made.notes, ["a, b: moved by up to 0.1 mm, out of what they began inside of"]);
    // A block of 27 cubes, each 0.1 mm inside those beside it.
    let at = |k: usize| 0.0599 * k as f64;
    let block: String =
        (0..27).map(|k| cube(&format!("c{k}"), [at(k % 3), at(k / 3 % 3), 0.0299 + at(k / 9)])).collect();
    let (made, config) = imported(&bodies(&(floor.to_owned() + &block)));
    assert_eq!(config.bodies.len(), 27);
    assert!(made.notes[0].contains("and 23 more: moved by up to 0."), "{:?}", made.notes);
    assert!(made.notes[1].contains("share what is uncertain"), "{:?}", made.notes);
}

/// Models that are wrong are refused, with the line and the column at fault.
#[test]
fn wrong_models_are_refused() {
    let deep = "<body>".repeat(300) + &"</body>".repeat(300);
    for (model, words) in [
        ("<mujoco>\n<worldbody>\n</mujoco>".to_owned(), &["line 3", "not valid XML"][..]),
        ("<sdf/>".into(), &["line 1, column 1", "its root is <sdf>"]),
        ("".into(), &["not valid XML"]),
        ("<!DOCTYPE a [<!ENTITY b 'c'>]><mujoco/>".into(), &["not valid XML"]),
        (bodies("\n<geom size='a'/>"), &["line 2, column 1", "size of <geom>", "are not finite numbers"]),
        (bodies("<geom size='nan'/>"), &["not finite"]),
        (bodies("<geom/>"), &["a sphere needs 1 positive numbers"]),
        (bodies("<geom type='box' size='1 1 0'/>"), &["a box needs 3 positive numbers"]),
        (bodies("<geom type='ball' size='1'/>"), &["\"ball\" is unknown: known are plane, hfield, sphere"]),
        (bodies("<geom type='capsule' size='1' fromto='1 2 3 1 2 3'/>"), &["the same place"]),
        (bodies("<geom size='1' class='none'/>"), &["there is no class \"none\""]),
        (bodies("<geom type='mesh' mesh='none'/>"), &["there is no mesh \"none\""]),
        (bodies("<body quat='0 0 0 0'/>"), &["quat of <body>", "no direction"]),
        (bodies("<body quat='1 0 0 0' euler='1 2 3'/>"), &["euler of <body>: quat says already"]),
        (bodies("<body pos='1 2'/>"), &["3 numbers are needed, not 2"]),
        (bodies("<joint/>"), &["the world cannot have a joint"]),
        (bodies("<body><body><freejoint/></body></body>"), &["only a body that belongs to the world can be free"]),
        (bodies("<body><joint range='2 1'/></body>"), &["range of <joint>", "must not be larger"]),
        (bodies("<body><joint axis='0 0 0'/></body>"), &["axis of <joint>", "no direction"]),
        (bodies(&deep), &["more than 200 elements within each other"]),
        ("<mujoco><compiler eulerseq='xy'/></mujoco>".into(), &["eulerseq", "three letters of xyzXYZ"]),
        ("<mujoco><compiler coordinate='global'/></mujoco>".into(), &["save the model with local ones"]),
        ("<mujoco><include file='none.xml'/></mujoco>".into(), &["line 1, column 9: none.xml: "]),
        ("<mujoco>\n<include file='../a.xml'/></mujoco>".into(), &["line 2", "outside the scenario's folder"]),
        ("<mujoco><include file='arm.xml'/><include file='arm.xml'/></mujoco>".into(), &["a second time"]),
        (
            "<mujoco><asset><mesh name='a' file='a.stl'/></asset><worldbody><geom type='mesh' mesh='a'/></worldbody></mujoco>"
                .into(),
            &["a.stl: "],
        ),
    ] {
        let error = refused(&model);
        assert!(words.iter().all(|word| error.contains(word)), "{words:?}: {error}");
    }
    let mut both = files("<mujoco><include file='sub.xml'/></mujoco>");
    let included = b"<mujocoinclude>\n<worldbody>\n <geom size='x'/></worldbody></mujocoinclude>";
    both.insert("sub.xml", included.as_slice());
    let error = import::scenario("model.xml", false, None, &both);
    assert!(error.unwrap_err().to_string().contains("sub.xml, line 3, column 2: size of <geom>"));
}

/// A model with bytes that were changed, left out or doubled is read or refused: nothing else happens.
#[test]
fn damaged_models_are_read_or_refused() {
    let arm = include_bytes!("models/arm.xml");
    let mut state = 1_u64;
    let mut next = |below: usize| {
        // Knuth's linear congruential generator (MMIX).
        state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (state >> 33) as usize % below
    };
    let mut refused = 0;
    for nth in 0..4000 {
        let mut bytes = if nth % 2 == 0 { FRAMES } else { JOINTS }.as_bytes().to_vec();
        for _ in 0..=next(3) {
            let (at, more) = (next(bytes.len() - 40), next(40));
            match next(3) {
                0 => bytes[at] = b"<>/\"'=0-9ae \n\xff"[next(14)],
                1 => drop(bytes.drain(at..at + more)),
                _ => bytes.extend_from_within(at..at + more),
            }
        }
        refused += usize::from(plaus_asset::read_model(&bytes, &mut |_| Ok(arm.to_vec())).is_err());
    }
    assert!((400..4000).contains(&refused), "{refused}");
}
