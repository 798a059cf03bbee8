//! What things are called, one by one or in arrays; and their colours.

use super::values::Owner;
use crate::scene::ConfigError;
use std::collections::BTreeSet;

/// Longest name in a file.
const LONGEST: usize = 40;

/// Most bodies, and most pieces of scenery, arrays counted out.
const MOST: usize = 4096;

/// One body or piece of scenery.
#[derive(Debug)]
pub(super) struct Member {
    /// The place of its table in the file.
    pub(super) entry: usize,
    name: String,
    pub(super) key: String,
    nth: Option<[u32; 2]>,
}

impl Member {
    pub(super) fn owner(&self) -> Owner<'_> {
        Owner { name: &self.name, key: &self.key, nth: self.nth }
    }
}

/// What the tables of a list stand for: each has a name and, where it is an array, how many there are of it.
///
/// # Errors
/// Names that are none or that are there already, and too many members.
pub(super) fn members<'a>(
    list: &str,
    tables: impl Iterator<Item = (&'a str, Option<u32>)>,
    names: &mut BTreeSet<String>,
) -> Result<Vec<Member>, ConfigError> {
    let mut members = Vec::new();
    for (entry, (name, count)) in tables.enumerate() {
        let key = format!("world.custom.{list}[{entry}]");
        check_name(&Owner::new(name, &key))?;
        if members.len() + count.unwrap_or(1) as usize > MOST {
            let many = members.len() + count.unwrap_or(1) as usize;
            let at = if count.is_some() { "count" } else { "name" };
            return Err(Owner::new(name, &key).wrong(at, format!("these are {many} {list}: at most {MOST}")));
        }
        for nth in 0..count.unwrap_or(1) {
            let name = if count.is_some() { format!("{name}_{}", nth + 1) } else { name.to_owned() };
            let member = Member { entry, name, key: key.clone(), nth: count.map(|count| [nth, count]) };
            if !names.insert(member.name.clone()) {
                let message = format!("the name {:?} is already used", member.name);
                return Err(member.owner().wrong("name", message));
            }
            members.push(member);
        }
    }
    Ok(members)
}

/// Refuses names that could not be told apart in requirements, tables and files.
pub(super) fn check_name(owner: &Owner<'_>) -> Result<(), ConfigError> {
    let letter = |c: char| c.is_ascii_alphanumeric() || c == '_' || c == '-';
    if owner.name.is_empty() || owner.name.len() > LONGEST || !owner.name.chars().all(letter) {
        let must = format!("a name has from 1 to {LONGEST} letters a–z, A–Z, digits, `_` and `-`");
        return Err(owner.wrong("name", format!("{:?}: {must}", owner.name)));
    }
    Ok(())
}

/// A name in which `{i}`, `{i+1}` and the like stand for numbers.
pub(super) fn numbered(text: &str, nth: Option<[u32; 2]>) -> Option<String> {
    let Some((before, rest)) = text.split_once('{') else { return Some(text.to_owned()) };
    let (inside, after) = rest.split_once('}')?;
    let more = match inside.trim().strip_prefix('i')?.trim() {
        "" => 0,
        more => more.strip_prefix('+')?.trim().parse::<u32>().ok()?,
    };
    Some(format!("{before}{}{}", nth?[0].checked_add(more)?, numbered(after, nth)?))
}

/// The colour in `#c04030`.
pub(super) fn colour(owner: &Owner<'_>, text: &str) -> Result<Option<[u8; 3]>, ConfigError> {
    if text.is_empty() {
        return Ok(None);
    }
    let digits = text.strip_prefix('#').filter(|digits| digits.len() == 6 && digits.is_ascii());
    let part = |k: usize| u8::from_str_radix(digits?.get(2 * k..2 * k + 2)?, 16).ok();
    match (part(0), part(1), part(2)) {
        (Some(red), Some(green), Some(blue)) => Ok(Some([red, green, blue])),
        _ => Err(owner.wrong("colour", format!("{text:?} is not a colour: write one like \"#c04030\""))),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_numbered() {
        let third = Some([2, 9]);
        assert_eq!(numbered("link_{i+1}", third).as_deref(), Some("link_3"));
        assert_eq!(numbered("link_{ i }", third).as_deref(), Some("link_2"));
        assert_eq!(numbered("{i}{i + 2}", third).as_deref(), Some("24"));
        assert_eq!(numbered("post", third).as_deref(), Some("post"));
        for bad in ["link_{j}", "link_{i", "link_{i-1}", "{i+99999999999}"] {
            assert_eq!(numbered(bad, third), None, "{bad}");
        }
        assert_eq!(numbered("link_{i}", None), None);
    }
}
