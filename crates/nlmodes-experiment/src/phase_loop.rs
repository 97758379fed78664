//! The phase-locked loop: phase detector, loop filter, oscillator.
