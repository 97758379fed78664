//! A branch as a curve of which files, figures and page are made.

use std::cell::RefCell;

use nlmodes::branches::{ComputedBranch, Histories, figure_points, reference_points};
use nlmodes::modal::{Coordinate, ModalBranch, Participation, TimeHistory};
use nlmodes::model::DofContact;
use nlmodes::report::StopLine;
use nlmodes::report::columns::ResponseRow;
use nlmodes_scene::assemble::OpenStructure;

use crate::Failure;
use crate::curve::{Curve, Frames};

/// A branch with the participation of linear modes at its points.
pub(crate) struct BranchCurve<'a> {
    computed: &'a ComputedBranch,
    participation: &'a [Participation],
    histories: RefCell<Histories<'a>>,
}

impl<'a> BranchCurve<'a> {
    pub fn new(computed: &'a ComputedBranch, participation: &'a [Participation]) -> Self {
        Self { computed, participation, histories: RefCell::new(Histories::of(computed)) }
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
        let line = |contact: &DofContact| {
            let dof = structure.model().dofs()[contact.dof];
            let is_there = |c: &Coordinate| c.kind == dof.kind.name() && c.position == dof.position;
            // What is recorded is numbered, which of large structures is not every degree of freedom; displacements
            // that are recovered from free-interface modes have numbers of their own.
            let recorded = structure.recorded_index(contact.dof);
            let recorded = recorded.filter(|&k| coordinates.get(k).is_some_and(is_there));
            Some(StopLine {
                coordinate: recorded.or_else(|| coordinates.iter().position(is_there))?,
                position: contact.side.sign() * contact.gap,
                positive: contact.side.sign() > 0.0,
            })
        };
        structure.model().contacts().iter().filter_map(line).collect()
    }

    fn histories(&self, point: usize, samples: usize, label: &str) -> Result<Vec<TimeHistory>, Failure> {
        Ok(self.histories.borrow_mut().at(point, samples, label)?)
    }

    fn frames(&self, open: &OpenStructure, point: usize, dofs: &[usize], frames: usize) -> Result<Frames, Failure> {
        let contacts = self.histories.borrow_mut().equidistant(point, frames, "")?;
        Ok(Frames::new(contacts, &self.branch().points[point].coefficients, open, dofs, frames))
    }
}
