//! Impulses of very many contacts: projected Gauss–Seidel, whose steps are combined as conjugate gradients are.
//!
//! A round visits each contact once, up and down in turn, and costs a time proportional to their number. The change of
//! all impulses in a round takes the place of a gradient. The next round begins a part of the last direction farther
//! on (Fletcher and Reeves' part), unless changes grow: then it begins where the last one ended. Source:
//! Silcowitz-Hansen, Niebe & Erleben, "A nonsmooth nonlinear conjugate gradient method for interactive contact force
//! problems", Vis. Comput. 26 (2010). The last round is always a plain one, so every impulse lies in Coulomb's cone.

use super::contact_constraint::{ContactConstraint, SolverBody};
use crate::rigid::tolerances::{INDEPENDENT_RESPONSE, NNCG_ACCURACY, NNCG_WHOLE_ROUNDS};
use glam::{DMat3, DVec3};

/// A contact as rounds see it, or the resistance to turning at the contact before it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NncgContact {
    pub(crate) a: usize,
    pub(crate) b: Option<usize>,
    pub(crate) arms: [DVec3; 2],
    pub(crate) normal: DVec3,
    /// Added to the velocity at the point to get the velocity that must be removed.
    pub(crate) bias: DVec3,
    /// Of a resistance: the least load that bounds it, in N s.
    pub(crate) friction: f64,
    pub(crate) held_slip: Option<DVec3>,
    /// Impulse per velocity along the normal and across it.
    gain: [f64; 2],
    /// Response to impulses, in velocity per impulse, that weighs them against each other.
    weight: f64,
    /// Slip per impulse along the normal.
    pub(crate) lean: DVec3,
    pub(crate) impulse: DVec3,
    /// Of a resistance: the largest torques along the normal and across it, over the load.
    resists: Option<[f64; 2]>,
}

/// A body as rounds see it.
#[derive(Debug, Clone, Copy)]
pub(crate) struct NncgBody {
    v: DVec3,
    w: DVec3,
    inverse_mass: f64,
    /// Its inverse inertia if that is the same about all axes, as a ball's is; otherwise NaN.
    even: f64,
}

/// Bodies, and their inverse inertias, which even ones do not need.
#[derive(Debug, Default)]
pub(crate) struct NncgBodies {
    all: Vec<NncgBody>,
    inverse_inertias: Vec<DMat3>,
    radii: Vec<f64>,
    /// Their velocities one round ago.
    lasts: Vec<[DVec3; 2]>,
    /// How the direction of the search changes their velocities.
    directions: Vec<[DVec3; 2]>,
}

/// Work space.
#[derive(Debug, Default)]
pub(crate) struct Nncg {
    pub(crate) rows: Vec<NncgContact>,
    pub(crate) movers: NncgBodies,
    /// The rows that rounds visit, in order: all, or those that were not at rest when all were last visited.
    live: Vec<u32>,
    /// Impulses before a round, and the direction of the search.
    before: Vec<DVec3>,
    direction: Vec<DVec3>,
}

impl Nncg {
    /// Rounds until one changes no body's velocity by more than a part of `enough` m/s, at most `most`. Returns whether
    /// it converged.
    pub(crate) fn solve(
        &mut self,
        contacts: &mut [ContactConstraint],
        members: &mut [SolverBody],
        enough: f64,
        most: u32,
    ) -> bool {
        self.rows.clear();
        self.rows.extend(contacts.iter().map(NncgContact::of));
        self.movers.take(members);
        let is_solved = self.run(NNCG_ACCURACY * enough, most);
        for (c, r) in contacts.iter_mut().zip(&self.rows) {
            c.impulse = r.impulse;
            c.note_solved();
        }
        self.movers.give(members);
        is_solved
    }

    /// Rounds over the rows until one changes no body's velocity by more than `enough` m/s, at most `most`. Returns
    /// whether it converged.
    pub(crate) fn run(&mut self, enough: f64, most: u32) -> bool {
        for list in [&mut self.direction, &mut self.before] {
            list.clear();
            list.resize(self.rows.len(), DVec3::ZERO);
        }
        let resists = self.rows.iter().any(|r| r.resists.is_some());
        let (mut last, mut is_quiet) = (f64::INFINITY, false);
        for round in 0..most {
            // Most rows bear nothing. They are visited now and then, and before the rounds end.
            let is_whole = resists || is_quiet || round % NNCG_WHOLE_ROUNDS == 0 || round + 1 == most;
            if is_whole {
                self.live.clear();
                self.live.extend(0..self.rows.len() as u32);
            }
            self.live.iter().for_each(|&k| self.before[k as usize] = self.rows[k as usize].impulse);
            self.movers.note();
            if resists {
                self.visit_and_resist(round % 2 == 1)
            } else {
                self.visit_live(round % 2 == 1)
            }
            is_quiet = self.movers.is_quiet(enough);
            if is_quiet && is_whole {
                return true;
            }
            if is_whole && !resists {
                let of = |k: usize| [self.rows[k].impulse, self.before[k], self.direction[k]];
                self.live.retain(|&k| of(k as usize) != [DVec3::ZERO; 3]);
            }
            if round + 1 < most {
                last = self.go_on(last);
            }
        }
        false
    }

    /// Gives bodies the velocities that rounds have found, with no more of the impulses than give no energy beyond what
    /// biases ask for: rounds that end early may leave more than the bodies need. With the part `α` of impulses `p`
    /// that change the velocities at their points by `Wp` to `u`, this is `αp · (u + bias - (1 - α) Wp)`.
    pub(crate) fn give_passively(&mut self, members: &mut [SolverBody]) {
        let (mut given, mut whole) = (0.0, 0.0);
        for r in self.rows.iter().filter(|r| r.impulse != DVec3::ZERO) {
            let [a, b] = [Some(r.a), r.b].map(|k| k.map(|k| (&self.movers.all[k], &members[k])));
            let change = |of: Option<(&NncgBody, &SolverBody)>, arm: DVec3| {
                of.map_or([DVec3::ZERO; 2], |(now, m)| match r.resists {
                    None => [now.v + now.w.cross(arm), now.v - m.v + (now.w - m.w).cross(arm)],
                    Some(_) => [now.w, now.w - m.w],
                })
            };
            let ([u, du], [v, dv]) = (change(a, r.arms[0]), change(b, r.arms[1]));
            given += r.impulse.dot(u - v + r.bias);
            whole += r.impulse.dot(du - dv);
        }
        if given <= 0.0 || whole <= 0.0 {
            return self.movers.give(members);
        }
        let part = (1.0 - given / whole).max(0.0);
        self.rows.iter_mut().for_each(|r| r.impulse *= part);
        for (m, now) in members.iter_mut().zip(&self.movers.all) {
            (m.v, m.w) = (m.v + (now.v - m.v) * part, m.w + (now.w - m.w) * part);
        }
    }

    fn visit_live(&mut self, is_down: bool) {
        let Self { rows, live, movers, .. } = self;
        if is_down {
            live.iter().rev().for_each(|&k| rows[k as usize].visit(movers));
        } else {
            live.iter().for_each(|&k| rows[k as usize].visit(movers));
        }
    }

    /// The same, where some rows are resistances.
    fn visit_and_resist(&mut self, is_down: bool) {
        let Self { rows, movers, .. } = self;
        let all = 0..rows.len();
        let mut visit = |k: usize| {
            let (earlier, rest) = rows.split_at_mut(k);
            let row = &mut rest[0];
            match row.resists {
                None => row.visit(movers),
                Some(most) => {
                    let load = earlier.last().map_or(0.0, |c| c.impulse.dot(c.normal)) + row.friction;
                    row.resist(movers, most.map(|most| most * load.max(0.0)));
                }
            }
        };
        if is_down {
            all.rev().for_each(&mut visit);
        } else {
            all.for_each(&mut visit);
        }
    }

    /// Goes on along the last direction, turned towards the last round's change. `last` is the square of the change
    /// before that; returns that of the last change.
    fn go_on(&mut self, last: f64) -> f64 {
        let Self { rows, live, before, direction, .. } = self;
        let change = |&k: &u32| (rows[k as usize].impulse - before[k as usize], rows[k as usize].weight);
        let now: f64 = live.iter().map(change).map(|(change, weight)| change.length_squared() * weight).sum();
        let part = if now < last { now / last } else { 0.0 };
        for k in live.iter().map(|&k| k as usize) {
            let (change, farther) = (rows[k].impulse - before[k], direction[k] * part);
            direction[k] = farther + change;
            rows[k].impulse += farther;
        }
        // Velocities are linear in impulses.
        let movers = &mut self.movers;
        for ((now, last), direction) in movers.all.iter_mut().zip(&movers.lasts).zip(&mut movers.directions) {
            let change = [now.v - last[0], now.w - last[1]];
            let farther = direction.map(|d| d * part);
            *direction = [farther[0] + change[0], farther[1] + change[1]];
            now.v += farther[0];
            now.w += farther[1];
        }
        now
    }
}

impl NncgContact {
    fn of(c: &ContactConstraint) -> Self {
        let fresh = Self::new([Some(c.a), c.b], c.arms, c.normal, c.friction, &c.response());
        Self { bias: c.bias - c.normal * c.target, held_slip: c.held_slip, impulse: c.impulse, ..fresh }
    }

    /// A contact with that response to impulses, without any.
    #[inline]
    pub(crate) fn new([a, b]: [Option<usize>; 2], arms: [DVec3; 2], n: DVec3, friction: f64, k: &DMat3) -> Self {
        let along = n.dot(*k * n);
        let across = (k.x_axis.x + k.y_axis.y + k.z_axis.z - along) * 0.5;
        let lean = *k * n - n * along;
        // Where normal and tangent depend on each other, the response differs with the direction of the slip as well.
        let is_even = lean.length() <= INDEPENDENT_RESPONSE * along;
        let (lean, gain) = if is_even {
            (DVec3::ZERO, [1.0 / along, 1.0 / across])
        } else {
            (lean, [1.0 / along, 1.0 / largest_across(k, n, across)])
        };
        Self {
            a: a.unwrap_or(0),
            b,
            arms,
            normal: n,
            bias: DVec3::ZERO,
            friction,
            held_slip: None,
            gain,
            weight: along,
            lean,
            impulse: DVec3::ZERO,
            resists: None,
        }
    }

    /// The resistance to turning at this contact: `most` along the normal and across it, over the load, which is at
    /// least `load`; `k` is the response of the angular velocity to torques.
    pub(crate) fn resistance(&self, most: [f64; 2], load: f64, k: &DMat3) -> Self {
        let turn = Self::new([Some(self.a), self.b], [DVec3::ZERO; 2], self.normal, load, k);
        Self { resists: Some(most), ..turn }
    }

    /// Impulse along the normal per velocity there.
    pub(crate) fn gain_along(&self) -> f64 {
        self.gain[0]
    }

    /// The velocity there.
    pub(crate) fn velocity(&self, movers: &NncgBodies) -> DVec3 {
        self.velocity_beside(movers, DVec3::ZERO)
    }

    /// The same, with this added.
    #[inline(always)]
    fn velocity_beside(&self, movers: &NncgBodies, bias: DVec3) -> DVec3 {
        let at = |m: &NncgBody, arm: DVec3| m.v + m.w.cross(arm);
        let mut u = at(&movers.all[self.a], self.arms[0]) + bias;
        if let Some(b) = self.b {
            u -= at(&movers.all[b], self.arms[1]);
        }
        u
    }

    /// Slows the turning down, by torques of at most these along the normal and across it.
    fn resist(&mut self, movers: &mut NncgBodies, most: [f64; 2]) {
        let w = movers.all[self.a].w - self.b.map_or(DVec3::ZERO, |b| movers.all[b].w);
        let n = self.normal;
        let (along, old) = (w.dot(n), self.impulse.dot(n));
        let across = self.impulse - n * old - (w - n * along) * self.gain[1];
        let next = n * (old - along * self.gain[0]).clamp(-most[0], most[0]) + across.clamp_length_max(most[1]);
        let change = next - self.impulse;
        self.impulse = next;
        movers.turn(self.a, change);
        if let Some(b) = self.b {
            movers.turn(b, -change);
        }
    }

    /// Gives the contact the impulse that removes its velocity, projected onto Coulomb's cone.
    #[inline]
    fn visit(&mut self, movers: &mut NncgBodies) {
        let u = self.velocity_beside(movers, self.bias);
        let n = self.normal;
        let rate = u.dot(n);
        if self.impulse == DVec3::ZERO && rate >= 0.0 {
            return;
        }
        let old = self.impulse.dot(n);
        let load = (old - rate * self.gain[0]).max(0.0);
        // Friction sees the slip that is left after the impulse along the normal.
        let (slip, across) = (u - n * rate + self.lean * (load - old), self.impulse - n * old);
        let most = self.friction * load;
        let deferred = across - slip * self.gain[1];
        let next = match self.held_slip {
            Some(s) if slip.dot(s) * self.gain[1] > across.dot(s) + most => n * load - s * most,
            _ if deferred.length_squared() <= most * most => n * load + deferred,
            _ => n * load + deferred * (most / deferred.length()),
        };
        let change = next - self.impulse;
        self.impulse = next;
        self.push(movers, change);
    }

    /// Gives the bodies an impulse here.
    #[inline(always)]
    pub(crate) fn push(&self, movers: &mut NncgBodies, impulse: DVec3) {
        movers.push(self.a, self.arms[0], impulse);
        if let Some(b) = self.b {
            movers.push(b, self.arms[1], -impulse);
        }
    }
}

impl NncgBodies {
    pub(crate) fn take(&mut self, members: &[SolverBody]) {
        self.all.clear();
        self.inverse_inertias.clear();
        self.directions.clear();
        self.radii.clear();
        for m in members {
            let i = &m.inverse_inertia;
            let is_even = *i == DMat3::from_diagonal(DVec3::splat(i.x_axis.x));
            let even = if is_even { i.x_axis.x } else { f64::NAN };
            self.all.push(NncgBody { v: m.v, w: m.w, inverse_mass: m.inverse_mass, even });
            self.inverse_inertias.push(*i);
            self.directions.push([DVec3::ZERO; 2]);
            self.radii.push(m.bounding_radius);
        }
    }

    pub(crate) fn give(&self, members: &mut [SolverBody]) {
        for (m, now) in members.iter_mut().zip(&self.all) {
            (m.v, m.w) = (now.v, now.w);
        }
    }

    fn note(&mut self) {
        self.lasts.clear();
        self.lasts.extend(self.all.iter().map(|m| [m.v, m.w]));
    }

    /// Whether the last round changed no velocity by more than this.
    fn is_quiet(&self, enough: f64) -> bool {
        let is_quiet = |((now, [v, w]), radius): ((&NncgBody, &[DVec3; 2]), &f64)| {
            (now.v - v).length_squared().max((now.w - w).length_squared() * radius * radius) <= enough * enough
        };
        self.all.iter().zip(&self.lasts).zip(&self.radii).all(is_quiet)
    }

    #[inline(always)]
    fn push(&mut self, k: usize, arm: DVec3, impulse: DVec3) {
        let m = &mut self.all[k];
        m.v += impulse * m.inverse_mass;
        self.turn(k, arm.cross(impulse));
    }

    #[inline(always)]
    fn turn(&mut self, k: usize, turn: DVec3) {
        let m = &mut self.all[k];
        m.w += if m.even.is_nan() { self.inverse_inertias[k] * turn } else { turn * m.even };
    }
}

/// The largest response to an impulse across a normal, if their mean is `mean`.
fn largest_across(k: &DMat3, n: DVec3, mean: f64) -> f64 {
    let (s, t) = n.any_orthonormal_pair();
    let (ks, kt) = (*k * s, *k * t);
    let (off, difference) = (s.dot(kt), 0.5 * (s.dot(ks) - t.dot(kt)));
    mean + (off * off + difference * difference).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::rigid::solver::contact_constraint::response;
    use plaus_dist::{Purpose, Seed, open_unit};

    /// Cubes on each other on a floor, each moving a little, with guesses of the impulses at their corners of up to
    /// three times the load.
    fn stack(draw: u64) -> (Nncg, Vec<SolverBody>) {
        let mut stream = Seed(3).chain(0).at(draw, Purpose::START);
        let mut some = |most: f64| most * (2.0 * open_unit(&mut stream) - 1.0);
        let count = 3 + (draw % 10) as usize;
        let mut body = || SolverBody {
            inverse_mass: 1.0,
            inverse_inertia: DMat3::from_diagonal(DVec3::new(6.0, 6.5, 7.0)),
            v: DVec3::new(some(0.1), some(0.1), some(0.3) - 0.1),
            w: DVec3::new(some(0.1), some(0.1), some(0.1)),
            bounding_radius: 0.9,
            last: [DVec3::ZERO; 2],
        };
        let members: Vec<SolverBody> = (0..count).map(|_| body()).collect();
        let mut rounds = Nncg::default();
        rounds.movers.take(&members);
        for (k, corner) in (0..count).flat_map(|k| (0..4).map(move |corner| (k, corner))) {
            let side = |bit: i32| if corner & bit == 0 { -0.5 } else { 0.5 };
            let arms = [DVec3::new(side(1), side(2), -0.5), DVec3::new(side(1), side(2), 0.5)];
            let at = |k: usize, arm: DVec3| response(1.0, &members[k].inverse_inertia, arm);
            let both = at(k, arms[0]) + if k > 0 { at(k - 1, arms[1]) } else { DMat3::ZERO };
            let mut row = NncgContact::new([Some(k), k.checked_sub(1)], arms, DVec3::Z, 0.4, &both);
            let load = 0.025 * (count - k) as f64;
            row.impulse = DVec3::new(some(0.5), some(0.5), 2.0) * (load * (0.75 + some(0.75)));
            row.impulse = row.impulse.with_z(row.impulse.z.max(row.impulse.truncate().length() / 0.4));
            row.push(&mut rounds.movers, row.impulse);
            rounds.rows.push(row);
        }
        (rounds, members)
    }

    fn energy(members: &[SolverBody]) -> f64 {
        members.iter().map(|m| 0.5 * (m.v.length_squared() + m.w.dot(m.inverse_inertia.inverse() * m.w))).sum()
    }

    /// Rounds that end early make no energy, whatever impulses they begin with; these stay in Coulomb's cones and are
    /// those that change the velocities. Giving all that the rounds have found makes energy in many of these stacks.
    /// The bounds are rounding.
    #[test]
    fn rounds_that_end_early_make_no_energy() {
        let mut made = 0;
        for draw in 0..200 {
            let (mut rounds, start) = stack(draw);
            rounds.run(0.0, 1 + (draw % 3) as u32);
            let (mut passive, mut all) = (start.clone(), start.clone());
            rounds.movers.give(&mut all);
            rounds.give_passively(&mut passive);
            let before = energy(&start);
            assert!(energy(&passive) <= before * (1.0 + 1e-12), "{draw}");
            made += usize::from(energy(&all) > before);
            for r in &rounds.rows {
                assert!(r.impulse.truncate().length() <= 0.4 * r.impulse.z * (1.0 + 1e-12), "{draw}");
            }
            let pushed: DVec3 = rounds.rows.iter().filter(|r| r.b.is_none()).map(|r| r.impulse).sum();
            let gained: DVec3 = passive.iter().zip(&start).map(|(m, s)| m.v - s.v).sum();
            assert!((pushed - gained).length() < 1e-12, "{draw}");
        }
        assert!(made > 20, "{made}");
    }
}
