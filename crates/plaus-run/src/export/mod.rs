//! A run's draws for other programs.

pub mod csv;
pub mod output;
pub mod zarr;
