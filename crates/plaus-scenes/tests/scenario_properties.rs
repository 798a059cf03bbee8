//! Whatever a scenario file contains, there is no panic: the result is a scenario within all ranges, or problems with a
//! place.

use crate::common::{BALL2D, Leaf, leaves};
use plaus_scenes::Scenario;
use plaus_scenes::files::NoFiles;
use plaus_scenes::registry::NAMES;
use plaus_scenes::scenario::{Problem, ScenarioError, Source, template};
use proptest::prelude::*;
use proptest::sample::{Index, select};
use proptest::test_runner::TestCaseResult;
use std::sync::LazyLock;

static LEAVES: LazyLock<Vec<Leaf>> = LazyLock::new(leaves);

const NASTY: &[&str] = &[
    "0",
    "-0.0",
    "-1",
    "nan",
    "-nan",
    "inf",
    "-inf",
    "1e308",
    "1e309",
    "1e-400",
    "9223372036854775807",
    "9223372036854775808",
    "-9223372036854775809",
    "0x7f",
    "0b2",
    "1_0",
    "1__0",
    "01",
    "1.",
    ".5",
    "1e",
    "true",
    "\"1\"",
    "'",
    "[1]",
    "[[1]]",
    "{}",
    "{a=1}",
    "1979-05-27",
    "07:32:00",
    "",
    "1,5",
    "mixed",
    "999999999999999999999999",
];

/// Lists that scenes accept.
const LISTS: &[&str] = &[
    "[]",
    "[{face_up={}}]",
    "[{rest_at={x_mm=-3.5,within_mm=0.1}},{passes={z_mm=1e-3}}]",
    "[{first_impact={time_s=0.1}},{pose_at={velocity_sd=1.5}}]",
];

/// Text that is inserted between the tokens of a file.
const TOKENS: &[&str] = &[
    "a",
    "world",
    "ball2d",
    "sampler",
    "seed",
    "sigma_d",
    ".",
    "=",
    "[",
    "]",
    "[[",
    "]]",
    "{",
    "}",
    ",",
    "\n",
    "\r\n",
    "\r",
    " ",
    "\"",
    "'",
    "\"\"\"",
    "'''",
    "1",
    "-",
    "0x",
    "1e9",
    "nan",
    "true",
    "#",
    "\\",
    "\\u",
    "1979-05-27",
    "\u{feff}",
    "\0",
    "é",
    "\n[a]\n",
    "\n[a.b]\n",
    "\n[[a]]\n",
    "\na.b=1\n",
    "\n[[a.b]]\n",
    "a={b=1}\n",
    "[world.ball2d]\n",
];

#[derive(Debug, Clone)]
enum Mutation {
    Flip(Index, u8),
    Truncate(Index),
    DeleteLine(Index),
    DoubleLine(Index, Index),
    SwapLines(Index, Index),
    Number(Index, &'static str),
    Insert(Index, &'static str),
    Windows,
}

fn mutation() -> impl Strategy<Value = Mutation> {
    let place = any::<Index>;
    prop_oneof![
        3 => (place(), 0_u8..8).prop_map(|(at, bit)| Mutation::Flip(at, 1 << bit)),
        1 => place().prop_map(Mutation::Truncate),
        2 => place().prop_map(Mutation::DeleteLine),
        2 => (place(), place()).prop_map(|(from, to)| Mutation::DoubleLine(from, to)),
        2 => (place(), place()).prop_map(|(a, b)| Mutation::SwapLines(a, b)),
        4 => (place(), select(NASTY)).prop_map(|(at, text)| Mutation::Number(at, text)),
        2 => (place(), select(TOKENS)).prop_map(|(at, text)| Mutation::Insert(at, text)),
        1 => Just(Mutation::Windows),
    ]
}

fn mutate(bytes: Vec<u8>, mutation: &Mutation) -> Vec<u8> {
    if bytes.is_empty() {
        return bytes;
    }
    let at = |index: &Index| index.index(bytes.len());
    let mut lines: Vec<&[u8]> = bytes.split_inclusive(|byte| *byte == b'\n').collect();
    let count = lines.len();
    match mutation {
        Mutation::Flip(index, bit) => {
            let mut flipped = bytes.clone();
            flipped[at(index)] ^= bit;
            return flipped;
        }
        Mutation::Truncate(index) => return bytes[..at(index)].to_vec(),
        Mutation::DeleteLine(at) => drop(lines.remove(at.index(count))),
        Mutation::DoubleLine(from, to) => lines.insert(to.index(count), lines[from.index(count)]),
        Mutation::SwapLines(a, b) => lines.swap(a.index(count), b.index(count)),
        Mutation::Number(index, text) => {
            let is_number = |range: &std::ops::Range<usize>| bytes[range.clone()].iter().any(u8::is_ascii_digit);
            let numbers: Vec<_> = tokens(&bytes).into_iter().filter(is_number).collect();
            return numbers
                .get(index.index(numbers.len().max(1)))
                .map_or(bytes.clone(), |range| [&bytes[..range.start], text.as_bytes(), &bytes[range.end..]].concat());
        }
        Mutation::Insert(index, text) => return [&bytes[..at(index)], text.as_bytes(), &bytes[at(index)..]].concat(),
        Mutation::Windows => return String::from_utf8_lossy(&bytes).replace('\n', "\r\n").into_bytes(),
    }
    lines.concat()
}

/// Runs of letters, digits, dots and minus signs.
fn tokens(bytes: &[u8]) -> Vec<std::ops::Range<usize>> {
    let is_part = |byte: &u8| byte.is_ascii_alphanumeric() || b"._-".contains(byte);
    let mut tokens = Vec::new();
    let mut start = 0;
    for run in bytes.chunk_by(|a, b| is_part(a) == is_part(b)) {
        if is_part(&run[0]) {
            tokens.push(start..start + run.len());
        }
        start += run.len();
    }
    tokens
}

/// Line and column, counted in the slow way.
fn line_column(text: &str, offset: usize) -> (usize, usize) {
    let (mut line, mut column) = (1, 1);
    for (at, c) in text.char_indices().take_while(|(at, _)| *at < offset) {
        match c {
            '\n' => (line, column) = (line + 1, 1),
            '\u{feff}' if at == 0 => {}
            _ => column += 1,
        }
    }
    (line, column)
}

fn place_agrees(error: &ScenarioError, problem: &Problem) -> TestCaseResult {
    prop_assert!(!problem.message.is_empty());
    match &problem.span {
        Some(span) => {
            prop_assert!(span.start <= span.end && span.end <= error.text.len());
            prop_assert!(error.text.get(span.clone()).is_some(), "not on character boundaries");
            let (line, column) = line_column(&error.text, span.start);
            prop_assert_eq!((problem.line, problem.column), (Some(line), Some(column)));
            prop_assert_eq!(&problem.source, &Source::File);
        }
        None => {
            prop_assert_eq!((problem.line, problem.column), (None, None));
            prop_assert!(problem.source != Source::File || problem.key == "world", "{} has no place", problem);
        }
    }
    Ok(())
}

/// Reads a scenario, and checks the result, whatever it is.
fn read(bytes: Vec<u8>, overrides: &[String]) -> TestCaseResult {
    let result =
        ScenarioError::decode("mutated.toml", bytes).and_then(|text| Scenario::read("mutated.toml", &text, overrides));
    match result {
        Ok(scenario) => {
            let values = serde_json::to_value(&scenario).unwrap();
            for leaf in LEAVES.iter() {
                let value = values.pointer(&format!("/{}", leaf.key.replace('.', "/")));
                prop_assert!(value.is_none_or(|value| leaf.allows(value)), "{}: {:?}", leaf.key, value);
            }
            same_when_written(&scenario)
        }
        Err(error) => {
            prop_assert!(!error.problems.is_empty());
            prop_assert_eq!(error.to_string().lines().count(), error.problems.len(), "one line a problem: {}", error);
            error.problems.iter().try_for_each(|problem| place_agrees(&error, problem))
        }
    }
}

/// Equal to the last bit: `{:?}` tells apart −0 and 0, and any two other floats.
fn same_when_written(scenario: &Scenario) -> TestCaseResult {
    let again = Scenario::read("written.toml", &scenario.to_toml(), &[]);
    prop_assert_eq!(again.as_ref().ok(), Some(scenario));
    prop_assert_eq!(format!("{:?}", again.unwrap()), format!("{scenario:?}"));
    let value = Scenario::of_value(&scenario.to_value(), &NoFiles);
    prop_assert_eq!(format!("{:?}", value.unwrap()), format!("{scenario:?}"));
    Ok(())
}

/// An override with a value in range; the ends of the range are frequent.
fn valid_override(leaf: Leaf) -> BoxedStrategy<String> {
    let key = leaf.key.clone();
    let value = match leaf.kind() {
        "number" => {
            let [least, most] = leaf.floats();
            let small = prop::num::f64::POSITIVE.prop_map(move |x| x.clamp(least, most));
            prop_oneof![Just(least), Just(most), least..=most, small].prop_map(|x| format!("{x:e}")).boxed()
        }
        "integer" => {
            let [least, most] = leaf.integers();
            prop_oneof![Just(least), Just(most), least..=most].prop_map(|x| x.to_string()).boxed()
        }
        "boolean" => any::<bool>().prop_map(|x| x.to_string()).boxed(),
        "string" => select(&["\"\"", "\"HI\"", "\"a b!\"", "\"#.#\"", "\"é\""][..]).prop_map(str::to_owned).boxed(),
        "array" if leaf.key.ends_with("constraints") => select(LISTS).prop_map(str::to_owned).boxed(),
        "array" => Just(leaf.list()).boxed(),
        _ => select(leaf.words()).boxed(),
    };
    value.prop_map(move |value| format!("{key}={value}")).boxed()
}

fn cases(cases: u32) -> ProptestConfig {
    ProptestConfig { cases, failure_persistence: None, ..ProptestConfig::default() }
}

proptest! {
    #![proptest_config(cases(10_000))]

    #[test]
    fn mutated_scenarios_are_read_or_refused(mutations in prop::collection::vec(mutation(), 1..6)) {
        read(mutations.iter().fold(BALL2D.as_bytes().to_vec(), mutate), &[])?;
    }

    #[test]
    fn any_tokens_are_read_or_refused(tokens in prop::collection::vec(select(TOKENS), 0..16)) {
        read(tokens.concat().into_bytes(), &[])?;
    }

    #[test]
    fn any_override_is_taken_or_refused(
        key in select(LEAVES.iter().map(|leaf| leaf.key.clone()).collect::<Vec<_>>()),
        cut in any::<Index>(),
        value in prop_oneof![select(NASTY).prop_map(str::to_owned), ".{0,12}"],
    ) {
        let mut boundary = cut.index(key.len());
        while !key.is_char_boundary(boundary) {
            boundary -= 1;
        }
        read(BALL2D.into(), &[format!("{}={value}", &key[boundary..]), value])?;
    }

    #[test]
    fn any_bytes_are_read_or_refused(bytes in prop::collection::vec(any::<u8>(), 0..200)) {
        read(bytes, &[])?;
    }
}

proptest! {
    #![proptest_config(cases(1000))]

    #[test]
    fn written_scenarios_are_read_back_to_the_last_bit(
        (scene, overrides) in select(NAMES).prop_flat_map(|scene| {
            let of_scene = |leaf: &&Leaf| !leaf.key.starts_with("world.") || leaf.key.starts_with(&format!("world.{scene}."));
            let all: Vec<_> = LEAVES.iter().filter(of_scene).cloned().map(valid_override).collect();
            (Just(scene), all)
        }),
    ) {
        let read = |overrides: &[String]| Scenario::read("random.toml", &template(scene).unwrap(), overrides);
        // Rungs need exact acceptance, and learnt weights need adaptation.
        let apart = ["sampler.tempering.rungs=1", "sampler.tempering.adapt_rungs=false", "sampler.adapt_weights=false"];
        let apart = apart.map(str::to_owned);
        let alone = [overrides.as_slice(), &apart].concat();
        let together = ["sampler.tempering.rungs", "sampler.adapt_weights"];
        let is_known = |problem: &Problem| together.contains(&problem.key.as_str());
        let refused = |error: &ScenarioError| error.problems.iter().all(is_known);
        let result = read(&overrides).or_else(|error| if refused(&error) { read(&alone) } else { Err(error) });
        match result {
            Ok(scenario) => same_when_written(&scenario)?,
            // Values that are valid one by one may not fit together: weights that are all zero, a ball larger than its
            // bin.
            // bin.
            Err(error) => {
                let of_the_scene = error.problems.iter().all(|problem| problem.key.starts_with(&format!("world.{scene}.")));
                prop_assert!(of_the_scene && !error.to_string().contains("out of range"), "{}", error);
            }
        }
    }
}
