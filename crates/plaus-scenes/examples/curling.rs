//! A scene of your own, whole, in one file: stones slide over ice between two rails and should come to rest in a ring.
//! How each is delivered, and how slippery the ice is, are uncertain.
//!
//!     cargo run --release -p plaus-scenes --example curling -- [ITERATIONS]
//!
//! A scene declares its variables, simulates a draw, and says what is asked of an outcome. Then the library's moves
//! sample it, tables and diagnostics have its columns, and it takes any requirement; here, a bounce off a rail.
#![allow(clippy::print_stdout, reason = "an example reports to the terminal")]

use glam::{DVec2, DVec3};
use plaus_dist::{Gaussian, LogDensity, LogPotential, Seed, Stream, math};
use plaus_mcmc::library::{RedrawGroup, Sizes, Step};
use plaus_mcmc::vars::log_prior;
use plaus_mcmc::{
    Chain, Goal, Law, Mixture, ModelError, Recipe, Simulated, SolutionClass, StateRefOf, Target, Var, Variables, Vars,
};
use plaus_scenes::animation::{Animation, Impact, Look, Piece, Prop, Shape, Track, View, upright};
use plaus_scenes::model::columns::{scalars, values};
use plaus_scenes::model::{Column, Features};
use plaus_scenes::require::{Cast, FAR, Mark, Missed, Require, RestsAt};
use plaus_scenes::{Asked, ConfigError, Member, Rules, Scalar, Scene};
use serde::{Deserialize, Serialize};
use std::collections::BTreeSet;
use std::error::Error;

/// Standard gravity, m/s².
const GRAVITY: f64 = 9.806_65;
/// From the release to the ring's middle, in m.
const AWAY: f64 = 28.0;
/// Radius of the ring, in m.
const RING: f64 = 0.61;
/// Half the width between the rails, in m.
const HALF: f64 = 2.2;
/// Radius of a stone, in m.
const STONE: f64 = 0.145;
/// Rebound speed over approach speed at a rail.
const RESTITUTION: f64 = 0.8;
/// How sharply a stone is led to the ring, in m.
const SIGMA: f64 = 0.3;

/// Stones, one after another, each alone on the ice.
pub(crate) struct Curling {
    stones: usize,
    vars: Vars,
}

/// The variables of each stone: speed in m/s, direction in degrees, friction.
const EACH: usize = 3;

/// A part of a stone's way, along which only friction slows it: when and where it begins, in s and m, with which
/// velocity.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
pub(crate) struct Leg {
    time: f64,
    pub(crate) place: DVec2,
    velocity: DVec2,
}

/// The legs of each stone's way; the last one is at rest.
pub(crate) type Ways = Vec<Vec<Leg>>;

impl Curling {
    pub(crate) fn new(stones: usize) -> Result<Self, Box<dyn Error>> {
        let laws = [("speed", "m/s", 2.4, 0.15), ("direction", "°", 0.0, 3.0), ("friction", "", 0.0105, 0.0005)];
        let mut vars = Vec::new();
        for stone in 1..=stones as u32 {
            for (name, unit, mean, sd) in laws {
                vars.push(Var::new(name, unit, Law::Gaussian(Gaussian::new(mean, sd)?)).of("stone", stone).column(1.0));
            }
        }
        Ok(Self { stones, vars: Vars::new(vars) })
    }

    /// How far a stone comes to rest from the ring's middle, in m.
    fn off(way: &[Leg]) -> f64 {
        way.last().map_or(f64::INFINITY, |rest| rest.place.distance(DVec2::new(AWAY, 0.0)))
    }
}

/// The way of a stone with these numbers: straight from rail to rail, in closed form.
pub(crate) fn slide(numbers: &[f64]) -> Vec<Leg> {
    let &[speed, direction, friction] = numbers else { return Vec::new() };
    let (sine, cosine) = math::sin_cos(direction.to_radians());
    let slowing = friction.max(1e-6) * GRAVITY;
    let mut leg = Leg { time: 0.0, place: DVec2::ZERO, velocity: speed.max(0.0) * DVec2::new(cosine, sine) };
    let mut way = vec![leg];
    loop {
        let (speed, along) = (leg.velocity.length(), leg.velocity.normalize_or_zero());
        let whole = 0.5 * speed * speed / slowing;
        let side = (HALF - STONE).copysign(along.y);
        let free = (side - leg.place.y) / along.y;
        // A stone that does not reach the rail stops; one on the rail moves away from it.
        let is_hit = along.y != 0.0 && free < whole;
        let length = if is_hit { free } else { whole };
        let end = (speed * speed - 2.0 * slowing * length).max(0.0).sqrt();
        let (time, place) = (leg.time + (speed - end) / slowing, leg.place + length * along);
        let velocity = if is_hit { end * along * DVec2::new(1.0, -RESTITUTION) } else { DVec2::ZERO };
        leg = Leg { time, place, velocity };
        way.push(leg);
        if !is_hit {
            return way;
        }
    }
}

impl Target for Curling {
    type Draw = Vec<f64>;
    type Outcome = Ways;
    type Scratch = ();

    fn start(&self, stream: &mut Stream) -> Vec<f64> {
        let mut draw = vec![0.0; self.vars.len()];
        self.renew_all(&mut draw, Recipe::Exact, stream);
        draw
    }

    fn log_prior(&self, draw: &Vec<f64>) -> Result<LogDensity, ModelError> {
        Ok(log_prior(self, draw)?)
    }

    fn simulate(
        &self,
        draw: &Vec<f64>,
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<Ways>, ModelError> {
        Ok(Simulated::Complete(draw.chunks(EACH).map(slide).collect()))
    }

    fn log_constraint(&self, ways: &Ways) -> Result<LogPotential, ModelError> {
        let log = |way: &Vec<Leg>| -0.5 * math::square(Self::off(way) / SIGMA);
        Ok(LogPotential::new(ways.iter().map(log).sum())?)
    }

    fn most(&self) -> Option<LogPotential> {
        Some(LogPotential::ONE)
    }
}

impl Variables for Curling {
    fn vars(&self) -> &Vars {
        &self.vars
    }

    fn get<'a>(&self, draw: &'a Vec<f64>, var: usize) -> Option<&'a [f64]> {
        draw.get(var).map(std::slice::from_ref)
    }

    fn get_mut<'a>(&self, draw: &'a mut Vec<f64>, var: usize) -> Option<&'a mut [f64]> {
        draw.get_mut(var).map(std::slice::from_mut)
    }
}

impl Goal for Curling {
    fn class(&self, state: StateRefOf<'_, Self>) -> Option<SolutionClass> {
        let bounces = |way: &Vec<Leg>| way.len() as i64;
        let all = state.outcome.iter().fold(SolutionClass::EMPTY, |class, way| class.with(bounces(way)));
        state.outcome.iter().all(|way| Self::off(way) < RING).then_some(all)
    }
}

impl Scene for Curling {
    fn moves(&self, _: &Rules) -> Result<Mixture<Self>, ConfigError> {
        let all = self.vars.which(|_| true);
        let step = Step::of("step", &all, Sizes::new(1e-3, 1.0));
        let moves =
            Mixture::new(vec![(1.0, Box::new(step) as _), (0.3, Box::new(RedrawGroup { name: "redraw" }) as _)]);
        moves.map_err(|error| ConfigError::new("weights", error))
    }

    fn scalars(&self) -> Vec<Scalar> {
        let of = |number| Column::result("off", "m").of(Some(Member { kind: "stone", number }));
        scalars((1..=self.stones as u32).map(of).collect(), &self.vars)
    }

    fn write_scalars(&self, state: StateRefOf<'_, Self>, places: &mut [f64]) {
        let mut numbers = values(self, state.draw);
        for (way, places) in state.outcome.iter().zip(places.chunks_exact_mut(EACH + 1)) {
            places[0] = Self::off(way);
            places[1..].iter_mut().zip(&mut numbers).for_each(|(place, number)| *place = number);
        }
    }

    /// How often each stone bounces, and where it comes to rest, to a tenth of a metre.
    fn features(&self, state: StateRefOf<'_, Self>, features: &mut Features) -> bool {
        for way in state.outcome {
            features.number(way.len() as i64);
            way.last().into_iter().flat_map(|rest| rest.place.to_array()).for_each(|x| features.place(10.0 * x));
        }
        self.class(state).is_some()
    }

    fn cast(&self) -> Cast {
        let bodies = (1..=self.stones).map(|stone| format!("stone_{stone}")).collect();
        Cast { bodies, fixed: vec!["rail".into()], turns: false, ..Cast::default() }
    }

    fn demands(&self) -> Vec<(String, Require)> {
        let (x_mm, within_mm) = (1e3 * AWAY, 1e3 * RING);
        let rests = |body| Require::RestsAt(RestsAt { body, x_mm, within_mm, ..RestsAt::default() });
        self.cast().bodies.into_iter().map(|body| ("the ring".to_owned(), rests(body))).collect()
    }

    fn asked(&self) -> Vec<String> {
        vec!["all stones in the ring".into()]
    }

    fn answers(&self, state: StateRefOf<'_, Self>) -> Vec<Mark> {
        let worst = state.outcome.iter().map(|way| Self::off(way)).fold(0.0, f64::max);
        vec![Mark::of(RING - worst)]
    }

    fn missed(&self, _: usize, margin: f64) -> Option<Missed> {
        Some(if margin > -FAR { Missed::By(-margin, "m") } else { Missed::Never })
    }

    fn animate(&self, draw: &Vec<f64>) -> Result<Animation, ModelError> {
        let level = |v: DVec2| upright(DVec3::new(v.x, v.y, 0.0));
        let (mut tracks, mut impacts, mut last) = (Vec::new(), Vec::new(), 0.0_f64);
        for (stone, numbers) in draw.chunks(EACH).enumerate() {
            let (way, name) = (slide(numbers), format!("stone_{}", stone + 1));
            let slowing = |leg: &Leg| -leg.velocity.normalize_or_zero() * numbers[2] * GRAVITY;
            let piece =
                |leg: &Leg| Piece::ballistic(leg.time, level(leg.place), level(leg.velocity), level(slowing(leg)));
            for (before, leg) in way.iter().zip(&way[1..]).filter(|(_, leg)| leg.velocity != DVec2::ZERO) {
                let normal = DVec2::new(0.0, leg.velocity.y.signum());
                let speed = (before.velocity + (leg.time - before.time) * slowing(before)).dot(normal).abs();
                let at = level(leg.place - STONE * normal);
                impacts
                    .push(Impact::new(leg.time, &name, "rail", at, level(normal)).with_strength(speed, 20.0 * speed));
            }
            last = last.max(way.last().map_or(0.0, |rest| rest.time));
            tracks.push(Track::new(name, Shape::ball(STONE), Look::nth(stone), way.iter().map(piece).collect()));
        }
        let rail = |side: f64| {
            let middle = upright(DVec3::new(0.5 * AWAY, side * (HALF + 0.05), 0.0));
            Prop::block("rail", Look::WOOD, middle, DVec3::new(0.5 * AWAY + 2.0, 0.1, 0.05))
        };
        let view = View::from(-0.2, 0.5, 1.0);
        Ok(Animation::new(last, tracks, impacts).with_scenery(vec![rail(-1.0), rail(1.0)]).with_view(view))
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    let iterations = std::env::args().nth(1).map_or(Ok(20_000), |text| text.parse())?;
    // The scene, and one thing more: the second stone comes off a rail.
    let required: Require = serde_json::from_str(r#"{ "touches": { "body": "stone_2", "with": "rail" } }"#)?;
    let scene = Asked::new(Curling::new(2)?, &[required])?;
    let moves = scene.moves(&Rules::default())?;
    let mut chain = Chain::start(&scene, &moves, Seed(1).chain(0))?;
    let (mut hits, mut kinds) = (0_u64, BTreeSet::new());
    for _ in 0..iterations {
        chain.step()?;
        let class = scene.class(chain.state().by_ref());
        hits += u64::from(class.is_some());
        kinds.extend(class);
    }
    println!("{hits} of {iterations} states are solutions, {} of them distinct", kinds.len());
    let columns = scene.scalars();
    let mut values = vec![0.0; columns.len()];
    scene.write_scalars(chain.state().by_ref(), &mut values);
    columns.iter().zip(values).for_each(|(column, value)| println!("  {} {value:.3} {}", column.name, column.unit));
    Ok(())
}
