//! Places within a region: their moments agree with closed forms, and a twin that is wrong about volume is caught.

use crate::common::shapes;
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{State, Target};
use plaus_scenes::{AnyScratch, Scenario, Scene};

const DRAWS: u64 = 4_000;
/// Standard errors. Of 50 means of right regions and laws, one exceeds it for one choice of seeds in 300.
const LIMIT: f64 = 4.0;

/// Where a ball starts that floats in place: read from where it ends, which the maps under test do not set. `tables`
/// may be quantities or scenery.
fn places(keys: &str, tables: &str) -> Vec<[f64; 3]> {
    columns(keys, tables, ["ball.end_x", "ball.end_y", "ball.end_z"])
}

/// The same columns of many draws.
fn columns<const N: usize>(keys: &str, tables: &str, names: [&str; N]) -> Vec<[f64; N]> {
    let scenery = if tables.contains("custom.fixed") { "" } else { "fixed = []" };
    let text = format!(
        "[world.custom]\nduration_s = 0.001\ngravity = 0\n{scenery}\n[[world.custom.bodies]]\nname = 'ball'\n\
         shape = {{ ball = {{ radius_mm = 3 }} }}\n{keys}\n{tables}"
    );
    let scenario = Scenario::read_with("within.toml", &text, &[], &shapes()).unwrap_or_else(|error| panic!("{error}"));
    let scene = scenario.stage().unwrap();
    let scalars = scene.scalars();
    let columns = names.map(|name| scalars.iter().position(|scalar| scalar.name == name).unwrap());
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

#[test]
fn a_column_tells_in_which_region_a_body_ends() {
    let tables = "[[world.custom.regions]]\nx_mm = [0, 20]\n[[world.custom.regions]]\nx_mm = [-90, 10]\n\
                  z_mm = [300, 400]\n";
    let keys = "at_mm = [0, 0, 300]\nwithin = { box = { size_mm = [80, 40, 120] } }\n";
    let mut seen = [0; 3];
    for [x, z, region] in columns(keys, tables, ["ball.end_x", "ball.end_z", "ball.region"]) {
        let wanted = if (0.0..20.0).contains(&x) { 1 } else { 2 * usize::from(x < 10.0 && z >= 300.0) };
        assert_eq!(region, wanted as f64, "{x} {z}");
        seen[wanted] += 1;
    }
    assert!(seen.iter().all(|count| *count > 500), "{seen:?}");
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

/// A box of 80 × 40 × 20, turned by 30° about y: on its top, s along the slope has mean square 80²/12.
#[test]
fn all_area_of_a_surface_is_equally_likely() {
    let slope = "[[world.custom.fixed]]\nname = 'slope'\nshape = { box = { size_mm = [80, 40, 20] } }\n\
                 turn_deg = [0, 30, 0]\nat_mm = [5, 0, 0]";
    let seen = places("within = { surface = { of = 'slope', above_mm = 8 } }", slope);
    let [a, b, cos, sin] = [80.0_f64, 40.0_f64, 0.75_f64.sqrt(), 0.5];
    let (along, across) = (a * a / 12.0, b * b / 12.0);
    let fourth = (cos * a).powi(4) / 80.0 + b.powi(4) / 80.0 + 2.0 * cos * cos * along * across;
    let squares = [cos * cos * along, across, sin * sin * along];
    let z = worst(&seen, [5.0 + 18.0 * sin, 0.0, 18.0 * cos], squares, fourth);
    assert!(z < LIMIT, "slope: {z} standard errors");
    // A roof of two slopes, each 200 wide and 120 high: x is uniform from −200 to 200, and at 0 both are 120 high.
    let roof = "[[world.custom.fixed]]\nname = 'roof'\nshape = { mesh = { file = 'roof.obj', up = 'z' } }";
    let seen = places("at_mm = [0, 0, 50]\nwithin = { surface = { of = 'roof' } }", roof);
    for [x, _, z] in &seen {
        assert!((z - 50.0 - 120.0 * (1.0 - x.abs() / 200.0)).abs() < 1e-9, "{x} {z}");
    }
    let level: Vec<[f64; 3]> = seen.iter().map(|[x, y, _]| [*x, *y, 0.0]).collect();
    let fourth = 2.0 * 400.0_f64.powi(4) / 80.0 + 2.0 * (160_000.0_f64 / 12.0).powi(2);
    let z = worst(&level, [0.0; 3], [160_000.0 / 12.0, 160_000.0 / 12.0, 0.0], fourth);
    assert!(z < LIMIT, "roof: {z} standard errors");
}

/// Laws whose numbers are drawn themselves: first and second moments in closed form.
#[test]
fn laws_may_have_uncertain_numbers() {
    let drawn = |name: &str, low: f64, high: f64| {
        format!("[[world.custom.quantities]]\nname = '{name}'\nvalue = {{ uniform = [{low}, {high}] }}\n")
    };
    let tables = [drawn("w", 20.0, 40.0), drawn("p", 0.0, 60.0)].concat();
    // w² is 2800/3 in the mean; of a triangle from 0 to 60 with its peak at p, x² is (60² + p² + 60 p)/6.
    let (w_squared, by_peak) = (2_800.0 / 3.0, 11.0 * 3_600.0 / 36.0);
    for (text, mean, square) in [
        ("uniform(0, w)", 15.0, w_squared / 3.0),
        ("normal(0, w)", 0.0, w_squared),
        ("normal(w, 5)", 30.0, w_squared + 25.0),
        ("log_normal(w, 0.2)", 30.0 * 0.02_f64.exp(), w_squared * 0.08_f64.exp()),
        ("triangular(0, p, 60)", 30.0, by_peak),
        ("choice(w, 0 - w, 0)", 0.0, w_squared * 2.0 / 3.0),
        ("uniform(0, normal(0, uniform(0, 30)))", 0.0, 300.0 / 3.0),
    ] {
        let seen = places(&format!("at_mm = ['{text}', 0, 0]"), &tables);
        let x = seen.iter().map(|place| place[0]);
        let z = off(x.clone(), mean).max(off(x.map(|x| x * x), square));
        assert!(z < LIMIT, "{text}: {z} standard errors");
    }
    let seen = places("at_mm = ['triangular(0, 30, 60)', 0, 0]", "");
    let z = off(seen.iter().map(|place| place[0].powi(2)), by_peak);
    assert!(z > LIMIT, "a peak in the middle is only {z} standard errors off");
}
