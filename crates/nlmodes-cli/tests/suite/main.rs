//! All tests of `nlmodes-cli` beside those in its sources, as one binary: each would link all dependencies once more.

mod branches;
mod command_line;
mod contact_problems;
mod contact_solvers;
mod effort;
mod elastic_stops;
mod hostile_files;
mod imposed_modes;
mod interrupted;
mod interrupted_responses;
mod measured_records;
mod messages;
mod reduced_elsewhere;
mod responses;
mod results_files;
mod shooting;
mod sliding;
mod springs;
mod static_loads;
mod stress;
mod structures;
mod studies;
mod updating;
mod verdicts;
mod verify;
mod virtual_tests;
