//! USD: text, binary and packages give the same, and damaged files are refused without harm.
#![allow(clippy::unwrap_used, reason = "a test that cannot go on fails")]

use openusd::{usda, usdc, usdz};
use plaus_asset::{AssetError, read_any, usd};
use std::io::Cursor;

/// Something of every kind that is read.
const STAGE: &str = r#"#usda 1.0
(
    defaultPrim = "World"
    metersPerUnit = 0.01
    upAxis = "Z"
    startTimeCode = 0
    endTimeCode = 24
    customLayerData = { dictionary made = { string by = "hand", double[] at = [1, 2, 3] } }
)
def Xform "World" (variants = { string size = "large" }
    prepend variantSets = "size")
{
    def PhysicsScene "scene" { float physics:gravityMagnitude = 981 }
    def Material "rubber" (prepend apiSchemas = ["PhysicsMaterialAPI"])
    {
        float physics:dynamicFriction = 0.7
        token outputs:surface.connect = </World/rubber/look.outputs:surface>
        def Shader "look"
        {
            uniform token info:id = "UsdPreviewSurface"
            color3f inputs:diffuseColor = (0.5, 0.25, 0)
            token outputs:surface
        }
    }
    def Cube "table" (prepend apiSchemas = ["PhysicsCollisionAPI", "MaterialBindingAPI"])
    {
        double size = 100
        rel material:binding = </World/rubber>
    }
    def Xform "body" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsMassAPI"])
    {
        float physics:mass = 2
        vector3f physics:velocity = (10, 0, 20)
        double3 xformOp:translate = (0, 10, 150)
        quatf xformOp:orient = (0.5, 0.5, 0.5, 0.5)
        uniform token[] xformOpOrder = ["xformOp:translate", "xformOp:orient"]
        def Capsule "a" (prepend apiSchemas = ["PhysicsCollisionAPI"]) { double radius = 4 }
        def Sphere "b" (prepend apiSchemas = ["PhysicsCollisionAPI"])
        {
            double radius = 4
            float3 xformOp:scale = (1, 2, 1)
            uniform token[] xformOpOrder = ["xformOp:scale"]
        }
    }
    def Mesh "arm" (prepend apiSchemas = ["PhysicsRigidBodyAPI", "PhysicsCollisionAPI", "PhysicsMeshCollisionAPI"])
    {
        bool physics:kinematicEnabled = 1
        uniform token physics:approximation = "convexHull"
        point3f[] points = [(-5, -5, -5), (5, -5, -5), (5, 5, -5), (-5, 5, -5), (0, 0, 9), (1, 1, 8)]
        int[] faceVertexCounts = [4, 3, 3, 3, 3]
        int[] faceVertexIndices = [0, 3, 2, 1, 0, 1, 4, 1, 2, 4, 2, 3, 4, 3, 0, 4]
        double3 xformOp:rotateZYX.timeSamples = { 0: (0, 0, 0), 12: (10, 90, 20), 24: (0, 0, 90) }
        uniform token[] xformOpOrder = ["xformOp:rotateZYX"]
    }
    def PhysicsRevoluteJoint "hinge" (prepend apiSchemas = ["PhysicsDriveAPI:angular"])
    {
        rel physics:body0 = </World/table>
        rel physics:body1 = </World/body>
        float physics:lowerLimit = -30
        float drive:angular:physics:stiffness = 5
    }
    def PhysicsCollisionGroup "group" (prepend apiSchemas = ["CollectionAPI:colliders"])
    {
        rel collection:colliders:includes = </World/body>
        rel physics:filteredGroups = </World/group>
    }
    def Xform "copy" (instanceable = true
        prepend references = </World/table>) {}
    variantSet "size" = {
        "large" { def Cone "tip" (prepend apiSchemas = ["PhysicsCollisionAPI"]) { double height = 30 } }
        "small" {}
    }
}
"#;

fn packed(name: &str, bytes: &[u8]) -> Result<Vec<u8>, AssetError> {
    usd::packed(name, bytes, &mut |_| Err("there is none".into()))
}

fn binary() -> Vec<u8> {
    let mut bytes = Cursor::new(Vec::new());
    usdc::CrateWriter::write(&usda::parse(STAGE).unwrap(), &mut bytes).unwrap();
    bytes.into_inner()
}

#[test]
fn text_binary_and_packages_are_alike() {
    let truth = packed("a.usda", STAGE.as_bytes()).unwrap();
    assert!(read_any("a.glb", &truth).unwrap().object("arm").is_some());
    assert_eq!(packed("a.usd", STAGE.as_bytes()).unwrap(), truth);
    let binary = binary();
    assert_eq!(packed("a.usdc", &binary).unwrap(), truth);
    assert_eq!(packed("a.usd", &binary).unwrap(), truth);
    let mut package = Cursor::new(Vec::new());
    let mut writer = usdz::ArchiveWriter::new(&mut package);
    writer.add_layer("inside.usda", STAGE.as_bytes()).unwrap();
    writer.finish().unwrap();
    assert_eq!(packed("a.usdz", &package.into_inner()).unwrap(), truth);
    // What was read stays as it is.
    assert_eq!(packed("a.usda", &truth).unwrap(), truth);
}

/// Uniform numbers, by Knuth's linear congruential generator (MMIX).
struct Uniform(u64);

impl Uniform {
    fn below(&mut self, count: usize) -> usize {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        ((self.0 >> 33) as usize) % count.max(1)
    }
}

/// Bytes that are changed, left out, doubled or cut off end in an error or a file that can be read, never in a panic,
/// of which the thread that reads would tell.
#[test]
fn damaged_files_do_no_harm() {
    let mut uniform = Uniform(3);
    for (name, whole) in [("a.usda", STAGE.as_bytes().to_vec()), ("a.usdc", binary())] {
        let mut refused = 0;
        for _ in 0..300 {
            let mut bytes = whole.clone();
            let at = uniform.below(bytes.len());
            let more = uniform.below(12).min(bytes.len() - at);
            match uniform.below(5) {
                0 => drop(bytes.drain(at..at + more)),
                1 => bytes.extend_from_within(at..at + more),
                2 => bytes.truncate(at),
                3 => bytes[at..at + more].fill(uniform.below(256) as u8),
                _ => bytes[at] = uniform.below(256) as u8,
            }
            match packed(name, &bytes) {
                Ok(glb) => drop(read_any("a.glb", &glb)),
                Err(error) => {
                    assert!(!error.to_string().contains("gave up"), "{error}");
                    refused += 1;
                }
            }
        }
        assert!(refused > 30, "{name}: {refused}");
    }
}

fn why(text: &str) -> String {
    packed("a.usda", text.as_bytes()).unwrap_err().to_string()
}

/// Brackets are counted as the library finds them, not where a text, a path or a comment seems to hide them.
#[test]
fn brackets_that_hide_are_found() {
    let hidden = ["(\n\"\"\"\\\"\"\"\n", "#' \" \r", "(\n@'@\n", "(\n</a'b>\n", "(\n/* ' */\n"];
    for start in hidden {
        let text = format!("#usda 1.0\n{start}{}", "{a = ".repeat(300));
        assert!(why(&text).contains("brackets within each other"), "{start:?}: {}", why(&text));
    }
    for open in ["\"\"\"a", "'a", "@a", "@@@a@", "</a", "/* a", "\"\\\n\""] {
        let text = format!("#usda 1.0\n\n{open}");
        assert!(why(&text).contains("line 3: "), "{open:?}: {}", why(&text));
    }
}

/// Too few numbers, or too many, are refused, and no others.
#[test]
fn numbers_between_parentheses_are_counted() {
    let wrong = [
        "double3 xformOp:translate = (1, 2)",
        "custom point3f[] float2 = [(1, 2, 3), (1, -inf)]",
        "token float2 double3 a = (1, 2)",
        "double b = -inf double3 a = (1 2)",
        "token[] b = [] double3 a = ()",
        "quatf a.timeSamples = { 0: (1, 0, 0, 0), 1: (1, 0, 0) }",
        "matrix2d a = ((1, 2), (3))",
        "double a.spline = { 1: 2; pre (1) }",
        "double3 a (customData = { float2 b = (1, 2) }) = (\"1\", \"2\")",
    ];
    for wrong in wrong {
        let text = format!("#usda 1.0\ndef Xform \"a\" {{\n{wrong}\n}}\n");
        assert!(why(&text).contains("line 3: "), "{wrong}: {}", why(&text));
    }
    let right = r#"#usda 1.0
( "of hands" customLayerData = { float2 a = (1, 2) int[] b = [1, 2] } )
def Cube "a" (doc = "(1)" kind = "component")
{
    double3 float2 = (1, 2, inf) ("said of it")
    double3 xformOp:translate = (1, 2, 3) ( customData = { double2 c = (1, -inf) string d = "e" } )
    float2[] b.timeSamples = { 0: [(1, 2), (3, 4)], 1: None }
    matrix2d[] c = [((1, 2), (3, 4))]
    int64 d = 3 (displayName = "x")
    uniform token[] xformOpOrder = ["xformOp:translate"]
}
"#;
    packed("a.usda", right.as_bytes()).unwrap();
}

/// The JSON of a GLB as text.
fn json(text: &str) -> String {
    let glb = packed("a.usda", text.as_bytes()).unwrap();
    let length = u32::from_le_bytes(glb[12..16].try_into().unwrap()) as usize;
    String::from_utf8(glb[20..20 + length].to_vec()).unwrap()
}

/// What is not taken over is told, and flat things that move are not endless.
#[test]
fn what_is_lost_is_told() {
    let sheet = "point3f[] points = [(0, 0, 0), (1, 0, 0), (0, 1, 0)] int[] faceVertexCounts = [3]
        int[] faceVertexIndices = [0, 1, 2] uniform token physics:approximation =";
    let mesh = r#"(prepend apiSchemas = ["PhysicsCollisionAPI", "PhysicsMeshCollisionAPI", "PhysicsMassAPI"])"#;
    let text = format!(
        r#"#usda 1.0
( metersPerUnit = 0.5 )
def Xform "body" (prepend apiSchemas = ["PhysicsRigidBodyAPI"])
{{
    def Mesh "flat" {mesh} {{ {sheet} "boundingCube" float physics:mass = 2 point3f physics:centerOfMass = (1, 0, 0) }}
    def Mesh "odd" {mesh} {{ {sheet} "strange" }}
    def Plane "plane" (prepend apiSchemas = ["PhysicsCollisionAPI"]) {{}}
    def Xform "still" (prepend apiSchemas = ["PhysicsMassAPI"]) {{ float physics:mass = 3 }}
}}
def PhysicsSphericalJoint "ball" (prepend apiSchemas = ["PhysicsDriveAPI:rotX"])
{{
    rel physics:body1 = </body>
    float physics:coneAngle0Limit = 90
    uniform token drive:rotX:physics:type = "acceleration"
    float drive:rotX:physics:damping = 1
    float drive:rotX:physics:maxForce = 8
}}
"#
    );
    let json = json(&text);
    for told in [
        "/body/flat: the box around its mesh, which is flat: its own triangles are used",
        "/body/flat: its centre of mass: it is no body",
        "/body/odd: its approximation \\\"strange\\\", which is not known: its own triangles are used",
        "/body/still: its mass: it is no body",
        r#""angularAxes":[2]"#,
        r#""maxForce":2.0"#,
    ] {
        assert!(json.contains(told), "{told}: {json}");
    }
    assert!(!json.contains(r#""plane":{}"#), "{json}");
}

/// So many groups are told, not looked at two by two.
#[test]
fn too_many_groups_are_told() {
    let group = |k: usize| format!("def PhysicsCollisionGroup \"g{k}\" {{}}\n");
    let groups: String = (0..1001).map(group).collect();
    let json = json(&format!("#usda 1.0\ndef Cube \"a\" {{}}\n{groups}"));
    assert!(json.contains("1001 collision groups, more than 1000: here all touch"), "{json}");
}
