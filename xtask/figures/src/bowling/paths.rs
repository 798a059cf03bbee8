//! Paths of the ball: those that the prior offers, and those that strike.

use super::plan::{self, Place};
use super::shots::{Bowler, STRIKE, Until, by_chain, first_touch, is_pin};
use crate::canvas::{self, HPos, bold, colour, pen, px, text, write};
use crate::plot::{Axes, plain};
use crate::{Result, Work};
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::Target;
use plaus_scenes::Scene;
use plaus_scenes::bowling::{Delivery, Shot};
use plotters::prelude::*;

const SEED: u64 = 1;
/// Number of chains from which strikes are taken, and iterations between two strikes.
const CHAINS: u64 = 6;
const APART: u64 = 20;
const SIZE: (u32, u32) = (1200, 420);
/// From the foul line to the head pin, in m.
const LANE: f64 = 18.288;
/// How far the gutters reach to the side, in m.
const SIDE: f64 = 0.78;

/// Paths of the ball from the foul line until it touches a pin.
struct Ways {
    prior: Vec<Vec<Place>>,
    strikes: Vec<Vec<Place>>,
}

fn way(bowler: &Bowler, draw: &Shot) -> Result<Vec<Place>> {
    let animation = bowler.scene.animate(draw)?;
    let ball = animation.motion.tracks.iter().find(|track| track.name == "ball").ok_or("there is no ball")?;
    let end = first_touch(&animation, "ball", is_pin).unwrap_or(animation.motion.duration);
    Ok(plan::way(ball, 0.0, end, 0.02).iter().map(|(x, y)| (y + LANE, *x)).collect())
}

fn ways(delivery: Delivery, work: &Work) -> Result<Ways> {
    let bowler = STRIKE.bowler_with(|config| (config.delivery, config.shown_m) = (delivery, 18.3))?;
    let draws = (0..work.size(150, 4)).map(|k| bowler.scene.start(&mut Seed(SEED).chain(k).at(0, Purpose::START)));
    let prior = draws.map(|draw| way(&bowler, &draw)).collect::<Result<_>>()?;
    let mut strikes = Vec::new();
    for chain in 0..work.size(CHAINS, 1) {
        let mut seen = 0;
        by_chain(&bowler, SEED + chain, Until::Draws(work.size(600, 6)), |state| {
            if seen % APART == 0 {
                strikes.push(way(&bowler, &state.draw)?);
            }
            seen += 1;
            Ok(())
        })?;
    }
    Ok(Ways { prior, strikes })
}

pub(super) fn make(work: &mut Work) -> Result<()> {
    work.say("ways of the ball: prior and strikes, both deliveries");
    let both = [(Delivery::Paper, "the paper's delivery"), (Delivery::Regulation, "regulation delivery")];
    let ways_of = |(delivery, name)| -> Result<(Ways, &str)> { Ok((ways(delivery, work)?, name)) };
    let both = both.into_iter().map(ways_of).collect::<Result<Vec<_>>>()?;
    canvas::save(&work.out, "ball-paths", SIZE, |area| {
        write(area, "Ways of the ball", &bold(20.0, colour::INK), HPos::Left, (24.0, 28.0))?;
        write(area, "draws of the prior", &text(14.0, colour::FAINT), HPos::Left, (240.0, 28.0))?;
        write(area, "strikes", &text(14.0, colour::OURS), HPos::Left, (400.0, 28.0))?;
        let (_, rest) = area.split_vertically(px(46.0));
        for (panel, (ways, name)) in rest.split_evenly((1, 2)).iter().zip(&both) {
            let axes = Axes {
                title: name,
                x: 0.0..19.0,
                y: -SIDE..SIDE,
                x_label: "from the foul line (m)",
                y_label: "across, to the right (m)",
                ticks: (10, 7),
                x_text: &plain,
                y_text: &plain,
            };
            let mut chart = axes.draw(panel)?;
            for way in &ways.prior {
                plan::path(&mut chart, way, pen(RGBColor(190, 190, 190), 0.7))?;
            }
            for way in &ways.strikes {
                plan::path(&mut chart, way, pen(colour::OURS, 0.8))?;
            }
            for side in [-1.0, 1.0] {
                let edge = side * 0.5 * 41.5 * 0.0254;
                chart.draw_series([PathElement::new(vec![(0.0, edge), (19.0, edge)], pen(colour::INK, 1.0))])?;
            }
        }
        Ok(())
    })?;
    let [paper, regulation] = [&both[0].0, &both[1].0];
    work.report.figure(
        "ball-paths",
        format!(
            "Ways of the ball's middle from the foul line until it touches a pin, seen from above, stretched across; lines mark the lane's edges. Grey: {} draws of the prior. Blue: strikes of {} chains (every {APART}th \
             satisfying iteration; {} with the paper's delivery, {} with regulation). Strikes come in beside the head pin from either side; a ball that hooks may start anywhere.",
            paper.prior.len(),
            work.size(CHAINS, 1),
            paper.strikes.len(),
            regulation.strikes.len(),
        ),
    );
    Ok(())
}
