//! The tables of points: branches, stops, forces of appropriation, participation.

use std::f64::consts::TAU;

use nlmodes_modal::{
    ContactPeriod, Event, InternalResonance, ModalPoint, Participation, PeakStress, Sliding, Stability,
};

use super::row::{Numbered, row};
use crate::table::hertz;

row! {
    /// A point of `branch.csv`.
    BranchRow {
        point: usize, "", "number of the point, from 0";
        frequency_hz: f64, "Hz", "nonlinear modal frequency, ω/2π";
        energy_j: f64, "J", "averaged kinetic energy over a period, the path parameter";
        total_energy_j: f64, "J", "kinetic and strain energy, above that at rest";
        modal_amplitude: f64, "m √kg",
            "nonlinear modal amplitude: norm of the fundamental, weighted by the mass matrix";
        fundamental_m: f64, "m", "real amplitude of the fundamental at stop 0, signed against its phase anchor";
        peak_m: f64, "m",
            "largest displacement at stop 0 toward the stop, from the drawing; in space, if the stop is fixed while \
             the base moves";
        contact_fraction: f64, "", "share of the period in which stop 0 is touched, 0 to 1";
        contact_intervals: usize, "", "closed intervals per period, all stops together";
        peak_contact_force_n: f64, "N",
            "largest contact force of all stops; for short impacts it need not converge with the number of harmonics, \
             `impulse_ns` does";
        residual: f64, "", "norm of the scaled residual";
        event: Vec<Event>, "",
            "events at this point, separated by spaces: grazing, lift-off, start, fold, frequency-fold, \
             branch-point, kink, contact-change, stability-change, period-doubling, neimark-sacker, tongue-foot, \
             resumed, other-mode, harmonics, harmonics-unproven, harmonics-no-help, accuracy-limit";
        resonance: Option<InternalResonance>, "",
            "internal resonance in which the motion takes part, `n:mode k`: harmonic n drives linear mode k";
        stable: Option<bool>, "", "whether small disturbances stay small; empty where unknown";
        largest_multiplier: Option<f64>, "",
            "magnitude of the largest Floquet multiplier; empty where unknown, or where its error is as large";
        multiplier_angle_deg: Option<f64>, "°", "its angle, 0 to 180; empty where the motion is stable";
        harmonics: usize, "", "number of harmonics of this point";
        error_estimate: Option<f64>, "",
            "estimated relative error of the frequency at the same energy, where `method.accuracy` asks for one";
        impulse_ns: Option<f64>, "N·s",
            "integral of all contact forces over the period, which converges with harmonics";
        stress_pa: Option<f64>, "Pa",
            "largest stress over the period, rest included: of meshes of solids the equivalent stress of von Mises at \
             the nodes, of rods and beams |N/A ± M c/I|; beside a contact node it grows with a finer mesh; empty until \
             the end of the run, and where elements, material or height of the section are not known";
        stress_at: Option<f64>, "",
            "where it is: number of the node, of rods and beams the position along the axis in m";
    }
}

impl BranchRow {
    /// The row of a point. Frequencies have 15 digits; the stability is empty where it was not found out, the angle of
    /// the multiplier where the motion is stable.
    pub fn of(index: usize, point: &ModalPoint) -> Self {
        Self {
            point: index,
            frequency_hz: hertz(point.listed_omega()),
            energy_j: point.kinetic_energy,
            total_energy_j: point.total_energy,
            modal_amplitude: point.modal_amplitude,
            fundamental_m: point.fundamental,
            peak_m: point.peak,
            contact_fraction: point.contact_fraction,
            contact_intervals: point.contact_intervals,
            peak_contact_force_n: point.peak_contact_force,
            residual: point.residual,
            event: point.events.clone(),
            resonance: point.resonance,
            stable: point.stability.and_then(|s| s.stable),
            largest_multiplier: point.stability.and_then(|s| s.known_magnitude()),
            multiplier_angle_deg: point.stability.and_then(|s| s.known_magnitude().and(s.angle_deg())),
            harmonics: point.coefficients.n_harmonics(),
            error_estimate: point.error_estimate,
            impulse_ns: point.impulse(),
            stress_pa: point.stress.map(|found| found.stress),
            stress_at: point.stress.map(|found| found.at),
        }
    }

    /// The point of a row, with what the contacts do there: all but its motion.
    pub fn point(self, contacts: Vec<ContactPeriod>) -> ModalPoint {
        let multiplier = self.largest_multiplier.unwrap_or(f64::NAN);
        let angle = self.multiplier_angle_deg.unwrap_or(0.0).to_radians();
        let largest_multiplier = [multiplier * angle.cos(), multiplier * angle.sin()];
        ModalPoint {
            omega: TAU * self.frequency_hz,
            kinetic_energy: self.energy_j,
            resonance: self.resonance,
            stability: self.stable.map(|stable| Stability::conservative(stable, largest_multiplier)),
            total_energy: self.total_energy_j,
            modal_amplitude: self.modal_amplitude,
            fundamental: self.fundamental_m,
            peak: self.peak_m,
            contact_fraction: self.contact_fraction,
            contact_intervals: self.contact_intervals,
            peak_contact_force: self.peak_contact_force_n,
            contacts,
            residual: self.residual,
            error_estimate: self.error_estimate,
            events: self.event,
            stress: self.stress_pa.zip(self.stress_at).map(|(stress, at)| PeakStress { stress, at }),
            ..ModalPoint::default()
        }
    }
}

row! {
    /// What a point of a scene with responses has behind the columns of every branch.
    ResponseRow {
        response: usize, "", "number of the response in the scene, from 1";
        kind: String, "", "what the curve is: frequency, force, phase-resonance, damped-mode, mode, appropriation";
        curve: usize, "", "number of the curve of this run, from 0";
        name: String, "", "name of the curve in figures";
        detached: bool, "", "whether the curve is detached: not reached by those from the ends of the window";
        level: Option<f64>, "", "level of the load: amplitude of the first force in N, or of the base in m/s² or m";
        force_n: Option<f64>, "N",
            "amplitude of the first force; of a damped mode the force in one harmonic at the drive point that would \
             hold it, of appropriation the fundamental of that of the first drive point";
        acceleration_m_s2: Option<f64>, "m/s²", "amplitude of the acceleration of the base";
        base_amplitude_m: Option<f64>, "m", "amplitude of the displacement of the base";
        drive_fundamental_m: Option<f64>, "m", "amplitude of the drive point at the frequency of the load";
        drive_lag_deg: Option<f64>, "°",
            "angle by which the drive point lags the force, or the displacement of the base, −180 to 180";
        input_power_w: Option<f64>, "W", "mean power of the load";
        dissipated_power_w: Option<f64>, "W", "mean power that damping dissipates; equals `input_power_w`";
        damping_ratio: Option<f64>, "", "damping ratio ξ/(2ω) of a damped mode";
        pbmif: Option<f64>, "",
            "active over apparent power of the forces; of a mode that of a force in one harmonic at the drive point";
        multiplier_error: Option<f64>, "",
            "estimated error of the largest multiplier; within it, stability is left open";
        mode_distance: Option<f64>, "",
            "of appropriation: distance of the velocities from those of the mode, over the latter";
    }
}

/// The curve of which a point has a [`ResponseRow`].
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct ResponseOf<'a> {
    /// Number of the response in the scene, from 1.
    pub response: usize,
    /// What it follows.
    pub kind: &'a str,
    /// Number of the curve, from 0.
    pub curve: usize,
    /// Its name in figures.
    pub name: &'a str,
    /// Whether no curve from the ends of the window reaches it.
    pub is_detached: bool,
    /// Unit of the level.
    pub unit: &'a str,
}

impl ResponseRow {
    /// The row of a point; cells that are not known are empty.
    pub fn of(curve: ResponseOf<'_>, point: &ModalPoint) -> Self {
        let known = |value: Option<f64>| value.filter(|value| value.is_finite());
        let driven = point.driven;
        let level = known(driven.and_then(|driven| driven.level));
        let of_unit = |unit: &str| level.filter(|_| curve.unit == unit);
        Self {
            response: curve.response,
            kind: curve.kind.to_owned(),
            curve: curve.curve,
            name: curve.name.to_owned(),
            detached: curve.is_detached,
            level,
            force_n: known(driven.and_then(|driven| driven.force)),
            acceleration_m_s2: of_unit("m/s²"),
            base_amplitude_m: of_unit("m"),
            drive_fundamental_m: driven.and_then(|driven| driven.drive).map(|drive| drive.norm()),
            drive_lag_deg: driven.and_then(|driven| driven.lag_deg()),
            input_power_w: known(driven.and_then(|driven| driven.input_power)),
            dissipated_power_w: known(driven.map(|driven| driven.dissipated_power)),
            damping_ratio: known(driven.and_then(|driven| driven.damping_ratio)),
            pbmif: known(driven.and_then(|driven| driven.indicator)),
            multiplier_error: known(point.stability.and_then(|s| s.known_magnitude().and(s.error))),
            mode_distance: known(driven.and_then(|driven| driven.mode_distance)),
        }
    }

    /// Which curve this is a point of.
    pub fn curve_name(&self) -> String {
        let name = if self.name.is_empty() { String::new() } else { format!("{}, ", self.name) };
        format!("{} of response {}, {name}curve {}", self.kind, self.response, self.curve)
    }

    /// The unit of the level, where one of the loads has it.
    pub fn level_unit(&self) -> Option<&'static str> {
        let level = self.level?;
        let loads = [(self.force_n, "N"), (self.acceleration_m_s2, "m/s²"), (self.base_amplitude_m, "m")];
        loads.into_iter().find(|(load, _)| *load == Some(level)).map(|(_, unit)| unit)
    }
}

row! {
    /// A force of `appropriation.csv`.
    AppropriationRow {
        point: usize, "", "number of the point, that of `branch.csv`; of a test that of the level, from 1";
        frequency_hz: f64, "Hz", "frequency of the mode, or of the level";
        drive: usize, "", "number of the drive point, from 0 in the order of the forces";
        harmonic: usize, "", "harmonic of the force, from 1";
        force_n: f64, "N", "its amplitude";
        phase_deg: f64, "°",
            "its phase, ahead of the cosine in which the mode moves; of a test, the fundamental of the displacement \
             of the drive point";
    }
}

row! {
    /// A stop at a point, of `contacts.csv`.
    ContactRow {
        point: usize, "", "number of the point, that of `branch.csv`";
        contact: usize, "", "number of the stop, from 0 in the order of the scene";
        contact_fraction: f64, "", "share of the period in which the contact is closed, 0 to 1";
        peak_force_n: f64, "N",
            "largest force, positive away from the stop; for short impacts it need not converge with the number of \
             harmonics";
        mean_force_n: f64, "N", "force averaged over the period";
        impulse_ns: f64, "N·s", "integral of the force over the period, which converges with harmonics";
        touches: usize, "", "closed intervals per period";
        approach_velocity_m_s: f64, "m/s",
            "largest speed at which the gap closes as it is touched; 0 without a touch";
        frequency_hz: f64, "Hz",
            "frequency of the motion, that of `branch.csv`; of one with twice the period of its load half of it";
        wear_work_rate_w: Option<f64>, "W",
            "mean of contact force times sliding speed, times a coefficient of friction a power, times one of wear a \
             rate of wear; of the motion without friction; empty where the node does not move within the plane of the \
             contact";
        sliding_path_m: Option<f64>, "m",
            "path that the closed contact slides per period, of the motion without friction";
        friction_power_w: Option<f64>, "W",
            "`wear_work_rate_w` times `friction_estimate` of the contact: an estimate, since the motion is computed \
             without friction: some per cent too high in steady sliding, an order of magnitude where impacts and \
             sliding alternate";
    }
}

impl ContactRow {
    /// The rows of the stops of a point.
    pub fn of(index: usize, point: &ModalPoint) -> impl Iterator<Item = Self> {
        point.contacts.iter().enumerate().map(move |(number, contact)| Self {
            point: index,
            contact: number,
            contact_fraction: contact.closed_share,
            peak_force_n: contact.peak_force,
            mean_force_n: contact.mean_force,
            impulse_ns: contact.impulse,
            touches: contact.touches,
            approach_velocity_m_s: contact.approach_velocity,
            frequency_hz: hertz(point.omega),
            wear_work_rate_w: contact.sliding.map(|sliding| sliding.wear_work_rate),
            sliding_path_m: contact.sliding.map(|sliding| sliding.path),
            friction_power_w: contact.sliding.and_then(|sliding| sliding.friction_power),
        })
    }

    /// What the stop does.
    pub fn period(&self) -> ContactPeriod {
        ContactPeriod {
            closed_share: self.contact_fraction,
            peak_force: self.peak_force_n,
            mean_force: self.mean_force_n,
            impulse: self.impulse_ns,
            touches: self.touches,
            approach_velocity: self.approach_velocity_m_s,
            sliding: self.wear_work_rate_w.zip(self.sliding_path_m).map(|(wear_work_rate, path)| Sliding {
                wear_work_rate,
                path,
                friction_power: self.friction_power_w,
            }),
        }
    }
}

row! {
    /// A point of `participation.csv`.
    ParticipationRow {
        point: usize, "", "number of the point, that of `branch.csv`";
        frequency_hz: f64, "Hz", "nonlinear modal frequency";
        modal_amplitude: f64, "m √kg", "nonlinear modal amplitude";
        harmonics: String, "", "those in the sum, first to last";
        participation "participation_…": Numbered<f64>, "",
            "participation of a linear mode in phase with the fundamental of the first contact, normalised by the \
             modal amplitude; NaN without a fundamental";
        quadrature "quadrature_…": Numbered<f64>, "",
            "the same in quadrature; zero for motions that are even in time";
        energy_share "energy_share_…": Numbered<f64>, "",
            "share of a linear mode in the averaged kinetic energy, all harmonics, 0 to 1";
    }
}

impl ParticipationRow {
    /// The row of a point, with so many modes.
    pub fn of(index: usize, point: &ModalPoint, found: &Participation, modes: usize) -> Self {
        let shares = (0..modes).map(|k| found.energy_shares.get(k).copied().unwrap_or(f64::NAN));
        Self {
            point: index,
            frequency_hz: point.listed_omega() / TAU,
            modal_amplitude: point.modal_amplitude,
            harmonics: format!("{}-{}", found.harmonics.start(), found.harmonics.end()),
            participation: Numbered(found.factors.clone()),
            quadrature: Numbered(found.quadrature.clone()),
            energy_share: Numbered(shares.collect()),
        }
    }
}
