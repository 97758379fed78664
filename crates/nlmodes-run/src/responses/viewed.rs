//! A response as a curve of which files, figures and page are made.

use std::cmp::Ordering;
use std::f64::consts::TAU;

use nlmodes::branches::way_points;
use nlmodes::linalg::Mat;
use nlmodes::modal::{ContactInstant, ModalBranch, ModalPoint, Participation, TimeHistory};
use nlmodes::report::StopLine;
use nlmodes::report::columns::{ResponseOf, ResponseRow};
use nlmodes::response::{ContactPattern, ResponsePoint};
use nlmodes_scene::assemble::OpenStructure;
use nlmodes_scene::scene::{ResponseKind, Scene};

use super::convert::modal_coordinates;
use super::curves::ComputedResponse;
use crate::Failure;
use crate::curve::{Curve, Grid, Instants};
use crate::model::Model;
use crate::physical::count_history_from_drawing;

/// A curve of motions of the model of a scene.
pub struct Viewed<'a> {
    model: &'a Model,
    scene: &'a Scene,
    computed: &'a ComputedResponse,
    /// Number of the curve in the run, from 0, and of its first point in `branch.csv`.
    number: usize,
    first: usize,
}

/// All curves with points, in the order of the run.
pub fn viewed<'a>(scene: &'a Scene, model: &'a Model, curves: &'a [ComputedResponse]) -> Vec<Viewed<'a>> {
    let mut next = 0;
    let all = curves.iter().enumerate().map(|(number, computed)| {
        let first = next;
        next += computed.branch.points.len();
        Viewed { model, scene, computed, number, first }
    });
    all.filter(|one| !one.computed.branch.points.is_empty()).collect()
}

impl Viewed<'_> {
    /// What was followed.
    pub fn kind(&self) -> ResponseKind {
        self.computed.kind
    }

    /// Number of the curve in the run, from 0.
    pub fn number(&self) -> usize {
        self.number
    }

    /// The motion of a point, and how many periods of the load are one of it.
    fn motion(&self, point: usize) -> Result<(&ResponsePoint, usize), Failure> {
        let found = self.computed.motions.as_ref().and_then(|curve| curve.points.get(point));
        let subharmonic = self.scene.responses[self.computed.response].subharmonic;
        Ok((found.ok_or("there is no such point")?, subharmonic))
    }

    fn pattern(&self, point: usize) -> Result<(ContactPattern<'_>, f64), Failure> {
        let (found, subharmonic) = self.motion(point)?;
        Ok((self.model.response().contact_pattern(&found.motion, subharmonic)?, found.motion.at.omega))
    }

    /// The contacts at these phases (rad), each in a segment with unchanged closed contacts; displacements with these
    /// signs.
    fn contacts(
        &self,
        point: usize,
        label: &str,
        sides: &[f64],
        phases: impl FnOnce(&[[f64; 2]]) -> Vec<(f64, usize)>,
    ) -> Result<Vec<TimeHistory>, Failure> {
        let (pattern, omega) = self.pattern(point)?;
        let stretches = pattern.stretches();
        // Stops where static loads have them; they are counted from the drawing at the end.
        let toward = |contact| self.model.state.as_ref().map_or(0.0, |state| state.toward(contact));
        let gaps = self.model.gaps.iter().enumerate().map(|(contact, gap)| gap - toward(contact));
        let empty = |(side, gap): (&f64, f64)| TimeHistory::empty(label, side * gap);
        let mut all: Vec<TimeHistory> = sides.iter().zip(gaps).map(empty).collect();
        let mut last = f64::NEG_INFINITY;
        for (tau, stretch) in phases(&stretches) {
            last = (tau / omega).max(f64::next_up(last));
            for ((history, state), side) in all.iter_mut().zip(pattern.state(tau, stretch)).zip(sides) {
                history.push(last, state.motion.map(|m| side * m), state.force.max(0.0));
            }
        }
        let ends = stretches.iter().enumerate();
        let middles: Vec<Vec<bool>> =
            ends.map(|(k, [a, b])| pattern.state(0.5 * (a + b), k).iter().map(|s| s.force > 0.0).collect()).collect();
        for (i, history) in all.iter_mut().enumerate() {
            for (pair, ends) in middles.windows(2).zip(&stretches).filter(|(pair, _)| pair[0][i] != pair[1][i]) {
                history.instants.push(ContactInstant { time: ends[1] / omega, touching: pair[1][i] });
            }
        }
        for (contact, (history, side)) in all.iter_mut().zip(sides).enumerate() {
            count_history_from_drawing(self.model.state.as_ref(), contact, *side, history);
        }
        Ok(all)
    }

    /// The point with the largest contact force, or with the largest amplitude if nothing is touched.
    fn hardest(&self) -> usize {
        let points = &self.computed.branch.points;
        (0..points.len()).max_by(|a, b| harder(&points[*a], &points[*b])).unwrap_or(0)
    }
}

/// Which of two motions has the larger contact force, or the larger amplitude if these are equal.
fn harder(a: &ModalPoint, b: &ModalPoint) -> Ordering {
    let forces = a.peak_contact_force.total_cmp(&b.peak_contact_force);
    forces.then_with(|| a.fundamental.abs().total_cmp(&b.fundamental.abs()))
}

/// The curve of which pictures and time histories are made: of those of the first response, that with the largest
/// contact force; by its place among these.
pub fn pictured_of(curves: &[Viewed<'_>]) -> usize {
    let hardest = |place: usize| &curves[place].computed.branch.points[curves[place].hardest()];
    let of_first = (0..curves.len()).filter(|place| curves[*place].computed.response == 0);
    // The first of several that are equal.
    of_first.rev().max_by(|a, b| harder(hardest(*a), hardest(*b))).unwrap_or(0)
}

impl Curve for Viewed<'_> {
    fn first(&self) -> usize {
        self.first
    }

    fn branch(&self) -> &ModalBranch {
        &self.computed.branch
    }

    fn participation(&self) -> &[Participation] {
        &self.computed.participation
    }

    fn response_row(&self, point: usize) -> Option<ResponseRow> {
        let of = ResponseOf {
            response: self.computed.response + 1,
            kind: self.computed.kind.name(),
            curve: self.number,
            name: &self.computed.branch.label,
            is_detached: self.computed.is_detached,
            unit: self.model.unit,
        };
        self.computed.branch.points.get(point).map(|point| ResponseRow::of(of, point))
    }

    /// On the way to the motion with the largest contact force.
    fn pictured(&self) -> Vec<usize> {
        way_points(self.branch(), self.hardest())
    }

    fn references(&self) -> Vec<usize> {
        vec![self.hardest()]
    }

    fn n_contacts(&self) -> usize {
        self.model.gaps.len()
    }

    fn stops(&self) -> Vec<StopLine> {
        let line = |(i, gap): (usize, &f64)| {
            Some(StopLine {
                coordinate: self.model.contact_coordinates.get(i).copied().flatten()?,
                position: self.model.sides[i] * gap,
                positive: self.model.sides[i] > 0.0,
            })
        };
        self.model.gaps.iter().enumerate().filter_map(line).collect()
    }

    fn histories(&self, point: usize, samples: usize, label: &str) -> Result<Vec<TimeHistory>, Failure> {
        self.contacts(point, label, &self.model.sides, |stretches| TimeHistory::exact_instants(stretches, samples))
    }

    fn load_shapes(&self) -> Vec<Vec<f64>> {
        self.model.response().load_shapes()
    }

    fn contacts_at(&self, open: &OpenStructure, point: usize, grid: Grid) -> Result<Vec<TimeHistory>, Failure> {
        let sides: Vec<f64> = open.reduced.direction_of().iter().map(|(_, toward)| *toward).collect();
        self.contacts(point, "", &sides, |stretches| match grid {
            Grid::Exact(samples) => TimeHistory::exact_instants(stretches, samples),
            Grid::Equidistant(count) => {
                let phases = (0..=count).map(|k| TAU * k as f64 / count as f64);
                let within = |tau: f64| stretches.partition_point(|ends| ends[1] < tau).min(stretches.len() - 1);
                phases.map(|tau| (tau, within(tau))).collect()
            }
        })
    }

    fn instants_of(
        &self,
        open: &OpenStructure,
        point: usize,
        phases: &[f64],
        contacts: Vec<TimeHistory>,
    ) -> Result<Instants, Failure> {
        let (found, subharmonic) = self.motion(point)?;
        let mut modal = modal_coordinates(&found.motion, open.modes.n_modes());
        // Motions are about the state at rest; what that has beyond the modes is added to displacements.
        let still = open.state.iter().flat_map(|state| &state.modal);
        for (mode, by) in still.take(open.modes.n_modes()).enumerate() {
            modal.of_mut(mode)[0] += by;
        }
        let coordinates = |phase: &f64| self.model.response().load_coordinates(&found.motion, subharmonic, *phase);
        let columns: Vec<Vec<f64>> = phases.iter().map(coordinates).collect();
        let loads = Mat::from_fn(columns.first().map_or(0, Vec::len), phases.len(), |j, k| columns[k][j]);
        Ok(Instants { loads, ..Instants::new(contacts, &modal, open.modes.n_modes(), phases) })
    }
}
