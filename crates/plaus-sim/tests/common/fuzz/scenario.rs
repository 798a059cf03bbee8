//! A world as the text of a scenario, for `plaus check`.

use super::form::Form;
use super::world::{DENSITY, Fixed, Mover, World, box_mesh};
use glam::{DQuat, DVec3, EulerRot};
use std::fmt::Write;

/// A scenario, and the files of triangles beside it with their names.
#[derive(Debug, Clone)]
pub struct Scenario {
    pub text: String,
    pub files: Vec<(String, String)>,
}

/// How far the first body's x is uncertain, in mm, so that there is something to sample.
const UNCERTAIN: f64 = 1e-6;

/// Shortest text that reads back as the same number.
fn number(x: f64) -> String {
    let text = format!("{x}");
    if text.contains(['.', 'e']) { text } else { format!("{text}.0") }
}

fn list(numbers: impl IntoIterator<Item = f64>) -> String {
    let all: Vec<String> = numbers.into_iter().map(number).collect();
    format!("[{}]", all.join(", "))
}

fn mm(v: DVec3) -> String {
    list((v * 1e3).to_array())
}

/// Angles about the world's x axis, then y, then z, in degrees.
fn angles(turn: DQuat) -> String {
    let (z, y, x) = turn.to_euler(EulerRot::ZYX);
    list([x, y, z].map(f64::to_degrees))
}

fn shape(form: &Form) -> String {
    let m = |x: f64| number(1e3 * x);
    match form {
        Form::Ball(r) => format!("{{ ball = {{ radius_mm = {} }} }}", m(*r)),
        Form::Cuboid { edges, rounding } if *rounding == 0.0 => format!("{{ box = {{ size_mm = {} }} }}", mm(*edges)),
        Form::Cuboid { edges, rounding } => {
            format!("{{ box = {{ size_mm = {}, rounding_mm = {} }} }}", mm(*edges), m(*rounding))
        }
        Form::Frustum { radii, height, rounding } => match (radii, rounding) {
            ([0.0, 0.0], r) => format!("{{ capsule = {{ radius_mm = {}, length_mm = {} }} }}", m(*r), m(*height)),
            ([a, 0.0], _) => format!("{{ cone = {{ radius_mm = {}, height_mm = {} }} }}", m(*a), m(*height)),
            ([a, b], _) if a == b => {
                format!("{{ cylinder = {{ radius_mm = {}, height_mm = {} }} }}", m(*a), m(*height))
            }
            // Scenarios have no frustum: this one is a frustum in the world, and a cylinder here.
            ([a, _], _) => {
                format!("{{ cylinder = {{ radius_mm = {}, height_mm = {} }} }} # a frustum", m(*a), m(*height))
            }
        },
        Form::Hull(points) => {
            let points: Vec<String> = points.iter().map(|p| mm(*p)).collect();
            format!("{{ hull = {{ points_mm = [{}] }} }}", points.join(", "))
        }
        Form::Skittle(p) => {
            let outline: Vec<String> = p.points.iter().map(|q| list(q.map(|x| 1e3 * x))).collect();
            format!(
                "{{ revolution = {{ foot_mm = {}, rim_mm = {}, outline_mm = [{}], top_mm = {} }} }}",
                m(p.foot),
                m(p.rim),
                outline.join(", "),
                m(p.top)
            )
        }
        Form::Compound(pieces) => {
            let piece = |(form, at): &(Form, DVec3)| format!("{{ shape = {}, at_mm = {} }}", shape(form), mm(*at));
            let pieces: Vec<String> = pieces.iter().map(piece).collect();
            format!("{{ compound = {{ pieces = [{}] }} }}", pieces.join(", "))
        }
    }
}

fn placed(text: &mut String, at: DVec3, turn: DQuat) {
    let _ = writeln!(text, "at_mm = {}", mm(at));
    if turn != DQuat::IDENTITY {
        let _ = writeln!(text, "turn_deg = {}", angles(turn));
    }
}

/// Triangles in an OBJ file, in m.
fn obj(edges: DVec3, n: u32) -> String {
    let (vertices, triangles) = box_mesh(edges, n);
    let v = vertices.iter().map(|v| format!("v {} {} {}\n", v.x, v.y, v.z));
    let f = triangles.iter().map(|t| format!("f {} {} {}\n", t[0] + 1, t[1] + 1, t[2] + 1));
    v.chain(f).collect()
}

fn body(text: &mut String, k: usize, mover: &Mover) {
    let at = mover.at * 1e3;
    let x =
        if k == 0 { format!("{{ uniform = {} }}", list([at.x - UNCERTAIN, at.x + UNCERTAIN])) } else { number(at.x) };
    let _ = write!(text, "\n[[world.custom.bodies]]\nname = \"body_{k}\"\nmaterial = \"m\"\n");
    let _ = writeln!(text, "shape = {}", shape(&mover.form));
    let _ = writeln!(text, "at_mm = [{x}, {}, {}]", number(at.y), number(at.z));
    if mover.turn != DQuat::IDENTITY {
        let _ = writeln!(text, "turn_deg = {}", angles(mover.turn));
    }
    if mover.velocity != DVec3::ZERO {
        let _ = writeln!(text, "velocity_m_s = {}", list(mover.velocity.to_array()));
    }
    if mover.spin != DVec3::ZERO {
        let _ = writeln!(text, "spin_deg_s = {}", list(mover.spin.to_array().map(f64::to_degrees)));
    }
}

/// The scenario of a world. `title` is its first line; files beside it get names that begin with `stem`.
pub fn scenario(world: &World, title: &str, stem: &str) -> Scenario {
    let mut text = format!("# {title}\n[world.custom]\n");
    let mut files = Vec::new();
    let _ = writeln!(text, "duration_s = {}\naccuracy = \"{}\"", number(world.until), world.preset.name());
    if world.gravity == 0.0 {
        text.push_str("gravity = 0\n");
    }
    if world.fixed.is_empty() {
        text.push_str("fixed = []\n");
    }
    let law = &world.law;
    let _ = write!(
        text,
        "\n[[world.custom.materials]]\nname = \"m\"\ndensity = {}\nfriction = {}\nrestitution = {}\nrolling = {}\n\
         spinning = {}\n",
        number(DENSITY),
        number(law.friction),
        number(law.restitution),
        number(law.rolling),
        number(law.spinning)
    );
    for (k, fixed) in world.fixed.iter().enumerate() {
        let _ = write!(text, "\n[[world.custom.fixed]]\nname = \"part_{k}\"\nmaterial = \"m\"\n");
        match fixed {
            Fixed::Plane(level) => {
                text.push_str("shape = { plane = {} }\n");
                placed(&mut text, DVec3::Z * *level, DQuat::IDENTITY);
            }
            Fixed::Table { level, bumps, spacing } => {
                text.push_str("# With bumps of its own in each draw, not those of the world that failed.\n");
                let (bumps, spacing) = (number(600.0 * bumps), number(1e3 * spacing));
                let _ = writeln!(text, "shape = {{ table = {{ bumps_mm = {bumps}, spacing_mm = {spacing} }} }}");
                placed(&mut text, DVec3::Z * *level, DQuat::IDENTITY);
            }
            Fixed::Block { at, edges } => {
                let _ = writeln!(text, "shape = {{ box = {{ size_mm = {} }} }}", mm(*edges));
                placed(&mut text, *at, DQuat::IDENTITY);
            }
            Fixed::Solid { form, at, turn } => {
                let _ = writeln!(text, "shape = {}", shape(form));
                placed(&mut text, *at, *turn);
            }
            Fixed::Mesh { edges, at, turn, n } => {
                let file = format!("{stem}-{k}.obj");
                let keys = "up = \"z\", unit_mm = 1000";
                let _ = writeln!(text, "shape = {{ mesh = {{ file = \"{file}\", {keys} }} }}");
                placed(&mut text, *at, *turn);
                files.push((file, obj(*edges, *n)));
            }
        }
    }
    for (k, mover) in world.movers.iter().enumerate() {
        body(&mut text, k, mover);
    }
    for line in &world.wanted {
        let _ = write!(text, "\n[[require]]\n{line}\n");
    }
    if world.wanted.is_empty() {
        text.push_str("\n[[require]]\nrests = { body = \"body_*\" }\n");
    }
    Scenario { text, files }
}
