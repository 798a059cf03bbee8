//! The scene with a simulator that is simple enough to trust: the ball keeps its direction, and pins in its way fall.
//! Moves cannot tell the difference, and thousands of shots take no time.

use plaus_dist::{LogDensity, LogPotential, Stream};
use plaus_mcmc::check::Statistic;
use plaus_mcmc::library::{RedrawAll, RedrawOne, RedrawSome, ShiftAll, ShiftSome, Sizes, Stride, Symmetry};
use plaus_mcmc::view::View;
use plaus_mcmc::{Fit, ModelError, Move, Simulated, State, StateRefOf, Target, Variables};
use plaus_scenes::bowling::{Aim, Bowling, Config, Delivery, Entry, Fate, Quantity, Rest, Shot, mirror};

pub(crate) type AnyMove = Box<dyn Move<Bowling>>;
pub(crate) type Bowled = State<Shot, Rest>;

/// Pins whose centre is closer to the ball's straight path than its radius fall. Offsets count ten times, so that they
/// matter.
pub(crate) struct Straight<'a>(pub &'a Bowling);

/// Place of a pin's spot across the lane, and beyond the head pin, in m.
fn spot(pin: usize) -> [f64; 2] {
    let (row, place) = match pin {
        1 => (0, 0),
        2..=3 => (1, pin - 2),
        4..=6 => (2, pin - 4),
        _ => (3, pin - 7),
    };
    [0.3048 * (place as f64 - 0.5 * f64::from(row)), 0.264 * f64::from(row)]
}

impl Target for Straight<'_> {
    type Draw = Shot;
    type Outcome = Rest;
    type Scratch = ();

    fn start(&self, stream: &mut Stream) -> Shot {
        self.0.start(stream)
    }

    fn log_prior(&self, draw: &Shot) -> Result<LogDensity, ModelError> {
        self.0.log_prior(draw)
    }

    fn simulate(
        &self,
        draw: &Shot,
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<Rest>, ModelError> {
        let slope = (draw.get(Quantity::Drift) + 0.01 * draw.get(Quantity::Hook)) / draw.get(Quantity::Speed);
        let mut rest = Rest { pins: Vec::new(), entry: None, struck: Vec::new(), complete: true, failed: None };
        for (pin, offset) in self.0.rack().pins().iter().zip(&draw.pins) {
            let [x, y] = spot(*pin);
            let way = draw.get(Quantity::Across) + slope * (18.3 + y) - x - 0.01 * offset[0];
            let is_struck = way.abs() < draw.get(Quantity::Radius);
            let moved = (offset[0] * offset[0] + offset[1] * offset[1]).sqrt() / 1000.0;
            rest.pins.push(if is_struck { Fate::Down } else { Fate::Standing(moved) });
            if is_struck {
                rest.struck.push(*pin as u8);
                rest.entry.get_or_insert(Entry { across: x + way, angle: slope.to_degrees() });
            }
        }
        Ok(Simulated::Complete(rest))
    }

    fn log_constraint(&self, rest: &Rest) -> Result<LogPotential, ModelError> {
        self.0.log_constraint(rest)
    }
}

impl View for Straight<'_> {
    type Seen = Bowling;

    fn seen(&self) -> &Bowling {
        self.0
    }
}

pub(crate) fn scene(change: impl FnOnce(&mut Config)) -> Bowling {
    let mut config = Config::default();
    change(&mut config);
    Bowling::new(&config).unwrap()
}

/// Three pins, which look the same in the mirror, one of which should be left. With the regulation delivery all
/// quantities of the ball are uncertain.
pub(crate) fn small(ln_lambda: f64, delivery: Delivery) -> Bowling {
    scene(|config| {
        config.pins = vec![1, 4, 6];
        config.leave = vec![1];
        config.ln_lambda = ln_lambda;
        config.moved_far_mm = 1.2;
        config.delivery = delivery;
    })
}

/// Steps of half a width.
pub(crate) fn strides(scene: &Bowling, vars: &[usize]) -> Vec<Stride> {
    vars.iter().map(|&var| Stride { var, part: 0.5, of: scene.vars().get(var).law.width() }).collect()
}

/// Some quantities of the ball shifted.
pub(crate) fn shifted(scene: &Bowling, quantities: &[Quantity]) -> AnyMove {
    let names: Vec<&str> = quantities.iter().map(|quantity| quantity.name().0).collect();
    Box::new(ShiftAll::by("change", strides(scene, &scene.vars().named(&names))))
}

/// The aim after learning that balls should come to places on one side of the lane, where few would come otherwise. How
/// far to the side depends on the ball's speed, unless the aim is to be `misled` about that.
pub(crate) fn learnt(scene: &Bowling, aim: &Aim, misled: bool) -> AnyMove {
    let width = |quantity: Quantity| scene.vars().get(quantity as usize).law.width();
    let point = |k: i32| {
        let [of_radius, of_speed] = [f64::from(k % 7) / 7.0, f64::from(k * 11 % 40) / 40.0];
        let radius = 0.108 + 0.001 * of_radius;
        let speed = 7.5 + of_speed;
        let aside = 0.2 + 0.05 * if misled { of_radius } else { of_speed } + 0.002 * f64::from(k % 5);
        [radius / width(Quantity::Radius), speed / width(Quantity::Speed), aside]
    };
    let points: Vec<f64> = (0..40).flat_map(point).collect();
    aim.at_fits(&[Fit::to(&points, 3)]).unwrap()
}

/// Every move, with settings that make each of its ways likely.
pub(crate) fn all_moves(scene: &Bowling) -> Vec<AnyMove> {
    use Quantity::{Across, Density, Drift, Gyration, Height, Hook, Radius, Roll, Speed, Twist};
    let pins = || scene.vars().named(&["offset"]);
    let ball = scene.vars().which(|var| var.member.is_none());
    let every = strides(scene, &scene.vars().which(|_| true));
    vec![
        Box::new(RedrawAll::exact("change_all")),
        shifted(scene, &[Radius]),
        shifted(scene, &[Density, Gyration]),
        shifted(scene, &[Across, Height]),
        shifted(scene, &[Speed, Drift]),
        shifted(scene, &[Roll, Hook, Twist]),
        Box::new(ShiftSome { name: "change_pins", among: pins(), chance: 0.5, sd: 0.5, adapts: true }),
        Box::new(RedrawOne { name: "redraw", among: ball, symmetric: false }),
        Box::new(RedrawSome { name: "redraw_pins", among: pins(), chance: 0.3 }),
        Box::new(Aim::new(scene, 0.5)),
        learnt(scene, &Aim::new(scene, 0.5), false),
        Box::new(ShiftAll::at_many_scales("refine", every, Sizes::down_to(1e-4))),
        Box::new(Symmetry { name: "mirror", map: mirror }),
    ]
}

/// Numbers whose law must not change: the ball's quantities, two offsets, and which pins fell.
pub(crate) fn statistics(scene: &Bowling) -> Vec<Statistic<'_, Shot, Rest>> {
    let quantity =
        |quantity: Quantity| Statistic::new(quantity.name().0, move |state: &Bowled| state.draw.get(quantity));
    let is_uncertain = |quantity: &Quantity| scene.vars().get(*quantity as usize).law.is_uncertain();
    let mut all: Vec<_> = Quantity::ALL.into_iter().filter(is_uncertain).map(quantity).collect();
    all.push(Statistic::new("over the lane", |state: &Bowled| {
        state.draw.get(Quantity::Height) - state.draw.get(Quantity::Radius)
    }));
    all.push(Statistic::new("an offset", |state: &Bowled| state.draw.pins[0][0]));
    all.push(Statistic::new("another", |state: &Bowled| state.draw.pins[2][1]));
    all.push(Statistic::new("k + m", |state: &Bowled| {
        let (k, m) = scene.counts(&state.outcome);
        (k + m) as f64
    }));
    all.push(Statistic::new("first down", |state: &Bowled| f64::from(u8::from(!state.outcome.pins[0].stands()))));
    all
}
