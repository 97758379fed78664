//! What is said about a branch, and how long it took.

use std::error::Error;
use std::f64::consts::TAU;
use std::fmt;
use std::ops::ControlFlow;
use std::time::Instant;

use nlmodes::branches::{BranchSettings, ComputedBranch, compute_branch};
use nlmodes::model::MasslessContactModel;
use nlmodes_benchmarks::Failure;

pub const HEADER: &str = "| case | points | refused | frequency, Hz | energy over start | contact, % | end | residual \
    | violation | CPU, s | judged by | difference |\n\
    | --- | ---: | ---: | --- | --- | --- | --- | ---: | ---: | ---: | --- | ---: |";

/// Instants of a period at which complementarity is checked.
const INSTANTS: usize = 256;

/// Points of a branch at which it is checked.
const CHECKED: usize = 40;

/// What came out.
pub struct Verdict {
    computed: ComputedBranch,
    violation: f64,
    cpu: f64,
    /// By what it is judged, the difference found, and what is permitted.
    judged: Option<(String, f64, f64)>,
}

/// Computes the branch and checks its contact.
pub fn follow(model: MasslessContactModel, settings: &BranchSettings) -> Result<Verdict, Failure> {
    let began = cpu_seconds();
    let told = std::env::var_os("HARD_CASES_POINTS").is_some();
    let computed = compute_branch(model, settings, |point| {
        if told {
            eprintln!("{:.9} Hz, {:.6e} J, {:?}", point.omega / TAU, point.kinetic_energy, point.events);
        }
        ControlFlow::Continue(())
    })?;
    let cpu = cpu_seconds() - began;
    let mut problem = computed.problem(0)?;
    let step = computed.unknowns.len().div_ceil(CHECKED);
    let mut violation = 0.0_f64;
    for x in computed.unknowns.iter().step_by(step).chain(computed.unknowns.last()) {
        violation = violation.max(problem.check_contact(x, INSTANTS)?.complementarity);
    }
    drop(problem);
    Ok(Verdict { computed, violation, cpu, judged: None })
}

/// A case that is to be refused, and is.
#[derive(Debug)]
pub struct Refused(String);

impl fmt::Display for Refused {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "refused, as it should be: {}", self.0)
    }
}

impl Error for Refused {}

/// What is beyond what numbers of 16 digits carry has to end with an error.
pub fn refused(outcome: Result<Verdict, Failure>) -> Result<Verdict, Failure> {
    match outcome {
        Ok(_) => Err("it should have been refused".into()),
        Err(error) => Err(Refused(chain(error.as_ref())).into()),
    }
}

impl Verdict {
    /// Judged by something else than this program's branch: the difference to it, and what is permitted.
    pub fn judged(self, by: impl Into<String>, difference: f64, permitted: f64) -> Self {
        Self { judged: Some((by.into(), difference, permitted)), ..self }
    }

    pub fn branch(&self) -> &ComputedBranch {
        &self.computed
    }

    /// Frequency at the last point, Hz.
    pub fn last_hz(&self) -> f64 {
        self.computed.branch.points.last().map_or(f64::NAN, |p| p.omega / TAU)
    }

    /// Frequency over that of the linear mode at the last point.
    pub fn last_ratio(&self) -> f64 {
        self.last_hz() * TAU / self.computed.grazing.omega
    }

    /// Largest relative change of the frequency along the branch.
    pub fn spread(&self) -> f64 {
        let hz = || self.computed.branch.points.iter().map(|p| p.omega);
        hz().fold(0.0, f64::max) / hz().fold(f64::INFINITY, f64::min) - 1.0
    }

    pub fn good(&self) -> bool {
        let residual = self.computed.branch.points.iter().all(|p| p.residual <= 1e-10);
        let judged = self.judged.as_ref().is_none_or(|(_, found, most)| found.abs() <= *most);
        self.computed.branch.end.complete && residual && self.violation <= 1e-6 && judged
    }
}

impl fmt::Display for Verdict {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let points = &self.computed.branch.points;
        let range = |of: &dyn Fn(&nlmodes::modal::ModalPoint) -> f64| {
            let values = || points.iter().map(of);
            (values().fold(f64::INFINITY, f64::min), values().fold(f64::NEG_INFINITY, f64::max))
        };
        let hz = range(&|p| p.omega / TAU);
        let energy = range(&|p| p.kinetic_energy / self.computed.grazing.energy);
        let contact = range(&|p| 100.0 * p.contact_fraction);
        let residual = range(&|p| p.residual).1;
        let mark = if self.good() { "" } else { "**" };
        let (by, difference) = match &self.judged {
            Some((by, found, most)) if found.abs() <= *most => (by.as_str(), format!("{found:.1e}")),
            Some((by, found, most)) => (by.as_str(), format!("**{found:.1e}**, {most:.0e} permitted")),
            None => ("", String::new()),
        };
        let end = if self.computed.branch.end.complete {
            self.computed.branch.end.names()
        } else {
            format!("{}: {}", self.computed.branch.end.names(), self.computed.branch.end.message)
        };
        write!(
            f,
            "{} | {} | {} to {} | {:.3} to {:.3} | {:.1} to {:.1} | {mark}{}{mark} | {residual:.0e} | {:.0e} | {:.2} \
             | {by} | {difference}",
            points.len(),
            self.computed.refused_steps,
            digits(hz.0),
            digits(hz.1),
            energy.0,
            energy.1,
            contact.0,
            contact.1,
            end,
            self.violation,
            self.cpu,
        )
    }
}

/// Seven digits.
fn digits(value: f64) -> String {
    if (1e-2..1e6).contains(&value) {
        let places = (6.0 - value.log10().floor()).clamp(0.0, 9.0) as usize;
        format!("{value:.places$}")
    } else {
        format!("{value:.6e}")
    }
}

/// An error with its causes.
pub fn chain(error: &(dyn Error + 'static)) -> String {
    let mut text = error.to_string();
    let mut cause = error.source();
    while let Some(error) = cause {
        text.push_str(&format!(": {error}"));
        cause = error.source();
    }
    text
}

/// Time of this process on a processor, s; by the clock where the system does not tell.
fn cpu_seconds() -> f64 {
    static BEGAN: std::sync::OnceLock<Instant> = std::sync::OnceLock::new();
    let told = std::fs::read_to_string("/proc/self/schedstat").ok();
    let nanoseconds = told.and_then(|text| text.split_whitespace().next()?.parse::<f64>().ok());
    nanoseconds.map_or_else(|| BEGAN.get_or_init(Instant::now).elapsed().as_secs_f64(), |ns| 1e-9 * ns)
}
