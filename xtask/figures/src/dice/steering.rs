//! Which bumps steer a die? The paper says that control points near the first few collisions bring about where it goes,
//! and later ones refine where it lies (section 5.4).

use super::{ONE, Thrown, posterior, sensitivity};
use crate::canvas::{self, Area, HPos, bold, colour, pen, px, text, write};
use crate::plot::{Axes, curve, plain};
use crate::{Result, Work};
use plaus_dist::math;
use plaus_scenes::dice::{Field, Realisation, Site};
use plotters::prelude::*;

/// Standard deviations of the bumps: the default, and one with which single points do steer.
const BUMPS: [f64; 2] = [0.1, 0.5];
const SHADES: [RGBColor; 2] = [colour::OURS, colour::PAPER];

/// Contacts with the table by their number: from, until (exclusive), name. The last ones are counted from the end.
pub(super) const CLASSES: [(usize, usize, &str); 7] =
    [(0, 1, "1"), (1, 2, "2"), (2, 3, "3"), (3, 5, "4–5"), (5, 9, "6–9"), (9, 17, "10–17"), (17, 33, "18–33")];

/// Number of kinds of contacts: the classes, and the last contact.
pub(super) const KINDS: usize = CLASSES.len() + 1;

/// The contact of a kind in an animation with `count` contacts; `pick` chooses among several. `None` if there is none.
/// The last contact belongs to no other kind.
pub(super) fn contact(kind: usize, count: usize, pick: f64) -> Option<usize> {
    let Some(&(from, until, _)) = CLASSES.get(kind) else { return count.checked_sub(1) };
    let until = until.min(count.saturating_sub(1));
    (from < until).then(|| from + ((until - from) as f64 * pick) as usize)
}

pub(super) fn name(kind: usize) -> &'static str {
    CLASSES.get(kind).map_or("last", |class| class.2)
}

/// The control points on which a field at a point depends, with their weights there: uniform cubic b-splines.
pub(super) fn basis(x: f64, y: f64, cell: f64) -> impl Iterator<Item = ([i32; 2], f64)> {
    let along = |at: f64| {
        let u = at / cell - (at / cell).floor();
        let (u2, u3) = (u * u, u * u * u);
        let weights = [1.0 - 3.0 * u + 3.0 * u2 - u3, 4.0 - 6.0 * u2 + 3.0 * u3, 1.0 + 3.0 * (u + u2 - u3), u3];
        ((at / cell).floor() as i32 - 1, weights.map(|w| w / 6.0))
    };
    let ((i, across), (j, up)) = (along(x), along(y));
    (0..16).map(move |k| ([i + k / 4, j + k % 4], across[k as usize / 4] * up[k as usize % 4]))
}

/// The height of a table at a place, relative to its standard deviation there: a standard normal number at any place
/// that is chosen without knowing the table.
pub(super) fn lift(table: &Realisation, sites: &[([i32; 2], f64)]) -> f64 {
    let (sum, squares) = sites.iter().fold((0.0, 0.0), |(sum, squares), &([i, j], weight)| {
        (sum + weight * table.score(Site { field: Field::Height, i, j }), squares + math::square(weight))
    });
    sum / squares.sqrt()
}

/// A number of each kind of contact with its standard error.
pub(super) type Row = [(f64, f64); KINDS];

pub(super) fn make(work: &mut Work) -> Result<()> {
    let mut rows = Vec::new();
    let mut text = String::new();
    for bumps in BUMPS {
        work.say(format_args!("steering: bumps of {bumps} mm"));
        let thrown = Thrown::new(ONE, |config| config.table.bumps_mm = bumps)?;
        let felt = sensitivity::measure(work, &thrown)?;
        let fixed = posterior::given_the_throw(work, &thrown)?;
        let free = posterior::of_solutions(work, &thrown)?;
        text += &table(bumps, &felt, &fixed, &free);
        rows.push((felt, fixed));
    }
    let size = (1000, 620);
    canvas::save(&work.out, "dice-steering", size, |area| draw(area, &rows))?;
    work.report.figure(
        "dice-steering",
        format!(
            "What control points near the n-th contact with the table do, for bumps of {} (blue) and {} mm (orange) standard deviation; bars are one standard error. How far the resting place moves when one point is \
             drawn anew (median over throws of the prior); how often such a change of a solution is accepted; shift \
             and spread of the height at the n-th contact of a solution in the posterior given its throw and all other \
             points, in prior standard deviations (the prior: 0 and 1).",
            BUMPS[0], BUMPS[1]
        ),
    );
    work.report.section("Dice: which bumps steer", &text);
    Ok(())
}

fn table(bumps: f64, felt: &sensitivity::Felt, fixed: &posterior::Fixed, free: &posterior::Free) -> String {
    let number = |(value, error): (f64, f64)| {
        if value.is_nan() { "–".to_owned() } else { format!("{value:.2} ± {error:.2}") }
    };
    let cells = (0..KINDS).map(|kind| {
        vec![
            name(kind).to_owned(),
            number(felt.moved[kind]),
            number(felt.turned[kind]),
            number(felt.accepted[kind]),
            number(fixed.shift[kind]),
            number(fixed.spread[kind]),
            number(free.solutions[kind]),
            number(free.prior[kind]),
            number(free.spread[kind]),
        ]
    });
    let head = [
        "contact",
        "rest moves, mm (median)",
        "another face",
        "accepted",
        "shift given the throw",
        "spread given the throw",
        "mean over solutions",
        "mean over the prior",
        "spread over solutions / over the prior",
    ];
    format!("Bumps of {bumps} mm:\n\n") + &crate::report::table(&head, cells) + "\n" + &felt.note + "\n\n"
}

/// The measurements on tables with one height of bumps.
type Measured = (sensitivity::Felt, posterior::Fixed);

/// A panel of the figure: title, label, the smallest upper end of its axis, and what it shows.
type Panel = (&'static str, &'static str, f64, fn(&Measured) -> Row);

fn draw(area: &Area<'_>, rows: &[Measured]) -> Result<()> {
    write(area, "Which bumps steer a die", &bold(20.0, colour::INK), HPos::Left, (24.0, 26.0))?;
    let (_, below) = area.split_vertically(px(44.0));
    let panels = below.split_evenly((2, 2));
    let of: [Panel; 4] = [
        ("one point drawn anew: the resting place moves", "mm (median)", 0.0, |row| row.0.moved),
        ("one point drawn anew: accepted", "share", 1.0, |row| row.0.accepted),
        ("posterior given the throw: shift", "prior standard deviations", 1.0, |row| row.1.shift),
        ("posterior given the throw: spread", "prior standard deviations", 1.2, |row| row.1.spread),
    ];
    for (panel, (title, label, least, value)) in panels.iter().zip(of) {
        let tops = rows.iter().flat_map(value).map(|(mean, error)| mean + error);
        let top = 1.08 * tops.filter(|top| top.is_finite()).fold(least.max(1e-3), f64::max);
        let mut chart = Axes {
            title,
            x: -0.5..KINDS as f64 - 0.5,
            y: 0.0..top,
            x_label: "contact with the table",
            y_label: label,
            ticks: (KINDS + 1, 5),
            x_text: &|x| {
                let kind = x.round();
                if (x - kind).abs() < 1e-9 && kind >= 0.0 && (kind as usize) < KINDS {
                    name(kind as usize).into()
                } else {
                    String::new()
                }
            },
            y_text: &plain,
        }
        .draw(panel)?;
        for ((k, row), shade) in (0_u8..).zip(rows).zip(SHADES) {
            let beside = 0.1 * (f64::from(k) - 0.5);
            let points: Vec<(f64, f64, f64)> = value(row)
                .iter()
                .enumerate()
                .filter(|(_, (mean, _))| mean.is_finite())
                .map(|(kind, &(mean, error))| (kind as f64 + beside, mean, error))
                .collect();
            let line: Vec<(f64, f64)> = points.iter().map(|&(x, mean, _)| (x, mean)).collect();
            curve(&mut chart, &line, pen(shade, 2.0))?;
            for (x, mean, error) in points {
                chart.draw_series([Circle::new((x, mean), px(3.0), shade.filled())])?;
                let bar = vec![(x, (mean - error).max(0.0)), (x, mean + error)];
                chart.draw_series([PathElement::new(bar, pen(shade, 1.5))])?;
            }
        }
    }
    for ((bumps, shade), left) in BUMPS.iter().zip(SHADES).zip([560.0, 700.0]) {
        write(area, &format!("bumps of {bumps} mm"), &text(14.0, shade), HPos::Left, (left, 26.0))?;
    }
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Weights of b-splines sum to one, and average to the place they belong to.
    #[test]
    fn weights_belong_to_their_place() {
        for (x, y) in [(0.0, 0.0), (0.0123, -0.0456), (-0.2, 0.0079)] {
            let (mut all, mut mean) = (0.0, [0.0; 2]);
            for ([i, j], weight) in basis(x, y, 0.008) {
                assert!((0.0..=4.0 / 9.0 + 1e-12).contains(&weight));
                all += weight;
                mean = [mean[0] + weight * f64::from(i) * 0.008, mean[1] + weight * f64::from(j) * 0.008];
            }
            assert!((all - 1.0).abs() < 1e-12 && (mean[0] - x).abs() < 1e-12 && (mean[1] - y).abs() < 1e-12);
        }
    }

    #[test]
    fn every_contact_is_of_one_kind() {
        assert_eq!(
            (contact(0, 40, 0.5), contact(4, 40, 0.99), contact(KINDS - 1, 40, 0.0)),
            (Some(0), Some(8), Some(39))
        );
        assert_eq!((contact(0, 1, 0.5), contact(KINDS - 1, 1, 0.5), contact(KINDS - 1, 0, 0.5)), (None, Some(0), None));
        assert_eq!((contact(3, 5, 0.99), contact(3, 4, 0.0)), (Some(3), None));
    }
}
