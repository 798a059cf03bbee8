//! Sound.

use super::{Collection, Exporter, Row};
use crate::clip::{Clip, ExportError};
use crate::{glb, sound};
use std::fs::File;
use std::io::{Read, Write};
use std::path::Path;

pub(super) struct Wav;

impl Exporter for Wav {
    fn row(&self) -> &'static Row {
        &Row {
            name: "wav",
            endings: &["wav"],
            about: "sound: impacts, rolling and slipping, 48 kHz, one channel",
            help: "A simple model of what things are made of (docs/sound.md) gives the pressure at a metre, scaled so \
                   that nothing clips. --min-impulse and --merge as for events. With --into, one sample after the \
                   other.",
        }
    }

    fn begin(&self, _path: &Path) -> Box<dyn Collection> {
        Box::new(Heard(Vec::new()))
    }

    fn is_ours(&self, path: &Path) -> bool {
        let mut head = [0; 34];
        let read = File::open(path).and_then(|mut file| file.read_exact(&mut head)).is_ok();
        read && head.starts_with(b"RIFF") && &head[20..28] == b"INFOISFT" && &head[32..] == b"pl"
    }
}

struct Heard(Vec<f64>);

impl Collection for Heard {
    fn add(&mut self, clip: &Clip<'_>, _out: &mut dyn Write) -> Result<(), ExportError> {
        self.0.extend(sound::pressure(clip));
        Ok(())
    }

    fn finish(self: Box<Self>, out: &mut dyn Write) -> Result<(), ExportError> {
        Ok(out.write_all(&sound::wav(&self.0, glb::GENERATOR)?)?)
    }
}
