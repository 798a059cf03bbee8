//! Worlds from `KHR_physics_rigid_bodies`: what touches how, what joints hold, which shapes solids have, and files that
//! are damaged.

use crate::imported::{glb, imported, is_left_out};
use glam::{DQuat, DVec3};
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::Target;
use plaus_scenes::custom::{Shape, Still};
use plaus_scenes::{Assets, Scene, custom, import};
use serde_json::{Value, json};
use std::f64::consts::PI;

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

    fn vector(&mut self, half: f64) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| half * (2.0 * self.next() - 1.0)))
    }

    fn turn(&mut self) -> DQuat {
        DQuat::from_scaled_axis(self.vector(2.0))
    }
}

/// A file of these nodes, with the lists of the extension, and solids.
pub(crate) fn file(nodes: &Value, bodies: &Value, shapes: &Value) -> Vec<u8> {
    glb(nodes, &more(nodes, bodies, shapes))
}

fn more(nodes: &Value, bodies: &Value, shapes: &Value) -> Value {
    let all = nodes.as_array().unwrap();
    let is_child = |k: usize| all.iter().any(|node| node["children"].as_array().into_iter().flatten().any(|c| *c == k));
    let roots: Vec<usize> = (0..all.len()).filter(|&k| !is_child(k)).collect();
    let names = ["KHR_physics_rigid_bodies", "KHR_implicit_shapes"];
    json!({ "scenes": [{ "nodes": roots }], "extensionsUsed": names, "extensionsRequired": names,
            "extensions": { "KHR_physics_rigid_bodies": bodies, "KHR_implicit_shapes": { "shapes": shapes } } })
}

/// A node with this at a place.
pub(crate) fn node(name: &str, at: DVec3, said: Value) -> Value {
    json!({ "name": name, "translation": at.to_array(), "extensions": { "KHR_physics_rigid_bodies": said } })
}

pub(crate) fn shape(index: usize) -> Value {
    json!({ "geometry": { "shape": index } })
}

/// Friction, static or not, and restitution between two materials follow the rule of higher rank of the two, average
/// before minimum before maximum before multiply; where no rule is said, the average. A twin with the ranks upside down
/// is caught.
#[test]
fn materials_combine_as_the_file_says() {
    const RULES: [Option<&str>; 5] = [Some("average"), Some("minimum"), Some("maximum"), Some("multiply"), None];
    let value = |rules: [usize; 2], [a, b]: [f64; 2], is_twin: bool| {
        let rule = if is_twin { rules[0].max(rules[1]) } else { rules[0].min(rules[1]) };
        [0.5 * (a + b), a.min(b), a.max(b), a * b, 0.5 * (a + b)][rule]
    };
    let mut uniform = Uniform(7);
    let mut twins = 0;
    for nth in 0..50 {
        let rules = [[nth % 5, nth / 5 % 5], [uniform.below(5), uniform.below(5)]];
        // With three decimals, as files have them.
        let [slides, bounces, more] = [0; 3].map(|_| [0; 2].map(|_| (1e3 * uniform.next()).round() / 1e3));
        let values = [slides, bounces, [0, 1].map(|k| (1e3 * (slides[k] + more[k])).round() / 1e3)];
        let material = |k: usize| {
            let mut material = json!({ "dynamicFriction": values[0][k], "restitution": values[1][k],
                                       "staticFriction": values[2][k] });
            for (key, rules) in ["frictionCombine", "restitutionCombine"].iter().zip(rules) {
                if let Some(rule) = RULES[rules[k]] {
                    material[*key] = rule.into();
                }
            }
            material
        };
        let collider = |k: usize| json!({ "collider": { "geometry": { "shape": 0 }, "physicsMaterial": k } });
        let mut ball = collider(1);
        ball["motion"] = json!({ "mass": 1 });
        let nodes = json!([node("table", DVec3::ZERO, collider(0)), node("ball", DVec3::Y * 3.0, ball)]);
        let bodies = json!({ "physicsMaterials": [material(0), material(1)] });
        let (made, config) = imported(&file(&nodes, &bodies, &json!([{ "type": "sphere", "sphere": {} }])));
        assert!(made.left_out.is_empty(), "{:?}", made.left_out);
        let between = format!("between = [\"{}\", \"{}\"]", config.fixed[0].material, config.bodies[0].material);
        let pair = made.text.split("[[world.custom.pairs]]").find(|pair| pair.contains(&between)).unwrap_or_default();
        let pair = pair.split("[[").next().unwrap_or_default();
        let mut told = ["friction = ", "restitution = ", "static_friction = "].map(|key| {
            let said = pair.lines().find_map(|line| line.strip_prefix(key))?;
            Some(said.parse::<f64>().unwrap())
        });
        // Unset, it is the pair's friction if that is set.
        told[2] = told[2].or(told[0]);
        // Then it is the geometric mean of what the two have.
        let own = |k: usize| {
            let materials = [&config.fixed[0].material, &config.bodies[0].material];
            let value = |name: &String| {
                let material = config.materials.iter().find(|material| material.name == *name).unwrap();
                let said = match (k, &material.static_friction) {
                    (1, _) => format!("{:?}", material.restitution),
                    (2, Some(grip)) => format!("{grip:?}"),
                    _ => format!("{:?}", material.friction),
                };
                said.trim_start_matches("Fixed(").trim_end_matches(')').parse::<f64>().unwrap()
            };
            materials.map(value).iter().product::<f64>().sqrt()
        };
        for k in 0..3 {
            let says = |value: f64| match &told[k] {
                // A scenario has millionths.
                Some(told) => (told - value).abs() <= 1e-6,
                None => (value - own(k)).abs() <= 1e-6,
            };
            let rules = rules[k % 2];
            assert!(says(value(rules, values[k], false)), "{rules:?} {:?}\n{}", values[k], made.text);
            twins += usize::from(!says(value(rules, values[k], true)));
        }
    }
    assert!(twins > 20, "{twins}");
}

/// A hinge with limits, in frames that are turned anyhow: all along the motion its two frames are in one place, share
/// their axis, and are turned within the limits, measured as the extension defines them. A twin that takes the limits
/// the other way round is caught.
#[test]
fn hinges_hold_what_the_file_says() {
    let mut uniform = Uniform(3);
    let mut twins = 0;
    for nth in 0..12 {
        let axis = nth % 3;
        let others = [(axis + 1) % 3, (axis + 2) % 3];
        let limits = [-0.2 - uniform.next(), 0.2 + 1.5 * uniform.next()];
        let start = limits[0] + (limits[1] - limits[0]) * uniform.next();
        let (pivot, turn) = (uniform.vector(1.0), uniform.turn());
        let (arm, arm_turn) = (pivot + uniform.vector(0.5), uniform.turn());
        let other = turn * DQuat::from_scaled_axis(DVec3::AXES[axis] * start);
        let inner = (arm_turn.inverse() * (pivot - arm), arm_turn.inverse() * other);
        let mut nodes = json!([
            node("post", DVec3::ZERO, json!({ "collider": shape(0) })),
            node("frame", pivot, json!({ "joint": { "connectedNode": 3, "joint": 0 } })),
            node("arm", arm, json!({ "motion": { "mass": 2 }, "collider": shape(1) })),
            node("other", inner.0, json!({})),
        ]);
        for (k, turn) in [(1, turn), (2, arm_turn), (3, inner.1)] {
            nodes[k]["rotation"] = turn.to_array().to_vec().into();
        }
        (nodes[0]["children"], nodes[2]["children"]) = (json!([1]), json!([3]));
        let bodies = json!({ "physicsJoints": [{ "limits": [
            { "linearAxes": [0, 1, 2], "min": 0, "max": 0 }, { "angularAxes": others, "min": 0, "max": 0 },
            { "angularAxes": [axis], "min": limits[0], "max": limits[1] },
        ] }] });
        let solids = json!([{ "type": "box", "box": { "size": [0.1, 0.1, 0.1] } },
                            { "type": "box", "box": { "size": [0.4, 0.3, 0.2] } }]);
        let (made, config) = imported(&file(&nodes, &bodies, &solids));
        // Nothing else could touch the post.
        assert!(made.left_out.is_empty() && config.fixed.is_empty(), "{:?}", made.left_out);
        let scene = custom::Custom::new(&config).unwrap();
        let film = scene.animate(&scene.start(&mut Seed(1).chain(0).at(0, Purpose::START))).unwrap();
        let track = film.motion.tracks.iter().find(|track| track.name == "arm").unwrap();
        for k in 0..=40 {
            let time = 0.05 * f64::from(k);
            // The track's own axes may be others than the file's.
            let now = track.orientation(time) * track.orientation(0.0).inverse() * arm_turn;
            let at = track.position(time) + now * inner.0;
            // A tenth of a millimetre: what animations are exact to.
            assert!((at - pivot).length() < 1e-4, "{nth} at {time}: {}", at - pivot);
            let q = turn.inverse() * now * inner.1;
            let off = (now * inner.1 * DVec3::AXES[axis]).angle_between(turn * DVec3::AXES[axis]);
            assert!(off < 1e-3, "{nth} at {time}: {off}");
            let angle = 2.0 * (q.to_array()[axis] * q.w.signum()).atan2(q.w.abs());
            let beyond = |[low, high]: [f64; 2]| (low - angle).max(angle - high);
            assert!(beyond(limits) < 2e-3, "{nth} at {time}: {angle} of {limits:?}");
            twins += usize::from(beyond([-limits[1], -limits[0]]) > 2e-3);
        }
    }
    assert!(twins > 20, "{twins}");
}

/// Which joint a set of limits is, and what is told where there is none like it.
#[test]
fn limits_are_the_nearest_joint() {
    let fixed = |key: &str, axes: &[usize]| json!({ key: axes, "min": 0, "max": 0 });
    let point = fixed("linearAxes", &[0, 1, 2]);
    for (limits, kind, told) in [
        (json!([point, fixed("angularAxes", &[0, 1, 2])]), "weld = {}", None),
        (json!([point, fixed("angularAxes", &[0]), fixed("angularAxes", &[1])]), "hinge = { axis = [0, -1, 0] }", None),
        (json!([point]), "ball = {}", None),
        (json!([point, fixed("angularAxes", &[1])]), "ball = {}", Some("that it does not turn about one axis")),
        (
            json!([fixed("linearAxes", &[0, 2]), fixed("angularAxes", &[0, 1, 2])]),
            "slider = { axis = [0, 0, 1] }",
            None,
        ),
        (json!([{ "linearAxes": [0, 1, 2], "max": 1 }]), "", Some("it fixes 0 of 3 places")),
        (
            json!([point, { "angularAxes": [1], "min": 0, "max": 0, "stiffness": 5 }]),
            "ball = {}",
            Some("its springs, but for that along the axis of a hinge or slider"),
        ),
    ] {
        let nodes = json!([
            node(
                "a",
                DVec3::ZERO,
                json!({ "motion": {}, "collider": shape(0), "joint": { "connectedNode": 1, "joint": 0 } })
            ),
            node("b", DVec3::X * 3.0, json!({ "motion": {}, "collider": shape(0) })),
            node(
                "c",
                DVec3::X * 9.0,
                json!({ "motion": {}, "collider": shape(0),
                                              "joint": { "connectedNode": 7, "joint": 0 } })
            ),
        ]);
        let joints = json!({ "physicsJoints": [{ "limits": limits, "drives": [{ "type": "angular", "axis": 2 }] }] });
        let (made, config) = imported(&file(&nodes, &joints, &json!([{ "type": "sphere" }])));
        assert_eq!(config.joints.len(), usize::from(!kind.is_empty()), "{limits}");
        assert!(made.text.contains(&format!("kind = {{ {kind}")) || kind.is_empty(), "{}", made.text);
        told.into_iter().for_each(|told| is_left_out(&made, told));
        is_left_out(&made, "c: its joint: its `connectedNode` is no node of the scene");
        is_left_out(&made, "a: its joint: its angular drive of z: nothing drives it here");
        if !kind.is_empty() {
            is_left_out(&made, "3000 mm from where the file holds them");
        }
    }
}

/// Scenery that no filter lets anything touch is left out, which changes nothing. What else passes through each other
/// is told, and nothing is where all touch that could.
#[test]
fn filters_are_kept_or_told() {
    let with = |filters: Value| {
        let at = |k: usize| json!({ "geometry": { "shape": 0 }, "collisionFilter": k });
        let nodes = json!([
            node("table", DVec3::ZERO, json!({ "collider": at(0) })),
            node("cloud", DVec3::Y * 20.0, json!({ "collider": at(1) })),
            node("ball", DVec3::Y * 3.0, json!({ "motion": {}, "collider": at(2) })),
            node("other", DVec3::Y * 6.0, json!({ "motion": {}, "collider": at(3) })),
        ]);
        imported(&file(&nodes, &json!({ "collisionFilters": filters }), &json!([{ "type": "sphere" }])))
    };
    let is_in = |name: &str| json!({ "collisionSystems": [name], "collideWithSystems": ["a", "b"] });
    let (made, config) = with(json!([is_in("a"), is_in("c"), is_in("b"), is_in("b")]));
    assert!(made.left_out.is_empty() && config.fixed.len() == 1, "{:?}", made.left_out);
    assert_eq!(made.notes, ["cloud: left out, as its filter lets nothing touch it"]);
    let only_b = json!({ "collisionSystems": ["b"], "notCollideWithSystems": ["b"] });
    let (made, config) = with(json!([is_in("a"), is_in("a"), only_b, is_in("b")]));
    assert!(made.left_out.is_empty(), "{:?}", made.left_out);
    assert!(config.bodies.iter().all(|body| body.no_contact == ["filter_1"]), "{}", made.text);
}

/// A file without any mesh: solids alone, each with the volume that the extension gives it, as its mass tells.
#[test]
fn solids_need_no_mesh() {
    // Of two balls with all between them, in thin slices.
    let tapered = |top: f64, bottom: f64, height: f64| {
        let radius = |y: f64| {
            let of = |k: u32| {
                let s = f64::from(k) / 400.0;
                let (r, at) = (bottom + (top - bottom) * s, (s - 0.5) * height);
                (r * r - (y - at) * (y - at)).max(0.0)
            };
            (0..=400).map(of).fold(0.0, f64::max)
        };
        let (low, high) = (-0.5 * height - bottom, 0.5 * height + top);
        let step = (high - low) / 4000.0;
        (0..4000).map(|k| PI * radius(low + (f64::from(k) + 0.5) * step) * step).sum::<f64>()
    };
    let round = |top: f64, bottom: f64| json!({ "radiusTop": top, "radiusBottom": bottom, "height": 0.8 });
    let scale = [1.0, 2.0, 0.5];
    for (kind, said, scale, volume) in [
        ("sphere", json!({}), [2.0; 3], 4.0 / 3.0 * PI),
        ("sphere", json!({ "radius": 0.3 }), scale, 4.0 / 3.0 * PI * 0.027),
        ("box", json!({ "size": [0.1, 0.2, 0.3] }), [1.0, -2.0, 0.5], 0.006),
        ("cylinder", round(0.3, 0.3), [1.0; 3], PI * 0.09 * 0.8),
        ("cylinder", round(0.0, 0.3), [1.0; 3], PI * 0.03 * 0.8),
        ("cylinder", round(0.2, 0.3), [1.0; 3], PI / 3.0 * 0.8 * 0.19),
        ("cylinder", round(0.3, 0.3), scale, PI * 0.09 * 0.8),
        ("capsule", round(0.3, 0.3), [1.0; 3], PI * 0.09 * 1.2),
        ("capsule", round(0.25, 0.389), [1.0; 3], tapered(0.25, 0.389, 0.8)),
        ("capsule", round(0.1, 0.45), scale, tapered(0.1, 0.45, 0.8)),
    ] {
        let mut body = node("it", DVec3::Y * 5.0, json!({ "motion": { "mass": 100 }, "collider": shape(0) }));
        body["scale"] = scale.to_vec().into();
        let nodes = json!([body, node("ground", DVec3::ZERO, json!({ "collider": shape(1) }))]);
        let solids = json!([{ "type": kind, kind: said }, { "type": "plane", "plane": {} }]);
        let (made, config) = imported(&file(&nodes, &json!({}), &solids));
        assert!(matches!(config.fixed[0].shape, Still::Plane(_)), "{}", made.text);
        let density = made.text.lines().find_map(|line| line.strip_prefix("density = ")).unwrap();
        let found = 100.0 / density.parse::<f64>().unwrap();
        // Slices of a four-thousandth of the height.
        assert!((found / volume - 1.0).abs() < 1e-3, "{kind} {said} {scale:?}: {found} {volume}");
        let is_replaced = matches!(config.bodies[0].shape, Shape::Hull(_) | Shape::Ellipsoid(_));
        assert_eq!(is_replaced, !made.left_out.is_empty(), "{:?}", made.left_out);
        custom::Custom::new(&config).unwrap_or_else(|error| panic!("{kind}: {error:?}"));
    }
    let wrong = [json!({ "radius": -1 }), json!({ "radius": 0 }), json!({ "radius": 1e300 })];
    for said in wrong {
        let nodes = json!([node("it", DVec3::ZERO, json!({ "collider": shape(0) }))]);
        let mut files = Assets::default();
        files.insert("a.glb", file(&nodes, &json!({}), &json!([{ "type": "sphere", "sphere": said }])));
        let error = import::scenario("a.glb", false, None, &files).unwrap_err().to_string();
        assert!(error.contains("no triangles, and no colliders"), "{error}");
    }
}

/// A collider may take its mesh from another node, in the scene or not, with all below it; what is required but has no
/// bearing on motion is told apart, and what holds meshes in a form of its own is refused by name.
#[test]
fn colliders_take_meshes_from_elsewhere() {
    let mut cup = node("cup", DVec3::Y, json!({ "motion": {}, "collider": { "geometry": { "node": 1 } } }));
    cup["scale"] = json!([2, 2, 2]);
    let nodes = json!([cup, { "children": [2], "translation": [9, 9, 9] }, { "mesh": 0, "translation": [0, 1, 0] }]);
    let mut more = more(&nodes, &json!({}), &json!([]));
    more["scenes"][0]["nodes"] = json!([0]);
    more["extensionsRequired"] = json!(["KHR_physics_rigid_bodies", "KHR_lights_punctual", "XY_springs"]);
    let (made, config) = imported(&glb(&nodes, &more));
    let Shape::HullOf(hull) = &config.bodies[0].shape else { panic!("{}", made.text) };
    assert_eq!(hull.0.object.as_deref(), Some("cup_collider"));
    assert_eq!(made.left_out, ["the extension XY_springs, which the file requires"]);
    assert_eq!(made.harmless, ["the extension KHR_lights_punctual, which the file requires"]);
    let scene = custom::Custom::new(&config).unwrap();
    let film = scene.animate(&scene.start(&mut Seed(1).chain(0).at(0, Purpose::START))).unwrap();
    assert!(film.motion.tracks.iter().any(|track| track.name == "cup"));
    // A wedge of 1 × 2 × 3 m, a metre up, and all of it twice as large.
    let bytes = glb(&nodes, &more);
    let content = plaus_asset::read("a.glb", &bytes).unwrap();
    let [low, high] = content.object("cup_collider").unwrap().triangles.ends();
    assert_eq!((low, high), (DVec3::new(0.0, 2.0, 0.0), DVec3::new(2.0, 6.0, 6.0)));
    more["extensionsRequired"] = json!(["KHR_draco_mesh_compression"]);
    let mut files = Assets::default();
    files.insert("a.glb", glb(&nodes, &more));
    let error = import::scenario("a.glb", false, None, &files).unwrap_err().to_string();
    assert!(error.contains("KHR_draco_mesh_compression, which is not read: export it without"), "{error}");
}

/// The JSON and the data of a GLB.
fn taken_apart(glb: &[u8]) -> (Value, Vec<u8>) {
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    (serde_json::from_slice(&glb[20..20 + length]).unwrap(), glb[28 + length..].to_vec())
}

fn base64(bytes: &[u8]) -> String {
    const LETTERS: &[u8; 64] = b"ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
    let group = |three: &[u8]| {
        let bits = (0..3).fold(0_u32, |bits, k| bits << 8 | u32::from(three.get(k).copied().unwrap_or(0)));
        let letter =
            |k: usize| if k <= three.len() { LETTERS[(bits >> (18 - 6 * k) & 63) as usize] as char } else { '=' };
        [0, 1, 2, 3].map(letter)
    };
    bytes.chunks(3).flat_map(group).collect()
}

/// A `.gltf` is the same world as the GLB of it, with its data in files beside it, in it, or both; what is missing is
/// named.
#[test]
fn a_gltf_is_its_glb() {
    let nodes = json!([
        { "name": "hill", "mesh": 0 },
        { "name": "rock", "mesh": 0, "translation": [9, 4, 0], "extras": { "plaus": "body" } },
    ]);
    let bytes = glb(&nodes, &json!({ "images": [{ "uri": "sky.png" }] }));
    let (made, _) = imported(&bytes);
    let (mut json, data) = taken_apart(&bytes);
    let half = 96;
    json["buffers"] = json!([
        { "byteLength": half, "uri": "my%20data.bin" },
        { "byteLength": data.len() - half,
          "uri": format!("data:application/octet-stream;base64,{}", base64(&data[half..])) },
    ]);
    for (index, view) in json["bufferViews"].as_array_mut().unwrap().iter_mut().enumerate() {
        if index >= 2 {
            view["buffer"] = 1.into();
            view["byteOffset"] = (view["byteOffset"].as_u64().unwrap() - half as u64).into();
        }
    }
    let mut files = Assets::default();
    files.insert("worlds/a.gltf", serde_json::to_vec(&json).unwrap());
    let error = import::scenario("worlds/a.gltf", false, None, &files).unwrap_err().to_string();
    assert!(error.contains("buffer 0: my data.bin: "), "{error}");
    files.insert("worlds/my data.bin", &data[..half]);
    let same = import::scenario("worlds/a.gltf", false, None, &files).unwrap();
    assert_eq!(same.text.replace("worlds/a.gltf", "a.glb"), made.text);
    files.insert("worlds/my data.bin", &data[..9]);
    let error = import::scenario("worlds/a.gltf", false, None, &files).unwrap_err().to_string();
    assert!(error.contains("it has 9 bytes, and 96 are said"), "{error}");
    json["buffers"][0]["uri"] = "https://example.org/a.bin".into();
    files.insert("worlds/a.gltf", serde_json::to_vec(&json).unwrap());
    let error = import::scenario("worlds/a.gltf", false, None, &files).unwrap_err().to_string();
    assert!(error.contains("is not on this computer"), "{error}");
}

/// Files with all of this, with bytes of their JSON that were changed, left out or doubled, are read or refused:
/// nothing else happens.
#[test]
fn damaged_files_are_read_or_refused() {
    let mut nodes = json!([
        node("table", DVec3::ZERO, json!({
            "collider": { "geometry": { "shape": 0 }, "physicsMaterial": 0, "collisionFilter": 0 } })),
        node("arm", DVec3::Y * 4.0, json!({
             "motion": { "mass": 2, "inertiaDiagonal": [1, 2, 2], "centerOfMass": [0, 1, 0] },
             "collider": { "geometry": { "shape": 1 }, "physicsMaterial": 1, "collisionFilter": 1 },
             "joint": { "connectedNode": 0, "joint": 0 } })),
        node("cup", DVec3::Y * 9.0, json!({ "motion": { "isKinematic": true, "angularVelocity": [0, 3, 0] },
             "collider": { "geometry": { "node": 3, "convexHull": true } } })),
        { "mesh": 0, "scale": [0.5, 0.5, 0.5] },
    ]);
    nodes[1]["rotation"] = json!([0.0, 0.6, 0.0, 0.8]);
    let bodies = json!({
        "physicsMaterials": [{ "restitution": 0.9, "restitutionCombine": "maximum" }, { "frictionCombine": "minimum" }],
        "collisionFilters": [{ "collisionSystems": ["a"] }, { "notCollideWithSystems": ["a", "b"] }],
        "physicsJoints": [{ "limits": [{ "linearAxes": [0, 1, 2], "min": 0, "max": 0 },
                            { "angularAxes": [1, 2], "min": 0, "max": 0 },
                            { "angularAxes": [0], "min": -1, "max": 0.5 }], "drives": [{ "axis": 0 }] }],
    });
    let solids = json!([{ "type": "plane", "plane": { "sizeX": 5, "sizeZ": 7 } },
                        { "type": "capsule", "capsule": { "radiusTop": 0.2, "radiusBottom": 0.4, "height": 1 } }]);
    let (mut whole, data) = taken_apart(&glb(&nodes, &more(&nodes, &bodies, &solids)));
    whole["buffers"][0]["uri"] = "a.bin".into();
    let text = serde_json::to_vec(&whole).unwrap();
    let mut uniform = Uniform(11);
    let mut refused = 0;
    for _ in 0..800 {
        let mut bytes = text.clone();
        for _ in 0..=uniform.below(2) {
            let (at, more) = (uniform.below(bytes.len() - 40), uniform.below(12));
            match uniform.below(4) {
                0 => drop(bytes.drain(at..at + more)),
                1 => bytes.extend_from_within(at..at + more),
                _ => {
                    // Numbers are what damage that is not found at once changes.
                    let digit = (at..bytes.len()).find(|&at| bytes[at].is_ascii_digit()).unwrap_or(at);
                    bytes[digit] = b"0123456789-e."[uniform.below(13)];
                }
            }
        }
        let mut files = Assets::default();
        files.insert("a.gltf", bytes);
        files.insert("a.bin", data.as_slice());
        refused += usize::from(import::scenario("a.gltf", false, None, &files).is_err());
    }
    assert!((200..800).contains(&refused), "{refused}");
}
