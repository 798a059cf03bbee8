//! What an impact does: at one point, at several at once, and through joints.

mod articulated;
mod instant;
mod scatter;
mod simultaneous;
mod single;
