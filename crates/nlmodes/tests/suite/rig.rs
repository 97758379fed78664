//! The virtual rig: exact motion, phase resonance, contact.

mod analysis;
mod beam;
mod chains;
mod closed_loop;
mod extracted;
mod force_by_balance;
mod forced_response;
mod free_decay;
mod hostile;
mod integration;
mod long_records;
mod phase_plant;
mod phase_resonance;
mod schedule;
mod test_control;
