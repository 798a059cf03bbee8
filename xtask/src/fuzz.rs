//! Random worlds under the laws of the simulator, for some minutes over fresh seeds.

use crate::command::{Failure, cargo};

/// What may be asked for, each with a value.
const KEYS: [&str; 4] = ["--minutes", "--seed", "--preset", "--law"];

/// Seeds of one run, at most: a run that names no seed begins so many further on each second.
const APART: u64 = 1_000;

/// Runs the simulator's example `fuzz`, in release.
#[allow(clippy::disallowed_methods, reason = "fresh seeds: which worlds are tried may depend on the clock")]
pub(crate) fn run(arguments: &[&str]) -> Result<(), Failure> {
    let since = std::time::SystemTime::now().duration_since(std::time::UNIX_EPOCH).map_or(0, |d| d.as_secs());
    let words = words(arguments, since.wrapping_mul(APART))?;
    cargo(&["run", "--release", "--package", "plaus-sim", "--example", "fuzz", "--"]).args(words).run()
}

/// The example's arguments: those given, and a seed if none is.
fn words(arguments: &[&str], fresh: u64) -> Result<Vec<String>, Failure> {
    let mut words: Vec<String> = Vec::new();
    for pair in arguments.chunks(2) {
        match pair {
            [key, value] if KEYS.contains(key) => words.extend([(*key).to_owned(), (*value).to_owned()]),
            [key, ..] if KEYS.contains(key) => return Err(Failure(format!("{key} needs a value"))),
            _ => return Err(Failure(format!("fuzz-worlds knows {}, not {}", KEYS.join(", "), pair[0]))),
        }
    }
    if !arguments.contains(&"--minutes") {
        return Err(Failure::new("fuzz-worlds needs --minutes N"));
    }
    if !arguments.contains(&"--seed") {
        words.extend(["--seed".to_owned(), fresh.to_string()]);
    }
    Ok(words)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arguments_are_read() {
        let given = ["--minutes", "2", "--law", "seams"];
        assert_eq!(words(&given, 7).expect("they are right"), ["--minutes", "2", "--law", "seams", "--seed", "7"]);
        let seeded = ["--seed", "3", "--minutes", "1"];
        assert_eq!(words(&seeded, 7).expect("they are right"), seeded);
        for wrong in [&["--minutes"][..], &["--minutes", "1", "--laws", "x"], &["--seed", "3"], &["2"]] {
            assert!(words(wrong, 7).is_err(), "{wrong:?}");
        }
    }

    #[test]
    fn the_usage_names_every_key() {
        assert!(KEYS.iter().all(|key| crate::USAGE.contains(key)));
        assert!(crate::USAGE.contains("fuzz-worlds"));
    }
}
