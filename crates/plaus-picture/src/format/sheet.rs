//! One clip that fills the picture, or several side by side.

use crate::{Camera, Film, Image, Quality, Renderer};
use plaus_animation::Animation;
use plaus_export::{Clip, Cut, ExportError};

/// Most clips on one sheet.
pub(super) const MOST: usize = 64;
/// Pixels between clips.
const GAP: u32 = 4;
/// Allowed sizes of a picture, in pixels. Pictures larger than the largest screens would take hours.
const SIZES: std::ops::RangeInclusive<u32> = 16..=16384;

/// Clips that are shown together, in the order in which they were added.
pub(super) struct Sheet {
    clips: Vec<(Animation, Cut)>,
    size: (u32, u32),
    rays: u32,
    progress: fn(u64, u64),
}

impl Sheet {
    /// A sheet of that size unless clips ask for another.
    pub(super) fn new(size: (u32, u32), rays: u32) -> Self {
        Self { clips: Vec::new(), size, rays, progress: |_, _| () }
    }

    pub(super) fn add(&mut self, clip: &Clip<'_>) -> Result<(), ExportError> {
        let (width, height) = clip.style.size.unwrap_or(self.size);
        if !SIZES.contains(&width) || !SIZES.contains(&height) {
            let (least, most) = (SIZES.start(), SIZES.end());
            let wrong = format!("{width}x{height} pixels: must be from {least} to {most} each");
            return Err(ExportError::Impossible(wrong));
        }
        if self.clips.len() == MOST {
            let many = format!("one picture shows at most {MOST} samples: choose some of them");
            return Err(ExportError::Impossible(many));
        }
        (self.size, self.progress) = ((width, height), clip.progress);
        self.clips.push((clip.animation.clone(), clip.cut));
        Ok(())
    }

    /// Pixels across and down.
    pub(super) fn size(&self) -> (u32, u32) {
        self.size
    }

    /// The clip, if there is only one.
    pub(super) fn alone(&self) -> Option<&(Animation, Cut)> {
        self.clips.first().filter(|_| self.clips.len() == 1)
    }

    /// Frames per second.
    pub(super) fn fps(&self) -> f64 {
        self.clips.first().map_or(1.0, |(_, cut)| cut.fps())
    }

    /// Passes on the picture of the ends of all clips.
    pub(super) fn last<E>(&self, mut take: impl FnMut(Image) -> Result<(), E>) -> Result<(), E> {
        take(self.draw(&mut self.films(), f64::INFINITY))
    }

    /// How long the longest clip is, in s.
    pub(super) fn length(&self) -> f64 {
        self.clips.iter().map(|(_, cut)| cut.length()).fold(0.0, f64::max)
    }

    /// Passes on all frames, and whether each is the last: the longest clip from its start to its end, at a `speed` of
    /// 1 as fast as it is; others stay at their ends.
    pub(super) fn frames<E>(&self, speed: f64, mut take: impl FnMut(Image, bool) -> Result<(), E>) -> Result<(), E> {
        let mut films = self.films();
        // The last is at the end or after it.
        let last = (self.length() / speed * self.fps()).ceil() as u64;
        for frame in 0..=last {
            take(self.draw(&mut films, frame as f64 * speed / self.fps()), frame == last)?;
            (self.progress)(frame + 1, last + 1);
        }
        Ok(())
    }

    /// How many clips are side by side, and the size of each in pixels.
    fn grid(&self) -> (u32, (u32, u32)) {
        let count = self.clips.len().max(1) as u32;
        let columns = (1..).find(|columns| columns * columns >= count).unwrap_or(1);
        let rows = count.div_ceil(columns);
        let share = |pixels: u32, parts: u32| ((pixels - (parts - 1) * GAP.min(pixels / parts)) / parts).max(1);
        (columns, (share(self.size.0, columns), share(self.size.1, rows)))
    }

    fn films(&self) -> Vec<Film<'_>> {
        let (_, (width, height)) = self.grid();
        let quality = Quality { width, height, rays: self.rays };
        let all: Vec<_> = self.clips.iter().map(|(one, cut)| (one, [cut.from(), cut.to()])).collect();
        let camera = Camera::of_all(&all, f64::from(width) / f64::from(height));
        self.clips.iter().map(|(one, _)| Film::new(Renderer::new(one, camera, quality))).collect()
    }

    /// The picture at a time after the clips' beginnings.
    fn draw(&self, films: &mut [Film<'_>], time: f64) -> Image {
        let (columns, (width, height)) = self.grid();
        let mut sheet = Image::new(self.size.0, self.size.1, vec![[255; 3]; (self.size.0 * self.size.1) as usize]);
        for (place, (film, (_, cut))) in (0..).zip(films.iter_mut().zip(&self.clips)) {
            let corner = (place % columns * (width + GAP), place / columns * (height + GAP));
            sheet.put(film.next((cut.from() + time).min(cut.to())), corner);
        }
        sheet
    }
}
