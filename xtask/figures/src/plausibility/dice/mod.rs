//! Cuboids x × y × y that are thrown at random: how often a square face comes up, compared with rolls of real cuboids;
//! and whether a cube is fair.

mod cube;
mod plot;
mod published;
mod sensitivity;
mod smooth;
mod throws;

use super::chance::{Count, chi_squared_tail, shown_p, signed};
use crate::report::{table, thousands};
use crate::{Result, Work};
use plaus_dist::math::square;
use published::Rolled;
use throws::Conditions;

const SEED: u64 = 9_716;

/// Throws under some conditions, to be compared with the rolls.
struct Compared {
    conditions: Conditions,
    /// One for each cuboid that was rolled.
    ours: Vec<Count>,
}

impl Compared {
    /// Σ z² over the cuboids by which conditions may be chosen, or over those held out, and their number.
    fn misfit(&self, rolled: &[Rolled], held_out: bool) -> (f64, u32) {
        let each = rolled.iter().zip(&self.ours).filter(|(rolled, _)| rolled.is_held_out() == held_out);
        each.fold((0.0, 0), |(sum, count), (rolled, ours)| (sum + square(ours.z(rolled.square)), count + 1))
    }

    /// The same as text.
    fn shown(&self, rolled: &[Rolled], held_out: bool) -> String {
        let (sum, count) = self.misfit(rolled, held_out);
        format!("{sum:.1} ({count}), {}", shown_p(chi_squared_tail(sum, count)))
    }
}

pub(crate) fn make(work: &mut Work) -> Result<()> {
    if let Some(part) = &work.part {
        return Err(format!("dice have no part `{part}`: all is made together").into());
    }
    cube::make(work)?;
    let rolled = Rolled::all();
    let throws = work.size(10_000, 20);
    work.say(format_args!("dice: {} throws of each of {} cuboids", thousands(throws), rolled.len()));
    let of = |conditions: Conditions, seed| -> Result<Compared> {
        Ok(Compared { conditions, ours: conditions.squares(&rolled, throws, seed)? })
    };
    let defaults = of(Conditions::default(), SEED)?;
    let chosen = sensitivity::make(work, &rolled)?;
    // Thrown again, because the smallest of many sums that are partly chance is too small.
    let chosen = of(chosen, SEED + 2_000)?;
    plot::make(work, &rolled, &defaults, &chosen)?;
    compare(work, &rolled, &defaults, &chosen, throws);
    Ok(())
}

fn compare(work: &mut Work, rolled: &[Rolled], defaults: &Compared, chosen: &Compared, throws: u64) {
    let cells = |compared: &Compared, k: usize| {
        let (ours, theirs) = (compared.ours[k], rolled[k].square);
        [ours.percent(), format!("{} ({})", signed(ours.z(theirs)), shown_p(ours.p(theirs)))]
    };
    let rows = rolled.iter().enumerate().map(|(k, rolled)| {
        let [default, default_z] = cells(defaults, k);
        let [best, best_z] = cells(chosen, k);
        let name = format!("{:.2}{}", rolled.ratio, if rolled.is_held_out() { "" } else { " †" });
        vec![name, format!("{}", rolled.square.of), rolled.square.percent(), default, default_z, best, best_z]
    });
    let head = ["x/y", "rolls", "published, %", "scene's defaults, %", "z (p)", "chosen conditions, %", "z (p)"];
    let mut text = table(&head, rows);
    let sums = [("†", false), ("held out", true)].map(|(name, held_out)| {
        let of = |compared: &Compared| compared.shown(rolled, held_out);
        format!("- {name}: defaults {}; chosen {}", of(defaults), of(chosen))
    });
    let (least, freedom) = smooth::misfit(rolled);
    text += &format!(
        "\nHow often a square face was uppermost; {} throws of each, y = 16 mm, edges sharp by default, seeds {SEED} and {} on. Errors are binomial. z: difference in standard errors of both; p: Fisher's exact \
         test. Published: fifteen cuboids cut out of a steel bar and rolled by students (The Mathematical Gazette, \
         March 2013, note 97.16); how and onto what is not said. Conditions were chosen by the \
         cuboids with † alone (below); chosen: {}.\n\nΣ z² (how many), probability of more by chance:\n\n{}\n\nNor \
         does a smooth curve agree: the best polynomial of fourth degree in ln(x/y) for \
         ln(p/(1 − p)), with a cube's third, leaves {least:.1} with {freedom} degrees of freedom (more by chance: {}).\n",
        thousands(throws),
        SEED + 2_000,
        sensitivity::name(&chosen.conditions),
        sums.join("\n"),
        shown_p(chi_squared_tail(least, freedom)),
    );
    work.report.section("Dice: a square face up", &text);
}
