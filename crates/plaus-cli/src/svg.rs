//! Just enough SVG for diagnostic plots.

use std::fmt::Write as _;

/// Width and height of a panel with its labels, and margins: left, right, top, bottom.
pub(crate) const PANEL: [f64; 2] = [560.0, 440.0];
const MARGIN: [f64; 4] = [84.0, 20.0, 42.0, 58.0];
/// Colours that remain distinct for people with colour blindness (Okabe & Ito).
const COLOURS: [&str; 6] = ["#0072b2", "#e69f00", "#009e73", "#cc79a7", "#d55e00", "#56b4e9"];

/// An unfinished picture. Writing to a string cannot fail.
pub(crate) struct Svg(String);

/// A panel with the ranges of its axes.
pub(crate) struct Frame {
    left: f64,
    size: [f64; 2],
    x: [f64; 2],
    y: [f64; 2],
}

impl Frame {
    /// The n-th panel from the left.
    pub(crate) fn new(number: u32, x: [f64; 2], y: [f64; 2]) -> Self {
        // A range that is empty or undefined gets some room.
        let room = |[low, high]: [f64; 2]| match (low.is_finite() && high.is_finite(), high > low) {
            (true, true) => [low, high],
            (true, false) => [low - 0.5, low + 0.5],
            _ => [0.0, 1.0],
        };
        Self { left: f64::from(number) * PANEL[0], size: PANEL, x: room(x), y: room(y) }
    }

    /// One panel of a width, with the same scale along both axes.
    pub(crate) fn to_scale(x: [f64; 2], y: [f64; 2], width: f64) -> Self {
        let [left, right, top, bottom] = MARGIN;
        let scale = (width - left - right) / (x[1] - x[0]);
        Self { left: 0.0, size: [width, scale * (y[1] - y[0]) + top + bottom], x, y }
    }

    /// Its height with its labels.
    pub(crate) fn height(&self) -> f64 {
        self.size[1]
    }

    fn place(&self, x: f64, y: f64) -> (f64, f64) {
        let [left, right, top, bottom] = MARGIN;
        let (width, height) = (self.size[0] - left - right, self.size[1] - top - bottom);
        let share = |value: f64, [low, high]: [f64; 2]| (value - low) / (high - low);
        (self.left + left + width * share(x, self.x), top + height * (1.0 - share(y, self.y)))
    }
}

impl Svg {
    pub(crate) fn new(width: usize, height: usize) -> Self {
        Self(format!(
            "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
             font-family=\"sans-serif\" font-size=\"17\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
        ))
    }

    /// Axes with their ends marked.
    pub(crate) fn axes(&mut self, frame: &Frame, title: &str, along: &str) {
        let ((left, bottom), (right, top)) = self.plain_axes(frame, title, along);
        self.text(left, bottom + 20.0, "start", &short(frame.x[0]));
        self.text(right, bottom + 20.0, "end", &short(frame.x[1]));
        self.text(left - 6.0, bottom, "end", &short(frame.y[0]));
        self.text(left - 6.0, top + 12.0, "end", &short(frame.y[1]));
    }

    /// Axes without numbers; gives where they meet, and the corner across.
    pub(crate) fn plain_axes(&mut self, frame: &Frame, title: &str, along: &str) -> ((f64, f64), (f64, f64)) {
        let ((left, bottom), (right, top)) = (frame.place(frame.x[0], frame.y[0]), frame.place(frame.x[1], frame.y[1]));
        let _ =
            writeln!(self.0, "<path d=\"M{left:.1} {top:.1}V{bottom:.1}H{right:.1}\" fill=\"none\" stroke=\"#555\"/>");
        let middle = 0.5 * (left + right);
        self.text(middle, top - 14.0, "middle", title);
        self.text(middle, bottom + 44.0, "middle", along);
        ((left, bottom), (right, top))
    }

    /// A dashed line across.
    pub(crate) fn level(&mut self, frame: &Frame, y: f64) {
        let ((left, at), (right, _)) = (frame.place(frame.x[0], y), frame.place(frame.x[1], y));
        let _ =
            writeln!(self.0, "<path d=\"M{left:.1} {at:.1}H{right:.1}\" stroke=\"#999\" stroke-dasharray=\"4 4\"/>");
    }

    /// A line of the n-th colour, broken where a value is not a number.
    pub(crate) fn line(&mut self, frame: &Frame, number: usize, points: impl IntoIterator<Item = (f64, f64)>) {
        let (mut path, mut pen) = (String::new(), 'M');
        for (x, y) in points {
            let (x, y) = frame.place(x, y);
            if !(x.is_finite() && y.is_finite()) {
                pen = 'M';
                continue;
            }
            let _ = write!(path, "{pen}{x:.1} {y:.1}");
            pen = 'L';
        }
        let colour = COLOURS[number % COLOURS.len()];
        let _ = writeln!(self.0, "<path d=\"{path}\" fill=\"none\" stroke=\"{colour}\" stroke-opacity=\".75\"/>");
    }

    /// A dashed line from one point to another.
    pub(crate) fn segment(&mut self, frame: &Frame, from: [f64; 2], to: [f64; 2]) {
        let ((x, y), (u, v)) = (frame.place(from[0], from[1]), frame.place(to[0], to[1]));
        let _ = writeln!(self.0, "<path d=\"M{x:.1} {y:.1}L{u:.1} {v:.1}\" stroke=\"#999\" stroke-dasharray=\"4 4\"/>");
    }

    /// A dot of the n-th colour.
    pub(crate) fn dot(&mut self, frame: &Frame, number: usize, [x, y]: [f64; 2]) {
        let (x, y) = frame.place(x, y);
        let colour = COLOURS[number % COLOURS.len()];
        let _ = writeln!(self.0, "<circle cx=\"{x:.1}\" cy=\"{y:.1}\" r=\"4\" fill=\"{colour}\" fill-opacity=\".6\"/>");
    }

    /// An upright column of a histogram.
    pub(crate) fn column(&mut self, frame: &Frame, x: [f64; 2], y: f64) {
        let ((left, top), (right, bottom)) = (frame.place(x[0], y), frame.place(x[1], 0.0));
        let _ = writeln!(
            self.0,
            "<rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\" fill=\"{}\" stroke=\"white\"/>",
            right - left,
            bottom - top,
            COLOURS[0]
        );
    }

    /// Words below the axis at `x`, and above a height of `y` there.
    pub(crate) fn label(&mut self, frame: &Frame, [x, y]: [f64; 2], below: &str, above: &str) {
        let ((at, top), (_, bottom)) = (frame.place(x, y), frame.place(x, frame.y[0]));
        self.text(at, bottom + 20.0, "middle", below);
        self.text(at, top - 4.0, "middle", above);
    }

    /// The outline of a thing.
    pub(crate) fn outline(&mut self, frame: &Frame, corners: &[[f64; 2]]) {
        let mut points = String::new();
        for corner in corners {
            let (x, y) = frame.place(corner[0], corner[1]);
            let _ = write!(points, "{x:.1},{y:.1} ");
        }
        let _ = writeln!(self.0, "<polygon points=\"{points}\" fill=\"#888\" fill-opacity=\".12\" stroke=\"#888\"/>");
    }

    /// What `draw` draws, within a panel's axes only. For one panel of a picture.
    pub(crate) fn clipped(&mut self, frame: &Frame, draw: impl FnOnce(&mut Self)) {
        let ((left, bottom), (right, top)) = (frame.place(frame.x[0], frame.y[0]), frame.place(frame.x[1], frame.y[1]));
        let _ = writeln!(
            self.0,
            "<clipPath id=\"panel\"><rect x=\"{left:.1}\" y=\"{top:.1}\" width=\"{:.1}\" height=\"{:.1}\"/></clipPath>\n\
             <g clip-path=\"url(#panel)\">",
            right - left,
            bottom - top
        );
        draw(self);
        self.0.push_str("</g>\n");
    }

    /// An upright bar of the n-th colour at `x`, for the allowed range there.
    pub(crate) fn band(&mut self, frame: &Frame, number: usize, x: f64, [low, high]: [f64; 2]) {
        let ((x, top), (_, bottom)) = (frame.place(x, high), frame.place(x, low));
        let (colour, height) = (COLOURS[number % COLOURS.len()], (bottom - top).max(1.0));
        let _ = writeln!(
            self.0,
            "<rect x=\"{:.1}\" y=\"{top:.1}\" width=\"12\" height=\"{height:.1}\" fill=\"{colour}\" fill-opacity=\".15\"/>",
            x - 6.0
        );
    }

    /// A line of a legend at height `y`, in pixels: what the n-th colour stands for.
    pub(crate) fn legend(&mut self, number: usize, y: f64, words: &str) {
        let (x, colour) = (MARGIN[0], COLOURS[number % COLOURS.len()]);
        let _ = writeln!(self.0, "<circle cx=\"{x:.1}\" cy=\"{:.1}\" r=\"6\" fill=\"{colour}\"/>", y + 8.0);
        self.text(x + 14.0, y + 14.0, "start", words);
    }

    /// A horizontal bar with a name before it and words after it.
    pub(crate) fn bar(&mut self, row: usize, name: &str, share: f64, words: &str) {
        let (y, width) = (28.0 + 44.0 * row as f64, 320.0 * share);
        self.text(220.0, y + 20.0, "end", name);
        let _ = writeln!(self.0, "<rect x=\"234\" y=\"{y}\" width=\"320\" height=\"28\" fill=\"#eee\"/>");
        let _ =
            writeln!(self.0, "<rect x=\"234\" y=\"{y}\" width=\"{width:.1}\" height=\"28\" fill=\"{}\"/>", COLOURS[0]);
        self.text(568.0, y + 20.0, "start", words);
    }

    fn text(&mut self, x: f64, y: f64, anchor: &str, text: &str) {
        let text = text.replace('&', "&amp;").replace('<', "&lt;");
        let _ =
            writeln!(self.0, "<text x=\"{x:.1}\" y=\"{y:.1}\" text-anchor=\"{anchor}\" fill=\"#222\">{text}</text>");
    }

    pub(crate) fn finish(mut self) -> String {
        self.0.push_str("</svg>\n");
        self.0
    }
}

/// A number with four digits.
fn short(value: f64) -> String {
    let size = value.abs();
    match size {
        _ if value == 0.0 => "0".to_owned(),
        _ if !(1e-3..1e6).contains(&size) => format!("{value:.2e}"),
        _ if size >= 100.0 => format!("{value:.0}"),
        _ if size >= 1.0 => format!("{value:.2}"),
        _ => format!("{value:.4}"),
    }
}
