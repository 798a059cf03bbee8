//! The scene with a simulator that is simple enough to trust: balls fall straight down. Moves cannot tell the
//! difference, and thousands of draws take no time.

use plaus_dist::{LogDensity, LogPotential, Stream};
use plaus_mcmc::check::Statistic;
use plaus_mcmc::library::{RedrawAll, RedrawSome, ShiftOne, ShiftSome, Swap, Toggle};
use plaus_mcmc::view::View;
use plaus_mcmc::{ModelError, Move, Simulated, State, StateRefOf, Target, Variables};
use plaus_scenes::spelling::{BirthDeath, Config, Drops, Redrop, Rest, Spelling, Vertices};

pub(crate) type AnyMove = Box<dyn Move<Spelling>>;
pub(crate) type Letters = State<Drops, Rest>;

/// A ball lands in the bin below it, moved by the first vertex's offset. If another ball lies there already, it lands
/// in the next bin, and after the last bin in none. So outcomes depend on offsets, on the order of balls, and on all
/// earlier balls.
pub(crate) struct Straight<'a>(pub &'a Spelling);

impl Target for Straight<'_> {
    type Draw = Drops;
    type Outcome = Rest;
    type Scratch = ();

    fn start(&self, stream: &mut Stream) -> Drops {
        self.0.start(stream)
    }

    fn log_prior(&self, draw: &Drops) -> Result<LogDensity, ModelError> {
        self.0.log_prior(draw)
    }

    fn simulate(
        &self,
        draw: &Drops,
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<Rest>, ModelError> {
        let mut rest = Rest { bins: Vec::new(), complete: true, failed: None };
        let count = (self.0.word().columns() * self.0.word().rows()) as u16;
        for ball in &draw.balls {
            let land = |position: &[f64; 2]| {
                // Ten times the offset, so that it matters.
                let at = [position[0] + 10.0 * draw.offsets[0][0], position[1]];
                let is_over = |bin: &u16| {
                    self.0.over(*bin).is_some_and(|ends| (0..2).all(|k| ends[k][0] <= at[k] && at[k] < ends[k][1]))
                };
                let mut bin = (0..count).find(is_over)?;
                while rest.bins.contains(&Some(bin)) {
                    bin += 1;
                }
                (bin < count).then_some(bin)
            };
            let bin = ball.as_ref().and_then(land);
            rest.bins.push(bin);
        }
        Ok(Simulated::Complete(rest))
    }

    fn log_constraint(&self, rest: &Rest) -> Result<LogPotential, ModelError> {
        self.0.log_constraint(rest)
    }
}

impl View for Straight<'_> {
    type Seen = Spelling;

    fn seen(&self) -> &Spelling {
        self.0
    }
}

pub(crate) fn scene(change: impl FnOnce(&mut Config)) -> Spelling {
    let mut config = Config::default();
    change(&mut config);
    Spelling::new(&config).unwrap()
}

/// Four balls for four of 5 × 4 bins, among 12 random vertices.
pub(crate) fn small(ln_lambda: f64) -> Spelling {
    scene(|config| {
        config.bitmap = "##.\n.##".into();
        config.vertices = Vertices::Interior;
        config.ln_lambda = Some(ln_lambda);
        // Large enough to make a difference.
        config.sigma_mm = 0.4;
    })
}

pub(crate) fn change_vertices(scene: &Spelling) -> AnyMove {
    let among = scene.vars().named(&["offset"]);
    Box::new(ShiftSome { name: "change_vertices", among, chance: 0.2, sd: 0.2, adapts: false })
}

pub(crate) fn redraw_vertices(scene: &Spelling) -> AnyMove {
    Box::new(RedrawSome { name: "redraw_vertices", among: scene.vars().named(&["offset"]), chance: 0.2 })
}

pub(crate) fn change_ball(scene: &Spelling) -> AnyMove {
    Box::new(ShiftOne { name: "change_ball", among: scene.vars().named(&["drop"]), sd: 20.0 })
}

pub(crate) fn toggle(scene: &Spelling, incomplete: bool) -> Toggle {
    Toggle { name: "toggle", among: scene.vars().named(&["drop"]), chance: 0.25, incomplete }
}

/// Every move, with settings that make each of its ways likely.
pub(crate) fn all_moves(scene: &Spelling) -> Vec<AnyMove> {
    vec![
        Box::new(RedrawAll::exact("change_all")),
        change_vertices(scene),
        redraw_vertices(scene),
        change_ball(scene),
        Box::new(toggle(scene, false)),
        Box::new(Redrop { aimed: 0.7 }),
        Box::new(BirthDeath { aimed: 0.7 }),
        Box::new(Swap { name: "swap", among: scene.vars().named(&["drop"]) }),
    ]
}

/// Numbers whose law must not change: how many balls are dropped, where two of them are, some offsets, and where the
/// balls ended.
pub(crate) fn statistics(scene: &Spelling) -> Vec<Statistic<'_, Drops, Rest>> {
    let coordinate = |ball: usize, axis: usize| {
        let value = move |state: &Letters| state.draw.balls[ball].map_or(-1.0, |position| position[axis]);
        Statistic::new(format!("ball {ball}, axis {axis}"), value)
    };
    let balls = scene.balls() - 1;
    vec![
        Statistic::new("dropped", |state: &Letters| state.draw.active() as f64),
        Statistic::new("filled", |state: &Letters| scene.filled(&state.outcome) as f64),
        Statistic::new("in a bin", |state: &Letters| state.outcome.bins.iter().flatten().count() as f64),
        Statistic::new("an offset", |state: &Letters| state.draw.offsets[0][0]),
        Statistic::new("another", |state: &Letters| state.draw.offsets[1][2]),
        coordinate(0, 0),
        coordinate(0, 1),
        coordinate(balls, 0),
    ]
}
