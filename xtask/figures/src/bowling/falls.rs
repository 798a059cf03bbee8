//! How many pins fall in draws of the prior.

use super::shots::STRIKE;
use crate::canvas::{self, HPos, bold, colour, pen, px, text, write};
use crate::plot::{Axes, plain};
use crate::report::{table, thousands};
use crate::stats::Estimate;
use crate::{Result, Work};
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::{StateOf, Target};
use plaus_scenes::bowling::{Bowling, Delivery, Work as Memory};
use plotters::prelude::*;
use rayon::prelude::*;

const SEED: u64 = 1;
const SIZE: (u32, u32) = (900, 440);
const BOTH: [(Delivery, &str, RGBColor); 2] = [
    (Delivery::Paper, "the paper's delivery", colour::PAPER),
    (Delivery::Regulation, "regulation delivery", colour::OURS),
];

/// Number of shots for each number of pins that fell.
fn falls(delivery: Delivery, shots: u64) -> Result<[usize; 11]> {
    let bowler = STRIKE.bowler_with(|config| config.delivery = delivery)?;
    let one = |memory: &mut Memory, shot| -> Result<usize> {
        let draw = bowler.scene.start(&mut Seed(SEED).chain(shot).at(0, Purpose::START));
        let state = StateOf::<Bowling>::evaluate(&bowler.scene, draw, memory)?;
        Ok(state.outcome.pins.iter().filter(|fate| !fate.stands()).count())
    };
    let each = (0..shots).into_par_iter().map_init(Memory::default, one).collect::<Result<Vec<_>>>()?;
    Ok(std::array::from_fn(|count| each.iter().filter(|fell| **fell == count).count()))
}

pub(super) fn make(work: &mut Work) -> Result<()> {
    let shots = work.size(5_000, 20);
    work.say(format_args!("pins that fall: {shots} draws of either delivery's prior"));
    let counts = BOTH.into_iter().map(|(delivery, ..)| falls(delivery, shots)).collect::<Result<Vec<_>>>()?;
    let share = |counts: &[usize; 11], fell: usize| Estimate::of(counts[fell], shots as usize);
    let most = counts.iter().flat_map(|counts| (0..11).map(|fell| share(counts, fell).value)).fold(0.0, f64::max);
    canvas::save(&work.out, "pin-falls", SIZE, |area| {
        write(area, "Pins that fall, draws of the prior", &bold(20.0, colour::INK), HPos::Left, (24.0, 28.0))?;
        for (k, (_, name, ink)) in (0_u8..).zip(BOTH) {
            write(area, name, &text(14.0, ink), HPos::Left, (420.0 + 200.0 * f64::from(k), 28.0))?;
        }
        let (_, plot) = area.split_vertically(px(46.0));
        let axes = Axes {
            title: "",
            x: -0.6..10.6,
            y: 0.0..1.15 * most,
            x_label: "pins down",
            y_label: "share of shots",
            ticks: (11, 6),
            x_text: &plain,
            y_text: &|y| format!("{y:.2}"),
        };
        let mut chart = axes.draw(&plot)?;
        for ((counts, (_, _, ink)), shift) in counts.iter().zip(BOTH).zip([-0.2, 0.2]) {
            for fell in 0..11 {
                let (x, Estimate { value, error }) = (fell as f64 + shift, share(counts, fell));
                let bar = Rectangle::new([(x - 0.17, 0.0), (x + 0.17, value)], ink.mix(0.55).filled());
                chart.draw_series([bar])?;
                let whisker = vec![(x, (value - error).max(0.0)), (x, value + error)];
                chart.draw_series([PathElement::new(whisker, pen(colour::INK, 1.4))])?;
            }
        }
        Ok(())
    })?;
    let shots = thousands(shots);
    work.report.figure(
        "pin-falls",
        format!("How many of ten pins fall: {shots} independent draws of the prior (seed {SEED}) of either delivery; whiskers are one standard error either way."),
    );
    let rows = (0..11).map(|fell| {
        let cell = |counts: &[usize; 11]| share(counts, fell).shown();
        vec![fell.to_string(), cell(&counts[0]), cell(&counts[1])]
    });
    let mut text = table(&["pins down", BOTH[0].1, BOTH[1].1], rows);
    text += &format!(
        "\nShares of {shots} draws of the prior each, with their standard errors. Ten pins down is a strike.\n"
    );
    work.report.section("Bowling: pins that fall", &text);
    Ok(())
}
