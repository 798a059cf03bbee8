//! Files that can be read, and files that cannot.

#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use glam::{DQuat, DVec3};
use plaus_asset::glb::{Between, Glb};
use plaus_asset::{AssetError, Content, Triangles, read, upright_turn};
use serde_json::{Value, json};

/// A wedge: corners, and triangles that face outwards.
const CORNERS: [[f32; 3]; 4] = [[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 3.0]];
const FACES: [[u32; 3]; 4] = [[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]];

fn obj() -> Vec<u8> {
    let corners = CORNERS.map(|[x, y, z]| format!("v {x} {y} {z}\n")).concat();
    let faces = FACES.map(|face| face.map(|corner| corner + 1)).map(|[a, b, c]| format!("f {a} {b} {c}\n")).concat();
    format!("o wedge\n{corners}{faces}").into_bytes()
}

/// Binary, with a header that begins like that of a text file, because some programs write such headers.
fn stl() -> Vec<u8> {
    let mut bytes = b"solid of a program".to_vec();
    bytes.resize(80, b' ');
    bytes.extend(4_u32.to_le_bytes());
    for face in FACES {
        bytes.extend([0; 12]);
        face.iter().for_each(|&k| CORNERS[k as usize].iter().for_each(|x| bytes.extend(x.to_le_bytes())));
        bytes.extend([0; 2]);
    }
    bytes
}

fn stl_text() -> Vec<u8> {
    let corner = |k: &u32| {
        format!("vertex {} {} {}\n", CORNERS[*k as usize][0], CORNERS[*k as usize][1], CORNERS[*k as usize][2])
    };
    let facet = |face: &[u32; 3]| {
        format!("facet normal 0 0 0\nouter loop\n{}endloop\nendfacet\n", face.iter().map(corner).collect::<String>())
    };
    format!("solid wedge\n{}endsolid wedge\n", FACES.iter().map(facet).collect::<String>()).into_bytes()
}

/// A GLB with these nodes, whose mesh 0 is the wedge; accessors 2 to 4 are two times, two places, two rotations.
fn glb(nodes: &Value, more: &Value) -> Vec<u8> {
    let mut bin: Vec<u8> = CORNERS.iter().flatten().flat_map(|x| x.to_le_bytes()).collect();
    bin.extend(FACES.iter().flatten().flat_map(|k| k.to_le_bytes()));
    for x in [0.5_f32, 1.5, 0.0, 0.0, 0.0, 0.0, 4.0, 0.0, 0.0, 0.0, 0.0, 1.0, 0.0, 1.0, 0.0, 0.0] {
        bin.extend(x.to_le_bytes());
    }
    let view = |offset: usize, length: usize| json!({ "buffer": 0, "byteOffset": offset, "byteLength": length });
    let numbers = |view: usize, count: usize, kind: &str| json!({ "bufferView": view, "componentType": 5126, "count": count, "type": kind });
    let mut file = json!({
        "asset": { "version": "2.0" },
        "scene": 0,
        "scenes": [{ "nodes": (0..nodes.as_array().unwrap().len()).collect::<Vec<_>>() }],
        "nodes": nodes,
        "meshes": [{ "primitives": [{ "attributes": { "POSITION": 0 }, "indices": 1, "material": 0 }] }],
        "materials": [{ "pbrMetallicRoughness": { "baseColorFactor": [1.0, 0.2, 0.0, 1.0] } }],
        "buffers": [{ "byteLength": bin.len() }],
        "bufferViews": [view(0, 48), view(48, 48), view(96, 8), view(104, 24), view(128, 32)],
        "accessors": [
            { "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3", "min": [0, 0, 0], "max": [1, 2, 3] },
            { "bufferView": 1, "componentType": 5125, "count": 12, "type": "SCALAR" },
            { "bufferView": 2, "componentType": 5126, "count": 2, "type": "SCALAR", "min": [0.5], "max": [1.5] },
            numbers(3, 2, "VEC3"),
            numbers(4, 2, "VEC4"),
        ],
    });
    for (key, value) in more.as_object().unwrap() {
        file[key] = value.clone();
    }
    let mut text = serde_json::to_vec(&file).unwrap();
    text.resize(text.len().next_multiple_of(4), b' ');
    let mut bytes = b"glTF".to_vec();
    let whole = 12 + 8 + text.len() + 8 + bin.len();
    for (number, part) in [(2, &b""[..]), (whole, b""), (text.len(), b"JSON"), (bin.len(), b"BIN\0")] {
        bytes.extend((number as u32).to_le_bytes());
        bytes.extend(part);
        match part {
            b"JSON" => bytes.extend(&text),
            b"BIN\0" => bytes.extend(&bin),
            _ => {}
        }
    }
    bytes
}

/// Six times the volume.
fn volume(triangles: &Triangles) -> f64 {
    let corner = |k: u32| triangles.corners[k as usize];
    triangles.faces.iter().map(|face| corner(face[0]).dot(corner(face[1]).cross(corner(face[2])))).sum()
}

fn only(content: &Content) -> &Triangles {
    assert_eq!(content.objects.len(), 1);
    &content.objects[0].triangles
}

#[test]
fn all_formats_tell_the_same_triangles() {
    let plain = glb(&json!([{ "name": "wedge", "mesh": 0 }]), &json!({}));
    let truth = CORNERS.map(|corner| DVec3::from_array(corner.map(f64::from)));
    for (file, bytes) in [("a.obj", obj()), ("a.STL", stl()), ("a.stl", stl_text()), ("a.glb", plain)] {
        let content = read(file, &bytes).unwrap();
        let triangles = only(&content);
        assert_eq!((triangles.corners.len(), triangles.faces.len()), (4, 4), "{file}");
        assert!(truth.iter().all(|corner| triangles.corners.contains(corner)), "{file}: {triangles:?}");
        assert!((volume(triangles) - 6.0).abs() < 1e-12, "{file}: outwards");
    }
    assert_eq!(
        read("a.glb", &glb(&json!([{ "mesh": 0 }]), &json!({}))).unwrap().objects[0].colour,
        Some([255, 124, 0])
    );
}

/// Nodes are placed, turned and scaled, also within each other. A shape that a mirror scales still faces outwards.
#[test]
fn nodes_are_where_the_tree_puts_them() {
    let half = std::f64::consts::FRAC_1_SQRT_2;
    let nodes = json!([
        { "name": "frame", "translation": [10, 0, 0], "rotation": [0, half, 0, half], "children": [1] },
        { "name": "mirrored", "mesh": 0, "translation": [0, 0, 1], "scale": [2, 2, -2] },
    ]);
    let scene = json!({ "scenes": [{ "nodes": [0] }] });
    let content = read("a.glb", &glb(&nodes, &scene)).unwrap();
    let object = content.object("mirrored").unwrap();
    assert!((object.at - DVec3::new(11.0, 0.0, 0.0)).length() < 1e-6, "{}", object.at);
    assert!((volume(&object.triangles) - 48.0).abs() < 1e-4, "{}", volume(&object.triangles));
    let far = DVec3::new(11.0 - 6.0, 0.0, 0.0);
    assert!(content.whole().corners.iter().any(|&corner| (corner - far).length() < 1e-5), "{:?}", content.whole());
    let turn = upright_turn(DQuat::from_rotation_y(0.3), plaus_asset::Up::Y);
    assert!((turn * DVec3::X - DQuat::from_rotation_z(0.3) * DVec3::X).length() < 1e-12, "about y is about up");
}

/// Every node has a name of its own, whatever the file calls it. Of two shapes of one name neither is lost, and a node
/// without a shape does not take the name of one that has.
#[test]
fn names_are_told_apart() {
    let nodes = json!([
        { "name": "box", "children": [1, 2, 3] },
        { "name": "box", "mesh": 0, "translation": [1, 0, 0] },
        { "name": "box", "mesh": 0, "translation": [2, 0, 0] },
        { "name": "box_2", "mesh": 0, "translation": [3, 0, 0] },
        { "mesh": 0, "translation": [4, 0, 0] },
        { "name": "object_5", "mesh": 0, "translation": [5, 0, 0] },
        { "name": "box", "mesh": 0, "translation": [6, 0, 0] },
    ]);
    let bytes = glb(&nodes, &json!({ "scenes": [{ "nodes": [0, 4, 5, 6] }] }));
    let content = read("a.glb", &bytes).unwrap();
    let names: Vec<&str> = content.objects.iter().map(|object| object.name.as_str()).collect();
    assert_eq!(names, ["box", "box_3", "box_2", "object_5_2", "object_5", "box_4"]);
    for (place, name) in ["box", "box_3", "box_2", "object_5_2", "object_5", "box_4"].into_iter().enumerate() {
        assert!((content.object(name).unwrap().at.x - (place + 1) as f64).abs() < 1e-6, "{name}");
    }
    let nodes = Glb::read(&bytes).unwrap().nodes();
    assert_eq!(nodes.iter().find(|node| !node.has_mesh).map(|node| node.name.as_str()), Some("box_5"));
}

#[test]
fn keys_and_extra_properties_are_read() {
    let nodes =
        json!([{ "name": "door", "mesh": 0, "extras": { "plaus": "driven" }, "extensions": { "A_b": { "c": 1 } } }]);
    let channel = |sampler: usize, path: &str| json!({ "sampler": sampler, "target": { "node": 0, "path": path } });
    let more = json!({ "extensionsUsed": ["A_b"], "extensions": { "A_b": [7] }, "animations": [{
        "samplers": [{ "input": 2, "output": 3 }, { "input": 2, "output": 4 }],
        "channels": [channel(0, "translation"), channel(1, "rotation"), channel(0, "scale")],
    }] });
    let file = Glb::read(&glb(&nodes, &more)).unwrap();
    let node = &file.nodes()[0];
    assert_eq!((node.extras["plaus"].as_str(), &node.extensions["A_b"]["c"]), (Some("driven"), &json!(1)));
    assert_eq!(file.extension("A_b")[0], 7);
    assert_eq!((node.between, node.keys.len()), (Between::Linear, 2));
    assert_eq!((node.keys[0].time, node.keys[1].time), (0.5, 1.5));
    assert!((node.keys[1].at - DVec3::new(0.0, 4.0, 0.0)).length() < 1e-6, "{:?}", node.keys);
    assert!((node.keys[1].turn * DVec3::X + DVec3::X).length() < 1e-6, "half a turn about y");
    assert_eq!(node.left_out.len(), 1, "{:?}", node.left_out);
}

/// The numbers that a GLB states about itself are not trusted.
#[test]
fn broken_files_are_errors() {
    let node = json!([{ "mesh": 0 }]);
    let accessor = |changes: Value| {
        let mut first = json!({ "bufferView": 0, "componentType": 5126, "count": 4, "type": "VEC3" });
        (first["min"], first["max"]) = (json!([0, 0, 0]), json!([1, 2, 3]));
        changes.as_object().unwrap().iter().for_each(|(key, value)| first[key] = value.clone());
        json!({ "accessors": [first, { "bufferView": 1, "componentType": 5125, "count": 12, "type": "SCALAR" }] })
    };
    for changes in [
        json!({ "count": 0 }),
        json!({ "count": 5 }),
        json!({ "count": u64::MAX / 8 }),
        json!({ "byteOffset": u64::MAX - 4 }),
        json!({ "sparse": {
            "count": 1, "indices": { "bufferView": 1, "componentType": 5125 }, "values": { "bufferView": 0 },
        } }),
    ] {
        let error = read("a.glb", &glb(&node, &accessor(changes.clone()))).unwrap_err();
        assert!(matches!(error, AssetError::Broken(_)), "{changes}: {error}");
    }
    let circle = json!({ "scenes": [{ "nodes": [0] }], "nodes": [{ "mesh": 0, "children": [0] }] });
    assert!(read("a.glb", &glb(&node, &circle)).unwrap_err().to_string().contains("twice"));
    let draco = "KHR_draco_mesh_compression";
    let needs = json!({ "extensionsRequired": [draco], "extensionsUsed": [draco] });
    assert!(read("a.glb", &glb(&node, &needs)).unwrap_err().to_string().contains(draco));
    // What has no bearing on shapes is no reason to refuse a file, unless it is required and hides triangles.
    let harmless = ["KHR_lights_punctual", "KHR_implicit_shapes", "EXT_of_tomorrow"];
    let lit = json!({ "extensionsRequired": harmless, "extensionsUsed": harmless });
    let plain = read("a.glb", &glb(&node, &json!({}))).unwrap();
    assert_eq!(only(&read("a.glb", &glb(&node, &lit)).unwrap()), only(&plain));
    let whole = glb(&node, &json!({}));
    for cut in (0..whole.len()).step_by(7) {
        assert!(read("a.glb", &whole[..cut]).is_err(), "{cut}");
    }
    for (file, whole) in [("a.obj", obj()), ("a.stl", stl())] {
        for cut in (0..whole.len()).step_by(11) {
            let _ = read(file, &whole[..cut]); // part of a text may be a whole one: only that it ends counts
        }
    }
    assert!(matches!(read("a.ply", b""), Err(AssetError::UnknownFormat)));
    assert!(matches!(read("a.obj", b""), Err(AssetError::Empty)));
}

/// What programs write into OBJ files, in every combination: the same triangles. A file whose faces are lost is
/// another.
#[test]
fn what_an_obj_says_besides_changes_nothing() {
    let truth = read("a.obj", &obj()).unwrap();
    let plain = String::from_utf8(obj()).unwrap();
    type Change = fn(String) -> Vec<u8>;
    let text = |change: fn(String) -> String| change;
    let changes: [fn(String) -> String; 8] = [
        text(|file| file.replace("f 1 3 2\n", "f 1 3 2 # the bottom\n")),
        text(|file| file.replace("f 1 2 4\n", "f 1 \\\n2 4\n")),
        text(|file| format!("mtllib \nusemtl \n{file}s off\nl 1 2\n")),
        text(|file| file.replace("v 1 0 0\n", "v 1 0 0 0.5 0.5 0.25\n")),
        text(|file| file.replace("f 1 4 3\n", "vt nothing\nvn 0 0 1\nf 1/1/1 4/9/1 3//1\n")),
        text(|file| format!("# façade\n{file}")),
        text(|file| file.replace('\n', "\r\n")),
        text(|file| format!("\u{feff}{file}")),
    ];
    let encodings: [Change; 2] = [String::into_bytes, |file| {
        // Latin-1 has no byte order mark.
        file.trim_start_matches('\u{feff}').chars().map(|c| c as u8).collect()
    }];
    for chosen in 0..1 << changes.len() {
        let file = (0..changes.len()).filter(|k| chosen >> k & 1 == 1).fold(plain.clone(), |file, k| changes[k](file));
        for encode in encodings {
            let found = read("a.obj", &encode(file.clone())).unwrap();
            assert_eq!(only(&found), only(&truth), "{file}");
            assert_eq!(found.objects[0].name, "wedge");
        }
    }
    assert_ne!(only(&read("a.obj", plain.replace("f 1 3 2\n", "").as_bytes()).unwrap()), only(&truth));
}

/// Replicas are turned once more, and moved on along their own axes; names get numbers, the inner one first. What would
/// be too many is refused with its line.
#[test]
fn replicas_are_where_they_belong() {
    let model = |inside: &str| format!("<mujoco><worldbody>{inside}</worldbody></mujoco>");
    let ring = "<replicate count='12' offset='2 0 0' euler='0 0 30' sep='-'><body name='b' pos='0 1 0'>\
                <replicate count='2' offset='0 0 3'><geom name='g' size='0.1'/></replicate></body></replicate>";
    let read = plaus_asset::read_model(model(ring).as_bytes(), &mut |_| Err(String::new())).unwrap();
    assert!(read.left_out.is_empty() && read.bodies.len() == 13, "{:?}", read.left_out);
    // The corners of a polygon with edges of 2 and the angles of a twelfth of a turn.
    let mut corner = glam::DVec3::ZERO;
    for (nth, body) in read.bodies.iter().skip(1).enumerate() {
        let turn = glam::DQuat::from_rotation_z((30.0 * nth as f64).to_radians());
        let off = (body.at - (corner + turn * glam::DVec3::Y)).length() + body.turn.angle_between(turn);
        assert!(off < 1e-7, "{nth}: {off}");
        corner += turn * (2.0 * glam::DVec3::X);
        let names: Vec<_> = body.geoms.iter().map(|geom| geom.name.clone().unwrap()).collect();
        assert_eq!(
            (body.name.clone(), names),
            (format!("b-{nth:02}"), vec![format!("g0-{nth:02}"), format!("g1-{nth:02}")])
        );
        assert!((body.geoms[1].at - body.geoms[0].at - 3.0 * glam::DVec3::Z).length() < 1e-12);
    }
    assert!(corner.length() < 1e-12, "twelve of them close: {corner}");
    let many = "<replicate count='9000'>\n<replicate count='9000'><geom size='1'/></replicate></replicate>";
    for (inside, words) in [(many, "in replicas: make `count` smaller"), ("<replicate count='0'/>", "a whole number")] {
        let error = plaus_asset::read_model(model(inside).as_bytes(), &mut |_| Err(String::new())).unwrap_err();
        assert!(error.to_string().contains(words) && error.to_string().contains("line"), "{error}");
    }
}
