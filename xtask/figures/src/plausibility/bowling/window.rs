//! Boards on which a ball strikes often, from strike rates on a row of boards.

use super::published::{OFTEN, STRAIGHT, WINDOW};
use super::roll::{Line, along};
use crate::Result;
use crate::plausibility::chance::Count;
use plaus_scenes::bowling::Bowling;

/// Strikes on a row of boards at one angle of entry.
#[derive(Debug, Clone)]
pub(super) struct Row {
    pub(super) angle: f64,
    /// Boards in ascending order, each with the count of shots that were strikes.
    pub(super) strikes: Vec<(f64, Count)>,
}

/// Boards: from, to, and the distance between two.
#[derive(Debug, Clone, Copy)]
pub(super) struct Boards(pub(super) f64, pub(super) f64, pub(super) f64);

impl Boards {
    pub(super) fn all(self) -> impl Iterator<Item = f64> {
        let Self(from, to, every) = self;
        (0..=((to - from) / every).round() as u32).map(move |k| from + every * f64::from(k))
    }
}

impl Row {
    /// This many shots on each board.
    pub(super) fn of(scene: &Bowling, angle: f64, boards: Boards, shots: u64, seed: u64) -> Result<Self> {
        let on = |(k, board): (usize, f64)| -> Result<(f64, Count)> {
            Ok((board, along(scene, shots, seed + k as u64, |_| Line::new(board, angle))?.strikes()))
        };
        Ok(Self { angle, strikes: boards.all().enumerate().map(on).collect::<Result<_>>()? })
    }

    /// The longest run of boards on which at least nine in ten are strikes, by straight lines between the boards. If
    /// there is none, it has length 0, at the best board.
    pub(super) fn window(&self) -> (f64, f64) {
        let rate = |k: usize| (self.strikes[k].0, self.strikes[k].1.share() - OFTEN);
        let best =
            (0..self.strikes.len()).max_by(|&a, &b| rate(a).1.total_cmp(&rate(b).1).then(b.cmp(&a))).unwrap_or(0);
        let mut longest = (rate(best).0, rate(best).0);
        let mut open: Option<f64> = None;
        let mut close = |from: f64, to: f64| {
            if to - from > longest.1 - longest.0 {
                longest = (from, to);
            }
        };
        for k in 0..self.strikes.len() {
            let (board, over) = rate(k);
            let crossing = || {
                let (before, other) = rate(k - 1);
                before + (board - before) * other / (other - over)
            };
            match (open, over >= 0.0) {
                (None, true) => open = Some(if k == 0 { board } else { crossing() }),
                (Some(from), false) => {
                    close(from, crossing());
                    open = None;
                }
                _ => {}
            }
        }
        if let (Some(from), Some((last, _))) = (open, self.strikes.last()) {
            close(from, *last);
        }
        longest
    }

    pub(super) fn width(&self) -> f64 {
        let (from, to) = self.window();
        to - from
    }

    pub(super) fn shown_window(&self) -> String {
        let (from, to) = self.window();
        if to > from { format!("{from:.2}–{to:.2}") } else { format!("none (best {from:.2})") }
    }
}

/// How far, in boards, the windows at 6° and of a straight ball are from the published ones: for the first the errors
/// of both ends, for the second by how much it is too wide.
pub(super) fn misfit(hooked: &Row, straight: &Row) -> f64 {
    let (from, to) = hooked.window();
    (from - WINDOW.0).abs() + (to - WINDOW.1).abs() + (straight.width() - STRAIGHT).max(0.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn row(rates: &[u64]) -> Row {
        let strikes = rates.iter().enumerate().map(|(k, &hits)| (k as f64, Count::new(hits, 100))).collect();
        Row { angle: 6.0, strikes }
    }

    #[test]
    fn windows_begin_and_end_where_nine_in_ten_are_crossed() {
        let (from, to) = row(&[80, 100, 100, 70, 95, 20]).window();
        assert!((from - 0.5).abs() < 1e-12 && (to - 2.0 - 1.0 / 3.0).abs() < 1e-12, "{from} to {to}");
        assert_eq!(row(&[95, 91, 50]).window().0, 0.0);
        assert_eq!(row(&[10, 95, 95]).window().1, 2.0);
        let none = row(&[10, 60, 30]);
        assert_eq!((none.window(), none.width(), none.shown_window().as_str()), ((1.0, 1.0), 0.0, "none (best 1.00)"));
    }

    #[test]
    fn misfits_are_in_boards() {
        let mut hooked = row(&[80, 100, 100, 80]);
        hooked.strikes.iter_mut().for_each(|s| s.0 += 16.0);
        // The window is 16.5 to 18.5, and 17 to 18.5 is published; the straight ball has 2 boards, and at most half a
        // board is published.
        assert!((misfit(&hooked, &hooked) - (0.5 + 0.0 + 1.5)).abs() < 1e-9);
    }
}
