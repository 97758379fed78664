//! A scene on a page with sliders, its branch computed anew while one drags.
//!
//! ```text
//! scene file  →  page at an address of this machine  ⇄  values of the sliders  →  branch and motions, computed anew
//! ```
//!
//! The page answers on the loopback interface only, and only to whoever knows its address, which has a token of 128
//! bits; pages of other origins are refused. One branch is computed at a time, that of the newest values. Nothing is
//! printed, and nothing is written but what is saved: the text of the scene with other values, beside it under a name
//! that is free.
//!
//! | item | what it is |
//! | --- | --- |
//! | [`Page`] | a scene and its server: [`Page::open`], [`Page::address`], [`Page::serve`], [`Page::end`] |
//! | [`ExploreError`] | why there is no page |
//!
//! # Example
//! ```
//! use std::io::{Read, Write};
//! use std::net::TcpStream;
//!
//! let folder = tempfile::tempdir()?;
//! let scene = folder.path().join("rod.toml");
//! # let text = r#"
//! # [structure]
//! # kind = "rod"
//! # length_m = 1.0
//! # elements = 8
//! # start = "clamped"
//! # material = { youngs_modulus_pa = 210e9, density_kg_m3 = 7800.0 }
//! # section = { area_m2 = 1e-4 }
//! # [[contact]]
//! # at_m = 1.0
//! # direction = "axial"
//! # side = "positive"
//! # gap_m = 1e-3
//! # [method]
//! # harmonics = 3
//! # [continuation]
//! # max_energy_ratio = 3.0
//! # "#;
//! std::fs::write(&scene, text)?; // the text of a scene
//! let page = nlmodes_explore::Page::open(&scene, Vec::new(), 0)?;
//! let address = page.address();
//! let (host, path) = address.trim_start_matches("http://").split_once('/').ok_or("no path")?;
//! std::thread::scope(|scope| -> std::io::Result<()> {
//!     scope.spawn(|| page.serve());
//!     let mut stream = TcpStream::connect(host)?;
//!     write!(stream, "GET /{path} HTTP/1.0\r\nHost: {host}\r\n\r\n")?;
//!     let mut answer = String::new();
//!     stream.read_to_string(&mut answer)?;
//!     assert!(answer.starts_with("HTTP/1.0 200") && answer.contains("contact.0.gap_m"), "{answer}");
//!     page.end();
//!     Ok(())
//! })?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

#![deny(clippy::print_stdout, clippy::print_stderr)]

mod answer;
mod computing;
mod error;
mod page;
mod save;
mod server;
mod sliders;

pub use error::ExploreError;
pub use page::Page;
