//! Places within a region: their moments agree with closed forms, and a twin that is wrong about volume is caught.

use crate::common::shapes;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{State, Target};
use plaus_scenes::{AnyScratch, Scenario, Scene};

const DRAWS: u64 = 4_000;
/// Standard errors. Of 22 means of right regions, one exceeds it for one choice of seeds in 700.
const LIMIT: f64 = 4.0;

/// Where a ball starts that floats in place: read from where it ends, which the maps under test do not set.
fn places(keys: &str, quantities: &str) -> Vec<[f64; 3]> {
    let text = format!(
        "[world.custom]\nduration_s = 0.001\ngravity = 0\nfixed = []\n[[world.custom.bodies]]\nname = 'ball'\n\
         shape = {{ ball = {{ radius_mm = 3 }} }}\n{keys}\n{quantities}"
    );
    let scenario = Scenario::read_with("within.toml", &text, &[], &shapes()).unwrap_or_else(|error| panic!("{error}"));
    let scene = scenario.stage().unwrap();
    let scalars = scene.scalars();
    let columns = ["ball.end_x", "ball.end_y", "ball.end_z"]
        .map(|name| scalars.iter().position(|scalar| scalar.name == name).unwrap());
    let place = |nth| {
        let draw = scene.start(&mut Seed(7).chain(0).at(nth, Purpose::START));
        let state = State::evaluate(&scene, draw, &mut AnyScratch::default()).unwrap();
        let mut values = vec![0.0; scalars.len()];
        scene.write_scalars(state.by_ref(), &mut values);
        columns.map(|column| values[column])
    };
    (0..DRAWS).map(place).collect()
}

/// The difference between a mean and its true value, in standard errors.
fn off(values: impl Iterator<Item = f64> + Clone, truth: f64) -> f64 {
    let n = DRAWS as f64;
    let mean = values.clone().sum::<f64>() / n;
    let variance = values.map(|value| (value - mean).powi(2)).sum::<f64>() / (n - 1.0);
    (mean - truth).abs() / (variance / n).sqrt().max(1e-9)
}

/// The worst of first and second moments about `middle`, and of the mean fourth power of the distance from its axis.
fn worst(places: &[[f64; 3]], middle: [f64; 3], squares: [f64; 3], fourth: f64) -> f64 {
    let mut worst = 0.0_f64;
    for axis in 0..3 {
        let from = places.iter().map(|place| place[axis] - middle[axis]);
        worst = worst.max(off(from.clone(), 0.0)).max(off(from.map(|x| x * x), squares[axis]));
    }
    let level = places.iter().map(|[x, y, _]| ((x - middle[0]).powi(2) + (y - middle[1]).powi(2)).powi(2));
    worst.max(off(level, fourth))
}

/// Mean of x², and of the fourth power: for a box with edges s, s²/12 and (of x⁴) s⁴/80; for a disc, r²/4 and (of the
/// distance from the axis) r⁴/3; for a ball, r²/5 and (likewise) 8r⁴/35.
#[test]
fn all_volume_of_a_region_is_equally_likely() {
    let middle = [10.0, -20.0, 300.0];
    let at = "at_mm = [10, -20, 300]\n";
    let [a, b, c, r]: [f64; 4] = [80.0, 40.0, 120.0, 50.0];
    let fourth = (a.powi(4) + b.powi(4)) / 80.0 + 2.0 * (a * b / 12.0).powi(2);
    let seen = places(&format!("{at}within = {{ box = {{ size_mm = [80, 40, 120] }} }}"), "");
    let z = worst(&seen, middle, [a * a / 12.0, b * b / 12.0, c * c / 12.0], fourth);
    assert!(z < LIMIT, "box: {z} standard errors");
    let seen = places(&format!("{at}within = {{ cylinder = {{ radius_mm = 50, height_mm = 120 }} }}"), "");
    let z = worst(&seen, middle, [r * r / 4.0, r * r / 4.0, c * c / 12.0], r.powi(4) / 3.0);
    assert!(z < LIMIT, "cylinder: {z} standard errors");
    let seen = places(&format!("{at}within = {{ ball = {{ radius_mm = 50 }} }}"), "");
    let z = worst(&seen, middle, [r * r / 5.0; 3], 8.0 * r.powi(4) / 35.0);
    assert!(z < LIMIT, "ball: {z} standard errors");
}

#[test]
fn a_disc_whose_radius_is_uniform_is_caught() {
    let quantities = "[[world.custom.quantities]]\nname = 'r'\nvalue = { uniform = [0, 50] }\n\
                      [[world.custom.quantities]]\nname = 'v'\nvalue = { uniform = [0, 360] }";
    let seen = places("at_mm = ['r * cos(v)', 'r * sin(v)', 'uniform(-60, 60)']", quantities);
    let z = worst(&seen, [0.0; 3], [625.0, 625.0, 1200.0], 50.0_f64.powi(4) / 3.0);
    assert!(z > LIMIT, "only {z} standard errors");
}

/// A level disc has two variables and one height; an uncertain radius adds one variable.
#[test]
fn a_level_disc_is_flat() {
    let disc = "at_mm = [0, 0, 40]\nwithin = { cylinder = { radius_mm = { uniform = [10, 50] } } }";
    let seen = places(disc, "");
    assert!(seen.iter().all(|[x, y, z]| x.hypot(*y) < 50.0 + 1e-6 && (z - 40.0).abs() < 1e-9));
    // The mean of R²/4 over radii R from 10 to 50.
    let square = (50.0_f64.powi(3) - 10.0_f64.powi(3)) / (3.0 * 40.0) / 4.0;
    let z = off(seen.iter().map(|[x, _, _]| x * x), square);
    assert!(z < LIMIT, "{z} standard errors");
}
