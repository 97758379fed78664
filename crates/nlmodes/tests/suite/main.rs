//! All tests of `nlmodes` beside those in its sources, as one binary: each would link all dependencies once more.

mod accuracy;
mod beam_hbm;
mod beam_paper;
mod branch_points;
mod force_appropriation;
mod hard_cases;
mod large_structure;
mod own_matrices;
mod paper_map;
mod response;
mod rig;
mod rod_paper;
mod shooting;
mod support;
mod threads;
mod updating;
mod virtual_rig;
