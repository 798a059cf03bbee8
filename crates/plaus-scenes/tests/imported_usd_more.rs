//! Worlds from USD with UsdPhysics: meshes, joints, filters, composition, what is seen, and what is refused.

use crate::imported::is_left_out;
use crate::imported_usd::{BODY, HEAD, list, made, made_of, named, number, prim, vector};
use glam::DVec3;
use plaus_scenes::{Assets, import};
use std::f64::consts::PI;

fn error(name: &str, text: &[u8]) -> String {
    let mut files = Assets::default();
    files.insert(name, text);
    import::scenario(name, false, None, &files).unwrap_err().to_string()
}

/// The corners and faces of a box of these sizes, with every polygon once.
fn cuboid(x: f64, y: f64, z: f64) -> String {
    let corner = |k: u32| {
        let side = |bit: u32, size: f64| if k >> bit & 1 == 1 { 0.5 * size } else { -0.5 * size };
        format!("({}, {}, {})", side(0, x), side(1, y), side(2, z))
    };
    let corners: Vec<String> = (0..8).map(corner).collect();
    format!(
        "point3f[] points = [{}]\nint[] faceVertexCounts = [4, 4, 4, 4, 4, 4]\nint[] faceVertexIndices = [0, 4, 6, 2, \
         1, 3, 7, 5, 0, 1, 5, 4, 2, 6, 7, 3, 0, 2, 3, 1, 4, 5, 7, 6]\n",
        corners.join(", ")
    )
}

/// Meshes are read as their approximations say, and either way round; what is only seen is left out beside bodies, and
/// colliders count even if they are not seen.
#[test]
fn meshes_are_approximated_as_they_say() {
    let mesh = |name: &str, approximation: &str, x: f64, lines: &str| {
        let lines = format!("uniform token physics:approximation = \"{approximation}\"\n{lines}");
        prim("Mesh", name, &format!("{BODY}, \"PhysicsMeshCollisionAPI\""), [x, 0.0, 2.0], &lines)
    };
    let wedge = "point3f[] points = [(0, 0, 0), (0.1, 0, 0), (0, 0.2, 0), (0, 0, 0.3)]\nint[] faceVertexCounts = [3, 3, \
                 3, 3]\nint[] faceVertexIndices = [0, 1, 2, 0, 3, 1, 0, 2, 3, 1, 3, 2]\nuniform token orientation = \
                 \"leftHanded\"\n";
    let text = [
        HEAD.to_owned(),
        mesh("cube", "boundingCube", 0.0, wedge),
        mesh("ball", "boundingSphere", 1.0, &cuboid(0.1, 0.2, 0.2)),
        mesh("hull", "convexHull", 2.0, wedge),
        mesh("simple", "meshSimplification", 3.0, &cuboid(0.1, 0.2, 0.3)),
        prim(
            "Mesh",
            "stand",
            "\"PhysicsCollisionAPI\"",
            [0.0, 0.0, 0.0],
            &format!("token visibility = \"invisible\"\n{}", cuboid(9.0, 9.0, 0.1)),
        ),
        prim("Mesh", "seen", "\"MaterialBindingAPI\"", [0.0, 0.0, 9.0], &cuboid(1.0, 1.0, 1.0)),
    ]
    .concat();
    let (made, table) = made(&text);
    let cube = named(&table, "bodies", "cube");
    assert!(vector(&cube["shape"]["box"]["size_mm"]).distance(DVec3::new(100.0, 200.0, 300.0)) < 1e-3);
    assert!(vector(&cube["at_mm"]).distance(DVec3::new(50.0, 100.0, 2150.0)) < 1e-3, "{}", made.text);
    let ball = named(&table, "bodies", "ball");
    assert!((number(&ball["shape"]["ball"]["radius_mm"]) - 150.0).abs() < 1e-3);
    assert!(named(&table, "bodies", "hull")["shape"].get("hull_of").is_some());
    assert!(named(&table, "bodies", "simple")["shape"].get("box").is_some());
    assert!(named(&table, "fixed", "stand")["shape"].get("box").is_some());
    assert!(list(&table, "fixed").iter().all(|fixed| fixed["name"].as_str() != Some("seen")));
    assert_eq!(made.left_out.len(), 1, "{:?}", made.left_out);
    is_left_out(&made, "/simple: the simplification of its mesh");
    is_left_out(&made, "1 shape that nothing can touch");
}

/// Joints hold what the schemas say: limits in degrees, springs and motors of drives, with their units.
#[test]
fn joints_hold_what_they_say() {
    let joint = |kind: &str, name: &str, lines: &str| {
        format!(
            "def {kind} \"{name}\" (prepend apiSchemas = [\"PhysicsDriveAPI:angular\", \"PhysicsDriveAPI:linear\"])\n{{\n{lines}\n}}\n"
        )
    };
    let ends = |a: &str, b: &str, at: [f64; 2]| {
        format!(
            "rel physics:body0 = <{a}>\nrel physics:body1 = <{b}>\npoint3f physics:localPos0 = ({}, 0, 0)\npoint3f \
             physics:localPos1 = ({}, 0, 0)\n",
            at[0], at[1]
        )
    };
    let cube = |name: &str, x: f64| prim("Cube", name, BODY, [x, 0.0, 200.0], "double size = 10");
    let text = [
        HEAD.replace("metersPerUnit = 1", "metersPerUnit = 0.01"),
        cube("a", 0.0),
        cube("b", 30.0),
        cube("c", 60.0),
        cube("d", 90.0),
        cube("e", 120.0),
        joint("PhysicsRevoluteJoint", "hinge", &(ends("/a", "/b", [15.0, -15.0]) + "uniform token physics:axis = \
            \"Y\"\nfloat physics:lowerLimit = -30\nfloat physics:upperLimit = 60\nfloat drive:angular:physics:stiffness \
            = 100\nfloat drive:angular:physics:targetPosition = 20\nfloat physics:breakForce = 100")),
        joint("PhysicsPrismaticJoint", "slide", &(ends("/b", "/c", [15.0, -15.0]) + "uniform token physics:axis = \
            \"X\"\nfloat physics:lowerLimit = -5\nfloat physics:upperLimit = 8\nfloat drive:linear:physics:damping = \
            1000\nfloat drive:linear:physics:targetVelocity = 50\nfloat drive:linear:physics:maxForce = 700")),
        joint("PhysicsSphericalJoint", "ball", &ends("/c", "/d", [15.0, -15.0])),
        joint("PhysicsFixedJoint", "weld", &ends("/d", "/e", [15.0, -15.0])),
        joint("PhysicsDistanceJoint", "rope", &(ends("/a", "/e", [0.0, 0.0]) + "float physics:maxDistance = 200")),
    ]
    .concat();
    let (made, table) = made(&text);
    let hinge = named(&table, "joints", "hinge");
    let kind = &hinge["kind"]["hinge"];
    assert!(vector(&kind["axis"]).distance(DVec3::Y) < 1e-6, "{}", made.text);
    let limits = &kind["limits_deg"];
    assert!((number(&limits[0]) + 30.0).abs() < 1e-4 && (number(&limits[1]) - 60.0).abs() < 1e-4);
    // 100 kg cm²/s² per degree.
    let stiffness = number(&kind["spring"]["stiffness_n_m_per_rad"]);
    assert!((stiffness - 0.01 * 180.0 / PI).abs() < 1e-5 && (number(&kind["spring"]["rest_deg"]) - 20.0).abs() < 1e-4);
    assert!((number(&hinge["at_mm"][2]) - 2000.0).abs() < 1e-3);
    let slide = &named(&table, "joints", "slide")["kind"]["slider"];
    assert!(vector(&slide["axis"]).distance(DVec3::X) < 1e-6);
    assert!(
        (number(&slide["limits_mm"][0]) + 50.0).abs() < 1e-2 && (number(&slide["limits_mm"][1]) - 80.0).abs() < 1e-2
    );
    let motor = &slide["motor"];
    assert!((number(&motor["most_n"]) - 7.0).abs() < 1e-6 && (number(&motor["speed_m_s"]) - 0.5).abs() < 1e-6);
    assert!(named(&table, "joints", "ball")["kind"].get("ball").is_some());
    assert!(named(&table, "joints", "weld")["kind"].get("weld").is_some());
    assert_eq!(list(&table, "joints").len(), 4);
    for what in ["/hinge: that a force of more than 100 breaks it", "rope: its joint: it fixes 0 of 3 places"] {
        is_left_out(&made, what);
    }
}

/// Pairs and groups that are filtered pass through each other.
#[test]
fn filters_keep_apart() {
    let body = |name: &str, x: f64, apis: &str, lines: &str| {
        prim("Sphere", name, &format!("{BODY}{apis}"), [x, 0.0, 5.0], &format!("double radius = 0.1\n{lines}"))
    };
    let group = |name: &str, members: &str, not: &str| {
        format!(
            "def PhysicsCollisionGroup \"{name}\" (prepend apiSchemas = [\"CollectionAPI:colliders\"])\n{{\nrel \
             collection:colliders:includes = [{members}]\nrel physics:filteredGroups = [{not}]\n}}\n"
        )
    };
    let text = [
        HEAD.to_owned(),
        body("a", 0.0, ", \"PhysicsFilteredPairsAPI\"", "rel physics:filteredPairs = </b>"),
        body("b", 1.0, "", ""),
        body("c", 2.0, "", ""),
        body("d", 3.0, "", ""),
        group("first", "</c>", "</second>"),
        group("second", "</d>", ""),
    ]
    .concat();
    let (made, table) = made(&text);
    let groups = |name: &str| -> Vec<String> {
        let body = named(&table, "bodies", name);
        let all = body.get("no_contact").and_then(toml::Value::as_array).cloned().unwrap_or_default();
        all.iter().map(|group| group.as_str().unwrap().to_owned()).collect()
    };
    let share = |a: &str, b: &str| groups(a).iter().any(|group| groups(b).contains(group));
    let all = ["a", "b", "c", "d"];
    for (k, a) in all.iter().enumerate() {
        for b in &all[k + 1..] {
            assert_eq!(share(a, b), matches!((*a, *b), ("a", "b") | ("c", "d")), "{a} {b}\n{}", made.text);
        }
    }
}

/// Layers, references, payloads, variants and instances are composed; what cannot be found is told.
#[test]
fn layers_are_composed() {
    let part = format!(
        "{HEAD}def Xform \"Part\"\n{{\n{}}}\n",
        prim("Cube", "block", BODY, [0.0, 0.0, 0.0], "double size = 0.1")
    );
    let under = "#usda 1.0\ndef Xform \"World\"\n{\ndef Xform \"two\"\n{\ndouble3 xformOp:translate = (2, 0, 1)\nuniform \
                 token[] xformOpOrder = [\"xformOp:translate\"]\n}\n}\n";
    let text = format!(
        "#usda 1.0\n(\nmetersPerUnit = 1\nupAxis = \"Z\"\nsubLayers = [@under.usda@]\n)\ndef Xform \"World\" (variants = \
         {{ string kind = \"many\" }}\nprepend variantSets = \"kind\")\n{{\ndef Xform \"one\" (instanceable = \
         true\nprepend references = @parts/part.usda@</Part>)\n{{\n{0}}}\nover \"two\" (prepend payload = \
         @parts/part.usda@</Part>)\n{{\n}}\ndef \"lost\" (prepend references = @none.usda@)\n{{\n}}\nvariantSet \"kind\" \
         = {{\n\"few\" {{\n}}\n\"many\" {{\ndef Xform \"three\" (prepend references = \
         @parts/part.usda@</Part>)\n{{\n{1}}}\n}}\n}}\n}}\n",
        "double3 xformOp:translate = (1, 0, 1)\nuniform token[] xformOpOrder = [\"xformOp:translate\"]\n",
        "double3 xformOp:translate = (3, 0, 1)\nuniform token[] xformOpOrder = [\"xformOp:translate\"]\n",
    );
    let (made, table) = made_of(&[("x/a.usda", &text), ("x/under.usda", under), ("x/parts/part.usda", &part)]);
    let mut places: Vec<f64> = list(&table, "bodies").iter().map(|body| vector(&body["at_mm"]).x.round()).collect();
    places.sort_by(f64::total_cmp);
    assert_eq!(places, [1000.0, 2000.0, 3000.0], "{}", made.text);
    is_left_out(&made, "none.usda");
}

/// Without physics all that is seen is scenery, of which some may be named as moving; solids are solids.
#[test]
fn what_is_seen_can_be_named() {
    let text = [
        HEAD.to_owned(),
        prim("Sphere", "Ball", "", [0.0, 0.0, 1.0], "double radius = 0.1"),
        prim("Mesh", "Table", "", [0.0, 0.0, 0.0], &cuboid(2.0, 1.0, 0.1)),
        prim("Cube", "Guide", "", [0.0, 0.0, 0.0], "uniform token purpose = \"guide\""),
    ]
    .concat()
    .replace("(prepend apiSchemas = [])", "");
    let mut files = Assets::default();
    files.insert("a.usda", text.as_bytes());
    let choice = import::Choice { moving: vec!["Ball".into()], ..import::Choice::default() };
    let made = import::chosen("a.usda", false, None, &choice, &files).unwrap();
    let table: toml::Table = made.text.parse().unwrap();
    let ball = named(&table, "bodies", "Ball");
    assert!((number(&ball["shape"]["ball"]["radius_mm"]) - 100.0).abs() < 1e-3, "{}", made.text);
    assert!(named(&table, "fixed", "Table")["shape"].get("box").is_some());
    assert!(list(&table, "fixed").iter().all(|one| one["name"].as_str() != Some("Guide")), "{}", made.text);
}

/// What is damaged is refused with where it is; what an engine alone knows is told.
#[test]
fn what_is_wrong_is_told() {
    let mesh = |lines: &str| format!("{HEAD}{}", prim("Mesh", "m", "\"PhysicsCollisionAPI\"", [0.0; 3], lines));
    let bad = "point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]\nint[] faceVertexCounts = [3]\n";
    for (text, what) in [
        (mesh(&format!("{bad}int[] faceVertexIndices = [0, 1, 7]")), "/m: faceVertexIndices: corner 7 does not exist"),
        (mesh(&format!("{bad}int[] faceVertexIndices = [0, 1]")), "/m: faceVertexCounts"),
        (HEAD.replace("\"Z\"", "\"X\""), "upAxis is \"X\""),
        (HEAD.replace("= 1\n", "= 0\n"), "metersPerUnit is 0"),
        (
            format!("{HEAD}def Cube \"c\"\n{{\nuniform token[] xformOpOrder = [\"xformOp:spin\"]\n}}\n"),
            "/c: xformOpOrder has xformOp:spin",
        ),
        ("#usda 1.0\ndef Mesh \"m\" {".into(), "USD"),
        ("hello".into(), "#usda 1.0"),
        (format!("#usda 1.0\n{}", "def \"a\" {".repeat(400)), "more than 220 brackets"),
    ] {
        let error = error("a.usda", text.as_bytes());
        assert!(error.contains(what), "{what}: {error}");
    }
    assert!(error("a.usdc", b"PXR-USDC\0\x0a\0\0\0\0\0\0").contains("it ends at byte"));
    assert!(error("a.usdz", b"PK").contains("no ZIP"));
    let lines = "double radius = 0.1\nfloat physxRigidBody:linearDamping = 0.5";
    let (made, _) = made(&format!("{HEAD}{}", prim("Sphere", "s", BODY, [0.0; 3], lines)));
    is_left_out(&made, "physxRigidBody:linearDamping of /s");
}
