//! Truths of another make: rigid bodies in very small steps of equal length, written without a look at the simulator.
//!
//! What it shares with the simulator is the model only: Coulomb's friction, Stronge's energetic restitution at one
//! point at a time, no restitution and Coulomb's cone where contact lasts. The steps are Moreau's: impulses over a step
//! such that no closed point approaches at its end, found by projected Gauss–Seidel (Jean, Comput. Methods Appl. Mech.
//! Eng. 177, 1999). Lasting contact is of the first order in the step's length: the distance of a run from one in half
//! its steps is what is unknown of the latter.
#![allow(dead_code, unreachable_pub)]

pub mod body;
pub mod impact;
pub mod planar;
pub mod tosses;
