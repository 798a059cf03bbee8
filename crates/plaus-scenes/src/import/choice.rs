//! What a user says of the objects of a file, by their names.

use super::ImportError;
use super::things::Role;

/// Which objects of a file move, follow their keyframes, or are left out; all others are what the file says, or else
/// scenery. Each is a name, or a pattern in which `*` stands for any text and `?` for one character.
#[derive(Debug, Clone, PartialEq, Eq, Default)]
pub struct Choice {
    /// What moves.
    pub moving: Vec<String>,
    /// What follows its keyframes.
    pub driven: Vec<String>,
    /// What is left out.
    pub ignored: Vec<String>,
}

/// Most names in a message.
const SHOWN: usize = 40;

impl Choice {
    /// Whether nothing is said.
    pub(super) fn is_empty(&self) -> bool {
        self.moving.is_empty() && self.driven.is_empty() && self.ignored.is_empty()
    }

    fn lists(&self) -> [(&[String], Role); 3] {
        [(&self.moving, Role::Body), (&self.driven, Role::Driven), (&self.ignored, Role::Gone)]
    }

    /// What an object of this name becomes, if that is said.
    pub(super) fn of(&self, name: &str) -> Option<Role> {
        let says = |(patterns, role): (&[String], Role)| patterns.iter().any(|one| fits(one, name)).then_some(role);
        self.lists().into_iter().find_map(says)
    }

    /// Checks what is said against the names of a file.
    pub(super) fn check(&self, names: &[&str]) -> Result<(), ImportError> {
        for pattern in self.lists().into_iter().flat_map(|(patterns, _)| patterns) {
            if !names.iter().any(|name| fits(pattern, name)) {
                let more = names.len().saturating_sub(SHOWN);
                let more = if more > 0 { format!(", and {more} more") } else { String::new() };
                let shown = names[..names.len().min(SHOWN)].join(", ");
                let what = format!("no object is called {pattern:?}; the file has {shown}{more}");
                return Err(ImportError::Choice(what));
            }
        }
        for name in names {
            let says = |(patterns, role): (&[String], Role)| patterns.iter().any(|one| fits(one, name)).then_some(role);
            if self.lists().into_iter().filter_map(says).count() > 1 {
                let what = format!("{name} is said to do two things: name it, or a pattern that it fits, only once");
                return Err(ImportError::Choice(what));
            }
        }
        Ok(())
    }
}

/// Whether a name fits a pattern.
fn fits(pattern: &str, name: &str) -> bool {
    let (pattern, name): (Vec<char>, Vec<char>) = (pattern.chars().collect(), name.chars().collect());
    // Where the last star is, and from where in the name it is tried to end.
    let (mut p, mut n, mut star) = (0, 0, None);
    while n < name.len() {
        match pattern.get(p) {
            Some('*') => {
                star = Some((p, n));
                p += 1;
            }
            Some(&c) if c == '?' || c == name[n] => (p, n) = (p + 1, n + 1),
            _ => match star {
                Some((at, end)) => {
                    star = Some((at, end + 1));
                    (p, n) = (at + 1, end + 1);
                }
                None => return false,
            },
        }
    }
    pattern[p..].iter().all(|&c| c == '*')
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn patterns_fit_names() {
        for (pattern, name, truth) in [
            ("Ball", "Ball", true),
            ("Ball", "Ball_2", false),
            ("Can_*", "Can_", true),
            ("Can_*", "Can_3.001", true),
            ("*an*1", "Can_3.001", true),
            ("*an*2", "Can_3.001", false),
            ("Can_?", "Can_3", true),
            ("Can_?", "Can_", false),
            ("*", "", true),
            ("", "a", false),
            ("***a", "aaa", true),
        ] {
            assert_eq!(fits(pattern, name), truth, "{pattern} {name}");
        }
    }
}
