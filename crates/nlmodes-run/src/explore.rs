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
//! | `Page` | a scene and its server: `Page::open`, `Page::address`, `Page::serve`, `Page::end` |
//! | [`picture`] | the first branch of a scene as data of the page, without files |
//! | `ExploreError` | why there is no page |
//!
//! All but [`picture`] needs the feature `explore`.
//!
//! # Example
//! ```
//! # #[cfg(feature = "explore")] {
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
//! let page = nlmodes_run::explore::Page::open(&scene, Vec::new(), 0)?;
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
//! # }
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```

use std::ops::ControlFlow;

use nlmodes::branches::{BranchPointRule, BranchSettings, StabilityRule, Watch, compute_branch};
use nlmodes::modal::ModalPoint;
use nlmodes_scene::SceneFile;
use nlmodes_scene::assemble::Structures;

use crate::branches::curve::BranchCurve;
use crate::curve::picture::MOST_POINTS;
use crate::physical::recover;
use crate::settings::{Models, branch_settings, models_sharing, starts};
use crate::{RunError, refusal};

#[cfg(feature = "explore")]
mod answer;
#[cfg(feature = "explore")]
mod computing;
#[cfg(feature = "explore")]
mod error;
#[cfg(feature = "explore")]
mod save;
#[cfg(feature = "explore")]
mod server;
#[cfg(feature = "explore")]
mod sliders;

#[cfg(feature = "explore")]
pub use error::ExploreError;
#[cfg(feature = "explore")]
pub use server::Page;

/// Computes the branch of a scene from its start; one way where it goes both ways, without stability. Of a scene with
/// responses the first curve of each level of the first one.
///
/// It is shown as the page's script takes it: JSON of the branch with the motions of its points. `watch` may end it;
/// what `structures` know of files is not read and reduced again.
///
/// # Errors
/// [`RunError`] if there is no branch, [`RunError::Ended`] if it was asked to end.
pub fn picture(file: &SceneFile, watch: Watch, structures: &Structures) -> Result<String, RunError> {
    crate::refusal::unless_in_time(file)?;
    if !file.scene.responses.is_empty() {
        return crate::responses::picture(file, &watch, structures);
    }
    let Models { model: _, massless, open, state } = models_sharing(file, structures)?;
    let plain = branch_settings(&file.scene);
    let settings = BranchSettings {
        start: starts(file.scene.continuation.start()).0,
        stability: StabilityRule::Never,
        at_branch_point: match plain.at_branch_point {
            BranchPointRule::All => BranchPointRule::Stay,
            rule => rule,
        },
        max_points: plain.max_points.min(MOST_POINTS),
        watch: watch.clone(),
        ..plain
    };
    let ended = watch.clone();
    let going_on = |_: &ModalPoint| match ended.has_ended() {
        true => ControlFlow::Break(()),
        false => ControlFlow::Continue(()),
    };
    let mut computed =
        compute_branch(massless, &settings, going_on).map_err(|error| refusal::of_branch(file, &error))?;
    let state = state.as_ref();
    recover(&file.scene, (open.as_ref(), state), [&mut computed]);
    crate::curve::picture::picture(&file.scene, &[&BranchCurve::new(&computed, &[], state)], &watch)
}
