//! Contact that is known to be hard. Each case states what must come of it: closed forms, conservation, symmetry.
//!
//! The example `contact_cases` prints the cases for every preset. A case that takes too long is cut off and says so.
#![allow(dead_code, unreachable_pub)]

mod balls;
pub mod boxes;
mod guard;
mod round;
pub mod throws;

pub use guard::Guard;
#[allow(unused_imports, reason = "shared by programs that use parts of it")]
pub use throws::{Toss, read_tosses};

use plaus_sim::{Accuracy, Preset};

/// How a case is run.
#[derive(Debug, Clone, Copy)]
pub struct Setting<'t> {
    pub preset: Preset,
    pub guard: Guard,
    /// Number of throws, in a case with many.
    pub throws: u64,
    /// Tosses of a real cube, if there are any.
    pub tosses: &'t [Toss],
}

impl Setting<'_> {
    pub fn accuracy(&self) -> Accuracy {
        Accuracy::preset(self.preset)
    }
}

/// The result of a case.
#[derive(Debug, Clone)]
pub struct Found {
    /// In words and numbers.
    pub text: String,
    /// Whether it is as expected.
    pub holds: bool,
    /// How far it is from the expected result, as the case measures it; NaN if the run was cut off.
    pub off: f64,
}

impl Found {
    pub fn new(holds: bool, off: f64, text: String) -> Self {
        Self { text, holds, off }
    }
}

/// One line of the table.
pub struct Case {
    pub name: &'static str,
    pub expected: &'static str,
    /// What is measured: see [`Found::off`].
    pub measure: &'static str,
    pub run: fn(&Setting<'_>) -> Found,
}

const fn case(
    name: &'static str,
    expected: &'static str,
    measure: &'static str,
    run: fn(&Setting<'_>) -> Found,
) -> Case {
    Case { name, expected, measure, run }
}

/// The table.
pub const CASES: [Case; 25] = [
    case("ice, e 0.125", "momentum kept", "part of it lost, worst throw", |s| throws::ice(s, 0.125)),
    case("ice, e 0.5", "momentum kept", "part of it lost, worst throw", |s| throws::ice(s, 0.5)),
    case("Coulomb's bound", "kept by all throws", "beyond it, m/s, worst throw", throws::bound),
    case("tosses of a cube", "real: 3.87 widths; random: see truths", "mean way, relative", throws::travel),
    case("flat cube, e 0", "stays on its spot", "edges aside + rad of yaw", |s| throws::flat(s, 0.0)),
    case("flat cube, e 0.5", "stays on its spot", "edges aside + rad of yaw", |s| throws::flat(s, 0.5)),
    case("cuboid slides to rest", "v²/(2 µ g), straight", "way, relative", throws::slides),
    case("two cubes meet", "mirror images stay so", "edges + rad/2, median throw", throws::mirrored),
    case("box on 25 balls", "box 1.2 g_x, balls 0.6 g_x", "acceleration, relative, worst body", boxes::on_balls),
    case("stack of 10", "rest", "farthest shift, edges", boxes::stack),
    case("pyramid of 55", "rest", "farthest shift, edges", boxes::pyramid),
    case("dominoes, 0.1 h", "v/sqrt(gh) 1.166", "speed, relative", |s| boxes::dominoes(s, 0.1, 1.166)),
    case("dominoes, 0.3 h", "v/sqrt(gh) 1.433", "speed, relative", |s| boxes::dominoes(s, 0.3, 1.433)),
    case("dominoes, 0.5 h", "v/sqrt(gh) 1.310", "speed, relative", |s| boxes::dominoes(s, 0.5, 1.310)),
    case("heavy on light, 1e2", "overlap < 1 % of the size", "deepest overlap, radii", |s| balls::heavy(s, 1e2)),
    case("heavy on light, 1e4", "overlap < 1 % of the size", "deepest overlap, radii", |s| balls::heavy(s, 1e4)),
    case("heavy on light, 1e6", "overlap < 1 % of the size", "deepest overlap, radii", |s| balls::heavy(s, 1e6)),
    case("heavy on light, 1e9", "no overlap is called rest", "deepest overlap, radii", |s| balls::heavy(s, 1e9)),
    case("Galperin, N = 3", "3141 impacts", "number, relative", |s| balls::galperin(s, 3)),
    case("Galperin, N = 4", "31415 impacts", "number, relative", |s| balls::galperin(s, 4)),
    case("cradle on a floor, e 1", "(0, 0, 0, 1, 1)", "worst speed", balls::cradle),
    case("ball at rest, e 1", "rests, at once", "events", balls::at_rest),
    case("Euler's disk", "precession kept for 1 s", "rad behind + tilt, relative", round::euler),
    case("coin on its rim", "circle kept for 1 s", "rad behind + tilt, relative", round::coin),
    case("slope too steep by 1e-6", "0.5 mm in 10 s, or rest", "way, relative", throws::slope),
];
