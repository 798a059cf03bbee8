//! The scene with a simulator that is fast, and simple enough to trust. Moves cannot tell the difference.

use glam::{DQuat, DVec3};
use plaus_dist::{LogDensity, LogPotential, Stream};
use plaus_mcmc::check::Statistic;
use plaus_mcmc::library::{RedrawAll, RedrawGroup, Sizes, Symmetry};
use plaus_mcmc::view::View;
use plaus_mcmc::{ModelError, Move, Simulated, State, StateRefOf, Target};
use plaus_scenes::dice::{
    Config, Constraint, Dice, Draw, FaceUp, Field, Point, Rest, RestAt, Shift, Site, Trip, component, turn,
};

pub(crate) type AnyMove = Box<dyn Move<Dice>>;
pub(crate) type Thrown = State<Draw, Rest>;

/// A die lands where its velocity brings it in a tenth of a second, moved by the height of the control point there. If
/// that point is above its mean, the die touches the table mostly there, otherwise mostly far behind it. So it depends
/// on the draw which points are near collisions. The die lies in the orientation in which it was thrown, or always on
/// the face that its first axis points to.
pub(crate) struct Plain<'a> {
    pub(crate) dice: &'a Dice,
    pub(crate) flat: bool,
}

/// Distance of control points in [`small`], in m.
const CELL: f64 = 0.03;

/// The site below a place.
fn below(place: DVec3) -> Site {
    let [i, j] = [place.x, place.y].map(|x| (x / CELL).round() as i32);
    Site { field: Field::Height, i, j }
}

impl Plain<'_> {
    fn trip(&self, draw: &Draw, die: usize) -> Trip {
        let throw = &draw.throws[die];
        let landing = throw.position + 0.1 * throw.velocity;
        let score = draw.tables[draw.table_of(die)].score(below(landing));
        let first = throw.position - 0.2 * DVec3::X;
        let [often, once] = if score > 0.0 { [landing, first] } else { [first, landing] };
        let mut impacts = vec![[0.1, often.x, often.y]; if score > 0.0 { 8 } else { 7 }];
        impacts.push([0.2, once.x, once.y]);
        let on_its_side = DQuat::from_rotation_arc(DVec3::X, DVec3::Z);
        Trip::resting(
            landing + DVec3::X * 0.02 * score,
            if self.flat { on_its_side } else { throw.orientation },
            impacts,
        )
    }
}

impl Target for Plain<'_> {
    type Draw = Draw;
    type Outcome = Rest;
    type Scratch = ();

    fn start(&self, stream: &mut Stream) -> Draw {
        self.dice.start(stream)
    }

    fn log_prior(&self, draw: &Draw) -> Result<LogDensity, ModelError> {
        self.dice.log_prior(draw)
    }

    fn simulate(
        &self,
        draw: &Draw,
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<Rest>, ModelError> {
        let trips = (0..draw.throws.len()).map(|die| self.trip(draw, die)).collect();
        Ok(Simulated::Complete(self.dice.judge(draw, trips)))
    }

    fn log_constraint(&self, rest: &Rest) -> Result<LogPotential, ModelError> {
        self.dice.log_constraint(rest)
    }
}

impl View for Plain<'_> {
    type Seen = Dice;

    fn seen(&self) -> &Dice {
        self.dice
    }
}

pub(crate) fn scene(change: impl FnOnce(&mut Config)) -> Dice {
    let mut config = Config::default();
    change(&mut config);
    Dice::new(&config).unwrap()
}

/// Two dice over few control points, with constraints that many draws of the prior nearly satisfy.
pub(crate) fn small(change: impl FnOnce(&mut Config)) -> Dice {
    scene(|config| {
        config.dice = 2;
        config.table.grid_mm = 30.0;
        config.throw.place_sd_mm = 20.0;
        config.constraints = vec![
            Constraint::RestAt(RestAt { x_mm: -40.0, sigma_mm: 40.0, ..RestAt::default() }),
            Constraint::RestAt(RestAt { die: 2, x_mm: -60.0, y_mm: 20.0, sigma_mm: 40.0, ..RestAt::default() }),
            Constraint::FaceUp(FaceUp { ln_lambda: 1.0, within_deg: 45.0, ..FaceUp::default() }),
        ];
        change(config);
    })
}

/// All moves.
pub(crate) fn all_moves(dice: &Dice) -> Vec<AnyMove> {
    let sizes = Sizes::new(0.3, 1.0);
    vec![
        Box::new(RedrawAll::exact("everything")),
        Box::new(component(dice, sizes)),
        Box::new(Point::anywhere(sizes)),
        Box::new(Point::near(sizes)),
        Box::new(RedrawGroup { name: "rethrow" }),
        Box::new(Symmetry { name: "turn", map: turn }),
        Box::new(Shift { sd: 0.02 }),
    ]
}

/// Numbers whose law must not change: how the dice are thrown, where they lie and what they show, and the table below
/// them.
pub(crate) fn statistics() -> Vec<Statistic<'static, Draw, Rest>> {
    let landing = |state: &Thrown, die: usize| state.draw.throws[die].position + 0.1 * state.draw.throws[die].velocity;
    let table = |state: &Thrown, die: usize, at: DVec3| state.draw.tables[state.draw.table_of(die)].score(below(at));
    fn last(state: &Thrown) -> &plaus_scenes::dice::Throw {
        state.draw.throws.last().unwrap()
    }
    vec![
        Statistic::new("x", |state: &Thrown| (state.draw.throws[0].position + state.draw.offset(0, CELL)).x),
        Statistic::new("y", |state: &Thrown| (last(state).position + state.draw.offset(1, CELL)).y),
        Statistic::new("z", |state: &Thrown| state.draw.throws[0].position.z),
        Statistic::new("velocity", |state: &Thrown| state.draw.throws[0].velocity.y),
        Statistic::new("spin", |state: &Thrown| last(state).spin.x),
        Statistic::new("turned", |state: &Thrown| (state.draw.throws[0].orientation * DVec3::X).z),
        Statistic::new("face", |state: &Thrown| f64::from(state.outcome.faces[0])),
        Statistic::new("rest x", |state: &Thrown| (state.outcome.trips[0].position + state.draw.offset(0, CELL)).x),
        Statistic::new("rest y", |state: &Thrown| {
            (state.outcome.trips.last().unwrap().position + state.draw.offset(1, CELL)).y
        }),
        Statistic::new("impacts", |state: &Thrown| state.outcome.trips[0].impacts.len() as f64),
        Statistic::new("below the die", move |state: &Thrown| table(state, 0, landing(state, 0))),
        Statistic::new("beside it", move |state: &Thrown| table(state, 0, landing(state, 0) + DVec3::X * CELL)),
        Statistic::new("fixed point", move |state: &Thrown| {
            table(state, 0, DVec3::new(-0.06, 0.0, 0.0) - state.draw.offset(0, CELL))
        }),
    ]
}
