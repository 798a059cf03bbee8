//! A scene without physics, as a modelling program writes it, becomes a world: `plaus new --from` with `--moving`.

use crate::common::Place;
use serde_json::{Value, json};
use std::f32::consts::TAU;

/// Corners and triangles, y up, in m.
type Mesh = (Vec<[f32; 3]>, Vec<[u32; 3]>);

/// What is turned about the y axis; points on the axis are one corner.
fn turned(profile: &[[f32; 2]], sides: u32) -> Mesh {
    let (mut corners, mut faces) = (Vec::new(), Vec::new());
    let mut ring = |&[radius, y]: &[f32; 2]| -> Vec<u32> {
        let count = if radius == 0.0 { 1 } else { sides };
        let angle = |k: u32| TAU * k as f32 / sides as f32;
        corners.extend((0..count).map(|k| [radius * angle(k).sin(), y, radius * angle(k).cos()]));
        (corners.len() as u32 - count..corners.len() as u32).collect()
    };
    let rings: Vec<Vec<u32>> = profile.iter().map(&mut ring).collect();
    for pair in rings.windows(2) {
        for k in 0..sides as usize {
            let of = |ring: &Vec<u32>, k: usize| ring[k % ring.len()];
            let [a, b, c, d] = [of(&pair[0], k), of(&pair[0], k + 1), of(&pair[1], k + 1), of(&pair[1], k)];
            faces.extend([[a, b, c], [a, c, d]].into_iter().filter(|[a, b, c]| a != b && b != c && c != a));
        }
    }
    (corners, faces)
}

fn ball(radius: f32) -> Mesh {
    let ring = |k: u32| {
        let angle = TAU / 2.0 * k as f32 / 16.0;
        [if k.is_multiple_of(16) { 0.0 } else { radius * angle.sin() }, -radius * angle.cos()]
    };
    turned(&(0..=16).map(ring).collect::<Vec<_>>(), 32)
}

fn can(radius: f32, height: f32) -> Mesh {
    turned(&[[0.0, -0.5 * height], [radius, -0.5 * height], [radius, 0.5 * height], [0.0, 0.5 * height]], 32)
}

/// A cup about the y axis, with a bottom and walls.
fn cup() -> Mesh {
    turned(&[[0.0, 0.0], [0.04, 0.0], [0.05, 0.1], [0.045, 0.1], [0.036, 0.006], [0.0, 0.006]], 24)
}

fn plate([x, y, z]: [f32; 3]) -> Mesh {
    let corners = (0..8_u32).map(|k| {
        let side = |bit: u32, size: f32| if k >> bit & 1 == 0 { -0.5 * size } else { 0.5 * size };
        [side(0, x), side(1, y), side(2, z)]
    });
    let sides = [[0, 4, 6, 2], [1, 3, 7, 5], [0, 1, 5, 4], [2, 6, 7, 3], [0, 2, 3, 1], [4, 5, 7, 6]];
    (corners.collect(), sides.into_iter().flat_map(|[a, b, c, d]| [[a, b, c], [a, c, d]]).collect())
}

/// Name, mesh, place, rotation and material.
type Object<'a> = (&'a str, Mesh, [f32; 3], [f32; 4], &'a str);

/// A file with these objects.
fn glb(objects: &[Object<'_>]) -> Vec<u8> {
    let (mut bin, mut views, mut accessors) = (Vec::<u8>::new(), Vec::new(), Vec::new());
    let mut view = |bytes: Vec<u8>, accessor: Value| {
        views.push(json!({ "buffer": 0, "byteOffset": bin.len(), "byteLength": bytes.len() }));
        bin.extend(bytes);
        let mut accessor = accessor;
        accessor["bufferView"] = json!(views.len() - 1);
        accessors.push(accessor);
        accessors.len() - 1
    };
    let mut materials: Vec<Value> = Vec::new();
    let (mut nodes, mut meshes) = (Vec::new(), Vec::new());
    for (name, (corners, faces), at, turn, material) in objects {
        let known = materials.iter().position(|known| known["name"] == *material).unwrap_or_else(|| {
            let colour = [0.1 * (materials.len() + 1) as f32, 0.3, 0.2, 1.0];
            materials.push(json!({ "name": material, "pbrMetallicRoughness": { "baseColorFactor": colour } }));
            materials.len() - 1
        });
        let end = |k: usize, of: fn(f32, f32) -> f32| corners.iter().map(|corner| corner[k]).reduce(of).unwrap();
        let [low, high] = [f32::min, f32::max].map(|of| [end(0, of), end(1, of), end(2, of)]);
        let places = corners.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
        let place = json!({ "componentType": 5126, "count": corners.len(), "type": "VEC3", "min": low, "max": high });
        let place = view(places, place);
        let index = json!({ "componentType": 5125, "count": 3 * faces.len(), "type": "SCALAR" });
        let index = view(faces.iter().flatten().flat_map(|k| k.to_le_bytes()).collect(), index);
        let primitive = json!({ "attributes": { "POSITION": place }, "indices": index, "material": known });
        meshes.push(json!({ "primitives": [primitive] }));
        nodes.push(json!({ "name": name, "mesh": meshes.len() - 1, "translation": at, "rotation": turn }));
    }
    let file = json!({
        "asset": { "version": "2.0" }, "scene": 0, "scenes": [{ "nodes": (0..nodes.len()).collect::<Vec<_>>() }],
        "nodes": nodes, "meshes": meshes, "materials": materials, "buffers": [{ "byteLength": bin.len() }],
        "bufferViews": views, "accessors": accessors,
    });
    let mut text = serde_json::to_vec(&file).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    let number = |n: usize| (n as u32).to_le_bytes();
    let head = [number(2), number(28 + text.len() + bin.len()), number(text.len())];
    [&b"glTF"[..], head.as_flattened(), b"JSON", &text, &number(bin.len()), b"BIN\0", &bin].concat()
}

const UPRIGHT: [f32; 4] = [0.0, 0.0, 0.0, 1.0];
/// By 30° about the upright axis.
const TURNED: [f32; 4] = [0.0, 0.258_819_04, 0.0, 0.965_925_8];

/// A ball beside three cans on a table, whose top is at 0.75 m.
fn kitchen() -> Vec<u8> {
    let on = |x: f32, half: f32, z: f32| [x, 0.75 + half, z];
    glb(&[
        ("Table", plate([1.2, 0.05, 0.8]), [0.0, 0.725, 0.0], TURNED, "oak"),
        ("Ball", ball(0.04), on(-0.3, 0.04, 0.0), UPRIGHT, "rubber"),
        ("Can_1", can(0.033, 0.12), on(0.1, 0.06, 0.0), UPRIGHT, "tin"),
        ("Can_2", can(0.033, 0.12), on(0.2, 0.06, 0.1), TURNED, "tin"),
        ("Can.003", can(0.033, 0.12), on(0.2, 0.06, -0.1), UPRIGHT, "tin"),
    ])
}

/// What moves is what it looks like, everything comes to rest, and no word is needed in the file.
#[test]
fn named_objects_move() {
    let place = Place::new();
    place.write("kitchen.glb", kitchen());
    let made = place.ok("new --from kitchen.glb --moving Ball,Can*");
    made.says(&["1 ball, 1 box, 3 cylinders", "a floor is added under everything, at a height of 700 mm", "wrote"]);
    let text = std::fs::read_to_string(place.path("kitchen.toml")).unwrap();
    for part in [
        "name = \"Ball\"\nshape = { ball = { radius_mm = 40 } }",
        "name = \"Can_003\"\nshape = { cylinder = { radius_mm = 33, height_mm = 120 } }",
        "name = \"Table\"\nshape = { box = { size_mm = [1200, 800, 50] } }",
        "material = \"tin\"",
        "name = \"oak\"\nrolling = 0.01\nspinning = 0.01",
        "bring things to rest",
        "shape = { plane = {} }\nmaterial = \"oak\"\nat_mm = [0, 0, 700]",
        "colour = \"#",
    ] {
        assert!(text.contains(part), "`{part}` is not in:\n{text}");
    }
    assert!(!text.contains("glb\", object"), "all of it is recognised:\n{text}");
    // It would say how draws ended if not all came to rest.
    let checked = place.ok("check kitchen.toml --draws 5");
    assert!(checked.out.contains("all of them") && !checked.out.contains("how they ended"), "{}", checked.out);
}

#[test]
fn names_that_are_not_there_are_told() {
    let place = Place::new();
    place.write("kitchen.glb", kitchen());
    let names = "the file has Table, Ball, Can_1, Can_2, Can.003";
    for (more, said) in [
        ("--moving Cup*", "no object is called \"Cup*\""),
        ("--moving Ball --ignore *table", "no object is called \"*table\""),
    ] {
        place.ends(&format!("new --from kitchen.glb {more}"), 2).says(&[said, names]);
    }
    place.ends("new --from kitchen.glb --driven Ball", 2).says(&["Ball has no keyframes to follow"]);
    place.ends("new --from kitchen.glb --moving Ball --ignore B*", 2).says(&["Ball is said to do two things"]);
    place.ends("new ball2d --moving Ball", 2).says(&["--from"]);
    assert!(!place.path("kitchen.toml").exists());
    // Without a terminal nobody is asked: the note says what could be said.
    let said = "nothing in the file moves: say which of its objects do, for example --moving Ball,Can_1,Can_2,Can.003";
    place.ok("new --from kitchen.glb").says(&[said, "there are Table, Ball,"]);
    place.ok("new --from kitchen.glb other.toml --moving Ball --ignore Can*").says(&["1 ball, 1 box"]);
    assert!(!std::fs::read_to_string(place.path("other.toml")).unwrap().contains("Can"));
}

/// A hollow body is several convex pieces, with what they are off told; a thing that stands on nothing gets a floor.
#[test]
fn a_hollow_body_is_in_pieces() {
    let place = Place::new();
    let objects =
        [("Cup", cup(), [0.0, 0.0, 0.0], UPRIGHT, "china"), ("Pea", ball(0.01), [0.0, 0.2, 0.0], UPRIGHT, "")];
    place.write("cup.glb", glb(&objects));
    place.ok("new --from cup.glb --moving *").says(&["Cup: its mesh, which is hollow", "convex pieces", "a floor is"]);
    let text = std::fs::read_to_string(place.path("cup.toml")).unwrap();
    assert!(text.matches("points_mm").count() > 4 && text.contains("compound"), "{text}");
    // A pea that is dropped into the cup ends in it: the cup's hull would keep it out.
    let exact = text.replace("{ normal = [0, 5] }", "{ normal = [0, 0.1] }");
    let asked = "[[require]]\ninside = { body = \"Pea\", x_mm = [-40, 40], y_mm = [-40, 40], z_mm = [0, 40] }\n\n[world.custom]";
    place.write("in.toml", exact.replacen("[world.custom]", asked, 1));
    let checked = place.ok("check in.toml --draws 2");
    assert!(checked.out.contains("all of them") && !checked.out.contains("how they ended"), "{}", checked.out);
    let all = checked.out.lines().find(|line| line.starts_with("all of them")).unwrap();
    assert!(all.contains("100.0%"), "{}", checked.out);
}

/// Meshes of other formats, which name their objects too.
#[test]
fn objects_of_an_obj_move() {
    let place = Place::new();
    let block = |name: &str, first: u32, [x, y, z]: [f32; 3]| {
        let (corners, faces) = plate([0.1, 0.2, 0.1]);
        let corners = corners.iter().map(|[a, b, c]| format!("v {} {} {}\n", a + x, b + y, c + z));
        let faces = faces.iter().map(|face| {
            let [a, b, c] = face.map(|k| k + first);
            format!("f {a} {b} {c}\n")
        });
        format!("o {name}\n{}{}", corners.collect::<String>(), faces.collect::<String>())
    };
    place.write("two.obj", block("low", 1, [0.0, 0.1, 0.0]) + &block("high", 9, [0.0, 0.5, 0.02]));
    place.ok("new --from two.obj --moving high --unit-mm 1000").says(&["2 boxes"]);
    let text = std::fs::read_to_string(place.path("two.toml")).unwrap();
    assert!(text.contains("[[world.custom.bodies]]\nname = \"high\"\nshape = { box = { size_mm = [100, 100, 200] } }"));
    place.ok("check two.toml --draws 5");
    place.ends("new --from two.obj --moving middle again.toml", 2).says(&["the file has low, high"]);
}
