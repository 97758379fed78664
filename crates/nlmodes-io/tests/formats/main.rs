//! Readers against each other, against files of other programs, and against files that are damaged.

mod agreement;
mod bracket;
mod contacts;
mod expanded;
mod inner;
mod meshes;
mod models;
mod mutilations;
mod nastran;
mod nested;
mod numbers;
mod paraview;
mod sample;
mod user_element;
mod writers;
