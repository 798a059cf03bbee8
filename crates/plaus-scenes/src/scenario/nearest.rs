//! The nearest names to a misspelt one, and lists of names in a sentence.

use super::tree::leaf;
use crate::registry::NAMES;
use crate::words::joined;

/// Longer names are not compared: nobody makes such misspellings, and the time grows with the square of the length.
const LONGEST: usize = 64;

/// The candidate nearest to `name`, if at most a third of its letters differ (swapped neighbours count once, case,
/// hyphens and whether it is a plural do not count), or if it is the only one that contains `name`.
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str> + Clone) -> Option<&'a str> {
    // An axis is called `minus_z`, and people write `-z`.
    let signed = |name: &str| name.strip_prefix('-').map_or_else(|| name.to_owned(), |axis| format!("minus_{axis}"));
    let plain = |name: &str| singular(&signed(name).to_lowercase().replace('-', "_"));
    let sought = plain(name);
    if sought.is_empty() || name.chars().count() > LONGEST {
        return None;
    }
    let distance = |candidate: &str| strsim::damerau_levenshtein(&sought, &plain(candidate));
    let near = |candidate: &str| match sought.chars().count().max(candidate.chars().count()) {
        0..=3 => 1, // most such words are near each other by chance
        longest => longest.div_ceil(3),
    };
    let measured = candidates.clone().into_iter().map(|candidate| (distance(candidate), candidate));
    let best =
        measured.filter(|(distance, candidate)| *distance <= near(candidate)).min_by_key(|(distance, _)| *distance);
    // `x` for `x_mm`: only the unit is missing.
    let without_unit = |candidate: &&str| candidate.split_once('_').is_some_and(|(begin, _)| plain(begin) == sought);
    let mut bare = candidates.clone().into_iter().filter(without_unit);
    if let Some(only) = bare.next().filter(|_| bare.next().is_none()) {
        return Some(only);
    }
    best.map(|(_, candidate)| candidate).or_else(|| {
        let mut containing = candidates.into_iter().filter(|candidate| sought.len() > 2 && candidate.contains(&sought));
        containing.next().filter(|_| containing.next().is_none())
    })
}

/// The first of the dotted `keys` whose last part is the nearest to `name`.
pub(super) fn nearest_leaf<'a>(name: &str, keys: &'a [String]) -> Option<&'a str> {
    let near = nearest(name, keys.iter().map(|key| leaf(key)))?;
    keys.iter().map(String::as_str).find(|key| leaf(key) == near)
}

/// What is wrong with the name of a scene that there is not, with the nearest and all that there are.
#[must_use]
pub fn no_scene(name: &str) -> String {
    let near = nearest(name, NAMES.iter().copied()).map(|near| format!("did you mean `{near}`? ")).unwrap_or_default();
    format!("there is no scene `{name}`; {near}known: {}", NAMES.join(", "))
}

/// `body` for `bodies`, `joint` for `joints`. Short words, such as `s` or `is`, are as they are.
fn singular(word: &str) -> String {
    match (word.strip_suffix("ies"), word.strip_suffix('s')) {
        (Some(stem), _) if stem.len() > 1 => format!("{stem}y"),
        (_, Some(stem)) if stem.len() > 2 => stem.to_owned(),
        _ => word.to_owned(),
    }
}

/// `a`, `a or b`, `a, b or c`.
pub(super) fn any_of(names: impl IntoIterator<Item = String>) -> String {
    joined(&names.into_iter().collect::<Vec<_>>(), "or")
}

/// A name from a file in a form that can be shown: at most 60 characters, quoted and escaped unless it is a bare key.
pub(super) fn shown(name: &str) -> String {
    let bare = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    let short: String = name.chars().take(60).collect();
    let ellipsis = if short.len() < name.len() { "…" } else { "" };
    if !name.is_empty() && name.chars().all(bare) { short + ellipsis } else { format!("{:?}", short + ellipsis) }
}

#[cfg(test)]
mod tests {
    use super::*;

    const NAMES: [&str; 5] = ["sigma_d", "sigma_theta_deg", "seed", "drop_height", "restitution"];

    #[test]
    fn near_names_are_found_and_far_ones_are_not() {
        for (name, expected) in [
            ("sgima_d", Some("sigma_d")),
            ("Sigma-D", Some("sigma_d")),
            ("sigma_theta", Some("sigma_theta_deg")),
            ("height", Some("drop_height")),
            ("restitutoin", Some("restitution")),
            ("gravity", None),
            ("", None),
            ("x", None),
            ("drop", Some("drop_height")),
            ("sigma", Some("sigma_d")),
        ] {
            assert_eq!(nearest(name, NAMES), expected, "{name}");
        }
        assert_eq!(nearest(&"x".repeat(1_000_000), NAMES), None);
        assert_eq!(nearest("body", ["bodies", "bounce", "box"]), Some("bodies"));
    }

    #[test]
    fn lists_read_as_sentences() {
        assert_eq!(any_of([]), "");
        assert_eq!(any_of(["a".into()]), "a");
        assert_eq!(any_of(["a".into(), "b".into(), "c".into()]), "a, b or c");
        assert_eq!(shown("a b\n"), "\"a b\\n\"");
        assert_eq!(shown(&"k".repeat(100)).chars().count(), 61);
    }
}
