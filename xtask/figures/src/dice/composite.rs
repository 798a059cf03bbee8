//! Figure 9: six dice, each thrown alone onto a table of its own, drawn on top of each other.

use super::{SIX, Thrown};
use crate::canvas::{self, HPos, Picture, bold, colour, text, write};
use crate::render::{Camera, Quality, render};
use crate::report::thousands;
use crate::{Result, Work};
use glam::DVec3;
use plaus_mcmc::Goal;
use plaus_scenes::Scene;
use plaus_scenes::animation::{Animation, Colour, Look, Motion, Piece, Shape, Track, Turn};

/// The chain from which the solution is taken.
const SEED: u64 = 1;
/// Time between two poses of a trail, in s.
const EVERY: f64 = 0.05;
/// Time between two points of a path, and their radius in m.
const FINE: f64 = 0.002;
const POINT: f64 = 6e-4;

/// Title, direction to the eye, up, field of view in degrees, and whether trails are shown.
const VIEWS: [(&str, DVec3, DVec3, f64, bool); 2] = [
    ("Poses every 0.05 s, and the ways of the middles", DVec3::new(-0.15, 0.8, 1.0), DVec3::Y, 26.0, true),
    (
        "At rest, from above, thrown upwards; marks are the places demanded",
        DVec3::new(0.0, 1.0, 0.0),
        DVec3::X,
        12.0,
        false,
    ),
];

pub(super) fn make(work: &mut Work) -> Result<()> {
    work.say(format_args!("figure-9: six dice, a chain of seed {SEED}"));
    let six = Thrown::new(SIX, |_| ())?;
    let (iteration, state) = six.solution(SEED, work.size(20_000, 2))?;
    let is_solution = six.scene.class(state.by_ref()).is_some();
    if !is_solution && !work.quick {
        return Err("the chain of figure 9 found no solution".into());
    }
    let animation = six.scene.animate(&state.draw)?;
    let (width, gap, head) = (900.0, 14.0, 62.0);
    let heights = [480.0, 420.0];
    let (mut pictures, mut top) = (Vec::new(), head);
    for (&(_, from, up, field, trails), height) in VIEWS.iter().zip(heights) {
        let shown = if trails { with_trails(&animation, work.quick) } else { at_rest(&animation) };
        let frame = shown.view.and_then(|view| view.frame).ok_or("the scene says nothing of what to look at")?;
        let dense = work.size(1.25, 0.1);
        let quality = Quality { width: (width * dense) as u32, height: (height * dense) as u32, rays: work.size(6, 1) };
        let camera = Camera::fitting(frame, from, up, field, width / height);
        let image = render(&shown, shown.motion.duration, &camera, quality)?;
        pictures.push(Picture { at: (gap, top), width, image });
        top += height + 34.0;
    }
    canvas::save_with(&work.out, "figure-9", ((width + 2.0 * gap) as u32, top as u32), &pictures, |area| {
        write(
            area,
            "Six dice, each at its own place with its own face up",
            &bold(20.0, colour::INK),
            HPos::Left,
            (gap, 24.0),
        )?;
        for (picture, (title, ..)) in pictures.iter().zip(VIEWS) {
            write(area, title, &text(13.0, colour::INK), HPos::Left, (picture.at.0, picture.at.1 - 11.0))?;
        }
        Ok(())
    })?;
    work.report.figure(
        "figure-9",
        format!(
            "{} of one exact chain of `scenarios/dice-six.toml` (seed {SEED}, iteration {}), as the paper's figure 9: die k is to come to rest with its middle near its mark (standard deviation 5 mm, \
             within 10 mm) with face k up. Each was thrown alone onto a random table of its own (bumps of 0.1 mm on a \
             grid of 8 mm); at each place the table of the die with the nearest mark is drawn. \
             Paler poses are earlier ones.",
            if is_solution { "The first solution" } else { "A state, no solution," },
            thousands(iteration)
        ),
    );
    Ok(())
}

/// A colour mixed with that of paper.
fn pale(look: Look, share: f64) -> Look {
    let Colour(rgb) = look.colour;
    let mixed = rgb.map(|c| (f64::from(c) + share * (235.0 - f64::from(c))).round() as u8);
    Look::new(mixed, look.material)
}

/// A track that stays where another one is at a time.
fn still(track: &Track, name: String, time: f64, look: Look) -> Track {
    let turn = Turn::still(track.orientation(time));
    Track::new(name, track.shape.clone(), look, vec![Piece::resting(0.0, track.position(time)).turning(turn)])
}

/// The dice at rest.
fn at_rest(animation: &Animation) -> Animation {
    let tracks: Vec<Track> = animation
        .motion
        .tracks
        .iter()
        .map(|track| still(track, track.name.clone(), animation.motion.duration, track.look))
        .collect();
    let corners = tracks.iter().map(|track| track.position(0.0));
    let low = corners.clone().fold(DVec3::splat(f64::INFINITY), DVec3::min) - DVec3::splat(0.02);
    let high = corners.fold(DVec3::splat(f64::NEG_INFINITY), DVec3::max) + DVec3::splat(0.02);
    let view = animation.view.map(|view| view.showing(low.with_y(0.0), high.with_y(0.0)));
    let motion = Motion { tracks, ..animation.motion.clone() };
    Animation { motion, view, ..animation.clone() }
}

/// The dice at rest, with poses on the way and their paths.
fn with_trails(animation: &Animation, quick: bool) -> Animation {
    let mut tracks = at_rest(animation).motion.tracks;
    for track in &animation.motion.tracks {
        let last = track.pieces.last().map_or(0.0, |piece| piece.start);
        let poses = (last / EVERY) as u32;
        for k in 0..poses {
            let share = 0.35 + 0.4 * (1.0 - f64::from(k) / f64::from(poses));
            tracks.push(still(
                track,
                format!("{}_pose_{k}", track.name),
                f64::from(k) * EVERY,
                pale(track.look, share),
            ));
        }
        let points = if quick { 0 } else { (last / FINE) as u32 };
        for k in 0..points {
            let at = Piece::resting(0.0, track.position(f64::from(k) * FINE));
            tracks.push(Track::new(format!("{}_way_{k}", track.name), Shape::ball(POINT), track.look, vec![at]));
        }
    }
    let motion = Motion { tracks, ..animation.motion.clone() };
    Animation { motion, ..animation.clone() }
}
