//! A draw with a variable of every law, for moves over variables. Any combination of values gives an outcome.

use plaus_dist::stream::below;
use plaus_dist::{Gaussian, LogDensity, LogPotential, Stream, TruncatedGaussian, WrappedUniform};
use plaus_mcmc::{
    Law, ModelError, Offset, Recipe, Rectangle, Simulated, StateRefOf, Target, Var, Variables, Vars, vars,
};

#[derive(Debug, Clone, PartialEq)]
pub struct Things {
    pub speed: f64,
    pub size: f64,
    pub height: f64,
    pub angle: f64,
    pub pins: [[f64; 2]; 2],
    pub vertex: [f64; 3],
    pub balls: [Option<[f64; 2]>; 3],
    pub face: usize,
    /// How much the speed's value is above its number.
    pub shift: f64,
}

/// Indices of the variables.
pub const SPEED: usize = 0;
pub const SIZE: usize = 1;
pub const HEIGHT: usize = 2;
pub const ANGLE: usize = 3;
pub const PINS: [usize; 2] = [4, 5];
pub const VERTEX: usize = 6;
pub const BALLS: [usize; 3] = [7, 8, 9];
pub const FACE: usize = 10;
/// Faces, each equally likely.
pub const FACES: usize = 6;

pub struct Slots(Vars);

impl Slots {
    pub fn new() -> Self {
        let pin = || Law::Plane(Offset::new(0.3, f64::INFINITY).unwrap());
        let ball = || Law::Rectangle(Rectangle::new([[0.0, 2.0], [1.0, 2.0]]).unwrap());
        Self(Vars::new(vec![
            Var::new("speed", "m/s", Law::Gaussian(Gaussian::new(1.0, 0.5).unwrap())).column(1.0),
            Var::new("size", "m", Law::Uniform(WrappedUniform::new(1.0, 2.0).unwrap())).column(1.0),
            Var::new("height", "m", Law::Above(1.5, 0.5, SIZE)),
            Var::new("angle", "rad", Law::Truncated(TruncatedGaussian::new(0.0, 1.0, -1.0, 2.0).unwrap())).column(1.0),
            Var::new("pin", "mm", pin()).of("pin", 1),
            Var::new("pin", "mm", pin()).of("pin", 2),
            Var::new("vertex", "mm", Law::Space(Offset::new(0.2, 0.5).unwrap())),
            Var::new("ball", "mm", ball()).of("ball", 1).optional(),
            Var::new("ball", "mm", ball()).of("ball", 2).optional(),
            Var::new("ball", "mm", ball()).of("ball", 3).optional(),
            Var::new("face", "", Law::Own),
        ]))
    }
}

impl Variables for Slots {
    fn vars(&self) -> &Vars {
        &self.0
    }

    fn get<'a>(&self, draw: &'a Things, var: usize) -> Option<&'a [f64]> {
        Some(match var {
            SPEED => std::slice::from_ref(&draw.speed),
            SIZE => std::slice::from_ref(&draw.size),
            HEIGHT => std::slice::from_ref(&draw.height),
            ANGLE => std::slice::from_ref(&draw.angle),
            4 | 5 => &draw.pins[var - 4],
            VERTEX => &draw.vertex,
            7..=9 => return draw.balls[var - 7].as_ref().map(<[f64; 2]>::as_slice),
            _ => return None,
        })
    }

    fn get_mut<'a>(&self, draw: &'a mut Things, var: usize) -> Option<&'a mut [f64]> {
        Some(match var {
            SPEED => std::slice::from_mut(&mut draw.speed),
            SIZE => std::slice::from_mut(&mut draw.size),
            HEIGHT => std::slice::from_mut(&mut draw.height),
            ANGLE => std::slice::from_mut(&mut draw.angle),
            4 | 5 => &mut draw.pins[var - 4],
            VERTEX => &mut draw.vertex,
            7..=9 => return draw.balls[var - 7].as_mut().map(<[f64; 2]>::as_mut_slice),
            _ => return None,
        })
    }

    fn set_present(&self, draw: &mut Things, var: usize, present: bool) {
        draw.balls[var - BALLS[0]] = present.then_some([0.0; 2]);
    }

    fn shift(&self, draw: &Things, var: usize) -> f64 {
        if var == SPEED { draw.shift } else { 0.0 }
    }

    fn renew_own(&self, draw: &mut Things, _: usize, stream: &mut Stream) {
        draw.face = below(stream, FACES);
    }

    fn step_own(&self, draw: &mut Things, _: usize, _: f64, stream: &mut Stream) {
        draw.face = (draw.face + 1 + below(stream, FACES - 1)) % FACES;
    }
}

/// The outcome is a sum to which every variable contributes; it should be about 5.
impl Target for Slots {
    type Draw = Things;
    type Outcome = f64;
    type Scratch = ();

    fn start(&self, stream: &mut Stream) -> Things {
        let mut draw = Things {
            speed: 0.0,
            size: 0.0,
            height: 0.0,
            angle: 0.0,
            pins: [[0.0; 2]; 2],
            vertex: [0.0; 3],
            balls: [None; 3],
            face: 0,
            shift: 0.25,
        };
        self.renew_all(&mut draw, Recipe::Exact, stream);
        draw
    }

    fn log_prior(&self, draw: &Things) -> Result<LogDensity, ModelError> {
        Ok(vars::log_prior(self, draw)?)
    }

    fn simulate(
        &self,
        draw: &Things,
        _: Option<StateRefOf<'_, Self>>,
        _: LogPotential,
        (): &mut (),
    ) -> Result<Simulated<f64>, ModelError> {
        let pins = 2.0 * draw.pins[0][0] - draw.pins[1][0] + draw.pins[1][1];
        let balls: f64 = draw.balls.iter().flatten().map(|[x, y]| x * y).sum();
        let speed = draw.speed + draw.shift;
        let sum = speed * draw.size + draw.height + draw.angle + pins + 3.0 * draw.vertex[0] - draw.vertex[1];
        Ok(Simulated::Complete(sum + 0.5 * balls + 0.3 * draw.face as f64))
    }

    fn log_constraint(&self, outcome: &f64) -> Result<LogPotential, ModelError> {
        Ok(LogPotential::new(-0.5 * (outcome - 5.0) * (outcome - 5.0))?)
    }
}
