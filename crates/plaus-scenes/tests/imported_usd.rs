//! Worlds from USD with UsdPhysics: places, shapes, masses, materials and motions.

use glam::{DMat3, DQuat, DVec3};
use plaus_scenes::{Assets, import};
use std::f64::consts::PI;
use std::fmt::Write;

/// Uniform numbers from 0 to 1, by Knuth's linear congruential generator (MMIX).
struct Uniform(u64);

impl Uniform {
    fn next(&mut self) -> f64 {
        self.0 = self.0.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 11) as f64 / (1_u64 << 53) as f64
    }

    fn between(&mut self, low: f64, high: f64) -> f64 {
        // With four digits, as files have them.
        (1e4 * (low + (high - low) * self.next())).round() / 1e4
    }

    fn vector(&mut self, half: f64) -> DVec3 {
        DVec3::from_array([0; 3].map(|_| self.between(-half, half)))
    }

    fn one_of<T: Copy>(&mut self, all: &[T]) -> T {
        all[(self.next() * all.len() as f64) as usize]
    }
}

/// What is made of `files`, the first of which is imported, and its text as TOML.
pub(crate) fn made_of(files: &[(&str, &str)]) -> (import::Imported, toml::Table) {
    let mut assets = Assets::default();
    files.iter().for_each(|(name, text)| assets.insert(*name, text.as_bytes()));
    let made = import::scenario(files[0].0, false, None, &assets);
    let made = made.unwrap_or_else(|error| panic!("{error}\n{}", files[0].1));
    let table = made.text.parse().unwrap();
    (made, table)
}

pub(crate) fn made(text: &str) -> (import::Imported, toml::Table) {
    made_of(&[("a.usda", text)])
}

/// The entries of a list of a world.
pub(crate) fn list(table: &toml::Table, name: &str) -> Vec<toml::Table> {
    let world = table["world"]["custom"].as_table().unwrap();
    let all = world.get(name).and_then(toml::Value::as_array);
    all.into_iter().flatten().map(|one| one.as_table().unwrap().clone()).collect()
}

pub(crate) fn named(table: &toml::Table, list_name: &str, name: &str) -> toml::Table {
    let found = list(table, list_name).into_iter().find(|one| one["name"].as_str() == Some(name));
    found.unwrap_or_else(|| panic!("no {name} among {list_name} of {table}"))
}

/// A number, or the mean of a law.
pub(crate) fn number(value: &toml::Value) -> f64 {
    match value {
        toml::Value::Float(number) => *number,
        toml::Value::Integer(number) => *number as f64,
        other => number(&other["normal"][0]),
    }
}

pub(crate) fn vector(value: &toml::Value) -> DVec3 {
    DVec3::from_array([0, 1, 2].map(|k| number(&value[k])))
}

fn turn(thing: &toml::Table) -> DQuat {
    let [x, y, z] = thing.get("turn_deg").map_or([0.0; 3], |turn| vector(turn).to_array()).map(f64::to_radians);
    DQuat::from_rotation_z(z) * DQuat::from_rotation_y(y) * DQuat::from_rotation_x(x)
}

/// The mass that a body has by its material's density and the volume of its shape.
fn mass(table: &toml::Table, body: &toml::Table) -> f64 {
    let material = body.get("material").and_then(toml::Value::as_str);
    let density =
        material.and_then(|name| named(table, "materials", name).get("density").map(number)).unwrap_or(1000.0);
    let (kind, shape) = body["shape"].as_table().unwrap().iter().next().unwrap();
    let of = |key: &str| 1e-3 * number(&shape[key]);
    let volume = match kind.as_str() {
        "ball" => 4.0 / 3.0 * PI * of("radius_mm").powi(3),
        "box" => 1e-9 * vector(&shape["size_mm"]).element_product(),
        "cylinder" => PI * of("radius_mm").powi(2) * of("height_mm"),
        "cone" => PI / 3.0 * of("radius_mm").powi(2) * of("height_mm"),
        "capsule" => PI * of("radius_mm").powi(2) * (of("length_mm") + 4.0 / 3.0 * of("radius_mm")),
        other => panic!("{other}"),
    };
    density * volume
}

/// An operation, as a stage has it and as it moves a point.
enum Op {
    Translate(DVec3),
    Scale(f64),
    /// Degrees about x, y, z, and the order of the axes.
    Euler(DVec3, [usize; 3]),
    Orient(DQuat),
    Matrix(DMat3, DVec3),
    /// A rotation about z by degrees, about a pivot.
    Pivot(f64, DVec3),
}

fn about(axis: usize, degrees: f64) -> DQuat {
    DQuat::from_axis_angle(DVec3::AXES[axis], degrees.to_radians())
}

impl Op {
    fn random(uniform: &mut Uniform, far: f64) -> Self {
        let turn = |uniform: &mut Uniform| DQuat::from_scaled_axis(uniform.vector(2.0));
        match (uniform.next() * 6.0) as u32 {
            0 => Self::Translate(uniform.vector(far)),
            1 => Self::Scale(uniform.between(0.8, 1.25)),
            2 => {
                let orders = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];
                Self::Euler(uniform.vector(170.0), uniform.one_of(&orders))
            }
            3 => Self::Orient(turn(uniform)),
            4 => Self::Matrix(DMat3::from_quat(turn(uniform)), uniform.vector(far)),
            _ => Self::Pivot(uniform.between(-170.0, 170.0), uniform.vector(far)),
        }
    }

    /// Where it moves a point; `is_twin` turns about the axes in the opposite order.
    fn moved(&self, p: DVec3, is_twin: bool) -> DVec3 {
        match self {
            Self::Translate(by) => p + *by,
            Self::Scale(by) => p * *by,
            Self::Euler(degrees, order) => {
                let mut order = *order;
                if is_twin {
                    order.reverse();
                }
                order.iter().fold(p, |p, &axis| about(axis, degrees[axis]) * p)
            }
            Self::Orient(turn) => *turn * p,
            Self::Matrix(turn, by) => *turn * p + *by,
            Self::Pivot(degrees, at) => about(2, *degrees) * (p - *at) + *at,
        }
    }

    /// Its lines, and its names in the order.
    fn said(&self, number: usize) -> (String, Vec<String>) {
        let v = |v: DVec3| format!("({}, {}, {})", v.x, v.y, v.z);
        let one = |kind: &str, name: &str, value: String| {
            let name = format!("xformOp:{name}:n{number}");
            (format!("{kind} {name} = {value}\n"), vec![name])
        };
        match self {
            Self::Translate(by) => one("double3", "translate", v(*by)),
            Self::Scale(by) => one("double3", "scale", v(DVec3::splat(*by))),
            Self::Euler(degrees, order) => {
                let letters: String = order.iter().map(|&axis| ['X', 'Y', 'Z'][axis]).collect();
                one("double3", &format!("rotate{letters}"), v(*degrees))
            }
            Self::Orient(q) => one("quatd", "orient", format!("({}, {}, {}, {})", q.w, q.x, q.y, q.z)),
            Self::Matrix(turn, by) => {
                let row = |v: DVec3, w: u32| format!("({}, {}, {}, {w})", v.x, v.y, v.z);
                let rows = [row(turn.x_axis, 0), row(turn.y_axis, 0), row(turn.z_axis, 0), row(*by, 1)];
                one("matrix4d", "transform", format!("({})", rows.join(", ")))
            }
            Self::Pivot(degrees, at) => {
                let pivot = format!("xformOp:translate:pivot{number}");
                let (turn, names) = one("double", "rotateZ", degrees.to_string());
                let names = vec![pivot.clone(), names[0].clone(), format!("!invert!{pivot}")];
                (format!("double3 {pivot} = {}\n{turn}", v(*at)), names)
            }
        }
    }
}

/// The lines of operations.
fn ops(all: &[Op]) -> String {
    let (mut text, mut order) = (String::new(), Vec::new());
    for (number, op) in all.iter().enumerate() {
        let (lines, names) = op.said(number);
        text += &lines;
        order.extend(names.iter().map(|name| format!("{name:?}")));
    }
    text + &format!("uniform token[] xformOpOrder = [{}]\n", order.join(", "))
}

/// Of USD, along its axes, z up.
fn upright(p: DVec3, is_z_up: bool) -> DVec3 {
    if is_z_up { p } else { DVec3::new(p.x, -p.z, p.y) }
}

/// The place, the sizes and the mass of every solid are those that all operations above it give, in any unit, with
/// either axis up; so is the direction of its axis. A twin that turns about three axes in the opposite order is caught.
#[test]
fn solids_are_where_all_operations_place_them() {
    let mut uniform = Uniform(11);
    let mut caught = 0;
    for _ in 0..60 {
        let unit = uniform.one_of(&[1.0, 0.01, 0.001]);
        let kilogram = uniform.one_of(&[1.0, 0.001]);
        let is_z_up = uniform.one_of(&[true, false]);
        let far = 1.0 / unit;
        let above: Vec<Op> = (0..3).map(|_| Op::random(&mut uniform, far)).collect();
        let own: Vec<Op> = (0..4).map(|_| Op::random(&mut uniform, far)).collect();
        let kind = uniform.one_of(&["Cube", "Sphere", "Cylinder", "Cone", "Capsule"]);
        let axis = (uniform.next() * 3.0) as usize;
        let [radius, height, mass_said] = [0.3, 1.0, 20.0].map(|most| uniform.between(0.3 * most, most));
        let by_density = uniform.one_of(&[true, false]);
        let said = if by_density {
            format!("float physics:density = {}", mass_said * 500.0 * unit.powi(3) / kilogram)
        } else {
            format!("float physics:mass = {}", mass_said / kilogram)
        };
        let mut text = format!("#usda 1.0\n(\nmetersPerUnit = {unit}\nkilogramsPerUnit = {kilogram}\n");
        let _ = writeln!(text, "upAxis = \"{}\"\n)\ndef Xform \"World\"\n{{", if is_z_up { "Z" } else { "Y" });
        text += &ops(&above);
        let _ = writeln!(
            text,
            "def {kind} \"thing\" (prepend apiSchemas = [\"PhysicsRigidBodyAPI\", \"PhysicsCollisionAPI\", \
             \"PhysicsMassAPI\"])\n{{\n{said}\ndouble radius = {}\ndouble height = {}\ndouble size = {}\nuniform token \
             axis = \"{}\"\n{}}}\n}}",
            radius / unit,
            height / unit,
            height / unit,
            ["X", "Y", "Z"][axis],
            ops(&own)
        );
        let place = |p: DVec3, is_twin: bool| {
            let all = above.iter().chain(&own).rev();
            unit * upright(all.fold(p, |p, op| op.moved(p, is_twin)), is_z_up)
        };
        let scale: f64 = above.iter().chain(&own).map(|op| if let Op::Scale(by) = op { *by } else { 1.0 }).product();
        let (made, table) = made(&text);
        let body = named(&table, "bodies", "thing");
        let fits = |is_twin: bool| {
            let at = 1e-3 * vector(&body["at_mm"]);
            let truth = place(DVec3::ZERO, is_twin);
            let axis = (place(DVec3::AXES[axis], is_twin) - truth).normalize();
            let mut off = (turn(&body) * DVec3::Z).distance(axis);
            if matches!(kind, "Cylinder" | "Capsule") {
                off = off.min((turn(&body) * DVec3::Z).distance(-axis));
            }
            // Of single precision, through two levels.
            at.distance(truth) < 2e-6 * (1.0 + truth.length()) && (matches!(kind, "Cube" | "Sphere") || off < 2e-6)
        };
        assert!(fits(false), "{text}\n{}", made.text);
        caught += usize::from(!fits(true));
        let (name, shape) = body["shape"].as_table().unwrap().iter().next().unwrap();
        let expected = ["box", "ball", "cylinder", "cone", "capsule"];
        let kinds = ["Cube", "Sphere", "Cylinder", "Cone", "Capsule"];
        assert_eq!(kinds.iter().position(|known| *known == kind), expected.iter().position(|known| known == name));
        let size = if kind == "Cube" { number(&shape["size_mm"][1]) } else { number(&shape["radius_mm"]) };
        let truth = 1e3 * scale * if kind == "Cube" { height } else { radius };
        assert!((size / truth - 1.0).abs() < 1e-5, "{size} {truth}\n{text}");
        let volume = mass(&table, &body) / 1000.0 * if by_density { 1000.0 / (500.0 * mass_said) } else { 1.0 };
        let mass = mass(&table, &body);
        let truth = if by_density { 500.0 * mass_said * volume } else { mass_said };
        assert!((mass / truth - 1.0).abs() < 1e-5, "{mass} {truth}\n{text}\n{}", made.text);
        assert!(made.left_out.is_empty(), "{:?}", made.left_out);
    }
    assert!(caught > 10, "{caught}");
}

pub(crate) const HEAD: &str = "#usda 1.0\n(\nmetersPerUnit = 1\nupAxis = \"Z\"\n)\n";
pub(crate) const BODY: &str = "\"PhysicsRigidBodyAPI\", \"PhysicsCollisionAPI\"";

/// A prim of a kind with these schemas, at a place, with these lines.
pub(crate) fn prim(kind: &str, name: &str, apis: &str, at: [f64; 3], lines: &str) -> String {
    let [x, y, z] = at;
    format!(
        "def {kind} \"{name}\" (prepend apiSchemas = [{apis}])\n{{\ndouble3 xformOp:translate = ({x}, {y}, {z})\nuniform \
         token[] xformOpOrder = [\"xformOp:translate\"]\n{lines}\n}}\n"
    )
}

/// Gravity, velocities, centres of mass, inertia, and friction by the binding for physics before the others.
#[test]
fn bodies_are_as_the_schemas_say() {
    let material = |name: &str, friction: f64| {
        format!(
            "def Material \"{name}\" (prepend apiSchemas = [\"PhysicsMaterialAPI\"])\n{{\nfloat physics:staticFriction = \
             0.9\nfloat physics:dynamicFriction = {friction}\nfloat physics:restitution = 0.25\n}}\n"
        )
    };
    let text = format!(
        "{HEAD}def PhysicsScene \"scene\"\n{{\nvector3f physics:gravityDirection = (0, 0, -2)\nfloat \
         physics:gravityMagnitude = 3.7\n}}\n{}{}{}{}{}",
        material("a", 0.3),
        material("b", 0.6),
        prim(
            "Cube",
            "one",
            &format!("{BODY}, \"PhysicsMassAPI\", \"MaterialBindingAPI\""),
            [0.0, 0.0, 3.0],
            "double size = 0.2\nvector3f physics:velocity = (1, 2, 3)\nvector3f physics:angularVelocity = (0, 90, \
             0)\nfloat physics:mass = 4\npoint3f physics:centerOfMass = (0, 0.02, 0)\nfloat3 physics:diagonalInertia = \
             (0.01, 0.02, 0.025)\nrel material:binding = </b>\nrel material:binding:physics = </a>\ncolor3f[] \
             primvars:displayColor = [(1, 0, 0)]"
        ),
        prim(
            "Sphere",
            "two",
            &format!("{BODY}, \"MaterialBindingAPI\""),
            [2.0, 0.0, 3.0],
            "double radius = 0.1\nrel material:binding = </b>"
        ),
        prim("Plane", "ground", "\"PhysicsCollisionAPI\"", [0.0, 0.0, 0.5], ""),
    );
    let (made, table) = made(&text);
    assert!(made.left_out.is_empty(), "{:?}", made.left_out);
    assert_eq!(number(&table["world"]["custom"]["gravity"]), 3.7);
    let one = named(&table, "bodies", "one");
    assert_eq!(vector(&one["velocity_m_s"]), DVec3::new(1.0, 2.0, 3.0));
    assert_eq!(vector(&one["spin_deg_s"]), DVec3::new(0.0, 90.0, 0.0));
    assert_eq!(one["colour"].as_str(), Some("#ff0000"));
    assert!((mass(&table, &one) - 4.0).abs() < 1e-9);
    assert!(made.text.contains("centre_mm = [0, 20, 0]"), "{}", made.text);
    let frictions = ["one", "two"].map(|name| {
        let body = named(&table, "bodies", name);
        let material = named(&table, "materials", body["material"].as_str().unwrap());
        [number(&material["friction"]), number(&material["static_friction"]), number(&material["restitution"])]
    });
    assert_eq!(frictions, [[0.3, 0.9, 0.25], [0.6, 0.9, 0.25]]);
    let ground = named(&table, "fixed", "ground");
    assert!(ground["shape"].get("plane").is_some());
    assert_eq!(vector(&ground["at_mm"]), DVec3::new(0.0, 0.0, 500.0));
}

/// Without a number of its own gravity is that of the earth, down the axis that points up; with a prim of physics, two
/// colliders of one body weigh what their densities give them, and the centre of mass is theirs.
#[test]
fn densities_of_colliders_add_up() {
    let part = |name: &str, at: f64, density: f64| {
        prim(
            "Cube",
            name,
            "\"PhysicsCollisionAPI\", \"PhysicsMassAPI\"",
            [at, 0.0, 0.0],
            &format!("double size = 0.1\nfloat physics:density = {density}"),
        )
    };
    let parts = part("light", -0.05, 500.0) + &part("heavy", 0.05, 3500.0);
    let body = prim("Xform", "two", "\"PhysicsRigidBodyAPI\"", [0.0, 0.0, 1.0], &parts);
    let (made, table) = made(&format!("{HEAD}def PhysicsScene \"scene\"\n{{\n}}\n{body}"));
    assert_eq!(number(&table["world"]["custom"]["gravity"]), 9.81);
    let two = named(&table, "bodies", "two");
    let pieces = two["shape"]["compound"]["pieces"].as_array().unwrap();
    let density = named(&table, "materials", two["material"].as_str().unwrap());
    let shares: Vec<f64> = pieces.iter().map(|piece| piece.get("density").map_or(1.0, number)).collect();
    let heaviest = number(&density["density"]);
    assert!(
        (heaviest * shares[0] - 500.0).abs() < 0.01 && (heaviest * shares[1] - 3500.0).abs() < 0.01,
        "{}",
        made.text
    );
}

/// What time samples turn about three axes at once is, between keys too, within 0.1 mm of where the stage has it. A
/// twin that turns straight from one sample to the next is caught.
#[test]
fn time_samples_become_keyframes() {
    let samples: [(f64, DVec3); 3] =
        [(24.0, DVec3::ZERO), (48.0, DVec3::new(80.0, -60.0, 120.0)), (96.0, DVec3::new(-100.0, 40.0, 30.0))];
    let each = samples.map(|(code, v)| format!("{code}: ({}, {}, {}),", v.x, v.y, v.z)).join(" ");
    let arm = format!(
        "def Cube \"arm\" (prepend apiSchemas = [{BODY}])\n{{\nbool physics:kinematicEnabled = 1\ndouble size = \
         0.4\ndouble3 xformOp:rotateXYZ.timeSamples = {{ {each} }}\nuniform token[] xformOpOrder = \
         [\"xformOp:rotateXYZ\"]\n}}\n"
    );
    let parent = format!(
        "def Xform \"lift\"\n{{\ndouble3 xformOp:translate.timeSamples = {{ 24: (0, 0, 1), 96: (0, 0, 4) }}\nuniform \
         token[] xformOpOrder = [\"xformOp:translate\"]\n{arm}}}\n"
    );
    let head = HEAD.replace(")\n", "startTimeCode = 24\nendTimeCode = 96\ntimeCodesPerSecond = 24\n)\n");
    let (made, table) = made(&format!("{head}{parent}"));
    let arm = named(&table, "driven", "arm");
    let keys: Vec<(f64, DVec3, DQuat)> = arm["keys"]
        .as_array()
        .unwrap()
        .iter()
        .map(|key| (number(&key["at_s"]), vector(&key["at_mm"]), turn(key.as_table().unwrap())))
        .collect();
    let truth = |time: f64, is_twin: bool| {
        let code = 24.0 + 24.0 * time;
        let after = samples.iter().position(|(at, _)| *at >= code).unwrap().max(1);
        let [(a, from), (b, to)] = [samples[after - 1], samples[after]];
        let share = (code - a) / (b - a);
        let euler = |v: DVec3| about(2, v.z) * about(1, v.y) * about(0, v.x);
        let turn = if is_twin { euler(from).slerp(euler(to), share) } else { euler(from.lerp(to, share)) };
        (DVec3::new(0.0, 0.0, 1e3 * (1.0 + time)), turn)
    };
    let off = |is_twin: bool| {
        let mut worst = 0.0_f64;
        for step in 0..=3000 {
            let time = (1e-3 * f64::from(step)).min(3.0);
            let after = keys.iter().position(|key| key.0 >= time).unwrap().max(1);
            let (a, b) = (keys[after - 1], keys[after]);
            let share = (time - a.0) / (b.0 - a.0);
            let (at, turn) = truth(time, is_twin);
            let corner = DVec3::splat(200.0);
            let now = a.1.lerp(b.1, share) + a.2.slerp(b.2, share) * corner;
            worst = worst.max(now.distance(at + turn * corner));
        }
        worst
    };
    assert!(off(false) < 0.1, "{} mm\n{}", off(false), made.text);
    assert!(off(true) > 10.0);
    assert!(made.left_out.is_empty(), "{:?}", made.left_out);
}
