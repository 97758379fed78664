//! Responses, damped modes and phase resonance, compared with time integration, closed forms and each other.

mod beam;
mod curves;
mod dissipating_stops;
mod finer;
mod floating;
mod free_phase;
mod gradients;
mod integrated;
mod limits;
mod limits_of_structures;
