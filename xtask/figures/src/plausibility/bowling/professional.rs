//! First balls of professionals: the regulation prior around a good player's delivery. Its spread is fitted to the
//! published strike rate only; the leaves are held out.

use super::SEED;
use super::published::{FIRST_BALLS, STRIKES, leaves};
use super::roll::{Leave, Tally, from_prior};
use crate::plausibility::chance::{Count, shown_p, signed};
use crate::report::{table, thousands};
use crate::{Result, Work};
use plaus_dist::math::square;
use plaus_scenes::bowling::{Bowling, Coefficients, Config, Delivery, Release};

/// Spreads that are tried, relative to [`delivery`]'s at 1.
const SPREADS: [f64; 6] = [0.2, 0.4, 0.6, 0.8, 1.0, 1.3];

/// A right-hander's delivery that on average meets the pins on the published best line, with 8.1 m/s and 39 rad/s at
/// the foul line, in the middle of what is reported of PBA players. `spread` scales all standard deviations together.
/// Their proportions are guesses (at 1: 2 cm/s across, which is 1.6 boards at the pins, 0.1 m/s, 1 rad/s).
fn delivery(spread: f64) -> Release {
    Release {
        // One ball of 15 lb.
        radius_min_mm: Some(108.4),
        radius_max_mm: Some(108.6),
        density_min: Some(1266.0),
        density_max: Some(1276.0),
        gyration_min: Some(0.58),
        gyration_max: Some(0.60),
        across_m: Some(0.01),
        height_mean: Some(1.1),
        height_sd: Some(0.05),
        speed_mean: Some(8.1),
        speed_sd: Some(0.1 * spread),
        drift_mean: Some(0.430),
        drift_sd: Some(0.02 * spread),
        roll_mean: Some(14.0),
        roll_sd: Some(spread),
        hook_mean: Some(-36.0),
        hook_sd: Some(spread),
        twist_mean: Some(6.0),
        twist_sd: Some(spread),
    }
}

fn scene(contact: Coefficients, spread: f64) -> Result<Bowling> {
    let config = Config { delivery: Delivery::Regulation, release: delivery(spread), contact, ..Config::default() };
    Ok(Bowling::new(&config)?)
}

/// Sets of coefficients by name, each with the number of first balls bowled with it.
pub(super) fn make(work: &mut Work, cases: &[(&str, Coefficients, u64)]) -> Result<()> {
    let mut text = String::new();
    for (k, (name, contact, balls)) in cases.iter().enumerate() {
        text += &one(work, name, *contact, *balls, SEED + 20_000 + 1_000 * k as u64)?;
    }
    work.report.section("Bowling: what professionals leave", &text);
    Ok(())
}

fn one(work: &Work, name: &str, contact: Coefficients, balls: u64, seed: u64) -> Result<String> {
    let (tries, shots) = work.size((300, balls), (3, 4));
    let spreads = if work.quick { &SPREADS[2..4] } else { &SPREADS[..] };
    work.say(format_args!(
        "bowling, {name}: spread of {} deliveries, then {} first balls",
        spreads.len(),
        thousands(shots)
    ));
    let mut tried = Vec::new();
    for (k, &spread) in spreads.iter().enumerate() {
        tried.push((spread, from_prior(&scene(contact, spread)?, tries, seed + k as u64)?));
    }
    let spread = fitted(&tried);
    let tally = from_prior(&scene(contact, spread)?, shots, seed + 100)?;
    let rates = tried.iter().map(|(spread, tally)| format!("{spread}: {} %", tally.strikes().percent()));
    let [board, angle] = [0, 1].map(|k| moments(&tally.entries, k));
    let mut text = format!("### {name}\n\n{}", comparison(&tally));
    text += &format!(
        "\nOurs: {} first balls, seed {}, {} unfinished. Strikes by spread, {tries} shots each, seeds from {seed}: {}; at {spread:.2} the straight lines between them have the published rate. The balls \
         then meet the pins at board {:.2} ± {:.2} (standard deviation) and {:.2} ± {:.2}°. Most frequent leaves, %: {}.\n\n",
        thousands(tally.shots),
        seed + 100,
        tally.unfinished,
        rates.collect::<Vec<_>>().join(", "),
        board.0,
        board.1,
        angle.0,
        angle.1,
        tally.words(12),
    );
    Ok(text)
}

/// The spread at which straight lines through the strike rates first fall to the published rate. If all rates are below
/// it, the first spread; otherwise the last.
fn fitted(tried: &[(f64, Tally)]) -> f64 {
    let rate = |k: usize| tried[k].1.strikes().share();
    let crossing = (1..tried.len()).find(|&k| rate(k - 1) >= STRIKES && rate(k) < STRIKES);
    match crossing {
        Some(k) => {
            let (from, to) = (tried[k - 1].0, tried[k].0);
            from + (to - from) * (rate(k - 1) - STRIKES) / (rate(k - 1) - rate(k))
        }
        None if rate(0) < STRIKES => tried[0].0,
        None => tried[tried.len() - 1].0,
    }
}

/// Mean and standard deviation.
fn moments(entries: &[[f64; 2]], which: usize) -> (f64, f64) {
    let n = entries.len().max(1) as f64;
    let mean = entries.iter().map(|entry| entry[which]).sum::<f64>() / n;
    (mean, (entries.iter().map(|entry| square(entry[which] - mean)).sum::<f64>() / n).sqrt())
}

fn comparison(tally: &Tally) -> String {
    let row = |name: String, published: Count, ours: Count| {
        vec![name, published.percent(), ours.percent(), signed(ours.z(published)), shown_p(ours.p(published))]
    };
    let mut rows = vec![row("strike (fitted)".into(), Count::of_share(STRIKES, FIRST_BALLS), tally.strikes())];
    let leaves = leaves();
    rows.extend(leaves.iter().map(|&(leave, published)| row(leave.name(), published, tally.of(leave))));
    // Numbers that do not depend on how many of the professionals were left-handed.
    let published = |leave: Leave| leaves.iter().find(|l| l.0 == leave).map_or_else(Count::default, |l| l.1);
    let [seven, ten] = [7, 10].map(|pin| Leave::of_pins(&[pin]));
    let both = |a: Count, b: Count| Count::new(a.hits + b.hits, a.of);
    rows.push(row("7 or 10".into(), both(published(seven), published(ten)), both(tally.of(seven), tally.of(ten))));
    table(&["left", "published, %", "ours, %", "z", "p"], rows)
}
