//! Asks which objects of a file move, where the file does not say.

use crate::console;
use std::io::BufRead;

/// Most names in a note.
const SHOWN: usize = 40;

/// How to say which objects move, with those that may.
pub(super) fn how_to_say(objects: &[(String, bool)]) -> String {
    let guess = guessed(objects);
    let example = if guess.is_empty() { objects.iter().take(1).map(|(name, _)| name.clone()).collect() } else { guess };
    let more = objects.len().saturating_sub(SHOWN);
    let more = if more > 0 { format!(" and {more} more") } else { String::new() };
    let names: Vec<&str> = objects.iter().take(SHOWN).map(|(name, _)| name.as_str()).collect();
    format!(
        "nothing in the file moves: say which of its objects do, for example --moving {}; there are {}{more}",
        console::quoted_word(&example.join(",")),
        names.join(", ")
    )
}

/// Asks until there is an answer; none if nothing moves.
pub(super) fn ask(objects: &[(String, bool)], input: &mut impl BufRead) -> Vec<String> {
    let lines = objects.iter().enumerate().map(|(index, (name, is_small))| {
        let mark = if *is_small { " *" } else { "" };
        format!("  {} {name}{mark}\n", index + 1)
    });
    console::note(&format!("The file does not say which objects move.\n{}", lines.collect::<String>()));
    loop {
        console::note("Which move? Numbers, as 1,3-5, or names; empty: those with *; none: nothing moves\n> ");
        let mut line = String::new();
        if !input.read_line(&mut line).is_ok_and(|length| length > 0) {
            return Vec::new();
        }
        match answered(line.trim(), objects) {
            Ok(names) => return names,
            Err(why) => console::note_line(&why),
        }
    }
}

fn guessed(objects: &[(String, bool)]) -> Vec<String> {
    objects.iter().filter(|(_, is_small)| *is_small).map(|(name, _)| name.clone()).collect()
}

/// The names that an answer means.
fn answered(line: &str, objects: &[(String, bool)]) -> Result<Vec<String>, String> {
    match line {
        "" => return Ok(guessed(objects)),
        "none" => return Ok(Vec::new()),
        _ => {}
    }
    let mut names: Vec<String> = Vec::new();
    for word in line.split(',').map(str::trim).filter(|word| !word.is_empty()) {
        let named = objects.iter().filter(|(name, _)| name == word);
        let mut found: Vec<String> = named.map(|(name, _)| name.clone()).collect();
        let (first, last) = word.split_once('-').unwrap_or((word, word));
        if let (true, Ok(first), Ok(last)) = (found.is_empty(), first.parse::<usize>(), last.parse::<usize>()) {
            if first == 0 || first > last || last > objects.len() {
                return Err(format!("{word}: numbers are from 1 to {}", objects.len()));
            }
            found = objects[first - 1..last].iter().map(|(name, _)| name.clone()).collect();
        }
        if found.is_empty() {
            return Err(format!("{word}: neither a number nor the name of an object"));
        }
        names.extend(found.into_iter().filter(|name| !names.contains(name)).collect::<Vec<_>>());
    }
    Ok(names)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn objects() -> Vec<(String, bool)> {
        [("Ball", true), ("Can_1", true), ("Can_2", true), ("Table", false)]
            .map(|(name, is_small)| (name.to_owned(), is_small))
            .to_vec()
    }

    #[test]
    fn answers_mean_names() {
        let answer = |line: &str| answered(line, &objects());
        assert_eq!(answer("").unwrap(), ["Ball", "Can_1", "Can_2"]);
        assert_eq!(answer("none").unwrap(), [""; 0]);
        assert_eq!(answer("2-3, 1").unwrap(), ["Can_1", "Can_2", "Ball"]);
        assert_eq!(answer("Table,4").unwrap(), ["Table"]);
        for wrong in ["5", "0", "3-2", "Cup", "1,Cup"] {
            assert!(answer(wrong).is_err(), "{wrong}");
        }
    }

    #[test]
    fn it_asks_until_there_is_an_answer() {
        assert_eq!(ask(&objects(), &mut &b"Cup\n1\n2\n"[..]), ["Ball"]);
        assert_eq!(ask(&objects(), &mut &b""[..]), [""; 0]);
    }

    #[test]
    fn a_note_says_how_to_say_it() {
        let note = how_to_say(&objects());
        assert!(note.contains("--moving Ball,Can_1,Can_2; there are Ball, Can_1, Can_2, Table"), "{note}");
    }
}
