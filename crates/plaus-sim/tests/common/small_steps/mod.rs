//! An independent truth: rigid bodies in very small steps of equal length, written without looking at the simulator.
//!
//! It shares only the model with the simulator: Coulomb's friction, Stronge's energetic restitution at one point at a
//! time, and no restitution but Coulomb's cone where contact lasts. The steps are Moreau's: the impulses over a step
//! are such that no closed point approaches at its end, and are found by projected Gauss–Seidel (Jean, Comput. Methods
//! Appl. Mech. Eng. 177, 1999). Lasting contact is of the first order in the step's length: the distance between a run
//! and one with half its steps is the uncertainty of the latter.
//! its steps is what is unknown of the latter.
#![allow(dead_code, unreachable_pub)]

pub mod body;
pub mod impact;
pub mod planar;
pub mod tosses;
