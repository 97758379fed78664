//! The virtual rig: exact motion, phase resonance, contact.
#![allow(mixed_script_confusables)]

mod analysis;
mod beam;
mod integration;
mod phase_resonance;
mod schedule;
