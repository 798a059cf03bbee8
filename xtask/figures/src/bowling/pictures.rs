//! Figure 3: frames of one animation for each of the paper's three shots.

use super::shots::{LEAVE, SPARE, STRIKE, Shot, first_touch, is_pin};
use crate::canvas::{self, HPos, Picture, bold, colour, text, write};
use crate::render::{Camera, Quality, render};
use crate::report::thousands;
use crate::{Result, Work};
use glam::DVec3;
use plaus_dist::Seed;
use plaus_scenes::animation::View;
use plaus_scenes::{Animation, Scene};

const SEED: u64 = 1;
/// Iterations after which a solution should have been found.
const MOST: u64 = 20_000;

/// Times of the frames, in s from when the ball first touches a pin; the last frame is at the end.
const TIMES: [f64; 4] = [-0.06, 0.08, 0.2, 0.5];

/// What must be visible: the deck, the ball before it, and the pins' heights. The ground is below the pit.
const FRAME: [DVec3; 2] = [DVec3::new(-0.72, -0.05, -0.95), DVec3::new(0.72, 0.4, 0.42)];
const GROUND: f64 = -0.31;

/// The direction from which it is seen.
const FROM: DVec3 = DVec3::new(0.0, 0.62, 1.0);
const FIELD: f64 = 22.0;

/// Size of a frame in pixels, and gaps.
const PANEL: (f64, f64) = (300.0, 220.0);
const GAP: f64 = 8.0;
const HEAD: f64 = 58.0;

/// A shot's animation and its caption.
struct Strip {
    shot: Shot,
    animation: Animation,
    iterations: u64,
}

fn strip(shot: Shot, most: u64) -> Result<Strip> {
    let bowler = shot.bowler()?;
    let first = bowler.first(Seed(SEED).chain(0), most)?;
    if !first.found && most == MOST {
        return Err(format!("no {} within {MOST} iterations of seed {SEED}", shot.name).into());
    }
    // The renderer puts its ground at the bottom of what the view shows.
    let view = View::from(FROM.x, FROM.y, FROM.z).only(DVec3 { y: GROUND, ..FRAME[0] }, FRAME[1]);
    let animation = bowler.scene.animate(&first.state.draw)?.with_view(view);
    Ok(Strip { shot, animation, iterations: first.iterations })
}

/// The times of a strip's frames.
fn times(animation: &Animation) -> Vec<f64> {
    let touch = first_touch(animation, "ball", is_pin).unwrap_or(0.0);
    let frames = TIMES.iter().map(|after| (touch + after).clamp(0.0, animation.motion.duration));
    frames.chain([animation.motion.duration]).collect()
}

pub(super) fn make(work: &mut Work) -> Result<()> {
    work.say(format_args!("figure 3: the first strike, leave and spare of chains of seed {SEED}"));
    let wanted = work.size(&[STRIKE, LEAVE, SPARE][..], &[SPARE][..]);
    let strips = wanted.iter().map(|shot| strip(*shot, work.size(MOST, 40))).collect::<Result<Vec<_>>>()?;
    let dense = work.size(1.25, 0.12);
    let quality = Quality { width: (PANEL.0 * dense) as u32, height: (PANEL.1 * dense) as u32, rays: work.size(6, 1) };
    let camera = Camera::fitting(FRAME, FROM, DVec3::Y, FIELD, PANEL.0 / PANEL.1);
    let mut pictures = Vec::new();
    for (row, strip) in (0_u8..).zip(&strips) {
        for (column, time) in (0_u8..).zip(times(&strip.animation)).take(work.size(TIMES.len() + 1, 2)) {
            let image = render(&strip.animation, time, &camera, quality)?;
            let at = (GAP + f64::from(column) * (PANEL.0 + GAP), HEAD + f64::from(row) * (PANEL.1 + 30.0));
            pictures.push(Picture { at, width: PANEL.0, image });
        }
    }
    let columns = (TIMES.len() + 1) as f64;
    let size =
        ((GAP + columns * (PANEL.0 + GAP)) as u32, (HEAD + strips.len() as f64 * (PANEL.1 + 30.0) - 20.0) as u32);
    canvas::save_with(&work.out, "figure-3", size, &pictures, |area| {
        write(area, "A strike, a six-seven split, and its spare", &bold(20.0, colour::INK), HPos::Left, (GAP, 22.0))?;
        for (row, strip) in (0_u8..).zip(&strips) {
            for (column, time) in (0_u8..).zip(times(&strip.animation)) {
                let at = (GAP + f64::from(column) * (PANEL.0 + GAP), HEAD - 10.0 + f64::from(row) * (PANEL.1 + 30.0));
                let moment =
                    if f64::from(column) + 1.0 < columns { format!("{time:.2} s") } else { "at the end".into() };
                write(area, &format!("{}: {moment}", strip.shot.name), &text(13.0, colour::INK), HPos::Left, at)?;
            }
        }
        Ok(())
    })?;
    let found: Vec<String> = strips
        .iter()
        .map(|s| format!("{}: iteration {} (`{}`)", s.shot.name, thousands(s.iterations), s.shot.file))
        .collect();
    work.report.figure(
        "figure-3",
        format!(
            "Frames of one animation for each shot, as the paper's figure 3: what exact chains with the default moves find first (seed {SEED}, chain 0, not chosen). {}. Times count from where \
             the animation begins, with the ball 4 m before the head pin; frames are {} s from the ball's first touch, and the end. Seen from the bowler's side.",
            found.join("; "),
            TIMES.map(|time| format!("{time:+}").replace('-', "−")).join(", "),
        ),
    );
    Ok(())
}
