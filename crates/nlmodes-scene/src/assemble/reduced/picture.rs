//! The mesh of a structure that was reduced elsewhere, and the displacements of its nodes.

use std::collections::HashMap;

use nlmodes::linalg::Mat;
use nlmodes::model::reduction::{GivenFlexibility, modal_flexibility};
use nlmodes_io::{Component, DofLabel, LabelTable, Mesh};

use super::{ReducedProblem, by_modes, flexibility_scale, name, refuse, table};
use crate::assemble::StructureError;
use crate::rule::counted;
use crate::scene::{Numbers, Picture, ReducedModel};

const ROWS: &str = "picture.rows";
const FLEXIBILITY: &str = "picture.flexibility_m_n";

/// A mesh whose nodes move with displacements of a structure that was reduced elsewhere.
#[derive(Debug)]
pub struct PictureMesh {
    /// Places in m and elements.
    pub mesh: Mesh,
    /// Where each displacement is found among those of the structure.
    rows: HashMap<DofLabel, usize>,
}

impl PictureMesh {
    /// The displacement of a node along an axis, as one of the structure; none of what is at rest.
    pub fn row_of(&self, node: u64, component: Component) -> Option<usize> {
        self.rows.get(&DofLabel { node, component }).copied()
    }

    /// Number of displacements.
    pub fn n_rows(&self) -> usize {
        self.rows.len()
    }
}

/// The mesh, and with the rows and the flexibility of the structure those of the mesh behind them.
pub fn joined(
    (model, picture): (&ReducedModel, &Picture),
    omega_squared: &[f64],
    rows: &Mat<f64>,
    flexibility: GivenFlexibility,
) -> Result<(PictureMesh, Mat<f64>, GivenFlexibility), StructureError> {
    let (own, modes) = (rows.nrows(), rows.ncols());
    let (shapes, _) = by_modes((&picture.rows, ROWS), modes, model.units)?;
    let labels = LabelTable::read(&picture.dofs);
    let labels = labels.map_err(|source| refuse("picture.dofs", ReducedProblem::Read(source)))?.labels;
    if labels.len() != shapes.nrows() {
        let (of, found) = (name(&picture.rows), counted(shapes.nrows(), "displacement"));
        let expected = format!("{}, as {} lists", labels.len(), picture.dofs.display());
        return Err(refuse(ROWS, ReducedProblem::Shape { of, found, expected }));
    }
    let mesh = Mesh::read(&picture.mesh);
    let mut mesh = mesh.map_err(|source| refuse("picture.mesh", ReducedProblem::Read(source)))?;
    mesh.scale(model.units.length());
    if let Some(label) = labels.iter().find(|label| mesh.index_of(label.node).is_none()) {
        let (of, found) = (format!("{}: ", picture.mesh.display()), format!("no node {}", label.node));
        let expected = format!("the nodes of {}", picture.dofs.display());
        return Err(refuse("picture.mesh", ReducedProblem::Shape { of, found, expected }));
    }
    let all = stacked(rows, &shapes);
    let answers = match (&picture.flexibility, &flexibility) {
        (Some(numbers), _) => answers(numbers, (shapes.nrows(), own), model)?,
        (None, GivenFlexibility::Residual(_)) => Mat::zeros(shapes.nrows(), own),
        (None, GivenFlexibility::Static(_)) => {
            modal_flexibility(omega_squared, &all, own).subrows(own, shapes.nrows()).to_owned()
        }
    };
    let flexibility = match flexibility {
        GivenFlexibility::Static(of_rows) => GivenFlexibility::Static(stacked(&of_rows, &answers)),
        GivenFlexibility::Residual(of_rows) => GivenFlexibility::Residual(stacked(&of_rows, &answers)),
    };
    let rows = labels.into_iter().enumerate().map(|(i, label)| (label, own + i)).collect();
    Ok((PictureMesh { mesh, rows }, all, flexibility))
}

/// Static displacements of the nodes under unit forces along the rows, m/N.
fn answers(numbers: &Numbers, (n, rows): (usize, usize), model: &ReducedModel) -> Result<Mat<f64>, StructureError> {
    let table = table(numbers, FLEXIBILITY)?;
    let width = if rows == 1 { 1 } else { table.shape.last().copied().unwrap_or(0) };
    if table.values.len() != n * rows || width != rows {
        let expected = format!("{n} × {rows} numbers, a line for each displacement of the picture");
        return Err(refuse(FLEXIBILITY, ReducedProblem::Shape { of: name(numbers), found: table.size(), expected }));
    }
    let scale = flexibility_scale(numbers, model.units);
    Ok(Mat::from_fn(n, rows, |i, j| scale * table.values[i * rows + j]))
}

fn stacked(above: &Mat<f64>, below: &Mat<f64>) -> Mat<f64> {
    let first = above.nrows();
    Mat::from_fn(first + below.nrows(), above.ncols(), |i, j| match i.checked_sub(first) {
        None => above[(i, j)],
        Some(k) => below[(k, j)],
    })
}
