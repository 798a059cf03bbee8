//! Sweeps over coupled contacts that converge for any masses: block Gauss–Seidel with Anderson's acceleration.
//!
//! A sweep alone carries a load only one body further, and moves heavy bodies by means of light ones: a ball of 10⁶
//! times the mass on a small one takes 10⁶ sweeps. If a few sweeps have not been enough, the next begins at the
//! combination of the last ones whose change would be least if sweeps were linear. For contacts that keep their state
//! (open, sticking or sliding) they are linear, and then it takes as many sweeps as there are independent loads, like a
//! direct solution. When contacts change state, the plain sweep decides, so that no law of contact is bent.
//!
//! Source: Anderson, "Iterative procedures for nonlinear integral equations", J. ACM 12 (1965); Walker & Ni, "Anderson
//! acceleration for fixed-point iterations", SIAM J. Numer. Anal. 49 (2011), for the form used here and its kinship
//! with GMRES.

use std::ops::ControlFlow;

/// Plain sweeps before any are combined. Default 8: most groups are done by then.
const PLAIN: u32 = 8;

/// Sweeps always allowed, whatever the preset: a draft must not let heavy balls sink either. Default 60.
const FEWEST: u32 = 60;

/// Maximum number of changes that are combined. Default 12; danger: with few, long chains of unequal masses do not
/// converge; with many, it takes time and diverges when contacts open and close.
const WINDOW: usize = 12;

/// Part of a change that must be new for it to count. Dimensionless; default 1e-9: rounding of changes that are a
/// millionth of what they change.
const NEW: f64 = 1e-9;

/// If a sweep's change grows by this factor, everything remembered is forgotten: other contacts bear now. Default 4.
const ASTRAY: f64 = 4.0;

/// A problem that sweeps solve.
pub(crate) trait Swept {
    /// Solves every contact once or more; gives the largest remaining change.
    fn sweep(&mut self) -> f64;
    /// Appends all loads, in one unit.
    fn read(&self, loads: &mut Vec<f64>);
    /// Sets loads, in the order in which they were read.
    fn write(&mut self, loads: &[f64]);
}

/// Sweeps until `judge`, which gets the system and the remaining change after each sweep, is satisfied, or `most`
/// sweeps are done. Gives whether it was satisfied.
pub(super) fn relax<S: Swept>(
    system: &mut S,
    memory: &mut Memory,
    most: u32,
    mut judge: impl FnMut(&mut S, f64) -> ControlFlow<()>,
) -> bool {
    memory.forget();
    let most = most.max(FEWEST);
    for k in 0..most {
        let remembers = k >= PLAIN && k + 1 < most;
        if remembers {
            memory.before.clear();
            system.read(&mut memory.before);
        }
        let change = system.sweep();
        if judge(system, change).is_break() {
            return true;
        }
        if remembers {
            memory.after.clear();
            system.read(&mut memory.after);
            if memory.combine() {
                system.write(&memory.after);
            }
        }
    }
    false
}

/// What the last sweeps did. Kept between uses for its room only.
#[derive(Debug, Default)]
pub(crate) struct Memory {
    before: Vec<f64>,
    after: Vec<f64>,
    /// What the last sweep changed, and where it led.
    change: Vec<f64>,
    led_to: Vec<f64>,
    /// How changes, and where they led, differed from sweep to sweep: at most `WINDOW` columns, of which the oldest is
    /// overwritten.
    changes: Vec<Vec<f64>>,
    leads: Vec<Vec<f64>>,
    /// Orthonormal directions of the changes, and their coefficients.
    directions: Vec<Vec<f64>>,
    kept: usize,
    next: usize,
    is_fresh: bool,
}

impl Memory {
    fn forget(&mut self) {
        (self.kept, self.next, self.is_fresh) = (0, 0, true);
    }

    /// Replaces `after` by the combination that changes least; false if there is nothing to combine yet.
    fn combine(&mut self) -> bool {
        let change: Vec<f64> = self.after.iter().zip(&self.before).map(|(g, x)| g - x).collect();
        if !self.is_fresh {
            if length(&change) > ASTRAY * length(&self.change) {
                (self.kept, self.next) = (0, 0);
            } else {
                self.remember(&change);
            }
        }
        self.is_fresh = false;
        self.led_to.clone_from(&self.after);
        self.change = change;
        if self.kept == 0 {
            return false;
        }
        self.subtract_what_is_known();
        true
    }

    fn remember(&mut self, change: &[f64]) {
        for columns in [&mut self.changes, &mut self.leads, &mut self.directions] {
            if columns.len() <= self.next {
                columns.push(Vec::new());
            }
        }
        let at = self.next;
        self.changes[at].clear();
        self.changes[at].extend(change.iter().zip(&self.change).map(|(f, last)| f - last));
        self.leads[at].clear();
        self.leads[at].extend(self.after.iter().zip(&self.led_to).map(|(g, last)| g - last));
        self.next = (at + 1) % WINDOW;
        self.kept = (self.kept + 1).min(WINDOW);
    }

    /// Least squares by modified Gram–Schmidt, newest first. A column that adds no new direction is left out.
    fn subtract_what_is_known(&mut self) {
        let mut rest = self.change.clone();
        // Row k of the triangle: column k's parts along the directions before it, and then its own.
        let mut triangle: Vec<(usize, Vec<f64>, f64)> = Vec::new();
        let mut weights = Vec::new();
        for back in 1..=self.kept {
            let column = (self.next + WINDOW - back) % WINDOW;
            let mut direction = std::mem::take(&mut self.directions[triangle.len()]);
            direction.clone_from(&self.changes[column]);
            let whole = length(&direction);
            let mut shares = Vec::with_capacity(triangle.len());
            for known in &self.directions[..triangle.len()] {
                let share = dot(known, &direction);
                subtract(&mut direction, share, known);
                shares.push(share);
            }
            let left = length(&direction);
            if left > NEW * whole {
                direction.iter_mut().for_each(|d| *d /= left);
                let weight = dot(&direction, &rest);
                subtract(&mut rest, weight, &direction);
                self.directions[triangle.len()] = direction;
                triangle.push((column, shares, left));
                weights.push(weight);
            } else {
                self.directions[triangle.len()] = direction;
            }
        }
        for k in (0..triangle.len()).rev() {
            let (column, shares, own) = &triangle[k];
            let weight = weights[k] / own;
            for (w, share) in weights.iter_mut().zip(shares) {
                *w -= weight * share;
            }
            subtract(&mut self.after, weight, &self.leads[*column]);
        }
    }
}

fn dot(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(x, y)| x * y).sum()
}

fn length(a: &[f64]) -> f64 {
    dot(a, a).sqrt()
}

fn subtract(from: &mut [f64], weight: f64, what: &[f64]) {
    from.iter_mut().zip(what).for_each(|(x, y)| *x -= weight * y);
}
