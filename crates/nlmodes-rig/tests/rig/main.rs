//! The virtual rig: exact motion, phase resonance, contact.

mod analysis;
mod beam;
mod extracted;
mod forced_response;
mod hostile;
mod integration;
mod long_records;
mod phase_resonance;
mod schedule;
