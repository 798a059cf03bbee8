//! Copies of draws without new memory.

/// `Clone` by fields, with a `clone_from` that keeps the memory of what it replaces: a chain copies its draw at every
/// iteration. (A derived `Clone` would allocate anew.)
macro_rules! clone_in_place {
    ($copied:ident { $($field:tt),+ }) => {
        impl Clone for $copied {
            fn clone(&self) -> Self {
                Self { $($field: Clone::clone(&self.$field)),+ }
            }

            fn clone_from(&mut self, source: &Self) {
                $(self.$field.clone_from(&source.$field);)+
            }
        }
    };
}
pub(crate) use clone_in_place;
