//! Impulses of several lasting contacts at once: Newton's rule on what Coulomb's law leaves undone.
//!
//! With the velocity `w` that is not to be at a contact and a small compliance `ε`, impulses `f` obey unilateral contact and Coulomb's law exactly where `f = P(f − w/ε)`, `P` being the
//! projection onto the cone that keeps the normal part (De Saxcé & Feng, Math. Comput. Modelling 28 (1998); Alart & Curnier, Comput. Methods Appl. Mech. Eng. 92 (1991)). Momentum ties velocities to
//! impulses. Each round linearises `P` where it is, solves for all velocities at once, and takes the impulses that follow; the velocity left is then `ε` times the change of the impulses, so that
//! redundant contacts, stacks and mass ratios of ten thousand converge in a few rounds where Gauss–Seidel needs thousands. The matrix is sparse: a block for a body and for each pair in
//! contact, eliminated in order of least degree.
//!
//! What is not reached: where many contacts slide or wedge, rounds may go to and fro without an end. The caller then falls back on sweeps.

#![allow(clippy::needless_range_loop, reason = "rows and columns of matrices go by their numbers")]

use super::contact::cross;
use super::solve::{Contact, Member};
use glam::{DMat3, DVec3};

/// Compliance of a contact over its response to an impulse. Default 1e-7: smaller values lose digits to rounding, larger ones take more rounds.
const COMPLIANCE: f64 = 1e-7;

/// Change of velocity over the largest at a contact that rounding makes. Default 1e-8: ten times its own, over the compliance.
const NOISE: f64 = 1e-8;

/// Rounds after which some go half of the way. Default 6.
const FRESH: usize = 6;

/// Most bodies of a group that are solved in this way. Default 256.
const MOST_MEMBERS: usize = 256;

/// A pivot over the largest entry of its block below which a matrix counts as singular.
const SINGULAR: f64 = 1e-14;

type Block = [[f64; 6]; 6];
type Column = [f64; 6];

/// Work space.
#[derive(Debug, Default)]
pub(crate) struct Newton {
    /// Which block of the matrix stands where, by place in the order of elimination; [`NONE`] where it is zero.
    slots: Vec<u32>,
    blocks: Vec<Block>,
    right: Vec<Column>,
    /// Place of each member in the order of elimination.
    place: Vec<usize>,
    degree: Vec<Option<usize>>,
    neighbours: Vec<bool>,
    /// Velocities of the members that go with the contacts' impulses.
    starts: Vec<[DVec3; 2]>,
    /// What the cones make of each contact.
    projected: Vec<Projected>,
    exact: Vec<DVec3>,
}

const NONE: u32 = u32::MAX;

/// How a contact answers to a change of its velocity.
#[derive(Debug, Clone, Copy)]
struct Projected {
    impulse: DVec3,
    /// Derivative of the impulse by the velocity, negative.
    stiffness: DMat3,
    /// Direction of the friction where it slides.
    sliding: Option<DVec3>,
}

/// How it ended.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub(crate) enum Ending {
    Solved,
    NotSolved,
}

impl Newton {
    /// Rounds until no body's velocity changes by more than `enough`, at most `most`. Where it is solved, impulses and velocities are consistent to rounding.
    pub(crate) fn solve(
        &mut self,
        contacts: &mut [Contact],
        members: &mut [Member],
        enough: f64,
        most: usize,
    ) -> Ending {
        if members.len() > MOST_MEMBERS {
            return Ending::NotSolved;
        }
        let fastest = contacts.iter().filter(|c| c.target > -f64::MAX).map(|c| (c.velocity(members) + c.bias).length());
        let enough = enough.max(NOISE * fastest.fold(0.0, f64::max));
        self.order(contacts, members.len());
        self.begin(contacts, members);
        for round in 0..most {
            // Where rounds go to and fro, half of the way lies between.
            let part = if round >= FRESH && round % 3 == 2 { 0.5 } else { 1.0 };
            if self.round(contacts, members, part).is_none() {
                return Ending::NotSolved;
            }
            if let Some(change) = self.take_impulses(contacts, members, enough) {
                if change * COMPLIANCE <= enough {
                    return Ending::Solved;
                }
                self.begin(contacts, members);
            }
        }
        Ending::NotSolved
    }

    /// Starts anew from impulses and velocities that go with each other.
    fn begin(&mut self, contacts: &[Contact], members: &[Member]) {
        self.starts.clear();
        self.starts.extend(members.iter().map(|m| [m.v, m.w]));
        self.projected.clear();
        self.projected.extend(contacts.iter().map(|c| project(c, members, None)));
    }

    /// One round, by this part of its change.
    fn round(&mut self, contacts: &[Contact], members: &mut [Member], part: f64) -> Option<()> {
        for (c, p) in contacts.iter().zip(&mut self.projected) {
            *p = project(c, members, p.sliding);
        }
        self.assemble(contacts, members);
        self.eliminate()?;
        for (m, &p) in members.iter_mut().zip(&self.place) {
            let x = &self.right[p];
            m.v += DVec3::new(x[0], x[1], x[2]) * part;
            m.w += DVec3::new(x[3], x[4], x[5]) * part;
        }
        members.iter().all(|m| m.v.is_finite() && m.w.is_finite()).then_some(())
    }

    /// Gives contacts the impulses of the cones, and members the velocities that follow to the last bit, where these are within `enough` of those that the cones were asked with. By how much
    /// impulses have changed then, as velocities at their contacts.
    fn take_impulses(&mut self, contacts: &mut [Contact], members: &mut [Member], enough: f64) -> Option<f64> {
        self.exact.clear();
        self.exact.extend(contacts.iter().map(|c| project(c, members, None).impulse));
        for (m, start) in members.iter_mut().zip(&self.starts) {
            m.last = [m.v, m.w];
            [m.v, m.w] = *start;
        }
        let mut change = 0.0_f64;
        for (c, &impulse) in contacts.iter().zip(&self.exact) {
            c.push(members, impulse - c.impulse);
            change = change.max((impulse - c.impulse).length() * c.compliance());
        }
        let off = |m: &Member| (m.v - m.last[0]).length().max((m.w - m.last[1]).length() * m.reach);
        if !members.iter().all(|m| off(m) <= enough) {
            for m in members.iter_mut() {
                [m.v, m.w] = m.last;
            }
            return None;
        }
        for (c, &impulse) in contacts.iter_mut().zip(&self.exact) {
            c.impulse = impulse;
        }
        Some(change)
    }

    /// Finds an order of elimination that fills few blocks: always a body with the fewest neighbours left.
    fn order(&mut self, contacts: &[Contact], n: usize) {
        self.neighbours.clear();
        self.neighbours.resize(n * n, false);
        for c in contacts {
            if let Some(b) = c.b {
                self.neighbours[c.a * n + b] = true;
                self.neighbours[b * n + c.a] = true;
            }
        }
        self.place.clear();
        self.place.resize(n, 0);
        self.slots.clear();
        self.slots.resize(n * n, NONE);
        self.degree.clear();
        self.degree.extend((0..n).map(|k| Some(self.neighbours[k * n..][..n].iter().filter(|&&is| is).count())));
        let mut count = 0;
        let mut order = Vec::with_capacity(n);
        for place in 0..n {
            let next = (0..n).filter_map(|k| Some((self.degree[k]?, k))).min().map_or(0, |(_, k)| k);
            self.degree[next] = None;
            self.place[next] = place;
            order.push(next);
            let left: Vec<usize> =
                (0..n).filter(|&k| self.neighbours[next * n + k] && self.degree[k].is_some()).collect();
            for &i in &left {
                for &j in &left {
                    self.neighbours[i * n + j] |= i != j;
                }
            }
            for &i in &left {
                let open = (0..n).filter(|&k| self.neighbours[i * n + k] && self.degree[k].is_some()).count();
                self.degree[i] = Some(open);
            }
        }
        for (i, &a) in order.iter().enumerate() {
            for (j, &b) in order.iter().enumerate() {
                if i == j || self.neighbours[a * n + b] {
                    self.slots[i * n + j] = count;
                    count += 1;
                }
            }
        }
        self.blocks.clear();
        self.blocks.resize(count as usize, [[0.0; 6]; 6]);
        self.right.clear();
        self.right.resize(n, [0.0; 6]);
    }

    fn assemble(&mut self, contacts: &[Contact], members: &[Member]) {
        let n = members.len();
        self.blocks.fill([[0.0; 6]; 6]);
        self.right.fill([0.0; 6]);
        for (k, (m, &place)) in members.iter().zip(&self.place).enumerate() {
            let block = &mut self.blocks[self.slots[place * n + place] as usize];
            let inertia = m.inverse_inertia.inverse();
            add(block, 0, 0, &DMat3::from_diagonal(DVec3::splat(1.0 / m.inverse_mass)));
            add(block, 3, 3, &inertia);
            // What the change so far takes of the momentum that the impulses bring.
            let [v, w] = self.starts[k];
            let (p, l) = ((v - m.v) / m.inverse_mass, inertia * (w - m.w));
            self.right[place] = [p.x, p.y, p.z, l.x, l.y, l.z];
        }
        for (c, p) in contacts.iter().zip(&self.projected) {
            let force = p.impulse - c.impulse;
            let sides = [Some((c.a, c.arms[0], 1.0)), c.b.map(|b| (b, c.arms[1], -1.0))];
            for (k, arm, sign) in sides.into_iter().flatten() {
                let right = &mut self.right[self.place[k]];
                let (f, torque) = (force * sign, arm.cross(force) * sign);
                for axis in 0..3 {
                    right[axis] += f[axis];
                    right[3 + axis] += torque[axis];
                }
            }
            if p.stiffness == DMat3::ZERO {
                continue;
            }
            for (i, r, sign) in sides.into_iter().flatten() {
                for (j, s, other) in sides.into_iter().flatten() {
                    let slot = self.slots[self.place[i] * n + self.place[j]];
                    let block = &mut self.blocks[slot as usize];
                    let d = p.stiffness * (sign * other);
                    // Velocity at the point: v − s× w; torque: r × f.
                    let (left, right) = (cross(r), cross(s));
                    let across = d * right;
                    add(block, 0, 0, &d);
                    add(block, 0, 3, &(-across));
                    add(block, 3, 0, &(left * d));
                    add(block, 3, 3, &(-(left * across)));
                }
            }
        }
    }

    /// Gauss's elimination by blocks; the solution takes the right side's place.
    fn eliminate(&mut self) -> Option<()> {
        let n = self.right.len();
        for k in 0..n {
            let pivot = factor(&self.blocks[self.slots[k * n + k] as usize])?;
            self.blocks[self.slots[k * n + k] as usize] = pivot;
            for j in k + 1..n {
                if self.slots[k * n + j] != NONE {
                    let slot = self.slots[k * n + j] as usize;
                    self.blocks[slot] = divide(&pivot, &self.blocks[slot]);
                }
            }
            self.right[k] = divide_column(&pivot, &self.right[k]);
            for i in k + 1..n {
                if self.slots[i * n + k] == NONE {
                    continue;
                }
                let lower = self.blocks[self.slots[i * n + k] as usize];
                for j in k + 1..n {
                    if self.slots[k * n + j] != NONE {
                        let upper = self.blocks[self.slots[k * n + j] as usize];
                        subtract(&mut self.blocks[self.slots[i * n + j] as usize], &lower, &upper);
                    }
                }
                let above = self.right[k];
                subtract_column(&mut self.right[i], &lower, &above);
            }
        }
        for k in (0..n).rev() {
            for j in k + 1..n {
                if self.slots[k * n + j] != NONE {
                    let below = self.right[j];
                    let upper = self.blocks[self.slots[k * n + j] as usize];
                    subtract_column(&mut self.right[k], &upper, &below);
                }
            }
        }
        Some(())
    }
}

/// What Coulomb's cone makes of a contact with the members' velocities. Where friction had the direction `before` and now would have the opposite one, the slip went through none: then the
/// contact is tried without slip, or rounds might go to and fro for ever.
fn project(c: &Contact, members: &[Member], before: Option<DVec3>) -> Projected {
    let stiff = 1.0 / (COMPLIANCE * c.compliance());
    let n = c.normal;
    let wrong = c.velocity(members) + c.bias - n * c.target;
    let trial = c.impulse - wrong * stiff;
    let load = trial.dot(n);
    if load.is_nan() || load <= 0.0 {
        return Projected { impulse: DVec3::ZERO, stiffness: DMat3::ZERO, sliding: None };
    }
    let across = trial - n * load;
    let (side, most) = (across.length(), c.friction * load);
    let slides = |t: DVec3, turning: DMat3| {
        let direction = n + t * c.friction;
        Projected { impulse: direction * load, stiffness: (outer(direction, n) + turning) * stiff, sliding: Some(t) }
    };
    if let Some(s) = c.held_slip.filter(|s| across.dot(*s) < -most) {
        // Friction against the slip as it was, as long as it goes on.
        return slides(-s, DMat3::ZERO);
    }
    if side <= most || before.is_some_and(|b| b.dot(across) < 0.0) {
        return Projected { impulse: trial, stiffness: DMat3::IDENTITY * stiff, sliding: None };
    }
    let t = across / side;
    slides(t, (DMat3::IDENTITY - outer(n, n) - outer(t, t)) * (most / side))
}

fn outer(a: DVec3, b: DVec3) -> DMat3 {
    DMat3::from_cols(a * b.x, a * b.y, a * b.z)
}

#[inline]
fn add(block: &mut Block, row: usize, column: usize, m: &DMat3) {
    for j in 0..3 {
        let c = m.col(j);
        for i in 0..3 {
            block[row + i][column + j] += c[i];
        }
    }
}

/// Triangular factors of a block, without exchange of rows: a body's own mass keeps it regular. `None` where it is not.
fn factor(block: &Block) -> Option<Block> {
    let mut f = *block;
    for k in 0..6 {
        let largest = (0..6).map(|i| block[k][i].abs()).fold(0.0, f64::max);
        if f[k][k].is_nan() || f[k][k].abs() <= SINGULAR * largest {
            return None;
        }
        let inverse = 1.0 / f[k][k];
        for i in k + 1..6 {
            let l = f[i][k] * inverse;
            f[i][k] = l;
            for j in k + 1..6 {
                f[i][j] -= l * f[k][j];
            }
        }
    }
    Some(f)
}

fn divide_column(f: &Block, right: &Column) -> Column {
    let mut x = *right;
    for i in 0..6 {
        for j in 0..i {
            x[i] -= f[i][j] * x[j];
        }
    }
    for i in (0..6).rev() {
        for j in i + 1..6 {
            x[i] -= f[i][j] * x[j];
        }
        x[i] /= f[i][i];
    }
    x
}

/// The inverse of a factored block times a block.
fn divide(f: &Block, right: &Block) -> Block {
    let mut x = *right;
    for i in 0..6 {
        for j in 0..i {
            for k in 0..6 {
                x[i][k] -= f[i][j] * x[j][k];
            }
        }
    }
    for i in (0..6).rev() {
        for j in i + 1..6 {
            for k in 0..6 {
                x[i][k] -= f[i][j] * x[j][k];
            }
        }
        let inverse = 1.0 / f[i][i];
        for entry in &mut x[i] {
            *entry *= inverse;
        }
    }
    x
}

fn subtract(block: &mut Block, a: &Block, b: &Block) {
    for i in 0..6 {
        for (k, row) in b.iter().enumerate() {
            for j in 0..6 {
                block[i][j] -= a[i][k] * row[j];
            }
        }
    }
}

fn subtract_column(column: &mut Column, a: &Block, b: &Column) {
    for i in 0..6 {
        for (k, entry) in b.iter().enumerate() {
            column[i] -= a[i][k] * entry;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_are_eliminated() {
        let mut seed = 1_u64;
        let mut next = || {
            seed = seed.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (seed >> 11) as f64 / (1_u64 << 53) as f64 - 0.5
        };
        let mut block = [[0.0; 6]; 6];
        for (i, row) in block.iter_mut().enumerate() {
            for entry in row.iter_mut() {
                *entry = next();
            }
            row[i] += 4.0;
        }
        let x: Column = std::array::from_fn(|_| next());
        let right: Column = std::array::from_fn(|i| (0..6).map(|j| block[i][j] * x[j]).sum());
        let solved = divide_column(&factor(&block).unwrap(), &right);
        for (a, b) in solved.iter().zip(&x) {
            assert!((a - b).abs() < 1e-14, "{solved:?} {x:?}");
        }
    }
}
