//! Times at which something begins: from a column of a table, or from the notes of a piece of music.

use super::AssetError;
use midly::{MetaMessage, MidiMessage, Smf, Timing, TrackEventKind};

/// Which times of a file to use.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Which<'a> {
    /// For a table: the column with this name in its first row; `None`: the first column.
    pub column: Option<&'a str>,
    /// For MIDI: only notes of this key, from 0 to 127: 36 is a bass drum; `None`: all.
    pub note: Option<u8>,
    /// For MIDI: only notes of this channel, from 1 to 16; `None`: all.
    pub channel: Option<u8>,
}

/// The times in a file, in seconds, each once, in ascending order.
///
/// ```
/// use plaus_asset::onsets::{Which, onsets};
///
/// assert_eq!(onsets("hits.csv", b"time,drum\n0.5,snare\n0.25,bass\n", &Which::default())?, [0.25, 0.5]);
/// # Ok::<(), plaus_asset::AssetError>(())
/// ```
///
/// # Errors
///
/// [`AssetError`] if the name does not end in `.csv`, `.mid` or `.midi`, the file does not match its name, or it has no
/// such times.
pub fn onsets(file: &str, bytes: &[u8], which: &Which<'_>) -> Result<Vec<f64>, AssetError> {
    Ok(read(file, bytes, which, None)?.into_iter().map(|stroke| stroke.time).collect())
}

/// Something that begins, and how strongly.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stroke {
    /// In s.
    pub time: f64,
    /// The velocity of a note, from 1 to 127; or what a table says, more than 0.
    pub strength: f64,
}

/// Where strengths are.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Strengths<'a> {
    /// With the notes of MIDI; in a table, in the column after that of the times.
    Usual,
    /// In the column of a table with this name in its first row.
    Column(&'a str),
}

/// The times in a file with their strengths, each time once, in ascending order. Of several at one time the strongest
/// counts.
///
/// ```
/// use plaus_asset::onsets::{Strengths, Stroke, Which, strokes};
///
/// let hits = strokes("hits.csv", b"0.5,90\n0.25,30\n", &Which::default(), Strengths::Usual)?;
/// assert_eq!(hits, [Stroke { time: 0.25, strength: 30.0 }, Stroke { time: 0.5, strength: 90.0 }]);
/// # Ok::<(), plaus_asset::AssetError>(())
/// ```
///
/// # Errors
///
/// As [`onsets`]; also [`AssetError`] where a time of a table has no strength that is more than 0.
pub fn strokes(
    file: &str,
    bytes: &[u8],
    which: &Which<'_>,
    strengths: Strengths<'_>,
) -> Result<Vec<Stroke>, AssetError> {
    read(file, bytes, which, Some(strengths))
}

/// The strokes of a file; without `strengths`, all of strength 0 in a table.
fn read(
    file: &str,
    bytes: &[u8],
    which: &Which<'_>,
    strengths: Option<Strengths<'_>>,
) -> Result<Vec<Stroke>, AssetError> {
    let ending = file.rsplit_once('.').map(|(_, ending)| ending.to_ascii_lowercase());
    let mut strokes = match ending.as_deref() {
        Some("csv") if which.note.or(which.channel).is_some() => {
            return Err(broken("a table has no notes or channels: give a `column`"));
        }
        Some("csv") => of_table(bytes, which.column, strengths)?,
        Some("mid" | "midi") if which.column.is_some() || matches!(strengths, Some(Strengths::Column(_))) => {
            return Err(broken("MIDI has no columns: give a `note` or `channel`"));
        }
        Some("mid" | "midi") => of_midi(bytes, which)?,
        _ => return Err(broken("its name must end in .csv, .mid or .midi")),
    };
    if strokes.is_empty() {
        return Err(broken("it has no such times"));
    }
    // Of one time the strongest comes first.
    strokes.sort_unstable_by(|a, b| a.time.total_cmp(&b.time).then(b.strength.total_cmp(&a.strength)));
    strokes.dedup_by(|later, kept| later.time == kept.time);
    Ok(strokes)
}

fn broken(message: impl Into<String>) -> AssetError {
    AssetError::Broken(message.into())
}

fn of_table(bytes: &[u8], column: Option<&str>, strengths: Option<Strengths<'_>>) -> Result<Vec<Stroke>, AssetError> {
    let mut reader =
        csv::ReaderBuilder::new().has_headers(false).flexible(true).trim(csv::Trim::All).from_reader(bytes);
    let (mut place, mut strokes) = (0, Vec::new());
    let mut beside = strengths.map(|_| 1);
    for (index, row) in reader.records().enumerate() {
        let row = row.map_err(|error| broken(error.to_string()))?;
        let line = row.position().map_or(0, csv::Position::line);
        let place_of = |name: &str| {
            let names = || row.iter().collect::<Vec<_>>().join(", ");
            let found = row.iter().position(|cell| cell == name);
            found.ok_or_else(|| broken(format!("it has no column {name:?}; there are {}", names())))
        };
        let named = column.is_some() || matches!(strengths, Some(Strengths::Column(_)));
        if index == 0 && named {
            place = column.map_or(Ok(0), place_of)?;
            beside = match strengths {
                Some(Strengths::Column(name)) => Some(place_of(name)?),
                other => other.map(|_| place + 1),
            };
            continue;
        }
        let cell = |place: usize| row.get(place).unwrap_or_default();
        let time = match cell(place).parse::<f64>() {
            Ok(time) if time.is_finite() && time >= 0.0 => time,
            // Names of columns.
            Err(_) if index == 0 => continue,
            _ => return Err(broken(format!("line {line}: {:?} is not a time in seconds", cell(place)))),
        };
        let strength = match beside.map(cell) {
            None => 0.0,
            Some(said) => {
                let number = said.parse::<f64>().ok().filter(|number| number.is_finite() && *number > 0.0);
                number.ok_or_else(|| broken(format!("line {line}: {said:?} is not a strength, a number above 0")))?
            }
        };
        strokes.push(Stroke { time, strength });
    }
    Ok(strokes)
}

/// Microseconds of a quarter note until the file says something else: 120 beats a minute.
const QUARTER: f64 = 500_000.0;

/// Place of the byte that says how a file counts time, and a value that means −128 frames per second, on which the
/// reader fails.
const COUNTING: (usize, u8) = (12, 0x80);

fn of_midi(bytes: &[u8], which: &Which<'_>) -> Result<Vec<Stroke>, AssetError> {
    if bytes.get(COUNTING.0) == Some(&COUNTING.1) {
        return Err(broken("its time division is not valid in MIDI"));
    }
    let file = Smf::parse(bytes).map_err(|error| broken(error.to_string()))?;
    // Tempi apply to all tracks, whichever track they are in; they come before the notes of the same time.
    let (mut tempi, mut notes) = (Vec::new(), Vec::new());
    for track in &file.tracks {
        let mut at = 0_u64;
        for event in track {
            at += u64::from(event.delta.as_int());
            match event.kind {
                TrackEventKind::Meta(MetaMessage::Tempo(quarter)) => tempi.push((at, f64::from(quarter.as_int()))),
                TrackEventKind::Midi { channel, message: MidiMessage::NoteOn { key, vel } } => {
                    let is_meant = which.note.is_none_or(|note| note == key.as_int())
                        && which.channel.is_none_or(|wanted| wanted == channel.as_int() + 1);
                    if vel > 0 && is_meant {
                        notes.push((at, f64::from(vel.as_int())));
                    }
                }
                _ => {}
            }
        }
    }
    tempi.sort_by_key(|tempo| tempo.0);
    notes.sort_unstable_by_key(|note| note.0);
    let (mut ahead, mut since, mut seconds) = (tempi.into_iter().peekable(), 0_u64, 0.0);
    let of_quarter = |quarter: f64| match file.header.timing {
        Timing::Metrical(ticks) => 1e-6 * quarter / f64::from(ticks.as_int().max(1)),
        Timing::Timecode(frames, parts) => 1.0 / f64::from(frames.as_f32()) / f64::from(parts.max(1)),
    };
    let mut tick = of_quarter(QUARTER);
    let stroke = |(note, strength): (u64, f64)| {
        while let Some((at, quarter)) = ahead.next_if(|tempo| tempo.0 <= note) {
            seconds += (at - since) as f64 * tick;
            (since, tick) = (at, of_quarter(quarter));
        }
        Stroke { time: seconds + (note - since) as f64 * tick, strength }
    };
    Ok(notes.into_iter().map(stroke).collect())
}

#[cfg(test)]
mod tests {
    use super::*;

    /// A piece of one track: a header with the ticks per quarter note, then events as in a file.
    fn midi(ticks: u16, events: &[&[u8]]) -> Vec<u8> {
        let track: Vec<u8> = events.iter().copied().chain([&[0, 0xff, 0x2f, 0][..]]).flatten().copied().collect();
        let mut file = b"MThd\0\0\0\x06\0\0\0\x01".to_vec();
        file.extend(ticks.to_be_bytes());
        file.extend(b"MTrk");
        file.extend((track.len() as u32).to_be_bytes());
        file.extend(track);
        file
    }

    #[test]
    fn notes_come_at_the_tempo_that_holds() {
        // A quarter of 96 ticks lasts half a second; from the second quarter on, it lasts a whole second. A chord is
        // one time, and a note of velocity 0 ends a note.
        let slow = [96, 0xff, 0x51, 3, 0x0f, 0x42, 0x40];
        let events: [&[u8]; 6] = [
            &[0, 0x99, 36, 100],
            &[0, 0x99, 38, 100],
            &[48, 0x90, 60, 80],
            &[48, 0x90, 60, 0],
            &[&slow[..]].concat(),
            &[96, 0x99, 36, 90],
        ];
        let piece = midi(96, &events);
        let times = |which: Which<'_>| onsets("song.mid", &piece, &which).unwrap();
        assert_eq!(times(Which::default()), [0.0, 0.25, 2.0]);
        assert_eq!(times(Which { note: Some(36), ..Which::default() }), [0.0, 2.0]);
        assert_eq!(times(Which { channel: Some(1), ..Which::default() }), [0.25]);
        let none = onsets("song.midi", &piece, &Which { note: Some(1), ..Which::default() });
        assert_eq!(none.unwrap_err().to_string(), "it has no such times");
    }

    /// Of a chord, the strongest note counts.
    #[test]
    fn strengths_are_those_of_notes_or_of_another_column() {
        let events: [&[u8]; 4] = [&[0, 0x99, 36, 100], &[0, 0x99, 38, 120], &[96, 0x99, 38, 0], &[0, 0x99, 36, 9]];
        let piece = midi(96, &events);
        let of = |which: Which<'_>| {
            let all = strokes("song.mid", &piece, &which, Strengths::Usual).unwrap();
            all.into_iter().map(|one| [one.time, one.strength]).collect::<Vec<_>>()
        };
        assert_eq!(of(Which::default()), [[0.0, 120.0], [0.5, 9.0]]);
        assert_eq!(of(Which { note: Some(36), ..Which::default() }), [[0.0, 100.0], [0.5, 9.0]]);
        let table = b"beat, seconds, force\n1, 0.5, 3\n2, 0.25, 4\n3, 0.5, 5\n";
        let read = |column, strengths| strokes("a.csv", table, &Which { column, ..Which::default() }, strengths);
        let both = [Stroke { time: 0.25, strength: 4.0 }, Stroke { time: 0.5, strength: 5.0 }];
        assert_eq!(read(Some("seconds"), Strengths::Usual).unwrap(), both);
        assert_eq!(read(Some("seconds"), Strengths::Column("force")).unwrap(), both);
        assert_eq!(read(None, Strengths::Column("force")).unwrap()[0], Stroke { time: 1.0, strength: 3.0 });
        for (bytes, strengths, wrong) in [
            (&table[..], Strengths::Column("loud"), "it has no column \"loud\"; there are beat, seconds, force"),
            (b"0.5\n", Strengths::Usual, "line 1: \"\" is not a strength, a number above 0"),
            (b"0.5,1\n0.6,0\n", Strengths::Usual, "line 2: \"0\" is not a strength, a number above 0"),
        ] {
            let error = strokes("a.csv", bytes, &Which::default(), strengths).unwrap_err();
            assert_eq!(error.to_string(), wrong);
        }
        let error = strokes("a.mid", &piece, &Which::default(), Strengths::Column("x")).unwrap_err();
        assert_eq!(error.to_string(), "MIDI has no columns: give a `note` or `channel`");
    }

    #[test]
    fn tables_are_read_by_column() {
        let table = b"beat, seconds\n1, 0.5\n2, 0.25\n3, 0.5\n";
        let of = |column| onsets("a.csv", table, &Which { column, ..Which::default() });
        assert_eq!(of(None).unwrap(), [1.0, 2.0, 3.0]);
        assert_eq!(of(Some("seconds")).unwrap(), [0.25, 0.5]);
        assert_eq!(of(Some("time")).unwrap_err().to_string(), "it has no column \"time\"; there are beat, seconds");
        assert_eq!(onsets("a.CSV", b"0.5\n0.75\n", &Which::default()).unwrap(), [0.5, 0.75]);
    }

    #[test]
    fn values_that_are_no_times_are_named() {
        let of = |file: &str, bytes: &[u8], which: Which<'_>| onsets(file, bytes, &which).unwrap_err().to_string();
        let any = Which::default;
        assert_eq!(of("a.csv", b"0.5\nsoon\n", any()), "line 2: \"soon\" is not a time in seconds");
        assert_eq!(of("a.csv", b"0.5\n-1\n", any()), "line 2: \"-1\" is not a time in seconds");
        assert_eq!(of("a.csv", b"0.5\nNaN\n", any()), "line 2: \"NaN\" is not a time in seconds");
        assert_eq!(of("a.csv", b"", any()), "it has no such times");
        assert_eq!(of("a.wav", b"", any()), "its name must end in .csv, .mid or .midi");
        assert!(of("a.mid", b"RIFF", any()).contains("MIDI") || !of("a.mid", b"RIFF", any()).is_empty());
        let noted = Which { note: Some(36), ..any() };
        assert!(of("a.csv", b"0.5\n", noted).contains("give a `column`"));
        assert!(of("a.mid", b"", Which { column: Some("x"), ..any() }).contains("give a `note`"));
    }

    /// Files that end anywhere, or contain anything, give errors or times, and nothing else.
    #[test]
    fn damaged_files_do_no_harm() {
        let piece = midi(96, &[&[0, 0x99, 36, 100], &[48, 0xff, 0x51, 3, 0, 0, 0], &[96, 0x99, 36, 90]]);
        for length in 0..piece.len() {
            let _ = onsets("a.mid", &piece[..length], &Which::default());
        }
        for at in 0..piece.len() {
            for byte in [0, 1, 0x7f, 0x80, 0xff] {
                let mut broken = piece.clone();
                broken[at] = byte;
                let read = onsets("a.mid", &broken, &Which::default()).unwrap_or_default();
                assert!(read.iter().all(|time| time.is_finite() && *time >= 0.0), "{read:?}");
            }
        }
    }
}
