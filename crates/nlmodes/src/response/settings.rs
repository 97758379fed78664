use std::sync::Arc;

use nlmodes_continuation::{Bound, Budget, Watch};
use nlmodes_hbm::{Coordinates, PeriodicSettings, Switching};

use crate::response::error::{holds, positive};
use crate::response::{FinerSettings, Gradients, ResponseError, StepLog};

/// What distinguishes one curve from another on the same structure.
#[derive(Debug, Clone, PartialEq)]
pub struct ResponseSettings {
    /// Harmonics of the base frequency. Default 10.
    pub harmonics: usize,
    /// How the instants of contact are treated. Default exact.
    pub switching: Switching,
    /// Unknowns of the linear structure. Default chosen.
    pub coordinates: Coordinates,
    /// Contact solver by name. Default `active-set`.
    pub contact_solver: String,
    /// Window of the frequency of the load, or of a damped mode, rad/s: a curve ends where it leaves it.
    pub window: [f64; 2],
    /// Mode near which phase resonance is sought, or that is followed as a damped mode, from 1. Default 1.
    pub mode: usize,
    /// Lag of the drive point at phase resonance, rad. Default a quarter of a turn.
    pub lag: f64,
    /// Periods of the load in one of the motion. Default 1.
    pub subharmonic: usize,
    /// Whether a curve over the frequency begins at the upper end of the window. Default no.
    pub from_upper_end: bool,
    /// Whether multipliers are computed. Default yes.
    pub stability: bool,
    /// Wall time for the multipliers of a curve, s: of points after it none are computed, which the end of the curve
    /// tells. Default three times that of the curve, and ten seconds at least.
    pub stability_budget_s: Option<f64>,
    /// Error of the largest multiplier, over its distance from the unit circle and over itself, from which on the exact
    /// motion next to a point is sought, whose multipliers then decide. Default 1 %.
    pub multiplier_margin: f64,
    /// The same up to which the estimate decides where no exact motion is found or sought. Default a third.
    pub verdict_margin: f64,
    /// Most points of a curve next to which exact motions are sought, of those in contact with the least certain
    /// estimates. Default 12: next to all of them, curves take some ten times as long.
    pub exact_motions: usize,
    /// Largest difference of the fundamentals of the gaps up to which an exact motion is that of the point, over the
    /// fundamental. Default 1 %.
    pub same_motion: f64,
    /// Which points of a curve are solved again with more harmonics. Default none.
    pub finer: Option<FinerSettings>,
    /// Most points of a curve. Default 2000.
    pub max_points: usize,
    /// Most curves of [`branching_responses`](crate::response::branching_responses). Default 20.
    pub max_branches: usize,
    /// Levels at which phase resonances are to be reported. Default none.
    pub levels: Vec<f64>,
    /// Who may end a curve between two of its points. Default nobody.
    pub watch: Watch,
    /// Where the steps of curves are kept. Default nowhere.
    pub log: StepLog,
    /// The parameters by which points are differentiated. Default none.
    pub gradients: Arc<Gradients>,
}

impl ResponseSettings {
    /// The defaults, in a window of frequencies, rad/s.
    pub fn new(window: [f64; 2]) -> Self {
        Self {
            harmonics: 10,
            switching: Switching::Exact,
            coordinates: Coordinates::Automatic,
            contact_solver: "active-set".to_owned(),
            window,
            mode: 1,
            lag: std::f64::consts::FRAC_PI_2,
            subharmonic: 1,
            from_upper_end: false,
            stability: true,
            stability_budget_s: None,
            multiplier_margin: 1e-2,
            verdict_margin: 1.0 / 3.0,
            exact_motions: 12,
            same_motion: 1e-2,
            finer: None,
            max_points: 2000,
            max_branches: 20,
            levels: Vec::new(),
            watch: Watch::default(),
            log: StepLog::default(),
            gradients: Arc::default(),
        }
    }

    pub(crate) fn budget(&self) -> Budget {
        Budget::new(self.stability_budget_s)
    }

    pub(crate) fn periodic(&self) -> PeriodicSettings {
        PeriodicSettings { harmonics: self.harmonics, switching: self.switching, coordinates: self.coordinates }
    }

    /// The window as a bound of the coordinate that is the base frequency over `base`, at which the curve begins.
    pub(crate) fn bound_from(&self, coordinate: usize, base: f64) -> Result<Bound, ResponseError> {
        let [low, high] = self.base_window();
        if !(low..=high).contains(&base) {
            return Err(ResponseError::OutsideWindow { omega: base * self.subharmonic as f64, window: self.window });
        }
        Ok(Bound { coordinate, min: low / base, max: high / base })
    }

    /// Window of the base frequency of the motion.
    pub(crate) fn base_window(&self) -> [f64; 2] {
        self.window.map(|omega| omega / self.subharmonic as f64)
    }

    pub(crate) fn check(&self) -> Result<(), ResponseError> {
        let [low, high] = self.window;
        positive("the lower end of the frequency window (rad/s)", low)?;
        let is_above = |high| high > low;
        holds("the upper end of the frequency window (rad/s)", high, "more than the lower end", is_above)?;
        holds("periods of the load in one of the motion", self.subharmonic as f64, "1 or more", |s| s >= 1.0)
    }
}
