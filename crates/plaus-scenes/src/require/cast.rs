//! Who is in a scene, and what names stand for.

/// Who is in a scene.
#[derive(Debug, Clone, PartialEq)]
pub struct Cast {
    /// Names of bodies, as in animations.
    pub bodies: Vec<String>,
    /// Names of what stands still and can be touched.
    pub fixed: Vec<String>,
    /// When the simulation ends at the latest, in s.
    pub longest: f64,
    /// Whether bodies are dice, whose faces have pips.
    pub faces: bool,
}

impl Cast {
    /// The only body there is.
    pub(super) fn only(&self) -> Option<&str> {
        match self.bodies.as_slice() {
            [one] => Some(one),
            _ => None,
        }
    }

    /// The bodies that a pattern stands for.
    pub(super) fn matching<'a>(&'a self, pattern: &'a str) -> impl Iterator<Item = &'a str> {
        self.bodies.iter().map(String::as_str).filter(move |name| matches(pattern, name))
    }
}

/// Whether `pattern`, in which each `*` stands for any letters, is `name`.
pub(super) fn matches(pattern: &str, name: &str) -> bool {
    let Some((head, rest)) = pattern.split_once('*') else { return pattern == name };
    let Some(name) = name.strip_prefix(head) else { return false };
    (0..=name.len()).filter(|&cut| name.is_char_boundary(cut)).any(|cut| matches(rest, &name[cut..]))
}
