//! The table of a solution: its height, greatly exaggerated, and its restitution and friction, with the places where
//! the die touched it.

use super::steering::basis;
use super::{ONE, Thrown};
use crate::canvas::{self, HPos, Picture, bold, colour, px, text, write};
use crate::render::{Camera, Quality, render};
use crate::report::thousands;
use crate::{Result, Work};
use glam::DVec3;
use plaus_mcmc::Goal;
use plaus_scenes::Scene;
use plaus_scenes::animation::{Animation, Form, Look, Material, Motion, Piece, Prop, Shape, Track};
use plaus_scenes::dice::{Dice, Field, Realisation, Site};
use plotters::prelude::*;
use resvg::tiny_skia::{ColorU8, Pixmap};

const SEED: u64 = 3;
/// Heights are drawn this many times larger.
const HIGHER: f64 = 30.0;
/// Over which width the table goes down at the border of the bumps, in m.
const BORDER: f64 = 0.015;
/// Pixels per control point of the maps.
const FINE: usize = 12;
const CLOTH: Look = Look::new([120, 150, 135], Material::Matte);

pub(super) fn make(work: &mut Work) -> Result<()> {
    work.say("dice-surface: a table");
    let one = Thrown::new(ONE, |_| ())?;
    let (iteration, state) = one.solution(SEED, work.size(20_000, 2))?;
    let is_solution = one.scene.class(state.by_ref()).is_some();
    let animation = one.scene.animate(&state.draw)?;
    let shift = one.scene.offset(&state.draw, 0);
    let touched: Vec<[f64; 2]> =
        state.outcome.trips[0].impacts.iter().map(|&[_, x, y]| [x + shift.x, y + shift.y]).collect();
    let relief = exaggerated(&animation, &touched)?;
    let frame = relief.view.and_then(|view| view.frame).ok_or("the scene says nothing of what to look at")?;
    let (width, height, gap, head) = (900.0, 400.0, 14.0, 62.0);
    let dense = work.size(1.25, 0.1);
    let quality = Quality { width: (width * dense) as u32, height: (height * dense) as u32, rays: work.size(6, 1) };
    let camera = Camera::fitting(frame, DVec3::new(0.1, 0.9, 1.0), DVec3::Y, 22.0, width / height);
    let mut pictures =
        vec![Picture { at: (gap, head), width, image: render(&relief, relief.motion.duration, &camera, quality)? }];
    let corners = [0, 1].map(|axis| {
        let along = || touched.iter().map(|at| at[axis]);
        [along().fold(f64::INFINITY, f64::min) - 0.03, along().fold(f64::NEG_INFINITY, f64::max) + 0.03]
    });
    let table = &state.draw.tables[0];
    let wide = 0.5 * (width - gap);
    let maps = [(Field::Restitution, "restitution", [0.43, 0.57]), (Field::Friction, "friction", [0.28, 0.42])];
    let mut lowest: f64 = 0.0;
    for (k, (field, _, range)) in (0_u8..).zip(maps) {
        let image = map(&one.scene, table, field, corners, range)?;
        lowest = lowest.max(wide * f64::from(image.height()) / f64::from(image.width()));
        let at = (gap + f64::from(k) * (wide + gap), head + height + 34.0);
        pictures.push(Picture { at, width: wide, image });
    }
    let size = ((width + 2.0 * gap) as u32, (head + height + 34.0 + lowest + gap) as u32);
    let title = format!("A random table: height {HIGHER:.0} times exaggerated, restitution and friction");
    // Marks are on top of the maps, so they are pictures as well.
    let marked = pictures.into_iter().enumerate().map(|(k, picture)| {
        if k == 0 { picture } else { Picture { image: with_marks(picture.image, &touched, corners), ..picture } }
    });
    let pictures: Vec<Picture> = marked.collect();
    canvas::save_with(&work.out, "dice-surface", size, &pictures, |area| {
        write(area, &title, &bold(20.0, colour::INK), HPos::Left, (gap, 24.0))?;
        let words = "where the die touched it, from the first (red) to the last (yellow) contact";
        write(area, words, &text(13.0, colour::INK), HPos::Left, (gap, head - 11.0))?;
        for (picture, (_, name, [low, high])) in pictures.iter().skip(1).zip(maps) {
            let words = format!("{name}: from {low} (dark) to {high} (bright)");
            write(area, &words, &text(13.0, colour::INK), HPos::Left, (picture.at.0, picture.at.1 - 11.0))?;
        }
        area.draw(&Rectangle::new([(0, 0), (px(0.0), px(0.0))], WHITE.filled()))?;
        Ok(())
    })?;
    work.report.figure(
        "dice-surface",
        format!(
            "The table of {} of `scenarios/dice-one.toml` (seed {SEED}, iteration {}) where the die came: bumps of 0.1 mm standard deviation a control point, on a grid of 8 mm. Three independent fields, each a uniform cubic \
             b-spline over control points that are made where something looks.",
            if is_solution { "the first solution" } else { "a state, no solution," },
            thousands(iteration)
        ),
    );
    Ok(())
}

/// The colour of contact `k` of `count`, from the first to the last.
fn shade(k: usize, count: usize) -> [u8; 3] {
    let share = k as f64 / count.max(2).saturating_sub(1) as f64;
    [220, (40.0 + 170.0 * share) as u8, (30.0 + 20.0 * share) as u8]
}

/// The table alone, its bumps exaggerated, with the places of contact on it.
fn exaggerated(animation: &Animation, touched: &[[f64; 2]]) -> Result<Animation> {
    let surface = animation.scenery.iter().find_map(|prop| match &prop.form {
        Form::Heightfield { origin, step, columns, heights } => Some((*origin, *step, *columns as usize, heights)),
        _ => None,
    });
    let (origin, step, columns, heights) = surface.ok_or("the table has no bumps")?;
    let all = heights.len() / columns;
    // Without the border, where the bumps go down to the block around them.
    let cut = step.map(|step| (BORDER / step).ceil() as usize);
    let (rows, across) = (cut[1]..all - cut[1], cut[0]..columns - cut[0]);
    let of_row = |row: usize| heights[row * columns..][across.clone()].iter().map(|height| height * HIGHER);
    let higher: Vec<f64> = rows.clone().flat_map(of_row).collect();
    let origin = origin + DVec3::new(cut[0] as f64 * step[0], 0.0, cut[1] as f64 * step[1]);
    let (rows, columns) = (rows.len(), across.len());
    let height = |x: f64, z: f64| {
        let index = |at: f64, most: usize| (at.round().max(0.0) as usize).min(most - 1);
        higher[index((z - origin.z) / step[1], rows) * columns + index((x - origin.x) / step[0], columns)]
    };
    let mark = |(k, at): (usize, &[f64; 2])| {
        // An animation's z runs against the simulator's y.
        let (x, z) = (at[0], -at[1]);
        let look = Look::new(shade(k, touched.len()), Material::Glossy);
        let place = DVec3::new(x, height(x, z) + 0.001, z);
        Track::new(format!("contact_{k}"), Shape::ball(0.0016), look, vec![Piece::resting(0.0, place)])
    };
    let tracks = touched.iter().enumerate().map(mark).collect();
    let far = DVec3::new((columns - 1) as f64 * step[0], 0.0, (rows - 1) as f64 * step[1]);
    let most = higher.iter().fold(0.0_f64, |most, height| most.max(height.abs()));
    let form = Form::Heightfield { origin, step, columns: columns as u32, heights: higher };
    let view = animation.view.map(|view| view.showing(origin - most * DVec3::Y, origin + far + most * DVec3::Y));
    let motion = Motion { tracks, ..animation.motion.clone() };
    Ok(Animation { motion, scenery: vec![Prop::new("surface", CLOTH, form)], view, ..animation.clone() })
}

/// A field between corners `[[x, x], [y, y]]` as a picture, dark where it is low.
fn map(scene: &Dice, table: &Realisation, field: Field, [xs, ys]: [[f64; 2]; 2], range: [f64; 2]) -> Result<Pixmap> {
    let cell = scene.config().table.grid_mm * 1e-3;
    let pixels = |[low, high]: [f64; 2]| ((high - low) / cell * FINE as f64).ceil().max(1.0) as u32;
    let mut image = Pixmap::new(pixels(xs), pixels(ys)).ok_or("a map without pixels")?;
    let (width, step) = (image.width() as usize, cell / FINE as f64);
    for (k, pixel) in image.pixels_mut().iter_mut().enumerate() {
        let x = xs[0] + ((k % width) as f64 + 0.5) * step;
        let y = ys[1] - ((k / width) as f64 + 0.5) * step;
        // Indices of points refer to the table before it was shifted.
        let (x, y) = (x - f64::from(table.shifted[0]) * cell, y - f64::from(table.shifted[1]) * cell);
        let value: f64 =
            basis(x, y, cell).map(|([i, j], weight)| weight * scene.value(table, Site { field, i, j })).sum();
        let share = ((value - range[0]) / (range[1] - range[0])).clamp(0.0, 1.0);
        *pixel = ColorU8::from_rgba(
            (60.0 + 180.0 * share) as u8,
            (70.0 + 165.0 * share) as u8,
            (95.0 + 130.0 * share) as u8,
            255,
        )
        .premultiply();
    }
    Ok(image)
}

/// The same, with squares where the die touched it.
fn with_marks(mut image: Pixmap, touched: &[[f64; 2]], [xs, ys]: [[f64; 2]; 2]) -> Pixmap {
    let (width, height) = (image.width() as i64, image.height() as i64);
    for (k, at) in touched.iter().enumerate() {
        let column = ((at[0] - xs[0]) / (xs[1] - xs[0]) * width as f64) as i64;
        let row = ((ys[1] - at[1]) / (ys[1] - ys[0]) * height as f64) as i64;
        let [r, g, b] = shade(k, touched.len());
        for (dx, dy) in (-2..=2).flat_map(|dx| (-2..=2).map(move |dy| (dx, dy))) {
            let (x, y) = (column + dx, row + dy);
            if (0..width).contains(&x) && (0..height).contains(&y) {
                image.pixels_mut()[(y * width + x) as usize] = ColorU8::from_rgba(r, g, b, 255).premultiply();
            }
        }
    }
    image
}
