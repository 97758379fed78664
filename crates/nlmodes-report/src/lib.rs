//! Tables and figures of nonlinear modes.
//!
//! Everything here starts from a [`ModalBranch`](nlmodes_modal::ModalBranch) or a
//! [`TimeHistory`](nlmodes_modal::TimeHistory), so that computed and measured modes share files, axes and figures.
//! Frequencies are converted to hertz here and nowhere else: `f = ω̃ / 2π`.
//!
//! | item | writes | shows |
//! | --- | --- | --- |
//! | [`write_branch`], [`BranchWriter`] | `branch.csv` | a row a point: frequency, energies, amplitudes, contact |
//! | [`write_starts`] | `starts.npz` | initial displacements of exact motions |
//! | [`write_contacts`] | `contacts.csv` | one row per point and stop: share, forces, impulse, number of contacts |
//! | [`write_histories`] | `histories.npz` | motion and force of the contacts over a period |
//! | [`write_matlab`] | `results.mat` | all of these for MATLAB and Octave |
//! | [`columns`] | | meaning of all files, columns and arrays |
//! | [`write_harmonics`] | `harmonics.npz` | frequencies and complex Fourier coefficients, eq. (7), for NumPy |
//! | [`write_summary`] | `summary.json` | any serialisable summary |
//! | [`BranchFigure`] | SVG | frequency over energy (Fig. 3 b) or modal amplitude (Fig. 8 a) |
//! | [`ContactFigure`] | SVG | share, impulse and largest force of each stop over frequency |
//! | [`MotionFigure`] | SVG | displacement over position and one period (Fig. 4) |
//! | [`HistoryFigure`] | SVG | displacement, velocity, contact force over time (Fig. 9) |
//! | [`MeasuredFigure`] | SVG | measured damping and mode indicator over modal amplitude (Fig. 10) |
//! | [`StiffnessFigure`] | SVG | contact force over displacement with the fitted stiffness (Fig. 7 b) |
//! | [`HtmlReport`] | `report.html` | everything on one self-contained page: figures with zoom, animated modes |
//! | [`Page`] | HTML | the frame of such a page, for other contents |
//! | `print`, with the feature of that name | PDF, PNG | figures in SVG for journals and slides |
//! | [`TornadoFigure`] | SVG | what parameters do to a quantity, a bar each |
//! | [`SpreadFigure`] | SVG | values of many cases over a variable, with median and band |
//! | [`ConvergenceFigure`] | SVG | errors over a discretisation parameter, on logarithmic axes |
//!
//! Files appear under their name when they are complete; only [`BranchWriter`] grows its file row by row.
//!
//! # Example
//! An oscillator of mass 1 kg and eigenfrequency `ω₀` against a rigid stop at `g₀` vibrates with amplitude `a ≥ g₀` at
//! `ω = π ω₀ / (π − arccos(g₀/a))`.
//!
//! ```
//! use nlmodes_modal::{BranchEnd, Coordinate, Event, HarmonicCoefficients, ModalBranch, ModalPoint};
//! use nlmodes_report::{Abscissa, BranchFigure, write_branch};
//! use std::f64::consts::PI;
//!
//! let (omega_0, stop) = (10.0, 1e-3);
//! let point = |amplitude: f64| ModalPoint {
//!     omega: PI * omega_0 / (PI - (stop / amplitude).acos()),
//!     coefficients: HarmonicCoefficients::zeros(1, 1),
//!     kinetic_energy: 0.25 * (omega_0 * amplitude).powi(2),
//!     total_energy: 0.5 * (omega_0 * amplitude).powi(2),
//!     modal_amplitude: amplitude,
//!     fundamental: amplitude,
//!     peak: stop,
//!     contact_intervals: 1,
//!     events: if amplitude == stop { vec![Event::Grazing] } else { Vec::new() },
//!     ..ModalPoint::default()
//! };
//! let branch = ModalBranch {
//!     label: "exact".into(),
//!     coordinates: vec![Coordinate { position: 0.0, kind: "axial".into() }],
//!     contact_coordinate: Some(0),
//!     stop: Some(stop),
//!     points: (0..50).map(|k| point(stop * (1.0 + 0.02 * f64::from(k)))).collect(),
//!     end: BranchEnd::given("fifty points"),
//! };
//! let folder = tempfile::tempdir()?;
//! write_branch(folder.path().join("branch.csv"), &branch)?;
//! let figure = BranchFigure::new(Abscissa::Energy, &[&branch]).title("Oscillator with a stop").render()?;
//! figure.write(folder.path().join("frequency_energy.svg"))?;
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! # Why the figures are drawn here
//! A figure of a motion needs the stop as a line that the surface hides where it is nearer; the plotting crate that was
//! tried first (kuva 0.6) has no such line, and its logarithmic axes end at whole decades by default. The modules
//! `chart` and `surface` therefore describe the contents, and the module `svg`, the only one that knows the format,
//! writes them to a hundredth of a pixel.
//!
//! # Reference
//! Peter et al., Mechanical Systems and Signal Processing 120 (2019) 793-807: the equations and figures cited here.

mod chart;
pub mod columns;
mod error;
mod figure;
mod html;
mod output;
mod palette;
#[cfg(feature = "print")]
pub mod print;
mod stations;
mod stop;
mod style;
mod surface;
mod svg;
mod table;
mod unit;

pub use error::ReportError;
pub use figure::{
    Abscissa, BranchFigure, ContactFigure, ConvergenceFigure, Figure, HistoryFigure, LineKind, MeasuredFigure,
    MotionFigure, ParticipationFigure, Quantity, ResponseFigure, ResponseLine, SHOWN_MODES, SpreadFigure,
    StiffnessFigure, TornadoFigure,
};
pub use html::{DataTable, HtmlReport, Page, Wireframe, explore};
pub use output::write_file;
pub use stop::StopLine;
pub use style::FigureStyle;
pub use svg::escape;
pub use table::{
    BranchWriter, PointHistories, TransientHistories, hertz, write_branch, write_contacts, write_harmonics,
    write_histories, write_matlab, write_participation, write_rows, write_rows_to, write_starts, write_summary,
    write_transient,
};
