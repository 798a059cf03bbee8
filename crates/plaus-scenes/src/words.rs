//! Lists in sentences.

use std::fmt::Display;

/// "1", "1 and 2", "1, 2 and 3".
pub(crate) fn listed<T: Display>(things: &[T]) -> String {
    joined(things, "and")
}

/// The same with another word before the last.
pub(crate) fn joined<T: Display>(things: &[T], word: &str) -> String {
    let things: Vec<String> = things.iter().map(T::to_string).collect();
    match things.as_slice() {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} {word} {last}", first.join(", ")),
    }
}
