//! How the shares of faces depend on what is not published: the table and the throw, varied in the open.

use super::published::Rolled;
use super::throws::Conditions;
use super::{Compared, SEED};
use crate::report::{table, thousands};
use crate::{Result, Work};

const BOUNCES: [f64; 4] = [0.3, 0.5, 0.65, 0.8];
const GRIPS: [f64; 3] = [0.2, 0.35, 0.6];

/// Every condition by itself, far to either side of the default; then the table's two conditions together.
fn tried() -> Vec<Conditions> {
    let own = Conditions::default();
    let throws = [
        Conditions { height_mm: 50.0, ..own },
        Conditions { height_mm: 400.0, ..own },
        Conditions { speed: 0.3, ..own },
        Conditions { speed: 2.0, ..own },
        Conditions { spin: 5.0, ..own },
        Conditions { spin: 45.0, ..own },
        Conditions { rounding_mm: 0.5, ..own },
        Conditions { rounding_mm: 1.0, ..own },
        Conditions { rounding_mm: 2.0, ..own },
    ];
    let tables = BOUNCES.into_iter().flat_map(|bounce| GRIPS.map(|grip| Conditions { bounce, grip, ..own }));
    throws.into_iter().chain(tables).collect()
}

/// Conditions in words.
pub(super) fn name(conditions: &Conditions) -> String {
    let Conditions { bounce, grip, height_mm, speed, spin, rounding_mm } = conditions;
    format!(
        "restitution {bounce}, friction {grip}, from {height_mm} mm, at {speed} m/s, spin {spin} rad/s, \
         edges rounded by {rounding_mm} mm"
    )
}

/// Tables of the results under each condition; returns the conditions that fit best.
pub(super) fn make(work: &mut Work, rolled: &[Rolled]) -> Result<Conditions> {
    let throws = work.size(1_200, 10);
    let all = if work.quick { tried().split_off(19) } else { tried() };
    work.say(format_args!("dice: {} conditions, {} throws of each cuboid", all.len(), thousands(throws)));
    let mut compared = Vec::new();
    for (k, conditions) in all.into_iter().enumerate() {
        let ours = conditions.squares(rolled, throws, SEED + 10_000 + 1_000 * k as u64)?;
        compared.push(Compared { conditions, ours });
    }
    let rows = compared.iter().map(|compared| {
        let Conditions { bounce, grip, height_mm, speed, spin, rounding_mm } = compared.conditions;
        let share = |ratio: f64| {
            let k = rolled.iter().position(|rolled| rolled.ratio == ratio).unwrap_or(0);
            format!("{:.1}", 100.0 * compared.ours[k].share())
        };
        let mut cells = [bounce, grip, height_mm, speed, spin, rounding_mm].map(|value| value.to_string()).to_vec();
        cells.extend([0.47, 0.75, 1.16, 1.44, 1.87].map(share));
        cells.extend([false, true].map(|held_out| compared.shown(rolled, held_out)));
        cells
    });
    let head = [
        "restitution",
        "friction",
        "height, mm",
        "speed, m/s",
        "spin, rad/s",
        "rounding, mm",
        "0.47",
        "0.75",
        "1.16",
        "1.44",
        "1.87",
        "Σ z² †, p",
        "Σ z² held out, p",
    ];
    let mut text = table(&head, rows);
    text += &format!(
        "\nShares of square faces in percent for some x/y, and how far all are from the published ones. {} throws of each cuboid, seeds from {} on. The spin is the standard deviation of each component; \
         the throw's other spreads are the scene's. Conditions are chosen by the least Σ z² over the cuboids with †.\n",
        thousands(throws),
        SEED + 10_000,
    );
    work.report.section("Dice: what the table and the throw do", &text);
    let best = compared.iter().min_by(|a, b| a.misfit(rolled, false).0.total_cmp(&b.misfit(rolled, false).0));
    Ok(best.map_or_else(Conditions::default, |compared| compared.conditions))
}
