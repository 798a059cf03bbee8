//! Whether the simulation is sound where statistics depend on it: leaves of balls from the left are mirror images,
//! equally frequent, of leaves of balls from the right; and a finer accuracy gives the same leaves.

use super::SEED;
use super::published::BEST;
use super::roll::{Leave, Line, Tally, along, scene_at};
use crate::plausibility::chance::{Count, chi_squared_tail, shown_p, signed};
use crate::report::{table, thousands};
use crate::{Result, Work};
use plaus_dist::math::square;
use plaus_dist::standard_normal;
use plaus_scenes::AccuracyPreset;
use plaus_scenes::bowling::Coefficients;

/// Standard deviation of the board, so that many leaves are seen.
const SPREAD: f64 = 1.0;

/// Leaves with at least this many shots on both sides together are compared one by one, the others as one sum.
const ENOUGH: u64 = 20;

pub(super) fn make(work: &mut Work) -> Result<()> {
    let (shots, fine) = work.size((2_000, 700), (6, 1));
    work.say(format_args!(
        "bowling: left and right, {} shots of each; {} at a finer accuracy",
        thousands(shots),
        thousands(fine)
    ));
    let bowl = |accuracy: AccuracyPreset, shots, from_left: bool, seed| {
        along(&scene_at(accuracy, Coefficients::default())?, shots, seed, |stream| Line {
            from_left,
            ..Line::new(BEST.0 + SPREAD * standard_normal(stream), BEST.1)
        })
    };
    let right = bowl(AccuracyPreset::Standard, shots, false, SEED + 1)?;
    let left = bowl(AccuracyPreset::Standard, shots, true, SEED + 2)?;
    let finer = bowl(AccuracyPreset::Fine, fine, false, SEED + 3)?;
    let mut text = format!(
        "Balls at {}° onto boards {} ± {SPREAD}, so that many leaves are seen: {} from either side (seeds {} and {}), and {} from the right at the `fine` accuracy (seed {}). z and p (Fisher's exact test): \
         against the first column.\n\n",
        BEST.1,
        BEST.0,
        thousands(shots),
        SEED + 1,
        SEED + 2,
        thousands(fine),
        SEED + 3,
    );
    let (mirrored, mirrored_sum) = compare(&right, &left, Leave::mirrored);
    let (fine, fine_sum) = compare(&right, &finer, |leave| leave);
    text += &table(&["left by a right-hander's ball", "%", "mirror image by a left-hander's, %", "z", "p"], mirrored);
    text += &format!("\n{mirrored_sum}\n\n");
    text += &table(&["left by a right-hander's ball", "standard, %", "fine, %", "z", "p"], fine);
    text +=
        &format!("\n{fine_sum} {} of all shots did not end.\n", right.unfinished + left.unfinished + finer.unfinished);
    work.report.section("Bowling: left and right, and a finer accuracy", &text);
    Ok(())
}

/// Rows of each frequent leave and its counterpart in the other tally, then of all other leaves; and the sum in words.
fn compare(ours: &Tally, other: &Tally, image: fn(Leave) -> Leave) -> (Vec<Vec<String>>, String) {
    let both = |leave: Leave| [ours.of(leave), other.of(image(leave))];
    let leaves = ours.most().into_iter().map(|(leave, _)| (leave.name(), both(leave)));
    let mut rows: Vec<(String, [Count; 2])> = leaves.filter(|(_, [a, b])| a.hits + b.hits >= ENOUGH).collect();
    let rest = |of: usize, shots: u64| Count::new(shots - rows.iter().map(|row| row.1[of].hits).sum::<u64>(), shots);
    let others = [rest(0, ours.shots), rest(1, other.shots)];
    rows.push(("others".to_owned(), others));
    // χ² of the whole table; the last row follows from the others.
    let part = |a: Count, b: Count| {
        let share = (a.hits + b.hits) as f64 / (a.of + b.of) as f64;
        let cell = |c: Count| {
            if share > 0.0 { square(c.hits as f64 - share * c.of as f64) / (share * c.of as f64) } else { 0.0 }
        };
        cell(a) + cell(b)
    };
    let sum: f64 = rows.iter().map(|(_, [a, b])| part(*a, *b)).sum();
    let freedom = rows.len() as u32 - 1;
    let words = format!(
        "χ² of the whole table: {sum:.1} with {freedom} degrees of freedom; more by chance: {}.",
        shown_p(chi_squared_tail(sum, freedom))
    );
    let row =
        |(name, [a, b]): (String, [Count; 2])| vec![name, a.percent(), b.percent(), signed(a.z(b)), shown_p(a.p(b))];
    (rows.into_iter().map(row).collect(), words)
}
