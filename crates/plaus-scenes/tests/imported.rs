//! Scenarios made from files: what each node of a GLB becomes, what is listed as left out, and that each scenario is
//! valid.

use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::Target;
use plaus_scenes::animation::Shape as Seen;
use plaus_scenes::custom::{Shape, Still};
use plaus_scenes::{Assets, Scenario, Scene, World, custom, import};
use serde_json::{Value, json};

/// A GLB with these nodes; mesh 0 is a wedge of 1 × 2 × 3 m, accessor 2 holds the times 0.5 and 1.5 s, accessor 3 the
/// places (0, 0, 0) and (0, 0, 4), accessor 4 the rotations by 0 and by 60° about the file's y axis, and accessor 5
/// those places with their tangents, of which only that before the last place, (0, 0, 12), is not 0.
pub(crate) fn glb(nodes: &Value, more: &Value) -> Vec<u8> {
    let corners = [[0.0_f32, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
    let faces = [[0_u32, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];
    let mut bin: Vec<u8> = corners.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    bin.extend(faces.iter().flatten().flat_map(|k| k.to_le_bytes()));
    bin.extend([0.5_f32, 1.5, 0.0, 0.0, 0.0, 0.0, 0.0, 4.0].iter().flat_map(|x| x.to_le_bytes()));
    bin.extend([0.0_f32, 0.0, 0.0, 1.0, 0.0, 0.5, 0.0, 0.75_f32.sqrt()].iter().flat_map(|x| x.to_le_bytes()));
    let cubic = [[0.0_f32; 3], [0.0; 3], [0.0; 3], [0.0, 0.0, 12.0], [0.0, 0.0, 4.0], [0.0; 3]];
    bin.extend(cubic.iter().flatten().flat_map(|x| x.to_le_bytes()));
    let view = |offset: usize, length: usize| json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
    let mut file = json!({
        "asset": { "version": "2.0" }, "scene": 0, "nodes": nodes,
        "scenes": [{ "nodes": (0..nodes.as_array().unwrap().len()).collect::<Vec<_>>() }],
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1 }] }],
        "buffers": [{ "byteLength": bin.len() }],
        "bufferViews": [view(0, 48), view(48, 48), view(96, 8), view(104, 24), view(128, 32), view(160, 72)],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 2, 3] },
            { "bufferView": 1, "componentType": 5125, "count": 12, "type": "SCALAR" },
            { "bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0.5], "max": [1.5] },
            { "bufferView": 3, "componentType": 5126, "count": 2, "type": "VEC3" },
            { "bufferView": 4, "componentType": 5126, "count": 2, "type": "VEC4" },
            { "bufferView": 5, "componentType": 5126, "count": 6, "type": "VEC3" },
        ],
    });
    more.as_object().unwrap().iter().for_each(|(key, value)| file[key] = value.clone());
    let mut text = serde_json::to_vec(&file).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    let number = |n: usize| (n as u32).to_le_bytes();
    let head = [number(2), number(28 + text.len() + bin.len()), number(text.len())];
    [&b"glTF"[..], head.as_flattened(), b"JSON", &text, &number(bin.len()), b"BIN\0", &bin].concat()
}

/// The result of importing a file, and its configuration.
pub(crate) fn imported(bytes: &[u8]) -> (import::Imported, custom::Config) {
    let mut files = Assets::default();
    files.insert("a.glb", bytes);
    let made = import::scenario("a.glb", false, None, &files).unwrap_or_else(|error| panic!("{error}"));
    let config = read(&made, &files);
    (made, config)
}

/// The configuration of what was imported.
fn read(made: &import::Imported, files: &Assets) -> custom::Config {
    let scenario = Scenario::read_with("a.toml", &made.text, &[], files).unwrap_or_else(|error| panic!("{error}"));
    let World::Custom(config) = scenario.world else { panic!() };
    *config
}

pub(crate) fn is_left_out(made: &import::Imported, what: &str) {
    let mut all = made.left_out.iter().chain(&made.harmless);
    assert!(all.any(|line| line.contains(what)), "{what}: {:?} {:?}", made.left_out, made.harmless);
    assert!(made.text.contains(what), "{what}");
}

/// Extras and keys decide what a node is: it stands still, moves with its children, follows its keys, or is left out.
#[test]
fn nodes_are_what_they_say() {
    let nodes = json!([
        { "name": "hill", "mesh": 0, "camera": 0 },
        { "name": "a b", "mesh": 0, "translation": [5, 1, 0], "extras": { "plaus": "body", "weight": 3 } },
        { "name": "gate", "mesh": 0, "translation": [20, 0, 0] },
        { "name": "cloud", "mesh": 0, "extras": { "plaus": "ignore" } },
        { "name": "cart", "extras": { "plaus": "body" }, "translation": [-5, 1, 0], "children": [5, 6] },
        { "name": "box", "mesh": 0 },
        { "name": "knob", "mesh": 0, "translation": [2, 0, 0] },
        { "name": "odd", "mesh": 0, "translation": [0, 0, 50], "extras": { "plaus": "boddy" } },
    ]);
    let more = json!({
        "scenes": [{ "nodes": [0, 1, 2, 3, 4, 7] }],
        "cameras": [{ "type": "perspective", "perspective": { "yfov": 1.0, "znear": 0.1 } }],
        "animations": [{ "samplers": [{ "input": 2, "output": 3 }],
                         "channels": [{ "sampler": 0, "target": { "node": 2, "path": "translation" } }] }],
    });
    let (made, config) = imported(&glb(&nodes, &more));
    let fixed: Vec<&str> = config.fixed.iter().map(|fixed| fixed.name.as_str()).collect();
    assert_eq!(fixed, ["hill", "odd"]);
    assert!(matches!(config.fixed[0].shape, Still::Mesh(_)));
    let bodies: Vec<&str> = config.bodies.iter().map(|body| body.name.as_str()).collect();
    assert_eq!(bodies, ["a_b", "cart"]);
    assert!(matches!(config.bodies[0].shape, Shape::HullOf(_)));
    let Shape::Compound(cart) = &config.bodies[1].shape else { panic!() };
    assert_eq!((cart.pieces.len(), cart.pieces[1].at_mm[0].clone()), (2, 2000.0.into()));
    // y is up in the file.
    assert_eq!(config.bodies[0].at_mm[2], 1000.0.into());
    let [gate] = &config.driven[..] else { panic!() };
    assert_eq!((gate.name.as_str(), gate.keys.len()), ("gate", 2));
    assert_eq!((gate.keys[1].at_s.clone(), gate.keys[1].at_mm[1].clone()), (1.5.into(), (-4000.0).into()));
    for what in ["hill: its camera", "weight of its extras", "\"boddy\" is unknown"] {
        is_left_out(&made, what);
    }
}

/// A door whose mesh begins at its hinge turns about it, between its keys too; what is carried by a cart that moves
/// goes
/// with the cart; and what the file moves on splines goes as their tangents say. All to 0.1 mm.
#[test]
fn animated_nodes_move_as_the_file_says() {
    let nodes = json!([
        { "name": "door", "mesh": 0, "scale": [0.1, 0.1, 0.1] },
        { "name": "cart", "mesh": 0, "translation": [20, 0, 0], "children": [2] },
        { "name": "arm", "mesh": 0, "translation": [0, 5, 0], "scale": [0.1, 0.1, 0.1] },
        { "name": "sledge", "mesh": 0, "translation": [0, 0, 50], "scale": [0.1, 0.1, 0.1] },
    ]);
    let channel = |sampler: usize, node: usize, path: &str| json!({ "sampler": sampler, "target": { "node": node, "path": path } });
    let more = json!({
        "scenes": [{ "nodes": [0, 1, 3] }],
        "animations": [{
            "samplers": [{ "input": 2, "output": 4 }, { "input": 2, "output": 5, "interpolation": "CUBICSPLINE" }],
            "channels": [
                channel(0, 0, "rotation"), channel(0, 1, "rotation"), channel(0, 2, "rotation"),
                channel(1, 3, "translation"),
            ],
        }],
    });
    let (made, config) = imported(&glb(&nodes, &more));
    assert!(made.left_out.is_empty(), "{:?}", made.left_out);
    let scene = custom::Custom::new(&config).unwrap();
    let film = scene.animate(&scene.start(&mut Seed(1).chain(0).at(0, Purpose::START))).unwrap();
    let track = |name: &str| film.motion.tracks.iter().find(|track| track.name == name).unwrap();
    let angle = |time: f64| 60_f64.to_radians() * (time - 0.5);
    for time in [0.5, 0.625, 0.8, 1.0, 1.33, 1.5] {
        // In the file and in animations y is up.
        let turn = DQuat::from_rotation_y(angle(time));
        let tip = |name: &str, corner: DVec3| {
            let track = track(name);
            let Seen::Solid { vertices, .. } = &*track.shape else { panic!("{:?}", track.shape) };
            let first = track.orientation(0.0).inverse() * (corner - track.position(0.0));
            let near = vertices.iter().map(|&v| (v - first).length()).fold(f64::INFINITY, f64::min);
            assert!(near < 1e-6, "{name} has a corner at {corner}");
            track.position(time) + track.orientation(time) * first
        };
        let off = (tip("door", DVec3::X * 0.1) - turn * DVec3::X * 0.1).length();
        assert!(off < 1e-4, "the door at {time}: {off}");
        let arm = DVec3::new(20.0, 0.0, 0.0) + turn * (DVec3::Y * 5.0 + turn * (DVec3::X * 0.1));
        let off = (tip("arm", DVec3::new(20.1, 5.0, 0.0)) - arm).length();
        assert!(off < 1e-4, "the arm at {time}: {off}");
        // The cubic from 0 with a slope of 0 to 4 with a slope of 12, in one second.
        let s = time - 0.5;
        let z = 12.0 * (s * s * s - s * s) + 4.0 * (3.0 * s * s - 2.0 * s * s * s);
        let off = (tip("sledge", DVec3::X * 0.1) - DVec3::new(0.1, 0.0, z)).length();
        assert!(off < 1e-4, "the sledge at {time}: {off}");
    }
}

/// Nodes of one name all keep their shapes, as things of their own or as pieces of one.
#[test]
fn nodes_of_one_name_keep_their_shapes() {
    let leg = |x: f64| json!({ "name": "leg", "mesh": 0, "translation": [x, 0, 0] });
    let nodes = json!([
        leg(-20.0), leg(-10.0), { "name": "table", "extras": { "plaus": "body" }, "children": [3, 4] }, leg(0.0), leg(10.0)
    ]);
    let (made, config) = imported(&glb(&nodes, &json!({ "scenes": [{ "nodes": [0, 1, 2] }] })));
    let places: Vec<_> = config.fixed.iter().map(|fixed| (fixed.name.as_str(), fixed.at_mm[0].clone())).collect();
    assert_eq!(places, [("leg", (-20e3).into()), ("leg_2", (-10e3).into())]);
    let Shape::Compound(table) = &config.bodies[0].shape else { panic!() };
    assert_eq!((table.pieces.len(), table.pieces[1].at_mm[0].clone()), (2, 10e3.into()));
    assert!(made.left_out.is_empty(), "{:?}", made.left_out);
}

/// From the extension for physics, in both of its spellings: one world.
#[test]
fn both_spellings_of_the_physics_extension_are_one_world() {
    let world = |shapes: &str, collider: &dyn Fn(Value) -> Value| {
        let ball = json!({ "motion": { "mass": 2.0, "linearVelocity": [1, 2, 0], "gravityFactor": 0.5 },
                           "collider": collider(json!({ "shape": 0 })) });
        let nodes = json!([
            { "name": "ground", "mesh": 0, "extensions": { "KHR_physics_rigid_bodies": { "collider": {} } } },
            { "name": "ball", "translation": [9, 5, 0], "extensions": { "KHR_physics_rigid_bodies": ball } },
            { "name": "seen", "mesh": 0 },
        ]);
        let named = json!({
            shapes: { "shapes": [{ "type": "sphere", "sphere": { "radius": 0.5 } }] },
            "KHR_physics_rigid_bodies": { "physicsMaterials": [{ "dynamicFriction": 0.25, "restitution": 0.75 }] },
        });
        let (made, config) = imported(&glb(
            &nodes,
            &json!({ "extensionsUsed": ["KHR_physics_rigid_bodies", shapes], "extensions": named }),
        ));
        assert!(made.text.contains("gravity_scale = 0.5\n"), "{}", made.text);
        is_left_out(&made, "seen: it has a mesh but no collider");
        made.text + &format!("{:?}", config.bodies.len())
    };
    let material = |mut collider: Value| {
        collider["physicsMaterial"] = 0.into();
        collider
    };
    let new = world("KHR_implicit_shapes", &|shape| material(json!({ "geometry": shape })));
    let old = world("KHR_collision_shapes", &|shape| material(shape));
    assert_eq!(new, old);
    // 2 kg in a ball of radius half a metre. z is up here, so the file's (1, 2, 0) is (1, 0, 2).
    let density = 2.0 / (4.0 / 3.0 * std::f64::consts::PI * 0.125);
    for line in [
        "shape = { ball = { radius_mm = 500 } }",
        "velocity_m_s = [1, 0, 2]",
        "friction = 0.25\nstatic_friction = 0.6\nrestitution = 0.75",
        &format!("density = {}", (density * 1e6).round() / 1e6),
    ] {
        assert!(new.contains(line), "{line}\n{new}");
    }
}

/// A file in which nothing moves gets a ball that falls on its contents.
#[test]
fn a_file_in_which_nothing_moves_gets_a_ball() {
    let (made, config) = imported(&glb(&json!([{ "name": "hill", "mesh": 0 }]), &json!({})));
    assert!(made.text.contains("Nothing in the file moves") && config.bodies[0].name == "ball", "{}", made.text);
}

/// Bodies that begin inside each other are moved apart, sideways each by half; one of them no farther down than to the
/// floor.
#[test]
fn bodies_that_begin_inside_another_are_moved_apart() {
    let body =
        |name: &str, at: [f64; 3]| json!({ "name": name, "mesh": 0, "translation": at, "extras": { "plaus": "body" } });
    let (made, _) = imported(&glb(&json!([body("one", [0.0; 3]), body("other", [0.1, 0.1, 0.0])]), &json!({})));
    let by = |line: &str| -> Option<Vec<f64>> {
        let numbers = line.split("# moved by [").nth(1)?.split(']').next()?;
        Some(numbers.split(", ").map(|mm| mm.parse().unwrap()).collect())
    };
    let moved: Vec<Vec<f64>> = made.text.lines().filter_map(by).collect();
    assert!(moved.len() == 2 && moved[0][2] >= -100.0, "{}", made.text);
    // Shifts are written to a ten-thousandth of a millimetre.
    assert!((0..2).all(|axis| (moved[0][axis] + moved[1][axis]).abs() < 1e-3), "{moved:?}");
    assert!(made.notes.iter().any(|note| note.starts_with("one, other: moved by up to")), "{:?}", made.notes);
}

/// An OBJ has no unit: what is less than 10 units across is read in metres, other files in millimetres, unless the
/// unit is given; the size and the other unit are said, in the scenario too.
#[test]
fn a_file_without_a_unit_is_read_in_the_likelier_one() {
    let of = |edge: f64, unit_mm: Option<f64>| {
        let obj = format!("v 0 0 0\nv {edge} 0 0\nv 0 {edge} 0\nv 0 0 {edge}\nf 1 3 2\nf 1 2 4\nf 1 4 3\nf 2 3 4\n");
        let mut files = Assets::default();
        files.insert("crate.obj", obj.as_bytes());
        let made = import::scenario("crate.obj", false, unit_mm, &files).unwrap_or_else(|error| panic!("{error}"));
        let config = read(&made, &files);
        let Shape::HullOf(hull) = &config.bodies[0].shape else { panic!() };
        (hull.0.unit_mm.clone(), config.fixed[0].at_mm[2].clone(), made)
    };
    for (edge, given, unit, said) in [
        (1.0, None, 1000.0, Some("crate.obj is 1000 × 1000 × 1000 mm: it has no unit, so 1 is read as a metre")),
        (9.9, None, 1000.0, Some("9900 × 9900 × 9900 mm")),
        (10.0, None, 1.0, Some("10 × 10 × 10 mm: it has no unit, so 1 is read as a millimetre")),
        (1.0, Some(1.0), 1.0, None),
        (300.0, Some(1000.0), 1000.0, None),
    ] {
        let (found, floor, made) = of(edge, given);
        assert_eq!(found, Some(unit.into()), "{edge} {given:?}");
        assert_eq!(floor, (-100.0).into(), "{edge} {given:?}");
        match said {
            Some(said) => assert!(made.notes[0].contains(said) && made.text.contains(said), "{:?}", made.notes),
            None => assert!(made.notes.is_empty(), "{:?}", made.notes),
        }
    }
    let mut files = Assets::default();
    files.insert("a.glb", glb(&json!([{ "name": "hill", "mesh": 0 }]), &json!({})));
    for unit in [1.0, -1.0, f64::NAN] {
        assert!(import::scenario("a.glb", false, Some(unit), &files).is_err(), "a GLB is in metres, not {unit}");
    }
}

/// The label that Plaus writes into a GLB says where a motion comes from, not what a node is; what has no size is left
/// out in one line; what another program writes there is still told.
#[test]
fn the_label_of_an_exported_motion_is_no_instruction() {
    let label = |key: &str| json!({ "plaus": "0.1.0", "scene": "dice", key: "00", "seed": 1 });
    let nodes = |key: &str| {
        json!([
            { "name": "dice", "extras": label(key), "children": [1, 2] },
            { "name": "table", "mesh": 0 },
            { "name": "surface", "mesh": 0, "scale": [0, 0, 0] },
        ])
    };
    let made = |key: &str| imported(&glb(&nodes(key), &json!({ "scenes": [{ "nodes": [0] }] }))).0;
    assert_eq!(made("scenario_hash").left_out, ["surface: its shape, as its scale is 0"]);
    assert!(made("scenario_hash").harmless.is_empty());
    assert_eq!((made("other").left_out.len(), made("other").harmless.len()), (2, 3));
}

/// Names that had to change are told; places and angles have no digits that single precision does not have.
#[test]
fn changed_names_are_told_and_places_are_short() {
    let (sin, cos) = plaus_dist::math::sin_cos(15_f64.to_radians());
    let turned = [0.0, sin, 0.0, cos];
    let nodes = json!([
        { "name": "Cube.001", "mesh": 0, "translation": [1.12, 0.050000001, -3.3], "rotation": turned },
        { "name": "Cube.002", "mesh": 0, "translation": [0.1, 0.7, 3.000123] },
        { "name": "cart", "extras": { "plaus": "body" }, "translation": [5.12, 7.7, 0], "children": [3] },
        { "name": "knob", "mesh": 0, "translation": [0.05, 0, 0] },
    ]);
    let (made, config) = imported(&glb(&nodes, &json!({ "scenes": [{ "nodes": [0, 1, 2] }] })));
    assert_eq!(made.notes.len(), 1, "{:?}", made.notes);
    assert!(made.notes[0].contains("Cube.001 is Cube_001, and 1 more") && made.text.contains(&made.notes[0]));
    let is = |at: [f64; 3]| at.map(custom::Amount::from);
    assert_eq!(config.fixed[0].at_mm, is([1120.0, 3300.0, 50.0]));
    assert_eq!(config.fixed[0].turn_deg, [0.0, 0.0, 30.0].map(custom::Amount::from));
    // What single precision has is kept.
    assert_eq!(config.fixed[1].at_mm, is([100.0, -3000.123, 700.0]));
    let Shape::Compound(cart) = &config.bodies[0].shape else { panic!("{}", made.text) };
    assert_eq!(cart.pieces[0].at_mm, is([50.0, 0.0, 0.0]));
}

/// Eight wedges in a row, 2 mm apart: if each place were uncertain by 5 mm, nearly all draws would have one inside
/// another; if by 1 mm, less than half of them.
#[test]
fn what_lies_close_together_is_less_uncertain() {
    let node = |k: u32, apart: f64| {
        let (name, place) = (format!("w{k}"), [f64::from(k) * apart, 0.0, 0.0]);
        json!({ "name": name, "mesh": 0, "translation": place, "extras": { "plaus": "body" } })
    };
    let row = |apart| imported(&glb(&(0..8).map(|k| node(k, apart)).collect(), &json!({}))).0;
    let close = row(1.002);
    let said = "places are uncertain by 1 mm only";
    assert!(close.text.contains(said) && close.notes.iter().any(|note| note.contains(said)), "{}", close.text);
    assert!(close.text.contains("{ normal = [1002, 1] }") && !close.text.contains("lifted"), "{}", close.text);
    let wide = row(1.05);
    assert!(wide.text.contains("{ normal = [1050, 5] }") && wide.notes.is_empty(), "{}", wide.text);
}

/// A block is a box, wherever its middle is; a room, whose faces point inwards, is not, nor is one without a ceiling.
#[test]
fn scenery_is_recognised_where_it_is_solid() {
    let corners: String = (0..8_u32).map(|k| format!("v {} {} {}\n", k & 1, 2 * (k >> 1 & 1), 3 * (k >> 2))).collect();
    let sides = [[1, 5, 7, 3], [2, 4, 8, 6], [1, 2, 6, 5], [3, 7, 8, 4], [1, 3, 4, 2], [5, 6, 8, 7]];
    let obj = |name: &str, sides: &[[u32; 4]], first: u32| {
        let face = |side: &[u32; 4]| format!("f {} \n", side.map(|k| (k + first).to_string()).join(" "));
        format!("o {name}\n{corners}{}", sides.iter().map(face).collect::<String>())
    };
    let inward = sides.map(|[a, b, c, d]| [a, d, c, b]);
    let text = obj("block", &sides, 0) + &obj("room", &inward, 8) + &obj("tub", &sides[..5], 16);
    let mut files = Assets::default();
    files.insert("a.obj", text.as_bytes());
    let config = read(&import::scenario("a.obj", false, Some(10.0), &files).unwrap(), &files);
    let shapes: Vec<_> = config.fixed.iter().map(|fixed| (fixed.name.as_str(), &fixed.shape)).collect();
    // An OBJ's y is up, and what was behind is in front.
    let [("block", Still::Box(block)), ("room", Still::Mesh(_)), ("tub", Still::Mesh(_))] = &shapes[..] else {
        panic!("{shapes:?}")
    };
    assert_eq!(block.size_mm, [10.0.into(), 30.0.into(), 20.0.into()]);
    assert_eq!(config.fixed[0].at_mm, [5.0.into(), (-15.0).into(), 10.0.into()]);
}
