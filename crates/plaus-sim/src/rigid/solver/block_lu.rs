//! Sparse matrices of 6 × 6 blocks: one block for the momentum of each body and one for each pair in contact,
//! eliminated in order of least degree.

#![allow(clippy::needless_range_loop, reason = "rows and columns of matrices go by their numbers")]

use super::contact_constraint::ContactConstraint;
use crate::rigid::tolerances::SINGULAR_PIVOT;
use glam::{DMat3, DVec3};

type Block = [[f64; 6]; 6];
type Column = [f64; 6];

/// A system of equations for the velocities of bodies.
#[derive(Debug, Default)]
pub(crate) struct BlockLu {
    /// The index of each block, by its places in the order of elimination; [`NONE`] where the block is zero.
    slots: Vec<u32>,
    blocks: Vec<Block>,
    right: Vec<Column>,
    /// Place of each body in the order of elimination.
    place: Vec<usize>,
    degree: Vec<Option<usize>>,
    neighbours: Vec<bool>,
    /// The pairs of bodies for which the order was made.
    pairs: Vec<[usize; 2]>,
}

const NONE: u32 = u32::MAX;

impl BlockLu {
    /// Makes room for `n` bodies with these contacts.
    ///
    /// The order of elimination fills few blocks: the next body is always one with the fewest neighbours left.
    pub(crate) fn order(&mut self, contacts: &[ContactConstraint], n: usize) {
        let pairs = || contacts.iter().filter_map(|c| Some([c.a, c.b?]));
        if self.right.len() == n && pairs().eq(self.pairs.iter().copied()) {
            return;
        }
        self.pairs.clear();
        self.pairs.extend(pairs());
        if n == 1 {
            (self.place, self.slots) = (vec![0], vec![0]);
            self.blocks.resize(1, [[0.0; 6]; 6]);
            self.right.resize(1, [0.0; 6]);
            return;
        }
        self.neighbours.clear();
        self.neighbours.resize(n * n, false);
        for &[a, b] in &self.pairs {
            self.neighbours[a * n + b] = true;
            self.neighbours[b * n + a] = true;
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

    /// Sets all blocks and the right side to zero.
    pub(crate) fn clear(&mut self) {
        self.blocks.fill([[0.0; 6]; 6]);
        self.right.fill([0.0; 6]);
    }

    /// Adds a body's own mass and inertia, and its momentum and angular momentum on the right side.
    pub(super) fn add_body(&mut self, k: usize, mass: f64, inertia: &DMat3, [p, l]: [DVec3; 2]) {
        let (n, place) = (self.right.len(), self.place[k]);
        let block = &mut self.blocks[self.slots[place * n + place] as usize];
        add(block, 0, 0, &DMat3::from_diagonal(DVec3::splat(mass)));
        add(block, 3, 3, inertia);
        self.add_right(k, p, l);
    }

    /// Adds to a body's right side.
    fn add_right(&mut self, k: usize, p: DVec3, l: DVec3) {
        let right = &mut self.right[self.place[k]];
        for axis in 0..3 {
            right[axis] += p[axis];
            right[3 + axis] += l[axis];
        }
    }

    /// Adds a contact that responds to a change `u` of its velocity with the impulse `force − stiffness · u`.
    pub(super) fn add_contact(&mut self, c: &ContactConstraint, force: DVec3, stiffness: &DMat3) {
        let n = self.right.len();
        let sides = [Some((c.a, c.arms[0], 1.0)), c.b.map(|b| (b, c.arms[1], -1.0))];
        for (k, arm, sign) in sides.into_iter().flatten() {
            self.add_right(k, force * sign, arm.cross(force) * sign);
        }
        if *stiffness == DMat3::ZERO {
            return;
        }
        for (i, r, sign) in sides.into_iter().flatten() {
            for (j, s, other) in sides.into_iter().flatten() {
                let slot = self.slots[self.place[i] * n + self.place[j]];
                let block = &mut self.blocks[slot as usize];
                let d = *stiffness * (sign * other);
                // Velocity at the point: v + w × s; torque: r × f.
                let across = times_cross(&d, s);
                add(block, 0, 0, &d);
                add(block, 0, 3, &-across);
                add(block, 3, 0, &cross_times(r, &d));
                add(block, 3, 3, &-cross_times(r, &across));
            }
        }
    }

    /// A body's part of the solution.
    pub(super) fn solution(&self, k: usize) -> [DVec3; 2] {
        let x = &self.right[self.place[k]];
        [DVec3::new(x[0], x[1], x[2]), DVec3::new(x[3], x[4], x[5])]
    }

    /// Gaussian elimination by blocks. The solution replaces the right side.
    pub(super) fn eliminate(&mut self) -> Option<()> {
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

/// The matrix of `r × ` times `m`.
fn cross_times(r: DVec3, m: &DMat3) -> DMat3 {
    DMat3::from_cols(r.cross(m.x_axis), r.cross(m.y_axis), r.cross(m.z_axis))
}

/// `m` times the matrix of `r × `.
fn times_cross(m: &DMat3, r: DVec3) -> DMat3 {
    DMat3::from_cols(m.y_axis * r.z - m.z_axis * r.y, m.z_axis * r.x - m.x_axis * r.z, m.x_axis * r.y - m.y_axis * r.x)
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

/// Triangular factors of a block, without exchanging rows: a body's own mass keeps the block regular. `None` if it is
/// not regular.
fn factor(block: &Block) -> Option<Block> {
    let mut f = *block;
    for k in 0..6 {
        if f[k][k].is_nan() || f[k][k].abs() <= SINGULAR_PIVOT * block[k][k].abs() {
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
