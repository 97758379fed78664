//! All tests of `nlmodes-scene` beside those in its sources, as one binary: each would link all dependencies once more.

mod choices_of_words;
mod files;
mod free_bodies;
mod hostile;
mod parts;
mod rows_apart;
mod schemas;
mod shared;
mod units;
