//! The bins that the word designates.

use super::config::{Config, Letters, MOST_COLUMNS, MOST_ROWS};
use crate::scene::ConfigError;

/// A grid of bins, some of them to be filled. Row 0 is the word's uppermost.
#[derive(Debug, Clone, PartialEq, Eq)]
pub struct Word {
    columns: usize,
    rows: usize,
    /// Bins to fill, in ascending order.
    designated: Vec<u16>,
    /// For each bin, whether it is to be filled.
    is_designated: Vec<bool>,
}

impl Word {
    /// The word or picture of a configuration, in the middle of its grid.
    ///
    /// # Errors
    /// [`ConfigError`] for a character that the font lacks, a picture or word that does not fit, or one without any bin
    /// to fill.
    pub fn new(config: &Config) -> Result<Self, ConfigError> {
        let blame = |key: &str, message: String| Err(ConfigError::new(format!("world.spelling.{key}"), message));
        let (key, picture) = match (&config.text, config.bitmap.as_str()) {
            (Some(text), bitmap) if !text.is_empty() && !bitmap.is_empty() => {
                return blame("text", "there is a `bitmap` too: leave one of them out, or set it to \"\"".into());
            }
            (text, "") => ("text", write(text.as_deref().unwrap_or("HI"), config.letters)?),
            (_, bitmap) => ("bitmap", read(bitmap)?),
        };
        if !picture.iter().flatten().any(|&fill| fill) {
            return blame(key, "there is no bin to fill: there must be at least one".into());
        }
        let (height, width) = (picture.len(), picture.first().map_or(0, Vec::len));
        let columns = fit(width, config.columns, MOST_COLUMNS, ["columns", key], "wide")?;
        let rows = fit(height, config.rows, MOST_ROWS, ["rows", key], "high")?;
        // If the number of spare bins is odd, the larger half is to the right and below.
        let (left, above) = ((columns - width) / 2, (rows - height) / 2);
        let mut is_designated = vec![false; columns * rows];
        for (row, line) in picture.iter().enumerate() {
            for (column, &fill) in line.iter().enumerate() {
                is_designated[(row + above) * columns + column + left] = fill;
            }
        }
        let designated = (0..).zip(&is_designated).filter_map(|(bin, &fill)| fill.then_some(bin)).collect();
        Ok(Self { columns, rows, designated, is_designated })
    }

    /// Bins along the word.
    #[must_use]
    pub fn columns(&self) -> usize {
        self.columns
    }

    /// Rows of bins.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Bins to fill, in ascending order; bin `row · columns + column`.
    #[must_use]
    pub fn designated(&self) -> &[u16] {
        &self.designated
    }

    /// Whether a bin is to be filled.
    #[must_use]
    pub fn wants(&self, bin: u16) -> bool {
        self.is_designated.get(usize::from(bin)).is_some_and(|&fill| fill)
    }
}

type Picture = Vec<Vec<bool>>;

/// The word in its font, letters one bin apart.
fn write(text: &str, letters: Letters) -> Result<Picture, ConfigError> {
    let mut picture: Picture = vec![Vec::new(); letters.height()];
    for (index, letter) in text.chars().enumerate() {
        let glyph = letters.glyph(letter).ok_or_else(|| {
            let known = "A to Z, 0 to 9, space and . - + ! ? = *";
            ConfigError::new("world.spelling.text", format!("the font lacks {letter:?}: it has {known}"))
        })?;
        for (line, row) in picture.iter_mut().zip(glyph) {
            line.extend((index > 0).then_some(false));
            line.extend(row.bytes().map(|byte| byte == b'#'));
        }
    }
    Ok(picture)
}

/// A picture's lines, made equally long.
fn read(bitmap: &str) -> Result<Picture, ConfigError> {
    let fail = |message| ConfigError::new("world.spelling.bitmap", message);
    let pixel = |c| match c {
        '#' | 'X' | 'x' | '1' | '*' => Ok(true),
        '.' | '_' | '0' | '-' | ' ' => Ok(false),
        other => Err(fail(format!(
            "{other:?} is not allowed: # X x 1 * is a bin to fill, . _ 0 - or a space one to leave empty"
        ))),
    };
    let lines: Picture =
        bitmap.lines().map(|line| line.chars().map(pixel).collect::<Result<_, _>>()).collect::<Result<_, _>>()?;
    let width = lines.iter().map(Vec::len).max().unwrap_or(0);
    let padded = lines.into_iter().map(|mut line| {
        line.resize(width, false);
        line
    });
    Ok(padded.collect())
}

/// How many bins there are along one side, given how many the picture needs.
fn fit(needed: usize, given: u32, most: u32, [key, blamed]: [&str; 2], size: &str) -> Result<usize, ConfigError> {
    let most = most as usize;
    if needed > most {
        let message = format!("{needed} bins {size}, but the box has at most {most} {key}");
        return Err(ConfigError::new(format!("world.spelling.{blamed}"), message));
    }
    match given as usize {
        0 => Ok((needed + 2).min(most)),
        given if given >= needed => Ok(given),
        given => {
            let message = format!("{given} {key} are too few: `{blamed}` is {needed} bins {size}");
            Err(ConfigError::new(format!("world.spelling.{key}"), message))
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn word(change: impl FnOnce(&mut Config)) -> Result<Word, ConfigError> {
        let mut config = Config::default();
        change(&mut config);
        Word::new(&config)
    }

    fn drawn(word: &Word) -> String {
        let bins: Vec<char> = word.is_designated.iter().map(|&fill| if fill { '#' } else { '.' }).collect();
        bins.chunks(word.columns).map(|row| row.iter().collect::<String>() + "\n").collect()
    }

    #[test]
    fn the_paper_s_words_have_the_paper_s_sizes() {
        let hi = word(|_| ()).unwrap();
        assert_eq!(drawn(&hi), ".......\n.#.#.#.\n.###.#.\n.#.#.#.\n.......\n");
        assert_eq!(hi.designated().len(), 10);
        let acm = word(|config| (config.text, config.letters) = (Some("acm".into()), Letters::Tall)).unwrap();
        assert_eq!((acm.columns(), acm.rows(), acm.designated().len()), (15, 7, 30));
        assert_eq!(
            drawn(&acm),
            "...............\n..#...##.#...#.\n.#.#.#...##.##.\n.###.#...#.#.#.\n.#.#.#...#...#.\n.#.#..##.#...#.\n...............\n"
        );
    }

    #[test]
    fn glyphs_are_rectangles_of_their_font_s_height() {
        for letters in [Letters::Short, Letters::Tall] {
            for letter in (' '..='~').filter(|letter| !letter.is_lowercase()) {
                let Some(rows) = letters.glyph(letter) else { continue };
                assert_eq!(rows.len(), letters.height(), "{letter} {letters:?}");
                assert!(rows.iter().all(|row| row.len() == rows[0].len()), "{letter} {letters:?}");
                assert!(rows.concat().bytes().all(|byte| b"#.".contains(&byte)), "{letter} {letters:?}");
            }
            assert!(('A'..='Z').chain('0'..='9').all(|letter| letters.glyph(letter).is_some()));
        }
    }

    #[test]
    fn pictures_are_read_and_put_in_the_middle() {
        let picture = word(|config| (config.bitmap, config.columns) = ("X.x\n#".into(), 6)).unwrap();
        assert_eq!(drawn(&picture), "......\n.#.#..\n.#....\n......\n");
    }

    #[test]
    fn errors_state_the_limit() {
        let said = |change: fn(&mut Config)| word(change).unwrap_err().to_string();
        let too_few = "world.spelling.columns: 4 columns are too few: `text` is 5 bins wide";
        assert_eq!(said(|config| config.columns = 4), too_few);
        assert_eq!(
            said(|config| config.text = Some("HELLO, HELLO".into())),
            "world.spelling.text: the font lacks ',': it has A to Z, 0 to 9, space and . - + ! ? = *"
        );
        let long = "world.spelling.text: 79 bins wide, but the box has at most 64 columns";
        assert_eq!(said(|config| config.text = Some("H".repeat(20))), long);
        assert_eq!(
            said(|config| config.text = Some("  ".into())),
            "world.spelling.text: there is no bin to fill: there must be at least one"
        );
        assert_eq!(
            said(|config| config.text = Some(String::new())),
            "world.spelling.text: there is no bin to fill: there must be at least one"
        );
        assert!(said(|config| config.bitmap = "#?".into()).starts_with("world.spelling.bitmap: '?' is not allowed"));
    }
}
