//! The bins that the word designates.

use super::config::{Config, MOST_COLUMNS, MOST_ROWS};
use super::picture;
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
        let blame = |key: &str, message: String| ConfigError::new(format!("world.spelling.{key}"), message);
        let (key, picture) = match (&config.text, config.bitmap.as_str()) {
            (Some(text), bitmap) if !text.is_empty() && !bitmap.is_empty() => {
                return Err(blame("text", "there is a `bitmap` too: leave one of them out, or set it to \"\"".into()));
            }
            (text, "") => ("text", picture::write(text.as_deref().unwrap_or("HI"), config.letters)),
            (_, bitmap) => ("bitmap", picture::read(bitmap)),
        };
        let picture = picture.map_err(|message| blame(key, message))?;
        if !picture.iter().flatten().any(|&fill| fill) {
            return Err(blame(key, "there is no bin to fill: there must be at least one".into()));
        }
        let [width, height] = picture::size(&picture);
        let columns = fit(width, config.columns, MOST_COLUMNS, ["columns", key], "wide")?;
        let rows = fit(height, config.rows, MOST_ROWS, ["rows", key], "high")?;
        let designated = picture::bins(&picture, [columns, rows]);
        let mut is_designated = vec![false; columns * rows];
        designated.iter().for_each(|&bin| is_designated[usize::from(bin)] = true);
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
    use super::super::font::Letters;
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
