//! Left and right: balls from the left leave, as often, the mirror images of what balls from the right leave.

use super::SEED;
use super::published::BEST;
use super::roll::{Leave, Line, Tally, along, scene};
use crate::plausibility::chance::{Count, chi_squared_tail, shown_p, signed};
use crate::report::{table, thousands};
use crate::{Result, Work};
use plaus_dist::math::square;
use plaus_dist::standard_normal;
use plaus_scenes::bowling::Contact;

/// Standard deviation of the board, so that many leaves are seen.
const SPREAD: f64 = 1.0;

/// Leaves that at least so many shots left on both sides together are compared by themselves, others in one sum.
const ENOUGH: u64 = 20;

pub(super) fn make(work: &mut Work) -> Result<()> {
    let shots = work.size(2_000, 12);
    work.say(format_args!("bowling: left and right, {} shots of each", thousands(shots)));
    let scene = scene(Contact::default())?;
    let side = |from_left: bool, seed| {
        along(&scene, shots, seed, |stream| Line {
            from_left,
            ..Line::new(BEST.0 + SPREAD * standard_normal(stream), BEST.1)
        })
    };
    let (right, left) = (side(false, SEED + 1)?, side(true, SEED + 2)?);
    let compared = compare(&right, &left);
    let (mut sum, mut freedom) = (0.0, 0);
    let rows = compared.iter().map(|(name, [a, b])| {
        sum += square(a.z(*b));
        freedom += 1;
        vec![name.clone(), a.percent(), b.percent(), signed(a.z(*b)), shown_p(a.p(*b))]
    });
    let mut text =
        table(&["left by the right-hander's ball", "%", "mirror image by the left-hander's, %", "z", "p"], rows);
    // The classes' z have one relation: their counts add up to all shots. Leaving out the strikes' would take it into account exactly; this takes it into account on average.
    let p = chi_squared_tail(sum, freedom.max(2) - 1);
    text += &format!(
        "\n{} shots of either side at {}°, boards {} ± {SPREAD}, seeds {} and {}. p: Fisher's exact test. Σ z² = {sum:.1} over {freedom} rows, of which the last follows from the others; more by chance: {}. \
         {} and {} shots did not end.\n",
        thousands(shots),
        BEST.1,
        BEST.0,
        SEED + 1,
        SEED + 2,
        shown_p(p),
        right.unfinished,
        left.unfinished,
    );
    work.report.section("Bowling: left and right", &text);
    Ok(())
}

/// Counts of each leave that is frequent and of its mirror image, then of all others.
fn compare(right: &Tally, left: &Tally) -> Vec<(String, [Count; 2])> {
    let both = |leave: Leave| [right.of(leave), left.of(leave.mirrored())];
    let mut rows: Vec<(String, [Count; 2])> = right
        .most()
        .into_iter()
        .map(|(leave, _)| (leave.name(), both(leave)))
        .filter(|(_, [a, b])| a.hits + b.hits >= ENOUGH)
        .collect();
    let rest = |of: usize, shots: u64| Count::new(shots - rows.iter().map(|row| row.1[of].hits).sum::<u64>(), shots);
    let others = [rest(0, right.shots), rest(1, left.shots)];
    rows.push(("others".to_owned(), others));
    rows
}
