//! The virtual rig: exact motion, phase resonance, contact.
#![allow(mixed_script_confusables)]

mod beam;
mod integration;
