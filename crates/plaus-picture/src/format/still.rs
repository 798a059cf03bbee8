//! Pictures and short loops, which need no other program.

use super::is_ours;
use super::sheet::{MOST, Sheet};
use plaus_export::format::{Collection, Row};
use plaus_export::{Clip, ExportError, Exporter, glb};
use std::io::Write;
use std::path::Path;

pub(super) struct Png;
pub(super) struct Gif;

/// Rays in each pixel; more than in videos, because a picture is looked at longer than a frame.
const RAYS: u32 = 16;
const RAYS_OF_A_FRAME: u32 = 4;
/// How thoroughly the palette of a frame is computed, from 1 (all pixels are used) to 30.
const PALETTE: i32 = 10;
/// Ticks per second in which GIF counts delays.
const TICKS: f64 = 100.0;
/// How long a loop stays at its end before it begins again, in s.
const HOLD: f64 = 1.0;

/// How fast a loop shows a motion that lasts so long in s: what is over in a moment is shown slowly, as in galleries.
fn speed(length: f64) -> f64 {
    match length {
        ..0.8 => 0.25,
        0.8..1.6 => 0.5,
        _ => 1.0,
    }
}

impl Exporter for Png {
    fn row(&self) -> &'static Row {
        &Row {
            name: "png",
            endings: &["png"],
            about: "a picture of the end; with --into, up to 64 samples side by side",
            help: "1280 x 720 pixels unless --size says otherwise; the same on every machine. With --time-range 0:1.5, \
                   a picture at 1.5 s.",
        }
    }

    fn begin(&self, _path: &Path) -> Box<dyn Collection> {
        Box::new(Still(Sheet::new((1280, 720), RAYS)))
    }

    fn is_ours(&self, path: &Path) -> bool {
        is_ours(path, b"\x89PNG")
    }

    fn most(&self) -> usize {
        MOST
    }
}

struct Still(Sheet);

impl Collection for Still {
    fn add(&mut self, clip: &Clip<'_>, _out: &mut dyn Write) -> Result<(), ExportError> {
        self.0.add(clip)
    }

    fn finish(self: Box<Self>, out: &mut dyn Write) -> Result<(), ExportError> {
        self.0.last(|image| {
            let mut encoder = png::Encoder::new(&mut *out, image.width(), image.height());
            encoder.set_color(png::ColorType::Rgb);
            encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
            let written = encoder
                .add_text_chunk("Software".to_owned(), glb::GENERATOR.to_owned())
                .and_then(|()| encoder.write_header())
                .and_then(|mut writer| writer.write_image_data(image.bytes()).and_then(|()| writer.finish()));
            written.map_err(|error| match error {
                png::EncodingError::IoError(error) => ExportError::Output(error),
                other => ExportError::Impossible(other.to_string()),
            })
        })
    }
}

impl Exporter for Gif {
    fn row(&self) -> &'static Row {
        &Row {
            name: "gif",
            endings: &["gif"],
            about: "a loop for web pages and chats; with --into, up to 64 samples side by side",
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
        encoder.set_repeat(gif::Repeat::Infinite).map_err(refused)?;
        encoder.write_raw_extension(gif::AnyExtension(COMMENT), &[glb::GENERATOR.as_bytes()]).map_err(refused)?;
        let fps = self.0.fps();
        let mut number = 0_u32;
        self.0.frames(speed(self.0.length()), |image, is_last| {
            let mut frame = gif::Frame::from_rgb_speed(width as u16, height as u16, image.bytes(), PALETTE);
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
