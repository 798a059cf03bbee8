//! The set-up of figure 4: the lane, where the pins stand, and how a ball reaches them; the two pins of the seven-ten
//! split are marked.

use super::plan;
use super::shots::{Bowler, SEVEN_TEN, STRIKE};
use crate::canvas::{self, Area, HPos, bold, colour, pen, px, text, write};
use crate::plot::{Axes, dashed, plain};
use crate::{Result, Work};
use plaus_dist::{Purpose, Seed};
use plaus_mcmc::Target;
use plaus_scenes::bowling::{Quantity, Shot};
use plaus_scenes::{Animation, Scene};
use plotters::prelude::*;

const SIZE: (u32, u32) = (1200, 690);
/// The range that the deck's plot shows, in m, and pixels per metre.
const X: std::ops::Range<f64> = -0.9..0.9;
const Y: std::ops::Range<f64> = -0.6..1.8;
const SCALE: f64 = 240.0;
const MARKED: RGBColor = RGBColor(250, 200, 190);
const PALE: RGBColor = RGBColor(255, 252, 244);

/// A delivery that hooks into the pocket like a professional's, and one without spin: the two presets' middle values
/// except for place, direction and spin.
fn delivery(bowler: &Bowler, values: &[(Quantity, f64)]) -> Shot {
    let mut draw = bowler.scene.start(&mut Seed(1).chain(0).at(0, Purpose::START));
    draw.pins.fill([0.0; 2]);
    for (quantity, value) in values {
        draw.ball[*quantity as usize] = *value;
    }
    draw
}

pub(super) fn make(work: &mut Work) -> Result<()> {
    use Quantity::{Across, Density, Drift, Gyration, Height, Hook, Radius, Roll, Speed, Twist};
    work.say("figure 4: the set-up");
    let all = (1..=10).collect::<Vec<u32>>();
    let hooking = SEVEN_TEN.bowler_with(|config| (config.pins, config.shown_m) = (all.clone(), 18.2))?;
    let hook = delivery(
        &hooking,
        &[
            (Radius, 0.1085),
            (Density, 1270.0),
            (Gyration, 0.6),
            (Across, 0.33),
            (Height, 0.115),
            (Speed, 8.0),
            (Drift, 0.26),
            (Roll, 20.0),
            (Hook, -30.0),
            (Twist, 0.0),
        ],
    );
    let plain = STRIKE.bowler_with(|config| config.shown_m = 18.2)?;
    let straight = delivery(
        &plain,
        &[
            (Radius, 0.1),
            (Density, 1300.0),
            (Across, 0.3),
            (Height, 0.115),
            (Speed, 7.0),
            (Drift, -0.085),
            (Twist, 0.0),
        ],
    );
    let ways = [
        (hooking.scene.animate(&hook)?, "regulation: 30 rad/s of side spin, 12 m of oil", colour::PATH),
        (plain.scene.animate(&straight)?, "the paper's: no spin, the same friction everywhere", colour::PAPER),
    ];
    canvas::save(&work.out, "figure-4", SIZE, |area| {
        write(
            area,
            "The lane, the pins' numbers, and two deliveries",
            &bold(20.0, colour::INK),
            HPos::Left,
            (24.0, 28.0),
        )?;
        let (_, rest) = area.split_vertically(px(50.0));
        let (left, right) = rest.split_horizontally(px(1.8 * SCALE + 100.0));
        deck(&left, &ways)?;
        whole(&right, &ways)
    })?;
    work.report.figure(
        "figure-4",
        "The set-up of the paper's figure 4, drawn from the scene's own numbers. Left: the deck with gutters, kickbacks (dark), pit and cushion; pins with their numbers, 7 and 10 marked. Dotted: how \
         the 7-10 split is converted: the seven, struck on its outer side, must come back from the kickback and slide \
         across the deck into the ten. Right: the whole lane from the foul line, stretched across; ways of the middle \
         of two simulated balls. The hooking ball slides straight on while the lane is oiled (shaded) and turns where \
         it is dry."
            .to_owned(),
    );
    Ok(())
}

type Way<'a> = (Animation, &'a str, RGBColor);

fn deck(area: &Area<'_>, ways: &[Way<'_>]) -> Result<()> {
    let plot = area.clone().shrink((0, 0), (px(1.8 * SCALE + 62.0 + 32.0), px(2.4 * SCALE + 44.0 + 12.0)));
    let mut chart = plan::deck(&plot, "", X, Y)?;
    let Some((animation, ..)) = ways.first() else { return Ok(()) };
    plan::ground(&mut chart, &animation.scenery)?;
    for (number, track) in plan::pins(animation) {
        let fill = if matches!(number, "7" | "10") { MARKED } else { PALE };
        plan::pin(&mut chart, number, plan::at(track, 0.0), SCALE, fill)?;
    }
    // From the seven to the kickback, and across to the ten.
    let bounce = [(-0.457, 0.791), (-0.71, 0.86), (0.457, 0.791)];
    dashed(&mut chart, &bounce, pen(colour::NORMAL, 1.8), 2.0, 4.0)?;
    for (animation, _, ink) in ways {
        let Some(ball) = animation.motion.tracks.iter().find(|track| track.name == "ball") else { continue };
        let touch =
            super::shots::first_touch(animation, "ball", super::shots::is_pin).unwrap_or(animation.motion.duration);
        plan::path(&mut chart, &plan::way(ball, 0.0, touch, 0.005), pen(*ink, 2.0))?;
        plan::circle(&mut chart, plan::at(ball, touch), ball.shape.reach(), SCALE, None, *ink)?;
    }
    Ok(())
}

fn whole(area: &Area<'_>, ways: &[Way<'_>]) -> Result<()> {
    let plot = area.clone().shrink((0, 0), (px(630.0), px(2.4 * SCALE + 44.0 + 12.0)));
    let axes = Axes {
        title: "",
        x: 0.0..19.4,
        y: -0.6..0.75,
        x_label: "from the foul line (m)",
        y_label: "across, to the bowler's right (m)",
        ticks: (10, 7),
        x_text: &plain,
        y_text: &plain,
    };
    let mut chart = axes.draw(&plot)?;
    let lane = 0.5 * 41.5 * 0.0254;
    chart.draw_series([Rectangle::new([(0.0, -lane), (19.4, lane)], RGBColor(246, 231, 205).filled())])?;
    chart.draw_series([Rectangle::new([(0.0, -lane), (12.0, lane)], RGBColor(226, 222, 214).filled())])?;
    for (k, (animation, name, ink)) in (0_u8..).zip(ways) {
        let Some(ball) = animation.motion.tracks.iter().find(|track| track.name == "ball") else { continue };
        let touch =
            super::shots::first_touch(animation, "ball", super::shots::is_pin).unwrap_or(animation.motion.duration);
        let way: Vec<_> = plan::way(ball, 0.0, touch, 0.01).iter().map(|(x, y)| (y + 18.288, *x)).collect();
        plan::path(&mut chart, &way, pen(*ink, 2.2))?;
        write(&plot, name, &text(13.0, *ink), HPos::Left, (90.0, 24.0 + 20.0 * f64::from(k)))?;
    }
    if let Some((animation, ..)) = ways.first() {
        for (_, track) in plan::pins(animation) {
            let (x, y) = plan::at(track, 0.0);
            chart.draw_series([Circle::new((y + 18.288, x), px(3.0), pen(colour::INK, 1.0))])?;
        }
    }
    Ok(())
}
