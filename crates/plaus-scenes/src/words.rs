//! Lists in sentences.

use std::fmt::Display;

/// "1", "1 and 2", "1, 2 and 3".
pub(crate) fn listed<T: Display>(things: &[T]) -> String {
    let things: Vec<String> = things.iter().map(T::to_string).collect();
    match things.as_slice() {
        [] => String::new(),
        [one] => one.clone(),
        [first @ .., last] => format!("{} and {last}", first.join(", ")),
    }
}
