//! The probability of what is asked for: right where it is known exactly, and the same bytes however it is computed.

use crate::common::{Ended, Place};
use serde_json::Value;
use std::f64::consts::FRAC_1_SQRT_2;

/// One bounce on a nearly level table, and a target that few bounces reach.
const RARE: &str = "--set collisions=1 --set sigma_theta_deg=3 --set target=4.2 --set sigma_d=0.1 --set tolerance=0.1 \
    --set downward=reject";

/// Probability that a ball comes to rest within `tolerance` of `target` after one bounce off a surface whose normal is
/// at θ ~ N(0, σ) from the vertical; normals that send the ball into the table are misses. For a fall from h its place
/// is `4h (1 + e) sin θ cos θ (e cos² θ − sin² θ)`. The integral over θ is a sum over cells so fine that the steps of
/// the indicator, the only error, are below 1e-4 of it.
#[allow(clippy::disallowed_methods, reason = "it is compared with what has errors of its own")]
fn one_bounce(target: f64, tolerance: f64, sigma_deg: f64) -> f64 {
    let (e, h, cells) = (FRAC_1_SQRT_2, 4.5, 4_000_000);
    let sigma = sigma_deg.to_radians();
    let most = (e.sqrt()).atan();
    let width = 2.0 * most / f64::from(cells);
    let density = |theta: f64| (-0.5 * (theta / sigma).powi(2)).exp() / (sigma * std::f64::consts::TAU.sqrt());
    let lands = |theta: f64| {
        let (s, c) = theta.sin_cos();
        (4.0 * h * (1.0 + e) * s * c * (e * c * c - s * s) - target).abs() < tolerance
    };
    let theta = |cell: i32| -most + width * (f64::from(cell) + 0.5);
    (0..cells).map(theta).filter(|&theta| lands(theta)).map(density).sum::<f64>() * width
}

fn json(said: &Ended) -> Value {
    serde_json::from_str(&said.out).unwrap()
}

/// The estimates for everything that is asked for, with their errors.
fn estimates(said: &Ended) -> Vec<(String, f64, f64)> {
    let all = &json(said)["answers"][0]["estimates"];
    let number = |one: &Value, key: &str| one[key].as_f64().unwrap();
    let row =
        |one: &Value| (one["method"].as_str().unwrap().to_owned(), number(one, "probability"), number(one, "error"));
    all.as_array().unwrap().iter().map(row).collect()
}

#[test]
fn a_rare_bounce_has_its_exact_probability() {
    let (place, p) = (Place::new(), one_bounce(4.2, 0.1, 3.0));
    assert!((1e-7..1e-4).contains(&p), "{p:e} is no test of rare events");
    let said = place.ok(&format!("chance ball.toml {RARE} --json --steps 50 --batches 24"));
    let found = estimates(&said);
    let [(_, counted, _), splitting, stones, importance] = found.as_slice() else { panic!("{found:?}") };
    assert!(*counted < 1e-3, "{found:?}");
    for (method, probability, error) in [splitting, stones, importance] {
        assert!((probability - p).abs() < 5.0 * error && *error < 0.5 * p, "{method}: {probability:e}, not {p:e}");
    }
    let all = &json(&said)["answers"][0];
    assert!(all["doubts"].as_array().unwrap().is_empty(), "{all}");
    // Another question has another answer, and these errors are small enough to tell the two apart.
    let nearer = one_bounce(3.9, 0.1, 3.0);
    assert!((splitting.1 - nearer).abs() > 5.0 * splitting.2, "{splitting:?} passes for {nearer:e}");
}

/// Two ways to the goal: far to the right, where each step nearer counts; or on a line to the left, a hundred times as
/// likely, of which nothing tells that it is near. Steps are short, so particles climb to the right. Counting finds the
/// line, and the answer is what it found; without enough draws to find it, the answer is what splitting found.
#[test]
fn the_answer_is_the_largest_that_is_supported() {
    let place = Place::new();
    let right = "{ rests_at = { x_mm = 420, scale_mm = 20, within_mm = 10 } }";
    let left = "{ rests_at = { x_mm = -160, scale_mm = 0.0001, within_mm = 0.05 } }";
    let world = "[world.ball2d]\ncollisions = 1\nsigma_theta_deg = 3\nconstrained = false\nmoves = \"paper\"\n\
                 step_deg = 0.3\ndownward = \"reject\"\n";
    let ask = |ways: &str| {
        place.write("ways.toml", format!("require = [{{ any = [{ways}] }}]\n{world}"));
        "chance ways.toml --particles 32 --draws 40000 --batches 8 --method counting --method splitting"
    };
    let (p_right, p_left) = (one_bounce(4.2, 0.1, 3.0), one_bounce(1.6, 0.0005, 3.0));
    assert!(p_left > 10.0 * p_right, "{p_left:e} and {p_right:e}");

    let both = ask(&format!("{right}, {left}"));
    let said = place.ok(&format!("{both} --json"));
    let found = estimates(&said);
    let [(_, counted, error), (_, split, _)] = found.as_slice() else { panic!("{found:?}") };
    assert!((counted - p_left - p_right).abs() < 5.0 * error && *split < 0.1 * counted, "{found:?}, not {p_left:e}");
    let best = |said: &Ended| json(said)["answers"][0]["best"]["method"].clone();
    assert_eq!(best(&said), "counting");
    let told = place.ok(both);
    assert!(told.out.contains("95 % interval") && !told.out.contains("agree"), "{}", told.out);

    // Without the line, what both find is near what is right; or it cannot tell.
    let said = place.run(&format!("{} --json", ask(right)));
    let all = &json(&said)["answers"][0];
    let [low, high] = [0, 1].map(|end| all["interval"][end].as_f64().unwrap());
    assert!(said.code == Some(1) || (low <= p_right && p_right <= high), "{}, not {p_right:e}", said.out);
}

#[test]
fn frequent_outcomes_are_counted() {
    let (place, p) = (Place::new(), one_bounce(0.0, 0.5, 10.0));
    let ask = "chance ball.toml --set collisions=1 --set target=0 --set tolerance=0.5 --set downward=reject";
    let found = estimates(&place.ok(&format!("{ask} --json")));
    let [(method, probability, error)] = found.as_slice() else { panic!("{found:?}") };
    assert!(method == "counting" && (probability - p).abs() < 5.0 * error && *error < 0.02, "{found:?}, not {p}");
    let told = place.ok(ask);
    assert!(told.out.contains("counting is enough") && told.out.contains("once in"), "{}", told.out);
    // The draws that chose the method count too, so they are not made twice.
    assert!(told.err.contains("8,000 simulations in"), "{}", told.err);
    let stopped = place.ends(&format!("{ask} --draws 1000000000 --max-time 200ms"), 1);
    assert!(stopped.out.contains("no batch is finished yet"), "{}", stopped.out);
}

/// The file is the same whatever the threads, interruptions and pieces.
#[test]
fn threads_interruptions_and_pieces_leave_the_same_file() {
    let place = Place::new();
    let ask = format!(
        "chance ball.toml {RARE} -q --batches 4 --draws 50 --particles 20 --steps 5 --rungs 4 --iterations 100"
    );
    let run = |more: &str| place.run(&format!("{ask} {more}"));
    run("--out one.json --threads 1");
    run("--out four.json --threads 4");
    let read = |name: &str| std::fs::read(place.path(name)).unwrap();
    assert!(read("one.json") == read("four.json"));
    // Stopped at once, then continued.
    run("--out late.json --max-time 0s");
    run("--out late.json");
    assert!(read("one.json") == read("late.json"));
    // In pieces.
    for piece in 1..=3 {
        place.ok(&format!("{ask} --out pieces/{{shard}} --shard {piece}/3"));
    }
    place.ends("merge pieces/1 pieces/3 --out no.json", 2).says(&["piece 2/3 is missing: batch 1 is in none"]);
    place
        .ends("merge pieces/1 pieces/2 pieces/3 pieces/3 --out no.json", 2)
        .says(&["pieces/3: is piece 3/3: batch 2 is in two pieces"]);
    place.ok("merge pieces/1 pieces/2 pieces/3 --out whole.json");
    assert!(read("one.json") == read("whole.json"));
    place.ends("merge pieces/1 pieces/2 pieces/3 --out whole.json", 2).says(&["already exists"]);
    // A file of estimates can be looked at, and is not mistaken for something else.
    let shown = place.run("chance whole.json").out;
    assert!(shown.contains("splitting") && shown.contains("stones"), "{shown}");
    place
        .ends(&format!("{ask} --out one.json --seed 8"), 2)
        .says(&["one.json: holds another run: it has another seed"]);
    place.ends(&format!("{ask} --out one.json --method counting"), 2).says(&["it uses other methods"]);
    let mut torn = read("one.json");
    let at = torn.windows(9).position(|bytes| bytes == b"\"hits\": [").unwrap();
    torn[at + 30] ^= 1;
    place.write("torn.json", torn);
    place.ends("chance torn.json", 2).says(&["torn.json: not an estimate of a chance, or changed since"]);
}

#[test]
fn requests_that_make_no_sense_are_refused() {
    let place = Place::new();
    place.ends("chance nowhere.toml", 2).says(&["cannot read the scenario"]);
    place.ends("chance nowhere.json", 2).says(&["there is no such file"]);
    place.ends("chance ball.toml --batches 1", 2).says(&["1"]);
    place.ends("chance ball.toml --batches 4 --shard 5/9 --out a.json", 2).says(&["cannot be cut into 9 pieces"]);
    place.ends("chance ball.toml --method luck", 2).says(&["luck"]);
    place
        .ends("chance ball.toml --set preset=as-printed --method splitting", 2)
        .says(&["sampler.rules.preset = \"exact\""]);
    // If moves are not exact, draws of the prior still are.
    let counted = place.ok("chance ball.toml --set preset=as-printed --batches 2 --draws 200").out;
    assert!(counted.contains("only counting is possible"), "{counted}");
    // Something that never happens is reported as rare, not as impossible.
    let never =
        place.ends("chance ball.toml --set target=90 --set tolerance=0.01 --draws 20 --batches 2 --method counting", 1);
    assert!(never.out.contains("nothing met it: less often than"), "{}", never.out);
}
