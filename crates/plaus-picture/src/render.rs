//! Pictures of an animation at one moment: rays traced through its bodies and scenery, with soft shadows.
//!
//! Everything follows from the animation and the size of the picture, bit for bit, whatever the number of threads.

use crate::camera::Camera;
use crate::changes::{Changes, Pose};
use crate::drawing::Drawing;
use crate::image::Image;
use crate::noise::Noise;
use crate::shade::{self, Shader};
use glam::DVec3;
use plaus_animation::Animation;
use rayon::prelude::*;

/// How far the table lies below everything that should be visible, in metres. Without this gap, bowls would touch it.
const SUNK: f64 = 2e-4;
/// A pixel that differs from a neighbour by this much in any colour, out of 255, gets more rays.
const EDGE: u8 = 8;

/// A picture's size, and how many rays are averaged in a pixel.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Quality {
    /// Pixels across.
    pub width: u32,
    /// Pixels down.
    pub height: u32,
    /// Rays in a pixel in which something changes; elsewhere one is enough.
    pub rays: u32,
}

/// A picture with what the next one can take from it.
struct Frame {
    /// The light of the first ray of each pixel, and how far it went.
    first: Vec<(DVec3, f64)>,
    image: Image,
    poses: Vec<Pose>,
}

/// Frames in succession: scenery is drawn in detail only once.
pub struct Film<'a> {
    renderer: Renderer<'a>,
    last: Option<Frame>,
}

impl<'a> Film<'a> {
    /// A film that has not begun.
    #[must_use]
    pub fn new(renderer: Renderer<'a>) -> Self {
        Self { renderer, last: None }
    }

    /// The next picture, at `time` seconds.
    pub fn next(&mut self, time: f64) -> &Image {
        let frame = self.renderer.draw(time, self.last.as_ref());
        &self.last.insert(frame).image
    }
}

/// Draws one animation at any of its times.
pub struct Renderer<'a> {
    drawing: Drawing<'a>,
    camera: Camera,
    quality: Quality,
    /// Height of the table on which everything stands: the bottom of the scenery and of everything that should be
    /// visible.
    ground: Option<f64>,
}

impl<'a> Renderer<'a> {
    /// Prepares everything that is the same at all times.
    #[must_use]
    pub fn new(animation: &'a Animation, camera: Camera, quality: Quality) -> Self {
        let drawing = Drawing::new(animation);
        let framed = animation.view.and_then(|view| view.frame).map(|[a, b]| a.y.min(b.y) - SUNK);
        // Things that fall below it do not push it down.
        let ground = drawing.scenery_bounds().map(|[low, _]| low.y - SUNK).into_iter().chain(framed).reduce(f64::min);
        Self { drawing, camera, quality, ground }
    }

    /// The picture at `time` seconds.
    #[must_use]
    pub fn at(&self, time: f64) -> Image {
        self.draw(time, None).image
    }

    /// A picture; pixels are copied from the previous picture if nothing near them has changed.
    fn draw(&self, time: f64, before: Option<&Frame>) -> Frame {
        let Quality { width, height, rays } = self.quality;
        let moment = self.drawing.at(time);
        let ground = self.ground.unwrap_or_else(|| moment.lowest());
        let poses = moment.poses.clone();
        // A ground that follows what moves changes everywhere.
        let known = before.filter(|_| self.ground.is_some());
        let known = known.map(|frame| (frame, Changes::between(&frame.poses, &poses)));
        let shader = Shader { moment, ground };
        let first: Vec<(DVec3, f64)> = self.pixels(|at| {
            let (noise, (from, along)) = self.ray(at, 0);
            let kept = known.as_ref().map(|(frame, changes)| (frame.first[(at.1 * width + at.0) as usize], changes));
            match kept.filter(|((_, far), changes)| !changes.touch(from, along, *far)) {
                Some((kept, _)) => kept,
                None => shader.light(from, along, &noise),
            }
        });
        let rough = Image::new(width, height, first.iter().map(|&(light, _)| shade::to_pixel(light)).collect());
        if rays <= 1 {
            return Frame { first, image: rough, poses };
        }
        let finer = self.pixels(|at| {
            let index = (at.1 * width + at.0) as usize;
            if !rough.changes_at(at, EDGE) {
                return rough.pixels()[index];
            }
            let same = |frame: &&Frame| rough.near(at).all(|near| frame.first[near] == first[near]);
            match before.filter(same) {
                Some(frame) => frame.image.pixels()[index],
                None => {
                    let others = (1..rays).map(|ray| {
                        let (noise, (from, along)) = self.ray(at, ray);
                        shader.light(from, along, &noise).0
                    });
                    shade::to_pixel((first[index].0 + others.sum::<DVec3>()) / f64::from(rays))
                }
            }
        });
        Frame { first, image: Image::new(width, height, finer), poses }
    }

    /// A value for every pixel, row by row.
    fn pixels<T: Send>(&self, make: impl Fn((u32, u32)) -> T + Sync) -> Vec<T> {
        let Quality { width, height, .. } = self.quality;
        (0..height * width).into_par_iter().with_min_len(256).map(|k| make((k % width, k / width))).collect()
    }

    /// One of the rays of a pixel, from the eye in its direction, with its noise.
    fn ray(&self, at: (u32, u32), ray: u32) -> (Noise, (DVec3, DVec3)) {
        let size = (f64::from(self.quality.width), f64::from(self.quality.height));
        let noise = Noise::new(at, ray);
        let [dx, dy] = noise.pair(0);
        let across = (f64::from(at.0) + dx) / size.0;
        let down = (f64::from(at.1) + dy) / size.1;
        (noise, self.camera.ray(across, down, size.0 / size.1))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use plaus_animation::{Colour, Look, Material, Piece, Prop, Shape, Track};

    /// A ball of radius 1 hovers over a plate, seen from above: it covers π/16 of a square of side 4, its colour is
    /// red, its shadow is darker than the plate.
    #[test]
    fn a_ball_covers_its_disc_and_casts_a_shadow() {
        let red = Look { colour: Colour([220, 30, 30]), ..Look::STONE };
        let ball = Track::new("ball", Shape::ball(1.0), red, vec![Piece::resting(0.0, DVec3::new(0.0, 1.5, 0.0))]);
        let plate = Prop::block("plate", Look::STONE, DVec3::new(0.0, -0.5, 0.0), DVec3::new(9.0, 0.5, 9.0));
        let animation = Animation::new(1.0, vec![ball], Vec::new()).with_scenery(vec![plate]);
        // From so far away that perspective has no effect.
        let frame = [DVec3::new(-2.0, 0.0, -2.0), DVec3::new(2.0, 0.0, 2.0)];
        let camera = Camera::fitting(frame, DVec3::Y, DVec3::NEG_Z, 0.2, 1.0);
        let image = Renderer::new(&animation, camera, Quality { width: 200, height: 200, rays: 4 }).at(0.0);
        let colours = image.pixels();
        let red = colours.iter().filter(|c| c[0] > c[1] + 60).count() as f64 / 40_000.0;
        // The frame keeps a margin of 4% and 2% on each side.
        let expected = std::f64::consts::PI / 16.0 / (1.06 * 1.06);
        assert!((red / expected - 1.0).abs() < 0.06, "{red} of the picture is red, not {expected}");
        let grey = |c: &&[u8; 3]| c[0].abs_diff(c[2]) < 25;
        let (dark, bright) =
            (colours.iter().filter(grey).map(|c| c[1]).min(), colours.iter().filter(grey).map(|c| c[1]).max());
        assert!(dark.unwrap() + 40 < bright.unwrap(), "{dark:?} {bright:?}: no shadow");
    }

    /// Bodies that fly over a plate and each other, with shadows and a glass one: light that is kept from the last frame
    /// is bit for bit what a new frame has. Some of it is kept, and some of it changes where only a shadow falls.
    #[test]
    fn light_is_kept_only_where_nothing_changes_it() {
        let track = |name: &str, look: Look, from: DVec3, velocity: DVec3| {
            let piece = Piece::ballistic(0.0, from, velocity, DVec3::NEG_Y * 0.3);
            Track::new(name, Shape::Cuboid { half: DVec3::new(0.1, 0.15, 0.2), pips: None }, look, vec![piece])
        };
        let glass = Look { material: Material::Glass, ..Look::STONE };
        let still = Piece::resting(0.0, DVec3::new(0.5, 0.2, -0.3));
        let tracks = vec![
            track("across", Look::nth(1), DVec3::new(-1.0, 0.9, 0.0), DVec3::new(1.1, 0.2, 0.1)),
            track("glass", glass, DVec3::new(0.3, 1.2, 0.5), DVec3::new(-0.4, 0.0, -0.6)),
            Track::new("still", Shape::ball(0.2), Look::nth(2), vec![still]),
        ];
        let plate = Prop::block("plate", Look::WOOD, DVec3::new(0.0, -0.1, 0.0), DVec3::new(1.5, 0.1, 0.8));
        let animation = Animation::new(2.0, tracks, Vec::new()).with_scenery(vec![plate]);
        let camera = Camera::of(&animation, [0.0, 2.0], 1.5);
        let renderer = Renderer::new(&animation, camera, Quality { width: 120, height: 80, rays: 1 });
        let mut last = renderer.draw(0.0, None);
        for step in 1..24 {
            let time = 0.05 * f64::from(step);
            let (next, alone) = (renderer.draw(time, Some(&last)), renderer.draw(time, None));
            assert!(next.first == alone.first, "at {time} s");
            let changes = Changes::between(&last.poses, &next.poses);
            let touched = (0..120 * 80).filter(|&k| {
                let (_, (from, along)) = renderer.ray((k % 120, k / 120), 0);
                changes.touch(from, along, last.first[k as usize].1)
            });
            let touched = touched.count();
            assert!((200..7000).contains(&touched), "{touched} of 9,600 pixels are drawn anew at {time} s");
            last = next;
        }
    }

    /// A ball that crosses a plate: pixels copied from the previous frame are equal to newly drawn ones.
    #[test]
    fn a_film_shows_the_same_as_single_pictures() {
        let across = Piece::ballistic(0.0, DVec3::new(-1.0, 0.4, 0.0), DVec3::X, DVec3::ZERO);
        let ball = Track::new("ball", Shape::ball(0.3), Look::nth(1), vec![across]);
        let plate = Prop::block("plate", Look::WOOD, DVec3::new(0.0, -0.1, 0.0), DVec3::new(1.5, 0.1, 0.8));
        let animation = Animation::new(2.0, vec![ball], Vec::new()).with_scenery(vec![plate]);
        let camera = Camera::of(&animation, [0.0, 2.0], 1.5);
        let renderer = || Renderer::new(&animation, camera, Quality { width: 150, height: 100, rays: 8 });
        let mut film = Film::new(renderer());
        for time in [0.0, 0.1, 0.2, 1.5] {
            let (frame, picture) = (film.next(time).clone(), renderer().at(time));
            let other = frame.pixels().iter().zip(picture.pixels()).filter(|(a, b)| a != b).count();
            // Pixels can differ at the rims of shadows, where no first ray nearby sees a change that a later ray would
            // see.
            assert!(other < 15, "{other} of 15,000 pixels at {time} s are others");
        }
    }
}
