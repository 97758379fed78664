//! Readers against each other, against files of other programs, and against files that are damaged.

mod agreement;
mod bracket;
mod contacts;
mod inner;
mod meshes;
mod models;
mod mutilations;
mod paraview;
mod sample;
mod writers;
