//! Bodies on joints as trees: each body has one joint that leads towards a body that nothing holds, a driven body or
//! the fixed world. Its coordinates say how it has moved at that joint since a step began, so joints hold to rounding.

use super::axis::Spring;
use super::joint::{JointKind, JointRow, JointRowKind, WORLD_POSE};
use crate::rigid::RigidWorld;
use crate::rigid::step_poses::StepPoses;
use glam::{DMat3, DQuat, DVec3};

/// What a link hangs on.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Parent {
    /// Nothing: it is the root of a tree in the air.
    Nothing,
    World,
    /// A driven body, by its place.
    Driven(usize),
    /// An earlier link.
    Link(usize),
}

/// How a link can move against its parent.
#[derive(Debug, Clone, Copy, PartialEq)]
pub(crate) enum Freedom {
    /// In all ways: place and orientation, velocity and angular velocity.
    All,
    /// About an axis of its parent, or along it: an angle or a distance, and its rate. If it is damped, there is
    /// another coordinate: the work of the damper since the step began.
    Axis { axis: DVec3, slides: bool, is_damped: bool },
    /// About a point: orientation and angular velocity, both in world axes.
    Ball,
    /// Not at all.
    Weld,
}

impl Freedom {
    /// How many coordinates and rates it has.
    pub(crate) fn counts(self) -> [usize; 2] {
        match self {
            Self::All => [7, 6],
            Self::Axis { is_damped, .. } => [1 + usize::from(is_damped), 1],
            Self::Ball => [4, 3],
            Self::Weld => [0, 0],
        }
    }
}

/// A body of a tree, with its joint.
#[derive(Debug, Clone, Copy)]
pub(crate) struct Link {
    /// Its place in the island.
    pub(crate) place: usize,
    pub(crate) parent: Parent,
    pub(crate) freedom: Freedom,
    /// The first of its coordinates, and of its rates.
    pub(crate) at: [usize; 2],
    /// The joint's anchor in its own axes; zero without a joint.
    pub(crate) own: DVec3,
    /// The anchor when the step begins, in the axes of its parent.
    pub(crate) onto: DVec3,
    /// Its orientation when the step begins, as its parent sees it; of a ball, as the world sees it.
    pub(crate) rest: DQuat,
    /// The joint, and the sign with which its coordinate grows with the link's.
    pub(crate) joint: Option<(usize, f64)>,
    /// Its spring along the link's coordinate.
    pub(crate) spring: Option<Spring>,
    /// Distance in m from its anchor that it and what hangs on it reach at most.
    pub(crate) reach: f64,
}

/// The trees of an island; the links of each follow each other, parents first.
#[derive(Debug, Default)]
pub(crate) struct JointTrees {
    pub(crate) links: Vec<Link>,
    /// How many coordinates and rates they have.
    pub(crate) counts: [usize; 2],
    /// The joints, with the places of their two bodies.
    edges: Vec<(usize, usize, Option<usize>)>,
    seen: Vec<bool>,
}

impl JointTrees {
    /// Finds the trees of an island's joints; returns false if they form a loop, or if a joint does more than hold.
    pub(crate) fn find(&mut self, world: &RigidWorld, places: &[StepPoses], rows: &[JointRow]) -> bool {
        self.links.clear();
        self.edges.clear();
        self.counts = [0; 2];
        for row in rows {
            match row.part {
                JointRowKind::Point(0) => self.edges.push((row.joint, row.a, row.b)),
                JointRowKind::Point(_) | JointRowKind::Spring => {}
                JointRowKind::DryFriction | JointRowKind::Motor | JointRowKind::Stop(_) => return false,
            }
        }
        self.seen.clear();
        self.seen.extend(places.iter().map(|p| world.specs[p.body].is_driven()));
        let joints = self.edges.len();
        let is_driven = |k: usize| world.specs[places[k].body].is_driven();
        for e in 0..joints {
            let (joint, a, b) = self.edges[e];
            let (child, parent) = match b {
                None => (a, Parent::World),
                Some(b) if is_driven(b) => (a, Parent::Driven(b)),
                Some(b) if is_driven(a) => (b, Parent::Driven(a)),
                Some(_) => continue,
            };
            if self.seen[child] {
                return false;
            }
            self.grow(world, places, (child, parent, Some(joint)));
        }
        for k in 0..places.len() {
            if !self.seen[k] {
                self.grow(world, places, (k, Parent::Nothing, None));
            }
        }
        let held = self.links.iter().filter(|link| link.joint.is_some()).count();
        held == joints && self.measure(world, places)
    }

    /// Adds a body and all that hangs on it.
    fn grow(&mut self, world: &RigidWorld, places: &[StepPoses], root: (usize, Parent, Option<usize>)) {
        let mut next = self.links.len();
        self.add(world, places, root);
        while let Some(&Link { place, joint: own, .. }) = self.links.get(next) {
            for e in 0..self.edges.len() {
                let (joint, a, b) = self.edges[e];
                let Some(b) = b else { continue };
                let child = if a == place { b } else { a };
                if (a == place || b == place) && own.is_none_or(|o| o.0 != joint) && !self.seen[child] {
                    self.add(world, places, (child, Parent::Link(next), Some(joint)));
                }
            }
            next += 1;
        }
    }

    fn add(&mut self, world: &RigidWorld, places: &[StepPoses], link: (usize, Parent, Option<usize>)) {
        let (place, parent, joint) = link;
        self.seen[place] = true;
        let (mut own, mut onto, mut rest) = (DVec3::ZERO, places[place].start.x, places[place].turn);
        let (mut freedom, mut sign, mut spring) = (Freedom::All, 1.0, None);
        if let Some(joint) = joint {
            let bond = &world.joints.bonds[joint];
            let joint = &bond.joint;
            let is_damped = bond.spring().is_some_and(|spring| spring.damping > 0.0);
            let is_first = joint.body == places[place].body;
            let [inner, outer] = if is_first { [1, 0] } else { [0, 1] }.map(|k: usize| joint.frames[k]);
            (own, onto, sign) = (outer.at, inner.at, if is_first { 1.0 } else { -1.0 });
            let base = match parent {
                Parent::Link(k) => places[self.links[k].place].turn,
                Parent::Driven(k) => places[k].turn,
                Parent::World | Parent::Nothing => DQuat::IDENTITY,
            };
            match joint.kind {
                JointKind::Ball => freedom = Freedom::Ball,
                // It has no point that is held, so it is no edge of a tree.
                JointKind::String(_) => {}
                JointKind::Weld => {
                    (freedom, rest) = (Freedom::Weld, (inner.turn * outer.turn.conjugate()).normalize());
                }
                JointKind::Slider(_) => {
                    let axis = inner.turn * DVec3::Z;
                    (freedom, rest) = (
                        Freedom::Axis { axis, slides: true, is_damped },
                        (inner.turn * outer.turn.conjugate()).normalize(),
                    );
                    let child = &places[place];
                    let from = match parent {
                        Parent::Link(k) => places[self.links[k].place].start.x,
                        Parent::Driven(k) => places[k].start.x,
                        Parent::World | Parent::Nothing => DVec3::ZERO,
                    };
                    let ahead = base.conjugate() * (child.start.x + child.turn * own - from) - onto;
                    onto += axis * ahead.dot(axis);
                }
                JointKind::Hinge(_) => {
                    freedom = Freedom::Axis { axis: inner.turn * DVec3::Z, slides: false, is_damped };
                    // The part of the rotation between the two frames that is about their axis.
                    let between = inner.turn.conjugate() * base.conjugate() * rest * outer.turn;
                    let about = DQuat::from_xyzw(0.0, 0.0, between.z, between.w).normalize();
                    rest = (inner.turn * about * outer.turn.conjugate()).normalize();
                }
            }
        }
        if let Some(bond) = joint.map(|number| &world.joints.bonds[number])
            && let Some(own) = bond.spring()
        {
            let base = match parent {
                Parent::Link(k) => &places[self.links[k].place].start,
                Parent::Driven(k) => &places[k].start,
                Parent::World | Parent::Nothing => &WORLD_POSE,
            };
            let both = [&places[place].start, base];
            let both = if sign > 0.0 { both } else { [both[1], both[0]] };
            spring = Some(Spring { rest: sign * (own.rest - bond.coordinate(both)), ..*own });
        }
        let at = self.counts;
        let [coordinates, rates] = freedom.counts();
        self.counts = [at[0] + coordinates, at[1] + rates];
        let joint = joint.map(|joint| (joint, sign));
        self.links.push(Link { place, parent, freedom, at, own, onto, rest, joint, spring, reach: 0.0 });
    }

    /// Finds how far what hangs on each joint reaches. Returns true.
    fn measure(&mut self, world: &RigidWorld, places: &[StepPoses]) -> bool {
        for k in (0..self.links.len()).rev() {
            let link = self.links[k];
            let reach = link.reach.max(link.own.length() + world.specs[places[link.place].body].bounding_radius);
            self.links[k].reach = reach;
            if let Parent::Link(p) = link.parent {
                let inner = &mut self.links[p];
                inner.reach = inner.reach.max((link.onto - inner.own).length() + reach);
            }
        }
        true
    }
}

/// A rotation's matrix, and the body's inertia turned by it.
pub(super) fn turned(turn: DQuat, moments: DVec3) -> (DMat3, DMat3) {
    let r = DMat3::from_quat(turn);
    if moments.x == moments.y && moments.y == moments.z {
        return (r, DMat3::from_diagonal(moments));
    }
    let scaled = DMat3::from_cols(r.x_axis * moments.x, r.y_axis * moments.y, r.z_axis * moments.z);
    (r, scaled * r.transpose())
}
