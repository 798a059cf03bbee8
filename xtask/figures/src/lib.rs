//! How figures and tables are made; shared by the chores that make them.
#![allow(missing_docs, reason = "for the chores of this workspace only")]

pub mod canvas;
pub mod clock;
pub mod distance;
pub mod lines;
pub mod plot;
pub mod render;
pub mod report;

/// Whatever went wrong, for the person at the terminal.
pub type Result<T> = std::result::Result<T, Box<dyn std::error::Error + Send + Sync>>;
