//! All tests of `nlmodes-hbm` beside those in its sources, as one binary: each would link all dependencies once more.

mod contact_periods;
mod describing_function;
mod duffing;
mod elastic_stops;
mod face_in_time;
mod floating;
mod forced_numbers;
mod hertz;
mod invariants;
mod jacobian;
mod laws;
mod one_sided_spring;
mod open_modes;
mod pattern_changes;
mod periodic_jacobian;
mod periodic_pieces;
mod several_contacts;
mod start;
mod support;
mod two_element_rod;
mod unknowns;
