//! Dice on one table, simulated group by group: see [`crate::model::groups`]. A group need not be simulated again if
//! its dice are the same, thrown alike, and came near no control point that has changed.

use super::Dice;
use super::animate::film;
use super::draw::{Draw, Site};
use super::fall::{Fall, Recorded};
use super::flight::Trip;
use super::throwing::Work;
use crate::model::groups::{Groups, Runner};
use crate::require::Stop;
use plaus_dist::LogPotential;
use plaus_mcmc::ModelError;
use std::sync::Arc;

/// Dice whose centres are nearer than this many times the reach of a die are simulated together: 2, and more than the
/// gap at which bodies touch.
const NEAR: f64 = 2.0 * 1.01;

/// How two draws differ; `None` if they differ in everything.
struct Differing<'a> {
    draws: [&'a Draw; 2],
    sites: Vec<Site>,
}

impl<'a> Differing<'a> {
    fn new(old: &'a Draw, new: &'a Draw) -> Option<Self> {
        let sites = old.tables[0].differing(&new.tables[0])?;
        Some(Self { draws: [old, new], sites })
    }

    /// Whether a simulation for the old draw has the same bits for the new one.
    fn leaves(&self, fall: &Fall) -> bool {
        let [old, new] = self.draws;
        fall.members.iter().all(|&die| old.throws[die].moves_like(&new.throws[die]))
            && !self.sites.iter().any(|site| fall.touched.has(*site))
    }
}

impl Work {
    /// The trips of dice thrown onto one table. `known` is a draw whose simulation can be reused in part; it is
    /// simulated now unless it is remembered.
    pub(super) fn throw_together(
        &mut self,
        scene: &Dice,
        (draw, stop): (&Draw, Option<Stop>),
        known: Option<&Draw>,
    ) -> Result<Option<Vec<Trip>>, ModelError> {
        let mut memory = std::mem::take(&mut self.memory);
        let made = memory
            .simulate((draw, stop), known, |draw, known, next, stop| self.falls((scene, draw), known, next, stop));
        let of_dice = |groups: &Groups<Draw, Fall>| {
            let mut trips: Vec<Option<Trip>> = vec![None; draw.throws.len()];
            for group in &groups.last {
                for (&die, trip) in group.members.iter().zip(&group.trips) {
                    trips[die] = Some(trip.clone());
                }
            }
            trips.into_iter().flatten().collect()
        };
        let trips = made.map(|groups| groups.map(of_dice));
        self.memory = memory;
        trips
    }

    /// The final groups of a draw.
    pub(super) fn groups(&mut self, scene: &Dice, draw: &Draw) -> Result<Vec<Vec<usize>>, ModelError> {
        let mut falls = Groups::default();
        self.falls((scene, draw), &Groups::default(), &mut falls, None)?;
        Ok(falls.last.iter().map(|group| group.members.clone()).collect())
    }

    /// Simulates `draw` into `next`, reusing parts of `known` that do not change; returns whether it came to the end.
    fn falls(
        &mut self,
        (scene, draw): (&Dice, &Draw),
        known: &Groups<Draw, Fall>,
        next: &mut Groups<Draw, Fall>,
        stop: Option<Stop>,
    ) -> Result<bool, ModelError> {
        let differing = known.draw.as_ref().and_then(|old| Differing::new(old, draw));
        let same = |fall: &Fall| differing.as_ref().is_some_and(|differing| differing.leaves(fall));
        let reach = NEAR * scene.plan.reach_of_die();
        let dice = draw.throws.iter().map(|_| true);
        next.simulate(draw, dice, Some(reach), (known, same), &mut Throwing { work: self, scene, draw, stop })
    }
}

/// Dice of a draw that are simulated.
struct Throwing<'a> {
    work: &'a mut Work,
    scene: &'a Dice,
    draw: &'a Draw,
    stop: Option<Stop>,
}

impl Runner<Fall> for Throwing<'_> {
    fn run(&mut self, members: Vec<usize>) -> Result<Option<Fall>, ModelError> {
        // What becomes of all dice is known only if they are simulated together.
        let stop = self.stop.clone().filter(|_| members.len() == self.draw.throws.len());
        self.work.fall((self.scene, self.draw), members, (&[], stop))
    }

    fn is_hopeless(&self, groups: &[Arc<Fall>], known: impl FnOnce() -> f64) -> bool {
        let Some(stop) = &self.stop else { return false };
        let seen = groups.iter().map(|group| group.recorded.as_deref().map(Recorded::seen));
        let Some(seen) = seen.collect::<Option<Vec<_>>>() else { return false };
        let begun = film(self.scene, self.draw, &seen, known());
        begun.is_ok_and(|begun| stop.is_hopeless(LogPotential::ONE, &begun))
    }
}

#[cfg(test)]
mod tests {
    use crate::Scene;
    use crate::dice::{Config, Dice, End, Field, Site, Work};
    use plaus_dist::{Purpose, Seed};
    use plaus_mcmc::{State, Target};

    /// Simulated group by group, dice end where they do when all are simulated at once. The two round differently, and
    /// dice that hit each other or the edges of bumps amplify that without bound. So the places of one die in fifty may
    /// differ by more than a micrometre.
    #[test]
    fn simulating_by_groups_ends_like_simulating_all_at_once() {
        let config = Config { dice: 4, together: true, ..Config::default() };
        let scene = Dice::new(&config).unwrap();
        let (mut work, mut at_once) = (Work::default(), Work::default());
        let mut stream = Seed(7).chain(0).at(0, Purpose::START);
        let (mut draws, mut dice, mut differing, mut met) = (0, 0, 0, 0);
        while draws < 60 {
            let draw = scene.start(&mut stream);
            if scene.log_prior(&draw).unwrap().is_zero() {
                continue;
            }
            draws += 1;
            let trips = work.throw_together(&scene, (&draw, None), None).unwrap().unwrap();
            let all = at_once.fall((&scene, &draw), (0..4).collect(), (&[], None)).unwrap().unwrap().trips;
            // A die that leaves ends the simulation of its group.
            if trips.iter().chain(&all).any(|trip| trip.end != End::AtRest) {
                continue;
            }
            for (a, b) in trips.iter().zip(&all) {
                dice += 1;
                met += usize::from(a.met);
                differing += usize::from(a.met != b.met || a.position.distance(b.position) > 1e-6);
            }
        }
        assert!(dice > 100 && met >= 10, "{dice} dice, of which {met} met another");
        assert!(50 * differing <= dice, "{differing} of {dice} differ");
    }

    /// Another state is simulated only as far as it differs from the current one, and the result is the same as from
    /// scratch.
    #[test]
    fn only_what_differs_is_simulated_again() {
        let scene = Dice::new(&Config { dice: 3, together: true, ..Config::default() }).unwrap();
        let plan = &scene.plan;
        let (mut work, mut stream) = (Work::default(), Seed(1).chain(0).at(0, Purpose::START));
        let current = loop {
            let draw = scene.start(&mut stream);
            let groups = work.groups(&scene, &draw).unwrap();
            // One die alone, two together.
            if !scene.log_prior(&draw).unwrap().is_zero() && groups == [vec![0], vec![1, 2]] {
                break draw;
            }
        };
        let trips = work.throw_together(&scene, (&current, None), Some(&current)).unwrap().unwrap();
        let mut simulated = |draw: &super::Draw| {
            let before = work.dice();
            let again = work.throw_together(&scene, (draw, None), Some(&current)).unwrap().unwrap();
            let fresh = Work::default().throw_together(&scene, (draw, None), None).unwrap().unwrap();
            assert_eq!(again, fresh);
            (work.dice() - before, again)
        };
        assert_eq!(simulated(&current), (0, trips.clone()));
        let with_point = |site: Site, score: f64| {
            let mut draw = current.clone();
            draw.tables[0].set(site, score);
            draw
        };
        // A point far from any die; one below the first contact of a die that is alone; one below that of a die that is
        // not.
        assert_eq!(simulated(&with_point(Site { field: Field::Height, i: -900, j: 900 }, 3.0)), (0, trips.clone()));
        let below = |die: usize| {
            let [_, x, y] = trips[die].impacts[0];
            let [i, j] = plan.surface.support(x, y).nth(5).unwrap();
            with_point(Site { field: Field::Height, i, j }, 3.0)
        };
        let (dice, moved) = simulated(&below(0));
        assert!(dice == 1 && moved[0] != trips[0] && moved[1..] == trips[1..], "{dice}");
        let (dice, moved) = simulated(&below(2));
        assert!((1..=7).contains(&dice) && moved[2] != trips[2], "{dice}");
        let mut turned = current.clone();
        turned.throws[1].turn = (turned.throws[1].turn + 1) % 24;
        assert_eq!(simulated(&turned).0, 0);
        turned.throws[0].velocity.x += 1e-3;
        assert!(simulated(&turned).0 >= 1);
    }

    /// A column of each die tells whether it met another one, and moves no other column.
    #[test]
    fn dice_on_one_table_tell_whether_they_met() {
        let of = |together| Dice::new(&Config { dice: 3, together, ..Config::default() }).unwrap();
        let names = |scene: &Dice| scene.scalars().into_iter().map(|scalar| scalar.name).collect::<Vec<_>>();
        assert!(!names(&of(false)).iter().any(|name| name.starts_with("met")));
        let scene = of(true);
        let (names, mut stream) = (names(&scene), Seed(5).chain(0).at(0, Purpose::START));
        let (mut values, mut seen) = (vec![0.0; names.len()], [0; 2]);
        for _ in 0..40 {
            let draw = scene.start(&mut stream);
            if scene.log_prior(&draw).unwrap().is_zero() {
                continue;
            }
            let state = State::evaluate(&scene, draw, &mut Work::default()).unwrap();
            scene.write_scalars(state.by_ref(), &mut values);
            let at = |name: &str, die: usize| {
                values[names.iter().position(|other| *other == format!("{name}_{}", die + 1)).unwrap()]
            };
            for (die, (trip, throw)) in state.outcome.trips.iter().zip(&state.draw.throws).enumerate() {
                assert_eq!(at("met", die), f64::from(u8::from(trip.met)));
                assert_eq!([at("impacts", die), at("x", die)], [trip.impacts.len() as f64, throw.position.x * 1e3]);
                seen[usize::from(trip.met)] += 1;
            }
        }
        assert!(seen.iter().all(|&count| count >= 5), "{seen:?}");
    }
}
