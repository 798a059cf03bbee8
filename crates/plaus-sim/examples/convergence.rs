//! How far each preset is from truths that are independent of the simulator, and how fast that distance falls: a table.
//!
//! `cargo run --release -p plaus-sim --example convergence -- [seconds for each run] [throws] [part of a name] [CSV]`
//!
//! The truths are closed forms, conservation laws and symmetry: `tests/common/cases`. Where there are none, another
//! kind of integrator in very small steps, with its error of first order extrapolated away: `tests/common/small_steps`.
//! By default each run gets 0.05 s and hardly any throws; `-- 20 20` runs everything. `cargo xtask accuracy` draws the
//! CSV.
#![allow(clippy::print_stdout, reason = "a measuring program: it prints")]

#[path = "../tests/common/cases/mod.rs"]
mod cases;
#[path = "../tests/common/laws/mod.rs"]
mod laws;
#[path = "../tests/common/small_steps/mod.rs"]
mod small_steps;

use cases::{CASES, Guard, Setting};
use plaus_dist::math;
use plaus_sim::{Accuracy, Preset};
use small_steps::tosses::{Look, Toss, dice, pin, smooth, wild};
use std::error::Error;
use std::io::Write as _;

/// Cases of `contact_cases` in which presets have no error that could converge.
const LEFT_OUT: [&str; 3] = ["tosses of a cube", "two cubes meet", "ball at rest, e 1"];

/// Steps of the truth at first, in s; it is also run with half and with a quarter of these.
const STEP: f64 = 4e-4;

/// Uncertainty of a wave of dominoes, relative: halving the last steps of its truth moved it by 8e-4 (the example
/// `truths`), and the cases give it to three decimals.
const DOMINOES: f64 = 1e-3;

/// Errors below this are rounding.
const ROUNDING: f64 = 1e-12;

/// A row of the table.
struct Row {
    name: String,
    truth: &'static str,
    measure: String,
    off: [f64; 4],
    /// Uncertainty of the truth, in the same measure.
    unknown: f64,
}

impl Row {
    /// Order in the step of lasting contact, from standard to reference.
    fn order(&self) -> String {
        let [_, standard, _, reference] = self.off;
        let steps = [Preset::Standard, Preset::Reference].map(|p| Accuracy::preset(p).step);
        if !(standard.is_finite() && reference.is_finite()) {
            return "–".to_owned();
        }
        let floor = ROUNDING.max(self.unknown);
        if standard <= floor {
            return if self.unknown > 0.0 { "≤ unknown" } else { "exact" }.to_owned();
        }
        let order = math::ln(standard / reference.max(floor)) / math::ln(steps[0] / steps[1]);
        format!("{}{order:.1}", if reference < floor { "> " } else { "" })
    }

    fn markdown(&self) -> String {
        let shown = |off: f64| match off {
            off if off.is_nan() => "cut off".to_owned(),
            off if off < 1e-14 => "0".to_owned(),
            off => format!("{off:.1e}"),
        };
        let [a, b, c, d] = self.off.map(shown);
        let unknown = if self.unknown > 0.0 { shown(self.unknown) } else { String::new() };
        let (name, truth, measure, order) = (&self.name, self.truth, &self.measure, self.order());
        format!("| {name} | {truth} | {measure} | {a} | {b} | {c} | {d} | {order} | {unknown} |")
    }

    fn csv(&self) -> String {
        let [a, b, c, d] = self.off;
        format!("\"{}\",\"{}\",\"{}\",{a:e},{b:e},{c:e},{d:e},{:e}", self.name, self.truth, self.measure, self.unknown)
    }
}

fn median(mut values: Vec<f64>) -> f64 {
    values.sort_by(f64::total_cmp);
    values[values.len() / 2]
}

/// Tosses at some of their looks: medians over the tosses.
fn tosses(toss: &Toss, looks: &[usize]) -> Vec<Row> {
    let truths: Vec<_> = toss.starts.iter().map(|s| toss.truth_and_doubt(s, STEP)).collect();
    let found = Preset::ALL.map(|p| toss.starts.iter().map(|s| toss.ours(s, p)).collect::<Vec<_>>());
    let far = |looks: &[Vec<Look>], look: usize| {
        median((0..truths.len()).map(|k| looks[k][look].off(&truths[k].0[look], toss.length())).collect())
    };
    let doubts: Vec<Vec<Look>> = truths.iter().map(|t| t.1.clone()).collect();
    let row = |&look: &usize| Row {
        name: format!("{}, after {} s", toss.name, toss.looks[look]),
        truth: "small steps",
        measure: "edges + rad/2, median".to_owned(),
        off: [0, 1, 2, 3].map(|k: usize| far(&found[k], look)),
        unknown: far(&doubts, look),
    };
    looks.iter().map(row).collect()
}

fn main() -> Result<(), Box<dyn Error>> {
    let args: Vec<String> = std::env::args().skip(1).collect();
    let seconds: f64 = args.first().map_or(Ok(0.05), |a| a.parse())?;
    let throws: u64 = args.get(1).map_or(Ok(2), |a| a.parse())?;
    let wanted = args.get(2).map_or("", String::as_str);
    println!("| case | truth | measured | draft | standard | fine | reference | order | unknown |");
    println!("| --- | --- | --- | --- | --- | --- | --- | --- | --- |");
    let mut file = args.get(3).map(std::fs::File::create).transpose()?;
    let mut write = |line: &str| file.as_mut().map_or(Ok(()), |file| writeln!(file, "{line}"));
    write("case,truth,measure,draft,standard,fine,reference,unknown")?;
    // Row by row, so that if you stop waiting you have the rows so far.
    let mut add = |row: Row| {
        println!("{}", row.markdown());
        write(&row.csv())
    };
    let guard = Guard { seconds, events: if seconds < 1.0 { 1_000 } else { 2_000_000 } };
    for case in CASES.iter().filter(|c| c.name.contains(wanted) && !LEFT_OUT.contains(&c.name)) {
        let off = Preset::ALL.map(|preset| (case.run)(&Setting { preset, guard, throws, tosses: &[] }).off);
        add(Row {
            name: case.name.to_owned(),
            truth: case.expected,
            measure: case.measure.to_owned(),
            off,
            unknown: if case.name.starts_with("dominoes") { DOMINOES } else { 0.0 },
        })?;
    }
    for toss in smooth().iter().chain([&pin()]).filter(|t| t.name.contains(wanted)) {
        let last = toss.looks.len() - 1;
        tosses(toss, &[last]).into_iter().try_for_each(&mut add)?;
    }
    for toss in wild(throws).iter().filter(|t| t.name.contains(wanted)) {
        tosses(toss, &[1, 5]).into_iter().try_for_each(&mut add)?;
    }
    for toss in [dice(throws)].iter().filter(|t| t.name.contains(wanted)) {
        tosses(toss, &[1, 3]).into_iter().try_for_each(&mut add)?;
    }
    Ok(())
}
