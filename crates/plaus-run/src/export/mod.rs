//! A run's draws for other programs.

pub mod csv;
pub mod output;
mod variables;
pub mod zarr;
