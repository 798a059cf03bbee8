//! Short loops, which need no other program: each frame holds only the pixels that change, in colours of its own.

use super::is_ours;
use super::sheet::{MOST, Sheet};
use crate::image::Image;
use color_quant::NeuQuant;
use gif::Frame;
use plaus_export::format::{Collection, Row};
use plaus_export::{Clip, ExportError, Exporter, glb};
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;

pub(super) struct Gif;

const RAYS_OF_A_FRAME: u32 = 4;
/// Ticks per second in which GIF counts delays.
const TICKS: f64 = 100.0;
/// How long a loop stays at its end before it begins again, in s.
const HOLD: f64 = 1.0;
/// A pixel changes if one of its colours differs by more than this from what is shown: steps of a palette of 255
/// colours are larger.
const SAME: u8 = 3;
/// Number of colours in a frame. One more index stands for what stays as it is.
const COLOURS: usize = 255;
/// Colours that agree in this many leading bits are taken for one while a palette is made.
const BITS: u32 = 6;

/// How fast a loop shows a motion that lasts so long in s: what is over in a moment is shown slowly, as in galleries.
fn speed(length: f64) -> f64 {
    match length {
        ..0.8 => 0.25,
        0.8..1.6 => 0.5,
        _ => 1.0,
    }
}

/// What of a picture differs from what is shown, which is brought up to date: the box around it, with what stays the
/// same left out.
fn changed(image: &Image, shown: &mut Option<Vec<[u8; 3]>>) -> Frame<'static> {
    let (width, pixels) = (image.width() as usize, image.pixels());
    let differ = |a: &[u8; 3], b: &[u8; 3]| (0..3).any(|k| a[k].abs_diff(b[k]) > SAME);
    let is_new: Vec<bool> = match shown {
        Some(shown) => shown.iter().zip(pixels).map(|(old, new)| differ(old, new)).collect(),
        None => vec![true; pixels.len()],
    };
    let places = || (0..pixels.len()).filter(|&at| is_new[at]).map(|at| [at % width, at / width]);
    let low = places().fold([width, usize::MAX], |low, at| [0, 1].map(|k| low[k].min(at[k])));
    let high = places().fold([0, 0], |high, at| [0, 1].map(|k| high[k].max(at[k])));
    // A frame that changes nothing has one pixel, which stays as it is.
    let low = [low[0].min(high[0]), low[1].min(high[1])];
    let shown = shown.get_or_insert_with(|| pixels.to_vec());
    shown.iter_mut().zip(pixels).zip(&is_new).filter(|(_, new)| **new).for_each(|((old, new), _)| *old = *new);
    let (palette, index_of) = palette(pixels.iter().zip(&is_new).filter(|(_, new)| **new).map(|(pixel, _)| *pixel));
    let inside = (low[1]..=high[1]).flat_map(|y| (low[0]..=high[0]).map(move |x| y * width + x));
    let buffer: Vec<u8> =
        inside.map(|at| if is_new[at] { index_of[&cell(pixels[at])] } else { COLOURS as u8 }).collect();
    Frame {
        left: low[0] as u16,
        top: low[1] as u16,
        width: (high[0] - low[0] + 1) as u16,
        height: (high[1] - low[1] + 1) as u16,
        transparent: Some(COLOURS as u8),
        palette: Some(palette),
        buffer: buffer.into(),
        ..Frame::default()
    }
}

fn cell(pixel: [u8; 3]) -> [u8; 3] {
    pixel.map(|value| value >> (8 - BITS))
}

/// A palette for these pixels, and the index of each cell of colours in it. A colour counts by the logarithm of how
/// often it is there, so that a small body keeps its colour on a large floor.
fn palette(pixels: impl Iterator<Item = [u8; 3]>) -> (Vec<u8>, BTreeMap<[u8; 3], u8>) {
    let mut cells: BTreeMap<[u8; 3], ([u64; 3], u64)> = BTreeMap::new();
    for pixel in pixels {
        let (sum, count) = cells.entry(cell(pixel)).or_default();
        (0..3).for_each(|k| sum[k] += u64::from(pixel[k]));
        *count += 1;
    }
    let mean = |(sum, count): &([u64; 3], u64)| sum.map(|sum| (sum / count) as u8);
    let mut colours: Vec<u8> = Vec::new();
    let mut index_of = BTreeMap::new();
    if cells.len() <= COLOURS {
        for (index, (cell, all)) in cells.iter().enumerate() {
            colours.extend(mean(all));
            index_of.insert(*cell, index as u8);
        }
    } else {
        let opaque = |all| {
            let [r, g, b] = mean(all);
            [r, g, b, u8::MAX]
        };
        let counted = cells.values().flat_map(|all| std::iter::repeat_n(opaque(all), 1 + all.1.ilog2() as usize));
        let chosen = NeuQuant::new(1, COLOURS, counted.collect::<Vec<_>>().as_flattened());
        colours = chosen.color_map_rgb();
        index_of.extend(cells.iter().map(|(cell, all)| (*cell, chosen.index_of(&opaque(all)) as u8)));
    }
    colours.resize(3 * (COLOURS + 1), 0);
    (colours, index_of)
}

impl Exporter for Gif {
    fn row(&self) -> &'static Row {
        &Row {
            name: "gif",
            endings: &["gif"],
            about: "a loop for web pages and chats; of several samples, up to 64, they are side by side",
            help: "640 x 360 pixels and 20 frames per second unless --size and --fps say otherwise; the format counts \
                   time in hundredths of a second. Motions of less than 1.6 s are shown at half their speed, of less \
                   than 0.8 s at a quarter, and the end stays for a second.",
        }
    }

    fn begin(&self, _path: &Path) -> Box<dyn Collection> {
        Box::new(Loop(Sheet::new((640, 360), RAYS_OF_A_FRAME)))
    }

    fn is_ours(&self, path: &Path) -> bool {
        is_ours(path, b"GIF89a")
    }

    fn fps(&self) -> f64 {
        20.0
    }

    fn most(&self) -> usize {
        MOST
    }
}

struct Loop(Sheet);

impl Collection for Loop {
    fn add(&mut self, clip: &Clip<'_>, _out: &mut dyn Write) -> Result<(), ExportError> {
        self.0.add(clip)
    }

    fn finish(self: Box<Self>, out: &mut dyn Write) -> Result<(), ExportError> {
        let refused = |error: gif::EncodingError| match error {
            gif::EncodingError::Io(error) => ExportError::Output(error),
            other => ExportError::Impossible(other.to_string()),
        };
        let (width, height) = self.0.size();
        let mut encoder = gif::Encoder::new(out, width as u16, height as u16, &[]).map_err(refused)?;
        let mut shown = None;
        encoder.set_repeat(gif::Repeat::Infinite).map_err(refused)?;
        encoder.write_raw_extension(gif::AnyExtension(COMMENT), &[glb::GENERATOR.as_bytes()]).map_err(refused)?;
        let fps = self.0.fps();
        let mut number = 0_u32;
        self.0.frames(speed(self.0.length()), |image, is_last| {
            let mut frame = changed(&image, &mut shown);
            // Whole ticks whose sum keeps up with the clock.
            let tick = |number: u32| (f64::from(number) * TICKS / fps).round() as u64;
            let ticks = tick(number + 1) - tick(number) + if is_last { (HOLD * TICKS) as u64 } else { 0 };
            frame.delay = ticks.min(u64::from(u16::MAX)) as u16;
            number += 1;
            encoder.write_frame(&frame).map_err(refused)
        })
    }
}

/// What GIF calls a comment.
const COMMENT: u8 = 0xfe;

#[cfg(test)]
mod tests {
    use super::*;

    /// A grey gradient with a green ball of a few pixels, which moves.
    fn pictures() -> [Image; 3] {
        [10, 20, 20].map(|ball| {
            let pixel = |at: u32| {
                let (x, y) = (at % 200, at / 200);
                if x.abs_diff(ball) < 3 && y.abs_diff(50) < 3 {
                    [20, 160 + x as u8, 40]
                } else {
                    [(x + y / 2) as u8; 3]
                }
            };
            Image::new(200, 100, (0..20_000).map(pixel).collect())
        })
    }

    /// What a player shows after each frame.
    fn played(pictures: &[Image]) -> Vec<Vec<[u8; 3]>> {
        let (mut shown, mut canvas) = (None, vec![[0; 3]; 20_000]);
        let frames = pictures.iter().map(|picture| changed(picture, &mut shown));
        let play = |frame: Frame<'_>| {
            let palette = frame.palette.unwrap();
            for (at, &index) in frame.buffer.iter().enumerate().filter(|(_, index)| Some(**index) != frame.transparent)
            {
                let (x, y) = (at % usize::from(frame.width), at / usize::from(frame.width));
                let place = (y + usize::from(frame.top)) * 200 + x + usize::from(frame.left);
                canvas[place].copy_from_slice(&palette[3 * usize::from(index)..][..3]);
            }
            canvas.clone()
        };
        frames.map(play).collect()
    }

    /// A cell of colours is 4 wide, and neighbouring colours may share an index where there are more than 255.
    #[test]
    fn colours_are_kept_in_every_frame() {
        let pictures = pictures();
        for (picture, shown) in pictures.iter().zip(played(&pictures)) {
            let apart = |(a, b): (&[u8; 3], &[u8; 3])| (0..3).map(|k| a[k].abs_diff(b[k])).max().unwrap();
            let worst = picture.pixels().iter().zip(&shown).map(apart).max().unwrap();
            assert!(worst <= 8, "{worst}");
        }
    }

    #[test]
    fn only_what_changes_is_in_a_frame() {
        let (pictures, mut shown) = (pictures(), None);
        let sizes = pictures.each_ref().map(|picture| {
            let frame = changed(picture, &mut shown);
            [frame.left, frame.top, frame.width, frame.height]
        });
        assert_eq!(sizes[..2], [[0, 0, 200, 100], [8, 48, 15, 5]]);
        assert_eq!(sizes[2][2..], [1, 1]);
    }
}
