//! Responses against an integration in time that shares no code with them.

mod detached;
mod doubled;
mod masses;
mod pressed;
mod touching;
