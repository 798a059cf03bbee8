//! The laws that every motion of turning bodies must obey, as checks on its record: momentum, Coulomb's bound, energy.
//!
//! A check knows only masses, moments of inertia, and the events that [`Recorder`](record::Recorder) wrote down through
//! the public interface. It returns the size of the worst breach in units of a stated bound. [`campaign`] gives the
//! checks the records of random [`worlds`], and also records that were made wrong on purpose ([`twins`]), which a check
//! must refuse.
#![allow(dead_code, unreachable_pub)]

pub mod campaign;
pub mod checks;
pub mod record;
pub mod twins;
pub mod wedges;
pub mod worlds;
