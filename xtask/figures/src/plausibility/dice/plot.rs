//! Share of square faces against the cuboid's proportions.

use super::Compared;
use super::published::Rolled;
use super::sensitivity::name;
use crate::canvas::{self, Area, HPos, bold, colour, pen, px, text, write};
use crate::plausibility::chance::Count;
use crate::plot::{Axes, Chart, curve, plain};
use crate::{Result, Work};
use plaus_dist::math;
use plotters::prelude::*;

const SIZE: (u32, u32) = (1200, 560);
/// Smallest share in the logarithmic half, as a power of ten.
const LEAST: f64 = -3.0;

pub(super) fn make(work: &mut Work, rolled: &[Rolled], defaults: &Compared, chosen: &Compared) -> Result<()> {
    canvas::save(&work.out, "dice-faces", SIZE, |area| draw(area, rolled, defaults, chosen))?;
    work.report.figure(
        "dice-faces",
        format!(
            "How often a square face of a cuboid x × y × y comes up, left as it is, right on a logarithmic scale: rolls of real ones (dots; filled: those that conditions were chosen by), and throws under \
             the scene's default conditions and under the chosen ones ({}). Bars: one standard error (Wilson's). The green dot is the cube's third.",
            name(&chosen.conditions)
        ),
    );
    Ok(())
}

fn draw(area: &Area<'_>, rolled: &[Rolled], defaults: &Compared, chosen: &Compared) -> Result<()> {
    write(area, "Cuboids x × y × y: a square face up", &bold(20.0, colour::INK), HPos::Left, (24.0, 28.0))?;
    let legend = [
        ("rolls of steel cuboids", colour::INK),
        ("thrown, defaults", colour::OURS),
        ("thrown, chosen conditions", colour::PAPER),
    ];
    for ((words, colour), x) in legend.into_iter().zip([480.0, 700.0, 900.0]) {
        area.draw(&Circle::new((px(x), px(28.0)), px(4.0), colour.filled()))?;
        write(area, words, &text(13.0, colour::INK), HPos::Left, (x + 12.0, 28.0))?;
    }
    let (_, plots) = area.split_vertically(px(50.0));
    let halves = plots.split_evenly((1, 2));
    panel(&halves[0], rolled, [defaults, chosen], false)?;
    panel(&halves[1], rolled, [defaults, chosen], true)
}

fn panel(area: &Area<'_>, rolled: &[Rolled], ours: [&Compared; 2], logarithmic: bool) -> Result<()> {
    let scale = move |share: f64| if logarithmic { math::log10(share.max(1e-9)).max(LEAST) } else { share };
    let percent = |share: &f64| plain(&(100.0 * share));
    let power = |x: &f64| match x.round() as i32 {
        whole if (x - f64::from(whole)).abs() > 1e-9 => String::new(),
        whole => plain(&(100.0 * math::powi(10.0, whole))),
    };
    let mut chart = Axes {
        title: "",
        x: 0.3..2.8,
        y: if logarithmic { LEAST..0.05 } else { 0.0..1.0 },
        x_label: "x / y",
        y_label: "square face up (%)",
        ticks: (6, if logarithmic { 4 } else { 6 }),
        x_text: &plain,
        y_text: if logarithmic { &power } else { &percent },
    }
    .draw(area)?;
    let third = (1.0, scale(1.0 / 3.0));
    for (compared, colour) in ours.into_iter().zip([colour::OURS, colour::PAPER]) {
        let points: Vec<(f64, f64)> =
            rolled.iter().zip(&compared.ours).map(|(rolled, ours)| (rolled.ratio, scale(ours.share()))).collect();
        curve(&mut chart, &points, pen(colour, 1.5))?;
        for (rolled, ours) in rolled.iter().zip(&compared.ours) {
            bar(&mut chart, rolled.ratio, *ours, scale, colour)?;
        }
    }
    for rolled in rolled {
        bar(&mut chart, rolled.ratio, rolled.square, scale, colour::INK)?;
        let at = (rolled.ratio, scale(rolled.square.share()));
        let style = if rolled.is_held_out() { pen(colour::INK, 1.5) } else { colour::INK.filled() };
        chart.draw_series([Circle::new(at, px(3.5), style)])?;
    }
    chart.draw_series([Circle::new(third, px(4.0), colour::TARGET.filled())])?;
    Ok(())
}

fn bar(chart: &mut Chart<'_>, x: f64, count: Count, scale: impl Fn(f64) -> f64, colour: RGBColor) -> Result<()> {
    let (low, high) = count.interval();
    chart.draw_series([PathElement::new([(x, scale(low)), (x, scale(high))], pen(colour, 1.5))])?;
    Ok(())
}
