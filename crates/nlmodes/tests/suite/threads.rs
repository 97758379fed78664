//! What a parameter study needs: problems, solvers and results cross threads, and a branch is the same wherever it is
//! computed.

use crate::support;

use std::ops::ControlFlow;
use std::thread;

use nlmodes::branches::{BranchSettings, ComputedBranch, compute_branch};
use nlmodes::contact::{LcpMatrix, LcpSolver, Series, SeriesSolution};
use nlmodes::continuation::{Branch, BranchTree};
use nlmodes::experiment::extraction::RecordExtraction;
use nlmodes::experiment::records::Recording;
use nlmodes::fem::{MassMatrix, Mesh};
use nlmodes::hbm::{CondensedStructure, PeriodicSystem};
use nlmodes::linalg::{SparseCholesky, SparseMatrix};
use nlmodes::modal::{ModalBranch, TimeHistory};
use nlmodes::model::{MasslessContactModel, StructuralModel};
use nlmodes::rig::VirtualTest;
use nlmodes::timestep::PeriodicMotion;

fn crosses_threads<T: Send + Sync>() {}

/// What holds a workspace belongs to one thread at a time.
fn moves_between_threads<T: Send>() {}

#[test]
fn models_problems_and_results_cross_threads() {
    crosses_threads::<(Mesh, StructuralModel, MasslessContactModel, CondensedStructure)>();
    crosses_threads::<(SparseMatrix, SparseCholesky, LcpMatrix, Box<dyn LcpSolver>, SeriesSolution)>();
    crosses_threads::<(PeriodicMotion, TimeHistory)>();
    crosses_threads::<(Branch, BranchTree, ModalBranch, ComputedBranch)>();
    moves_between_threads::<(Series, PeriodicSystem)>();
    crosses_threads::<(Recording, RecordExtraction, VirtualTest)>();
}

#[test]
fn a_branch_is_the_same_in_any_thread() {
    let branch = |harmonics| {
        let settings = BranchSettings { harmonics, max_energy_ratio: Some(4.0), ..BranchSettings::default() };
        let model = support::rod(40, MassMatrix::Consistent);
        compute_branch(model, &settings, |_| ControlFlow::Continue(())).unwrap().branch.points
    };
    let together: Vec<_> = thread::scope(|scope| {
        let started: Vec<_> = [1, 2, 5].map(|harmonics| scope.spawn(move || branch(harmonics))).into();
        started.into_iter().map(|one| one.join().unwrap()).collect()
    });
    for (harmonics, points) in [1, 2, 5].into_iter().zip(together) {
        let alone = branch(harmonics);
        assert!(alone.len() > 5);
        assert_eq!(points.len(), alone.len());
        for (a, b) in points.iter().zip(&alone) {
            // To the last bit: nothing is shared between the threads, and no order of summation depends on them.
            assert_eq!(a.omega.to_bits(), b.omega.to_bits());
            assert_eq!(a.kinetic_energy.to_bits(), b.kinetic_energy.to_bits());
        }
    }
}
