//! What the bodies of a model in MJCF or URDF become in a world.
//!
//! As in MuJoCo, a body without joints is part of the body that it belongs to, and one without joints up to the world
//! stands still. A mesh becomes its convex hull.

use super::ImportError;
use super::axes::Along;
use super::contact::Contact;
use super::geoms::{Geoms, Shaped};
use super::inertia::together;
use super::numbers::{joined, number};
use super::things::{Held, Inertia, Piece, Role, Shape, Thing, Things};
use crate::files::{Files, inside};
use glam::{DMat3, DVec3};
use plaus_asset::model::{Body, Joint, JointKind, Model};
use std::collections::BTreeMap;

/// The things of a model.
pub(super) fn things(
    path: &str,
    anywhere: bool,
    bytes: &[u8],
    files: &dyn Files,
) -> Result<Things<'static>, ImportError> {
    let folder = path.rfind(['/', '\\']).map_or("", |end| &path[..=end]);
    let open = |file: &str| {
        let file = joined(folder, file);
        inside(&file, anywhere)?;
        files.bytes(&file, anywhere).map(|bytes| bytes.to_vec())
    };
    let model = plaus_asset::read_model(bytes, &mut { open })?;
    let mut maker = Maker::new(&model, Geoms::new(&model, folder, anywhere, &open)?);
    for body in 0..model.bodies.len() {
        maker.decide(body);
    }
    maker.scenery();
    for body in 1..model.bodies.len() {
        maker.body(body);
    }
    Ok(maker.finish())
}

/// How a body moves in the one that it belongs to.
#[derive(Debug, Clone)]
enum Moves {
    /// Not at all: it is part of it.
    Not,
    Freely,
    /// As joints of this kind let it, at this place.
    By(Option<String>, DVec3, String),
}

struct Maker<'a> {
    model: &'a Model,
    geoms: Geoms<'a>,
    moves: Vec<Moves>,
    /// The body that each is part of; 0 for what stands still.
    owners: Vec<usize>,
    /// The thing that each body became.
    made: BTreeMap<usize, usize>,
    things: Things<'static>,
}

impl<'a> Maker<'a> {
    fn new(model: &'a Model, geoms: Geoms<'a>) -> Self {
        let mut things = Things::empty();
        (things.left_out, things.harmless) = (model.left_out.clone(), model.harmless.clone());
        things.gravity(model.gravity);
        Self { model, geoms, moves: Vec::new(), owners: Vec::new(), made: BTreeMap::new(), things }
    }

    fn leave(&mut self, name: &str, what: impl std::fmt::Display) {
        self.things.left_out.push(format!("{name}: {what}"));
    }

    /// Whether a body moves by itself, and what it is part of if not.
    fn decide(&mut self, index: usize) {
        let body = &self.model.bodies[index];
        let (mut moves, left_out) = moves(&body.joints);
        left_out.into_iter().for_each(|what| self.leave(&body.name, what));
        if body.is_mocap {
            self.leave(&body.name, "mocap: it stands still, as nothing outside moves it");
            moves = Moves::Not;
        }
        if !matches!(moves, Moves::Not) && !self.geoms.has_shape(&self.parts_below(index)) {
            self.leave(&body.name, "its joints: it has neither a shape nor a mass");
            moves = Moves::Not;
        }
        if body.gravcomp != 0.0 && matches!(moves, Moves::Not) {
            self.leave(&body.name, "its gravcomp: it is a part of something");
        }
        let above = if index == 0 { 0 } else { self.owners[body.parent] };
        self.owners.push(if matches!(moves, Moves::Not) { above } else { index });
        self.moves.push(moves);
    }

    /// The bodies that are parts of a body if it moves by itself: those below it without joints.
    fn parts_below(&self, index: usize) -> Vec<usize> {
        let mut parts = vec![index];
        for (other, body) in self.model.bodies.iter().enumerate().skip(index + 1) {
            if body.joints.is_empty() && parts.contains(&body.parent) {
                parts.push(other);
            }
        }
        parts
    }

    /// What stands still: each shape is a thing.
    fn scenery(&mut self) {
        for (body, _) in self.owners.iter().enumerate().filter(|(_, owner)| **owner == 0) {
            for shaped in self.geoms.of(body) {
                let name = shaped.name.as_deref().unwrap_or(&self.model.bodies[body].name);
                let mut thing = Thing::new(name, Role::Fixed, shaped.shape.clone());
                (thing.at, thing.turn, thing.colour) = (shaped.at * 1e3, shaped.turn, shaped.colour);
                thing.contact = shaped.friction.map(Contact::of_mujoco);
                self.things.all.push(thing);
            }
        }
    }

    /// What moves by itself, with all its parts.
    fn body(&mut self, index: usize) {
        let (body, moves) = (&self.model.bodies[index], self.moves[index].clone());
        if matches!(moves, Moves::Not) {
            return;
        }
        let parts: Vec<usize> = (index..self.owners.len()).filter(|&part| self.owners[part] == index).collect();
        let mut shaped: Vec<Shaped> = parts.iter().flat_map(|&part| self.geoms.of(part).cloned()).collect();
        if shaped.iter().any(|one| one.reach.is_infinite()) {
            self.leave(&body.name, "its plane: what moves cannot have one");
            shaped.retain(|one| one.reach.is_finite());
        }
        if shaped.is_empty() {
            shaped = self.ghost(body, &parts);
        }
        let inertia = self.inertia(body, &parts);
        let friction = shaped.iter().filter_map(|one| one.friction).reduce(f64::max);
        if let Some(largest) = friction.filter(|_| shaped.iter().any(|one| one.friction != friction)) {
            self.leave(&body.name, format!("the friction of each shape: all have the largest, {}", number(largest)));
        }
        let densest = shaped.iter().map(|one| one.density).fold(0.0, f64::max);
        let back = body.turn.inverse();
        let piece = |one: &Shaped| Piece {
            shape: one.shape.clone(),
            at: still(back * (one.at - body.at)),
            turn: back * one.turn,
            density: if densest > 0.0 { (one.density / densest).clamp(1e-6, 1.0) } else { 1.0 },
        };
        let shape = Shape::of_pieces(shaped.iter().map(piece).collect());
        let mut thing = Thing::new(&body.name, Role::Body, shape);
        (thing.at, thing.turn, thing.colour) = (body.at * 1e3, body.turn, shaped.iter().find_map(|one| one.colour));
        thing.mass = Some(parts.iter().map(|&part| self.geoms.mass(part)).sum()).filter(|mass| *mass > 0.0);
        if thing.mass.is_none() {
            self.leave(&body.name, "that it has no mass: it has the density of water");
        }
        thing.inertia = inertia;
        thing.contact = friction.map(Contact::of_mujoco);
        if body.gravcomp != 0.0 {
            thing.lines.push(format!("gravity_scale = {}", number(1.0 - body.gravcomp)));
        }
        if self.model.passes_itself {
            thing.no_contact = vec!["robot".into()];
        }
        let here = self.things.all.len();
        self.made.insert(index, here);
        self.things.all.push(thing);
        if let Moves::By(name, at, kind) = moves {
            let to = self.made.get(&self.owners[body.parent]).copied();
            let name = name.unwrap_or_else(|| format!("{}_joint", body.name));
            self.things.joints.push(Held { name, body: here, to, at: at * 1e3, kind });
        }
    }

    /// Where the mass of a body with these parts is, if the model says it of all that weigh anything.
    fn inertia(&mut self, body: &Body, parts: &[usize]) -> Inertia {
        let model = self.model;
        let said: Vec<usize> = parts.iter().copied().filter(|&part| model.bodies[part].mass.is_some()).collect();
        if parts.iter().any(|part| !said.contains(part) && self.geoms.mass(*part) > 0.0) {
            for part in said {
                self.leave(&model.bodies[part].name, "its centre of mass and inertia: its shapes give them");
            }
            return Inertia::default();
        }
        let back = DMat3::from_quat(body.turn.inverse());
        let all = said.into_iter().filter_map(|part| model.bodies[part].mass).filter(|own| own.mass > 0.0);
        let all = all.map(|own| (own.mass, back * (own.at - body.at), back * own.tensor * back.transpose()));
        let all: Vec<(f64, DVec3, DMat3)> = all.collect();
        if all.is_empty() { Inertia::default() } else { together(&all) }
    }

    /// A shape for what moves without one that can touch anything: its other shapes, or else a ball of its mass and
    /// mean moment of inertia.
    fn ghost(&mut self, body: &Body, parts: &[usize]) -> Vec<Shaped> {
        let unseen: Vec<Shaped> = parts.iter().flat_map(|&part| self.geoms.untouchable(part).cloned()).collect();
        if !unseen.is_empty() {
            self.leave(&body.name, "that it can touch nothing: here it can");
            return unseen;
        }
        let heavy = parts.iter().find_map(|&part| self.model.bodies[part].mass);
        let Some(heavy) = heavy.filter(|heavy| heavy.mass > 0.0) else { return Vec::new() };
        let trace = heavy.tensor.x_axis.x + heavy.tensor.y_axis.y + heavy.tensor.z_axis.z;
        let radius = (2.5 / 3.0 * trace / heavy.mass).sqrt().clamp(1e-3, 10.0);
        self.leave(&body.name, format!("that it has no shape: a ball of {} mm of its mass", number(1e3 * radius)));
        vec![Shaped::ball(radius, heavy.at)]
    }

    fn finish(mut self) -> Things<'static> {
        self.things.left_out.extend(self.geoms.left_out());
        self.things.name_all();
        self.things.sway_with_joints();
        if let Some(ends) = self.geoms.ends() {
            self.things.ends = ends;
        }
        self.things
    }
}

/// Zero instead of a rounding error: less than a millionth of a micrometre.
fn still(at: DVec3) -> DVec3 {
    if at.length() < 1e-12 { DVec3::ZERO } else { at }
}

/// How joints let a body move, and what of them is left out.
fn moves(joints: &[Joint]) -> (Moves, Vec<String>) {
    let mut left_out = Vec::new();
    if joints.is_empty() {
        return (Moves::Not, left_out);
    }
    let of = |kind: JointKind| joints.iter().filter(move |joint| joint.kind == kind);
    let (balls, hinges, slides) =
        (of(JointKind::Ball).count(), of(JointKind::Hinge).count(), of(JointKind::Slide).count());
    if let Some(free) = of(JointKind::Free).next() {
        if is_sprung(free) {
            left_out.push("the spring and damping of its free joint".into());
        }
        return (Moves::Freely, left_out);
    }
    if slides >= 3 && (balls > 0 || hinges >= 3) {
        let springs = if joints.iter().any(is_sprung) { ", without springs and damping" } else { "" };
        left_out.push(format!("its {} joints: it is free{springs}", joints.len()));
        return (Moves::Freely, left_out);
    }
    let along = |joint: &Joint| Along {
        slides: joint.kind == JointKind::Slide,
        limits: joint.limits,
        friction: joint.friction,
        spring: joint.spring,
        motor: None,
    };
    if let (Some(first), true) = (of(JointKind::Slide).next(), slides == joints.len()) {
        if slides > 1 {
            left_out.push(format!("{} of its {slides} slide joints", slides - 1));
        }
        let kind = along(first).joint(first.axis, &mut left_out);
        return (Moves::By(first.name.clone(), first.at, kind), left_out);
    }
    if slides > 0 {
        left_out.push(format!("what slides: its {slides} slide joint{}", if slides == 1 { "" } else { "s" }));
    }
    if let Some(ball) = of(JointKind::Ball).next() {
        if ball.limits.is_some() || ball.friction > 0.0 {
            left_out.push("the limits and friction of its ball joint".into());
        }
        if is_sprung(ball) {
            left_out.push("the spring and damping of its ball joint".into());
        }
        if hinges > 0 {
            left_out.push(format!("its {hinges} hinges beside its ball joint"));
        }
        return (Moves::By(ball.name.clone(), ball.at, "{ ball = {} }".into()), left_out);
    }
    let hinged: Vec<&Joint> = of(JointKind::Hinge).collect();
    match hinged[..] {
        [] => (Moves::Not, left_out),
        [one] => {
            let kind = along(one).joint(one.axis, &mut left_out);
            (Moves::By(one.name.clone(), one.at, kind), left_out)
        }
        [first, ..] if hinged.iter().all(|joint| joint.at.distance(first.at) < 1e-9) => {
            left_out
                .push(format!("the axes, limits and friction of its {hinges} hinges: together they are a ball joint"));
            if hinged.iter().any(|joint| is_sprung(joint)) {
                left_out.push(format!("the springs and damping of its {hinges} hinges"));
            }
            (Moves::By(first.name.clone(), first.at, "{ ball = {} }".into()), left_out)
        }
        [first, ..] => {
            left_out.push(format!("{} of its {hinges} hinges, which are in different places", hinges - 1));
            let kind = along(first).joint(first.axis, &mut left_out);
            (Moves::By(first.name.clone(), first.at, kind), left_out)
        }
    }
}

fn is_sprung(joint: &Joint) -> bool {
    joint.spring[0] > 0.0 || joint.spring[2] > 0.0
}
