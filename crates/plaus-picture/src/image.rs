//! Pictures in memory.

/// A picture in sRGB.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Image {
    width: u32,
    height: u32,
    pixels: Vec<[u8; 3]>,
}

impl Image {
    /// A picture, row by row from the upper left.
    ///
    /// # Panics
    ///
    /// If the number of pixels is not `width` times `height`.
    #[must_use]
    pub fn new(width: u32, height: u32, pixels: Vec<[u8; 3]>) -> Self {
        assert_eq!(pixels.len(), width as usize * height as usize);
        Self { width, height, pixels }
    }

    /// Pixels across.
    #[must_use]
    pub fn width(&self) -> u32 {
        self.width
    }

    /// Pixels down.
    #[must_use]
    pub fn height(&self) -> u32 {
        self.height
    }

    /// All of them, row by row from the upper left.
    #[must_use]
    pub fn pixels(&self) -> &[[u8; 3]] {
        &self.pixels
    }

    /// The pixels as three bytes each.
    #[must_use]
    pub fn bytes(&self) -> &[u8] {
        self.pixels.as_flattened()
    }

    /// Puts another picture on this one, with its upper left corner at a pixel; anything outside is cut off.
    pub fn put(&mut self, other: &Self, (x, y): (u32, u32)) {
        let across = other.width.min(self.width.saturating_sub(x)) as usize;
        for (row, line) in (y..self.height).zip(other.pixels.chunks(other.width as usize)) {
            let start = row as usize * self.width as usize + x as usize;
            self.pixels[start..start + across].copy_from_slice(&line[..across]);
        }
    }

    /// Indices of the pixels near one: from two to the left and two above, to two to the right and two below.
    pub(crate) fn near(&self, (x, y): (u32, u32)) -> impl Iterator<Item = usize> + use<> {
        let span = |at: u32, size: u32| at.saturating_sub(2) as usize..(at + 3).min(size) as usize;
        let (across, width) = (span(x, self.width), self.width as usize);
        span(y, self.height).flat_map(move |y| across.clone().map(move |x| y * width + x))
    }

    /// Whether any two pixels near one differ by more than `least` in any colour.
    pub(crate) fn changes_at(&self, at: (u32, u32), least: u8) -> bool {
        let (mut low, mut high) = ([u8::MAX; 3], [0; 3]);
        for index in self.near(at) {
            for channel in 0..3 {
                low[channel] = low[channel].min(self.pixels[index][channel]);
                high[channel] = high[channel].max(self.pixels[index][channel]);
            }
        }
        (0..3).any(|channel| high[channel] - low[channel] > least)
    }
}
