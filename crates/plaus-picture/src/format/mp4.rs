//! Videos, made by the program `ffmpeg`.

use super::is_ours;
use super::sheet::{MOST, Sheet};
use plaus_export::format::{Collection, Row};
use plaus_export::{Clip, ExportError, Exporter, Label, glb, sound};
use std::fs::{self, File};
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};
use std::process::{Child, Command, Stdio};

pub(super) struct Mp4;

/// Rays in each pixel.
const RAYS: u32 = 4;
/// The program that is run unless the environment variable [`VARIABLE`] names another.
const PROGRAM: &str = "ffmpeg";
/// Names another program of the same kind.
const VARIABLE: &str = "PLAUS_FFMPEG";
/// How a file of this kind begins: the length of its first box, then the box's name.
const HEAD: &[u8] = b"\0\0\0";

impl Exporter for Mp4 {
    fn row(&self) -> &'static Row {
        &Row {
            name: "mp4",
            endings: &["mp4"],
            about: "a video with sound; of several samples, up to 64, they are side by side, without sound",
            help: "Needs the program ffmpeg (PLAUS_FFMPEG names another one). H.264. Without --size and --fps: 1280 x \
                   720 pixels and 30 frames per second.",
        }
    }

    fn begin(&self, path: &Path) -> Box<dyn Collection> {
        Box::new(Video { path: path.to_owned(), sheet: Sheet::new((1280, 720), RAYS), sound: Vec::new() })
    }

    fn is_ours(&self, path: &Path) -> bool {
        is_ours(path, HEAD)
    }

    fn fps(&self) -> f64 {
        30.0
    }

    fn most(&self) -> usize {
        MOST
    }
}

struct Video {
    path: PathBuf,
    sheet: Sheet,
    /// The sound of the only clip.
    sound: Vec<f64>,
}

/// A file that is deleted together with this value.
struct Temporary(PathBuf);

impl Temporary {
    /// A file beside another, so that it is on a disk with room.
    fn beside(path: &Path, end: &str) -> Self {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        Self(path.with_file_name(format!(".{name}.{}.{end}", std::process::id())))
    }
}

impl Drop for Temporary {
    fn drop(&mut self) {
        // It may never have existed.
        let _ = fs::remove_file(&self.0);
    }
}

impl Collection for Video {
    fn add(&mut self, clip: &Clip<'_>, _out: &mut dyn Write) -> Result<(), ExportError> {
        self.sheet.add(clip)?;
        let (width, height) = self.sheet.size();
        if width % 2 + height % 2 > 0 {
            let odd = format!("{width}x{height} pixels: videos need even numbers");
            return Err(ExportError::Impossible(odd));
        }
        Ok(())
    }

    fn finish(mut self: Box<Self>, out: &mut dyn Write) -> Result<(), ExportError> {
        if let Some((animation, cut)) = self.sheet.alone() {
            self.sound = sound::pressure(&Clip::new(animation, &Label::default(), *cut));
        }
        let (video, heard) = (Temporary::beside(&self.path, "mp4"), Temporary::beside(&self.path, "wav"));
        let silent = self.sound.iter().all(|pressure| *pressure == 0.0);
        if !silent {
            fs::write(&heard.0, sound::wav(&self.sound, glb::GENERATOR)?)?;
        }
        let mut child = self.encoder(&video.0, (!silent).then_some(heard.0.as_path()))?;
        let mut frames = child.stdin.take().ok_or_else(|| io::Error::other("no pipe to the encoder"))?;
        let fed = self.sheet.frames(1.0, |image, _| frames.write_all(image.bytes()));
        drop(frames);
        let mut said = String::new();
        if let Some(mut errors) = child.stderr.take() {
            errors.read_to_string(&mut said)?;
        }
        // An encoder that stops in the middle has said why; the broken pipe does not say it.
        if !child.wait()?.success() {
            return Err(ExportError::Impossible(format!("{PROGRAM} could not make the video: {}", said.trim())));
        }
        fed?;
        io::copy(&mut File::open(&video.0)?, out)?;
        Ok(())
    }
}

impl Video {
    fn encoder(&self, video: &Path, sound: Option<&Path>) -> Result<Child, ExportError> {
        let program = std::env::var_os(VARIABLE).unwrap_or_else(|| PROGRAM.into());
        let (width, height) = self.sheet.size();
        let mut command = Command::new(&program);
        command.args(["-v", "error", "-f", "rawvideo", "-pixel_format", "rgb24", "-video_size"]);
        command.arg(format!("{width}x{height}")).arg("-framerate").arg(self.sheet.fps().to_string());
        command.args(["-i", "pipe:0"]);
        if let Some(sound) = sound {
            command.arg("-i").arg(sound).args(["-c:a", "aac", "-b:a", "160k"]);
        }
        command.args(["-c:v", "libx264", "-crf", "18", "-pix_fmt", "yuv420p", "-movflags", "+faststart"]);
        command.args(["-metadata", &format!("comment={}", glb::GENERATOR), "-f", "mp4", "-y"]).arg(video);
        command.stdin(Stdio::piped()).stdout(Stdio::null()).stderr(Stdio::piped());
        command.spawn().map_err(|error| match error.kind() {
            io::ErrorKind::NotFound => ExportError::Impossible(format!(
        "videos are made by the program {}, which was not found: install it, or name it in {VARIABLE}; --format gif \
         needs no other program",
                program.display()
            )),
            _ => ExportError::Output(error),
        })
    }
}
