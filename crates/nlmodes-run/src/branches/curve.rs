//! A branch as a curve of which files, figures and page are made.

use std::cell::RefCell;

use nlmodes::branches::{ComputedBranch, Histories, figure_points, reference_points};
use nlmodes::modal::{Coordinate, ModalBranch, Participation, TimeHistory};
use nlmodes::model::DofContact;
use nlmodes::report::StopLine;
use nlmodes::report::columns::ResponseRow;
use nlmodes_scene::assemble::{OpenStructure, StaticState};

use crate::Failure;
use crate::curve::{Curve, Grid, Instants};
use crate::physical::count_history_from_drawing;

/// A branch with the participation of linear modes at its points.
pub(crate) struct BranchCurve<'a> {
    computed: &'a ComputedBranch,
    participation: &'a [Participation],
    state: Option<&'a StaticState>,
    histories: RefCell<Histories<'a>>,
}

impl<'a> BranchCurve<'a> {
    /// `state` is what static loads and stops that press do to the structure.
    pub fn new(
        computed: &'a ComputedBranch,
        participation: &'a [Participation],
        state: Option<&'a StaticState>,
    ) -> Self {
        Self { computed, participation, state, histories: RefCell::new(Histories::of(computed)) }
    }
}

impl BranchCurve<'_> {
    /// Counts displacements of its contacts from the drawing.
    pub(super) fn count_from_drawing(&self, histories: &mut [TimeHistory]) {
        let sides = self.computed.structure.model().contacts().iter().map(|contact| contact.side.sign());
        for ((number, history), side) in histories.iter_mut().enumerate().zip(sides) {
            count_history_from_drawing(self.state, number, side, history);
        }
    }
}

impl Curve for BranchCurve<'_> {
    fn branch(&self) -> &ModalBranch {
        &self.computed.branch
    }

    fn participation(&self) -> &[Participation] {
        self.participation
    }

    fn response_row(&self, _: usize) -> Option<ResponseRow> {
        None
    }

    fn pictured(&self) -> Vec<usize> {
        figure_points(self.branch())
    }

    fn references(&self) -> Vec<usize> {
        reference_points(self.branch())
    }

    fn n_contacts(&self) -> usize {
        self.computed.structure.n_contacts()
    }

    fn stops(&self) -> Vec<StopLine> {
        let (structure, coordinates) = (&self.computed.structure, &self.branch().coordinates);
        let line = |(number, contact): (usize, &DofContact)| {
            let dof = structure.model().dofs()[contact.dof];
            let is_there = |c: &Coordinate| c.kind == dof.kind.name() && c.position == dof.position;
            // What is recorded is numbered, which of large structures is not every degree of freedom; displacements
            // that are recovered from free-interface modes have numbers of their own.
            let recorded = structure.recorded_index(contact.dof);
            let recorded = recorded.filter(|&k| coordinates.get(k).is_some_and(is_there));
            Some(StopLine {
                coordinate: recorded.or_else(|| coordinates.iter().position(is_there))?,
                position: contact.side.sign() * (contact.gap + self.state.map_or(0.0, |state| state.toward(number))),
                positive: contact.side.sign() > 0.0,
            })
        };
        structure.model().contacts().iter().enumerate().filter_map(line).collect()
    }

    fn histories(&self, point: usize, samples: usize, label: &str) -> Result<Vec<TimeHistory>, Failure> {
        let mut all = self.histories.borrow_mut().at(point, samples, label)?;
        self.count_from_drawing(&mut all);
        Ok(all)
    }

    fn contacts_at(&self, _: &OpenStructure, point: usize, grid: Grid) -> Result<Vec<TimeHistory>, Failure> {
        let mut contacts = match grid {
            Grid::Equidistant(count) => self.histories.borrow_mut().equidistant(point, count, "")?,
            Grid::Exact(samples) => self.histories.borrow_mut().at(point, samples, "")?,
        };
        self.count_from_drawing(&mut contacts);
        Ok(contacts)
    }

    fn instants_of(
        &self,
        open: &OpenStructure,
        point: usize,
        phases: &[f64],
        contacts: Vec<TimeHistory>,
    ) -> Result<Instants, Failure> {
        Ok(Instants::new(contacts, &self.branch().points[point].coefficients, open.modes.n_modes(), phases))
    }
}
