//! Pictures.

use super::is_ours;
use super::sheet::{MOST, Sheet};
use plaus_export::format::{Collection, Row};
use plaus_export::{Clip, ExportError, Exporter, glb};
use std::io::Write;
use std::path::Path;

pub(super) struct Png;

/// Rays in each pixel; more than in videos, because a picture is looked at longer than a frame.
const RAYS: u32 = 16;

impl Exporter for Png {
    fn row(&self) -> &'static Row {
        &Row {
            name: "png",
            endings: &["png"],
            about: "a picture of the end; of several samples, up to 64, they are side by side",
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
