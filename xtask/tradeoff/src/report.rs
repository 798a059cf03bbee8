//! Tables and sentences of one world.

use crate::measure::{Row, times};
use crate::world::{Outcome, Reading, Way, World};
use plaus_figures::distance::Distance;
use plaus_figures::report::{significant, table};

/// Times of the errors in the table, in s.
const SHOWN: [f64; 3] = [0.25, 0.5, 1.0];

/// Distances of one simulator's outcomes, reading by reading.
pub(crate) struct Distances {
    /// To the reference preset; empty for the reference itself.
    pub(crate) to_reference: Vec<Distance>,
    /// To the peer's finest step; empty for that step.
    pub(crate) to_finest: Vec<Distance>,
}

/// Distances of all simulators.
pub(crate) fn distances(rows: &[Row], readings: &[Reading], finest: Option<Way>) -> Vec<Distances> {
    let find = |way: Option<Way>| rows.iter().find(|row| Some(row.way) == way);
    let of = |row: &Row, other: Option<&Row>| -> Vec<Distance> {
        let Some(other) = other.filter(|other| other.way != row.way) else { return Vec::new() };
        let between =
            |(k, reading): (usize, &Reading)| Distance::between(&row.outcomes, &other.outcomes, k, reading.categories);
        readings.iter().enumerate().map(between).collect()
    };
    let all =
        |row: &Row| Distances { to_reference: of(row, find(Some(Way::REFERENCE))), to_finest: of(row, find(finest)) };
    rows.iter().map(all).collect()
}

/// The section of one world, without its heading.
pub(crate) fn section(world: &dyn World, rows: &[Row], distances: &[Distances], finest: Option<Way>) -> String {
    let mut text = format!("{}\n\n{}\n", world.about(), costs(world, rows));
    text += &laws(&world.readings(), rows, distances);
    text + "\n" + &verdict(rows, distances, finest, world.readings()[0].name)
}

fn costs(world: &dyn World, rows: &[Row]) -> String {
    let cells = rows.iter().map(|row| {
        let ms = |seconds: f64| significant(1000.0 * seconds, 3);
        let error = |&shown: &f64| {
            let at = times().iter().position(|t| (t - shown).abs() < 1e-9);
            at.and_then(|k| row.errors.get(k)).map_or("–".to_owned(), |e| micro(*e))
        };
        let mut cells = vec![row.way.name(), row.seconds.len().to_string()];
        cells.extend([ms(row.time(0.5)), ms(row.mean()), ms(row.time(0.9))]);
        cells.extend(SHOWN.iter().map(error));
        cells.push(row.agreement.map_or("–".to_owned(), |t| format!("{t:.2}")));
        cells.push(row.differing.map_or("–".to_owned(), |share| format!("{:.0} %", 100.0 * share)));
        cells
    });
    let errors = SHOWN.map(|t| format!("error at {t} s, mm"));
    let mut head = vec!["simulator", "draws", "ms, median", "ms, mean", "ms, 90 %"];
    head.extend(errors.iter().map(String::as_str));
    head.extend(["agrees for, s", "other outcome"]);
    format!(
        "{}\nError: median over up to 100 draws of the largest distance of a body from where the reference preset has it. Agrees for: median time, in steps of 0.05 s and at most 1.5 s, until a body is \
         {} mm away. Other outcome: share of these draws that end elsewhere than at the reference preset, in the first reading below.\n\n",
        table(&head, cells),
        significant(1000.0 * world.tolerance(), 2)
    )
}

/// A length in m as millimetres.
fn micro(metres: f64) -> String {
    if metres < 1e-9 { "< 1e-6".to_owned() } else { significant(1000.0 * metres, 2) }
}

fn laws(readings: &[Reading], rows: &[Row], distances: &[Distances]) -> String {
    let mut head = vec!["simulator".to_owned()];
    for reading in readings {
        head.push(format!("{}: mean", reading.name));
        head.push(format!("{}: distance", reading.name));
        head.push("by chance".into());
    }
    for reading in readings {
        head.push(format!("{}: to the peer's finest", reading.name));
        head.push("by chance".into());
    }
    let chance = |d: &Distance| format!("{} ({})", significant(d.noise, 2), significant(d.most, 2));
    let two = |d: Option<&Distance>| match d {
        Some(d) => [significant(d.found, 2), chance(d)],
        None => ["–".to_owned(), "–".to_owned()],
    };
    let cells = rows.iter().zip(distances).map(|(row, d)| {
        let mut cells = vec![row.way.name()];
        for k in 0..readings.len() {
            cells.push(mean(row, k));
            cells.extend(two(d.to_reference.get(k)));
        }
        cells.extend((0..readings.len()).flat_map(|k| two(d.to_finest.get(k))));
        cells
    });
    format!(
        "{}\nMean: of the number of the category, counted from 0, with its standard error. Distance: total variation between the outcomes and an independent sample of the reference preset's, or of the peer's at its finest step. By chance: what two samples of these sizes from one law show, mean and in brackets 95 % quantile, by \
         resampling whole draws of both together 200 times.\n",
        table(&head.iter().map(String::as_str).collect::<Vec<_>>(), cells)
    )
}

/// The mean number of a reading's category, and its standard error: draws are independent, a draw's bodies are not.
fn mean(row: &Row, reading: usize) -> String {
    let of_draw = |outcome: &Outcome| {
        let all = &outcome[reading];
        all.iter().map(|&c| f64::from(c)).sum::<f64>() / all.len().max(1) as f64
    };
    let means: Vec<f64> = row.outcomes.iter().map(of_draw).collect();
    let n = means.len() as f64;
    let mean = means.iter().sum::<f64>() / n;
    let error = (means.iter().map(|m| (m - mean) * (m - mean)).sum::<f64>() / (n * (n - 1.0))).sqrt();
    format!("{mean:.3} ± {error:.3}")
}

/// Fewest draws from which the distance of two laws is stated: chance alone then gives about a twentieth.
const ENOUGH: usize = 200;

/// How much faster than the peer: at 1/240 s, and where the peer is as near to its own finest step as the standard
/// preset is to the reference.
fn verdict(rows: &[Row], distances: &[Distances], finest: Option<Way>, reading: &str) -> String {
    let pair = |way: Way| rows.iter().zip(distances).find(|(row, _)| row.way == way);
    let (Some((standard, ours)), Some(finest)) = (pair(Way::STANDARD), finest) else { return String::new() };
    let ratio = |row: &Row| row.time(0.5) / standard.time(0.5);
    let mut text = String::new();
    if let Some((row, _)) = pair(Way::Peer(240.0)) {
        text += &format!(
            "Median time of {} over that of the standard preset: **{}**. ",
            row.way.name(),
            significant(ratio(row), 3)
        );
    }
    let Some(ours) = ours.to_reference.first() else { return text };
    let count = |way: Way| pair(way).map_or(0, |(row, _)| row.outcomes.len());
    if count(Way::REFERENCE).min(count(finest)) < ENOUGH {
        text += &format!(
            "Laws are not compared step by step: {} draws of the reference and {} of the peer's finest step are fewer than {ENOUGH}. Give more time with `--seconds`.\n",
            count(Way::REFERENCE),
            count(finest)
        );
        return text;
    }
    let near = |d: &Distances| d.to_finest.first().is_some_and(|d| d.found <= d.most + ours.excess());
    let mut peers: Vec<(f64, &Row, &Distances)> = rows
        .iter()
        .zip(distances)
        .filter_map(|(row, d)| if let Way::Peer(rate) = row.way { Some((rate, row, d)) } else { None })
        .collect();
    peers.sort_by(|a, b| a.0.total_cmp(&b.0));
    let coarsest = peers.iter().find(|(_, row, d)| row.way == finest || near(d));
    if let Some((_, row, _)) = coarsest {
        let bound = if row.way == finest {
            "at none coarser than its finest, so that the ratio is at least"
        } else {
            "the ratio is"
        };
        text += &format!(
            "The standard preset's distance in {reading} is {} beyond chance. The coarsest step at which the peer is as near to its own finest, within what chance shows in 95 of 100 cases: {}; {bound} **{}**.\n",
            significant(ours.excess(), 2),
            row.way.name(),
            significant(ratio(row), 3)
        );
    }
    text
}

/// One line of the summary: median and mean ms of each simulator.
pub(crate) fn summary(name: &str, rows: &[Row], ways: &[Way]) -> Vec<String> {
    let ms = |seconds: f64| significant(1000.0 * seconds, 2);
    let cell = |way: &Way| {
        let found = rows.iter().find(|row| row.way == *way);
        found.map_or("–".to_owned(), |row| format!("{}; {}", ms(row.time(0.5)), ms(row.mean())))
    };
    [name.to_owned()].into_iter().chain(ways.iter().map(cell)).collect()
}
