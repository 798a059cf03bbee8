//! Words and pictures, as bins to fill in a grid. Row 0 is the uppermost.

use super::bins::Bins;
use super::font::Letters;

/// Whether each bin is to be filled, row by row.
pub(crate) type Picture = Vec<Vec<bool>>;

/// The word in its font, letters one bin apart.
pub(crate) fn write(text: &str, letters: Letters) -> Result<Picture, String> {
    let mut picture: Picture = vec![Vec::new(); letters.height()];
    for (index, letter) in text.chars().enumerate() {
        let glyph = letters.glyph(letter).ok_or_else(|| {
            let known = "A to Z, 0 to 9, space and . - + ! ? = *";
            format!("the font lacks {letter:?}: it has {known}")
        })?;
        for (line, row) in picture.iter_mut().zip(glyph) {
            line.extend((index > 0).then_some(false));
            line.extend(row.bytes().map(|byte| byte == b'#'));
        }
    }
    Ok(picture)
}

/// A picture's lines, made equally long.
pub(crate) fn read(bitmap: &str) -> Result<Picture, String> {
    let pixel = |c| match c {
        '#' | 'X' | 'x' | '1' | '*' => Ok(true),
        '.' | '_' | '0' | '-' | ' ' => Ok(false),
        other => {
            Err(format!("{other:?} is not allowed: # X x 1 * is a bin to fill, . _ 0 - or a space one to leave empty"))
        }
    };
    let mut lines: Picture =
        bitmap.lines().map(|line| line.chars().map(pixel).collect::<Result<_, _>>()).collect::<Result<_, _>>()?;
    let width = lines.iter().map(Vec::len).max().unwrap_or(0);
    lines.iter_mut().for_each(|line| line.resize(width, false));
    Ok(lines)
}

/// Width and height in bins.
pub(crate) fn size(picture: &Picture) -> [usize; 2] {
    [picture.first().map_or(0, Vec::len), picture.len()]
}

/// The bins that a picture fills in the middle of a grid of columns and rows that is large enough, in ascending order;
/// bin `row · columns + column`. If the number of spare bins is odd, the larger half is to the right and below.
pub(crate) fn bins(picture: &Picture, [columns, rows]: [usize; 2]) -> Vec<u16> {
    let [width, height] = size(picture);
    let (left, above) = ((columns - width) / 2, (rows - height) / 2);
    let line = |(row, line): (usize, &Vec<bool>)| {
        let filled = line.iter().enumerate().filter(|(_, fill)| **fill);
        filled.map(move |(column, _)| ((row + above) * columns + column + left) as u16).collect::<Vec<_>>()
    };
    picture.iter().enumerate().flat_map(line).collect()
}

/// Bins in columns and rows, and the letters with which balls in them can spell.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Grid {
    /// The bins.
    pub bins: Bins,
    /// The font of words.
    pub letters: Letters,
}
