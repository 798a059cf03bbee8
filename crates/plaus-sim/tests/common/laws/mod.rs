//! The laws that every motion of turning bodies must keep, as checks on what was recorded of it: momentum, Coulomb's
//! bound, energy.
//!
//! A check knows only masses, moments of inertia, and what [`Recorder`](record::Recorder) wrote down through the public
//! interface. It returns how large the worst breach is in units of a stated bound. [`campaign`] hands checks the
//! records of random [`worlds`], and records that were made wrong on purpose ([`twins`]), which a check must refuse.
#![allow(dead_code, unreachable_pub)]

pub mod campaign;
pub mod checks;
pub mod record;
pub mod twins;
pub mod worlds;
