//! What a careful experimenter looks at once the values are there: delays, scales, signs, phases, forces, the state of
//! the vibration.

use nlmodes_modal::LinearModes;
use num_complex::Complex64;

use crate::extraction::balance::Balance;
use crate::extraction::blocks::Blocks;
use crate::extraction::consensus::{Consensus, Row};
use crate::extraction::layout::{Layout, Place, member};
use crate::extraction::scale::{Scales, likely_unit};
use crate::extraction::skew::Comparison;
use crate::extraction::values::{Method, Values};
use crate::extraction::window::Window;
use crate::extraction::{BalanceFigures, ContactFigures, ExtractionSettings, Finding, Measured, Stop, quadrature};
use crate::records::{Quantity, Record};

/// Distance of the stop from where it is declared, over gap or motion, that is reported.
const GAP: f64 = 0.5;
/// Share of the gap up to which a motion surely does not touch.
const SURELY_OPEN: f64 = 0.95;
/// Power that damping takes in higher harmonics and the force does not bring in, over that in the fundamental, from
/// which on something hands it over to them.
const HANDED_OVER: f64 = 0.02;
/// Share of the peak by the balance of the modes by which that of the cell must be off to be reported …
const DISAGREES: f64 = 0.08;
/// … and standard errors.
const SURE: f64 = 4.0;
/// Factor between the frequency and that of the nearest linear mode that is reported: a stop raises it to its double,
/// two stops further.
const FAR: f64 = 3.0;

/// What is judged.
#[derive(Debug)]
#[non_exhaustive]
pub struct Judgement<'a> {
    pub record: &'a Record,
    pub settings: &'a ExtractionSettings,
    pub layout: &'a Layout,
    pub window: &'a Window,
    pub method: &'a Method<'a>,
    pub blocks: &'a Blocks,
    pub values: &'a Values,
}

impl Judgement<'_> {
    /// Reports what disagrees among the responses; whether nothing does.
    pub fn responses(&self, findings: &mut Vec<Finding>) -> bool {
        let before = findings.len();
        self.far(findings);
        self.skew(findings);
        let places = self.all_places();
        Scales { consensus: self.consensus(&places), channels: &self.record.channels }.report(findings);
        if findings.len() == before {
            self.quadrature(findings);
        }
        findings.len() == before
    }

    /// Reports a frequency that no linear mode can have.
    fn far(&self, findings: &mut Vec<Finding>) {
        let distance = |omega: &f64| (omega / self.method.omega).ln().abs();
        let omegas = self.method.modes.iter().flat_map(|modes| modes.omegas());
        let Some(nearest) = omegas.min_by(|a, b| distance(a).total_cmp(&distance(b))) else { return };
        if distance(nearest) > FAR.ln() {
            let [frequency_hz, nearest_hz] = [self.method.omega, *nearest].map(|omega| omega / std::f64::consts::TAU);
            findings.push(Finding::FarFromModes { frequency_hz, nearest_hz });
        }
    }

    fn skew(&self, findings: &mut Vec<Finding>) {
        let comparison = Comparison {
            blocks: self.blocks,
            names: self.record.channels.iter().map(|channel| channel.name.as_str()).collect(),
            omega: self.method.omega,
            sample_rate: self.record.sample_rate,
            n_samples: self.window.n_samples,
            tolerances: self.settings.tolerances,
        };
        let before = findings.len();
        comparison.collocated(&self.layout.places, findings);
        // A channel that disagrees with its neighbour spoils the comparison with the modes.
        if let Some(modes) = self.method.modes.as_ref().filter(|_| findings.len() == before) {
            comparison.against_modes(modes, &self.method.shape_places, findings);
        }
    }

    /// The places that have a position, and a drive point without one.
    fn all_places(&self) -> Vec<Place> {
        let lonely = self.layout.drive.iter().filter(|drive| drive.position.is_none());
        self.layout.places.iter().chain(lonely).cloned().collect()
    }

    fn consensus(&self, places: &[Place]) -> Consensus<'_> {
        let omega = self.method.omega;
        let sampling = (2.0 / self.window.n_samples as f64).sqrt();
        let shape = |place: &Place| {
            let here = |shape: &Place| shape.position.is_some() && shape.position == place.position;
            self.method.modes.as_ref().and_then(|_| self.method.shape_places.iter().position(here))
        };
        let row = |(k, place): (usize, &Place), (i, order): (usize, u32)| Row {
            channel: i,
            place: k,
            shape: shape(place),
            value: self.blocks.all[i][1] / Complex64::new(0.0, omega).powu(order),
            noise: sampling * self.blocks.noise[i] / omega.powi(order as i32),
            calibration: self.record.channels[i].uncertainty,
        };
        let rows = places.iter().enumerate().flat_map(|(k, place)| place.members.iter().map(move |m| ((k, place), *m)));
        Consensus {
            rows: rows.map(|(place, member)| row(place, member)).collect(),
            modes: self.method.modes.as_ref(),
            omega,
        }
    }

    fn quadrature(&self, findings: &mut Vec<Finding>) {
        let anchor = self.layout.drive.as_ref().map(|drive| {
            let q = &self.blocks.all;
            crate::extraction::layout::displacement(drive, q, &self.blocks.noise, self.method.omega, 1).arg()
        });
        let modal: Option<Vec<Complex64>> = self.modal();
        let name = |place: &Place| self.name_at(place);
        let tolerance = self.settings.tolerances.quadrature;
        let places = &self.method.shape_places;
        quadrature::report(&self.values.motion, modal.as_deref(), anchor, tolerance, name, places, findings);
    }

    /// Modal coordinates of the fundamental.
    fn modal(&self) -> Option<Vec<Complex64>> {
        let coordinates = &self.values.modal.as_ref()?.coordinates;
        Some((0..coordinates.n_coordinates()).map(|k| coordinates.of(k)[1]).collect())
    }

    /// Reports forces that do not fit the motion.
    pub fn forces(&self, power: Option<Measured>, contact: Option<&ContactFigures>, findings: &mut Vec<Finding>) {
        let (Some(modes), Some(modal)) = (self.method.modes.as_ref(), self.modal()) else { return };
        let channels = &self.record.channels;
        let is_sound = self.layout.contact.is_none_or(|i| !findings.iter().any(|f| f.spoils(&channels[i].name)));
        let touched = contact.filter(|contact| is_sound && contact.peak_force.value > 0.0);
        let at_stop =
            self.settings.stop.zip(self.layout.contact).filter(|_| touched.is_some()).and_then(|(stop, i)| {
                let row = self
                    .method
                    .shape_places
                    .iter()
                    .position(|place| place.position.is_some_and(|x| near(x, stop.position)))?;
                let side = if stop.positive { 1.0 } else { -1.0 };
                Some((&channels[i], self.blocks.all[i][1] * side, row))
            });
        let force = self.layout.force.zip(power);
        // A stop whose force was not measured, or a force whose place in the modes is not known.
        let unknown_contact = contact
            .map_or_else(|| self.may_touch(), |_| !is_sound || (touched.is_some() && at_stop.is_none()))
            || (at_stop.is_none() && self.hands_over(modes, &modal));
        Balance {
            modes,
            modal,
            omega: self.method.omega,
            force: force.map(|(i, power)| (&channels[i], [power.value, power.uncertainty])),
            contact: at_stop,
            unknown_contact,
        }
        .report(findings);
    }

    /// Whether the motion may reach a stop whose force is not measured.
    fn may_touch(&self) -> bool {
        self.settings.stop.is_some_and(|stop| self.may_reach(&stop))
    }

    /// Whether the motion may reach a stop: unless its largest displacement there is known, and is less.
    pub fn may_reach(&self, stop: &Stop) -> bool {
        let here = |place: &Place| place.position.is_some_and(|x| near(x, stop.position));
        let row = self.method.shape_places.iter().position(here);
        let largest = |row: usize| self.values.motion.of(row).iter().map(|q| q.norm()).sum::<f64>();
        row.is_none_or(|row| largest(row) > SURELY_OPEN * stop.gap)
    }

    /// Whether damping takes power in higher harmonics that the force brings in by its fundamental: a contact or
    /// another law of force is there, whether it was described or not.
    fn hands_over(&self, modes: &LinearModes, modal: &[Complex64]) -> bool {
        let (Some(own), Some(power)) = (&self.values.modal, self.values.power) else { return false };
        let rates = modes.omegas().iter().zip(modes.damping_ratios()).map(|(omega, zeta)| zeta * omega);
        let first: f64 = rates.zip(modal).map(|(rate, eta)| rate * self.method.omega.powi(2) * eta.norm_sqr()).sum();
        let higher = own.dissipated - self.method.dissipated_by_noise(self.window.n_samples) - first;
        let brought = (power.active - power.fundamental).abs();
        higher - brought > HANDED_OVER * first
    }

    /// Reports a contact that closes far from where the stop is declared.
    pub fn gap(&self, contact: Option<&ContactFigures>, findings: &mut Vec<Finding>) {
        let Some((stop, contact)) = self.settings.stop.zip(contact).filter(|(stop, _)| stop.gap > 0.0) else { return };
        let Some((stiffness, history)) = contact.stiffness.as_ref().zip(contact.history.as_ref()) else { return };
        let side = if stop.positive { 1.0 } else { -1.0 };
        let found = side * stiffness.stop;
        let largest = history.displacement.iter().fold(stop.gap, |m, x| m.max(x.abs()));
        let Some(place) =
            self.layout.places.iter().find(|place| place.position.is_some_and(|x| near(x, stop.position)))
        else {
            return;
        };
        if (found - stop.gap).abs() <= GAP * largest {
            return;
        }
        let i = member(place, &self.record.channels, Quantity::Displacement).or(place.members.first().map(|(i, _)| *i));
        let Some(channel) = i.map(|i| &self.record.channels[i]) else { return };
        let factor = found / stop.gap;
        findings.push(Finding::WrongScale {
            channel: channel.name.clone(),
            factor,
            uncertainty: stiffness.stop_error / stop.gap,
            against: format!("the gap of the stop, {} m", stop.gap),
            declared: channel.unit.clone(),
            likely: likely_unit(channel, factor, 0.1),
            alternatives: vec!["the gap".into()],
        });
    }

    /// Reports a force cell whose peak is not that of the balance of the linear modes, where nothing else was found
    /// wrong with it.
    pub fn cell(&self, contact: &ContactFigures, balance: &BalanceFigures, findings: &mut Vec<Finding>) {
        let Some(channel) = self.layout.contact.map(|i| self.record.channels[i].name.clone()) else { return };
        let (cell, by_modes) = (contact.peak_force, balance.peak_force);
        let uncertainty = cell.uncertainty.hypot(by_modes.uncertainty);
        let off = (cell.value - by_modes.value).abs();
        let is_off = off > DISAGREES * by_modes.value && off > SURE * uncertainty;
        if cell.value > 0.0 && is_off && !findings.iter().any(|finding| finding.spoils(&channel)) {
            let (peak, balance) = (cell.value, by_modes.value);
            findings.push(Finding::CellDisagrees { channel, peak, balance, uncertainty });
        }
    }

    fn name_at(&self, place: &Place) -> String {
        place.members.first().map_or_else(String::new, |(i, _)| self.record.channels[*i].name.clone())
    }
}

/// Whether two positions are the same place.
fn near(a: f64, b: f64) -> bool {
    (a - b).abs() <= 1e-3 * a.abs().max(b.abs())
}
