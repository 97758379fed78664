//! Rods and beams reduced to free- and fixed-interface modes, and at rest before their stops.

mod held_modes;
mod open_modes;
mod rest;
