use std::collections::{BTreeMap, HashMap, HashSet};

use super::{FeFiles, FeModel, NodeChoice, expanded, turned};
use crate::error::{Problem, ReadError, Result};
use crate::formats::{Format, MatrixData, read_matrix};
use crate::labels::{Component, DofLabel, LabelTable};
use crate::lower::LowerTriangle;
use crate::mesh::Mesh;

pub(super) fn read(files: &FeFiles) -> Result<FeModel> {
    let format = |address| files.format.map_or_else(|| Format::of(address), Ok);
    let (of_stiffness, of_mass) = (format(&files.stiffness)?, format(&files.mass)?);
    let table = files.dofs.as_deref().map(LabelTable::read).transpose()?;
    let mut mesh = files.mesh.as_deref().map(Mesh::read).transpose()?;
    let order = table.as_ref().map(|table| table.labels.len()).filter(|_| !names_rows(of_stiffness));
    let mut stiffness = read_matrix(&files.stiffness, of_stiffness, order)?;
    let labels = match (&stiffness.labels, &table) {
        (Some(labels), _) => labels.clone(),
        (None, Some(table)) => table.labels.clone(),
        (None, None) => return Err(unnamed(files, of_stiffness)),
    };
    let order = (!names_rows(of_mass)).then_some(labels.len());
    let mass = read_matrix(&files.mass, of_mass, order)?;
    let mut directions = std::mem::take(&mut stiffness.directions);
    let mass = along(files, mass, &labels, &stiffness.fixed)?;
    let mut places = std::mem::take(&mut stiffness.positions);
    places.extend(table.iter().flat_map(|table| &table.positions));
    places.values_mut().flatten().for_each(|x| *x *= files.units.length());
    let named = table.as_ref().filter(|_| !names_rows(of_stiffness));
    let mut model = FeModel::new(stiffness, mass, labels, places);
    if let Some(mesh) = &mut mesh {
        mesh.scale(files.units.length());
        mesh.scale_stress(files.units.stiffness(Component::X, Component::X) / files.units.length());
        check_mesh(files, mesh, &model.labels)?;
        turned::check(files, of_stiffness, &model.labels, mesh)?;
        directions.extend(std::mem::take(&mut mesh.directions));
    }
    if let Some(motion) = turned::motion(files, &model.labels, &directions)? {
        model.take_unknowns(&motion);
    }
    if let Some(means) = named.map(|table| expanded::means(files, table, mesh.as_ref())).transpose()?.flatten() {
        model.take_unknowns(&means.motion);
        (model.labels, model.within) = (means.labels, means.within);
    }
    if let Some(mesh) = mesh.as_ref().filter(|_| of_stiffness == Format::Calculix) {
        model.name_rotations(mesh);
    }
    if let Some(own) = &mut model.as_written {
        own.scale(&model.labels, &files.units);
    }
    model.rows = rows_of(&model.labels);
    model.mesh = mesh;
    hold(&mut model, files)?;
    model.leave_out_level();
    into_si(&mut model, files);
    check_diagonal(&model, files)?;
    check_exchanged(&model, files)?;
    Ok(model)
}

impl FeModel {
    fn new(stiffness: MatrixData, mass: LowerTriangle, labels: Vec<DofLabel>, places: HashMap<u64, [f64; 3]>) -> Self {
        let (stiffness, fixed) = (stiffness.lower, stiffness.fixed);
        let (fixed_mass, rows, within) = (Vec::new(), HashMap::new(), BTreeMap::new());
        let digits = [&stiffness, &mass].map(LowerTriangle::digits);
        Self {
            stiffness,
            mass,
            labels,
            mesh: None,
            fixed,
            held_on_diagonals: Vec::new(),
            digits,
            fixed_mass,
            places,
            rows,
            within,
            as_written: None,
        }
    }
}

impl FeModel {
    /// CalculiX names rotations of a rigid body as displacements of a node of their own.
    fn name_rotations(&mut self, mesh: &Mesh) {
        for label in self.labels.iter_mut().filter(|label| mesh.rotations.contains(&label.node)) {
            if let Some(axis) = label.component.translation() {
                label.component = [Component::RX, Component::RY, Component::RZ][axis];
            }
        }
    }
}

/// Whether a format names the rows of its matrices.
fn names_rows(format: Format) -> bool {
    matches!(format, Format::Abaqus | Format::Dmig)
}

pub(super) fn rows_of(labels: &[DofLabel]) -> HashMap<DofLabel, usize> {
    labels.iter().enumerate().map(|(row, label)| (*label, row)).collect()
}

fn unnamed(files: &FeFiles, format: Format) -> ReadError {
    let problem = Problem::Expected {
        expected: "a table of degrees of freedom beside it (key `dofs`): .dof, .mapping or .csv".into(),
        found: format!("a matrix of the format {format}, whose rows have no names"),
    };
    ReadError::whole(&files.stiffness.path, problem)
}

/// The mass in the rows of the stiffness.
fn along(files: &FeFiles, mass: MatrixData, labels: &[DofLabel], held: &[DofLabel]) -> Result<LowerTriangle> {
    let whole = |problem| ReadError::whole(&files.mass.path, problem);
    if mass.lower.n_entries() == 0 {
        return Err(whole(Problem::Expected { expected: "a mass".into(), found: "zeros only".into() }));
    }
    let Some(named) = mass.labels else {
        return match mass.lower.order() == labels.len() {
            true => Ok(mass.lower),
            false => {
                let (expected, found) = (labels.len() as u64, mass.lower.order() as u64);
                Err(whole(Problem::Size { what: "rows of the mass, as of the stiffness".into(), expected, found }))
            }
        };
    };
    let (rows, held) = (rows_of(labels), held.iter().collect::<HashSet<_>>());
    let place = |label: &DofLabel| match rows.get(label) {
        Some(row) => Ok(Some(*row)),
        None if held.contains(label) => Ok(None),
        None => Err(whole(Problem::Expected {
            expected: "nodes and directions that the stiffness has".into(),
            found: format!("{label}, which it has not"),
        })),
    };
    let to: Vec<Option<usize>> = named.iter().map(place).collect::<Result<_>>()?;
    Ok(mass.lower.placed(&to, labels.len()))
}

/// Some of the nodes must be nodes of the mesh; those within elements need not.
fn check_mesh(files: &FeFiles, mesh: &Mesh, labels: &[DofLabel]) -> Result<()> {
    if labels.iter().any(|label| mesh.index_of(label.node).is_some()) {
        return Ok(());
    }
    let path = files.mesh.as_deref().unwrap_or(&files.stiffness.path);
    let problem = Problem::Expected { expected: "the mesh of the matrices".into(), found: "no node of theirs".into() };
    Err(ReadError::whole(path, problem))
}

/// Takes out the rows of nodes that are to be held.
fn hold(model: &mut FeModel, files: &FeFiles) -> Result<()> {
    let mut nodes = HashSet::new();
    for choice in &files.fixed {
        match choice {
            NodeChoice::Set(name) => {
                nodes.extend(model.nodes_of_set(files, name)?);
                // Also those of which only unknowns within elements are left.
                let set = model.mesh.as_ref().and_then(|mesh| mesh.node_set(name));
                nodes.extend(set.unwrap_or_default());
            }
            NodeChoice::Node(node) if model.labels.iter().any(|label| label.node == *node) => {
                nodes.insert(*node);
            }
            NodeChoice::Node(node) => {
                let found = format!("node {node}, which is to be held and has none");
                let problem = Problem::Expected { expected: "nodes with rows in the matrices".into(), found };
                return Err(ReadError::whole(&files.stiffness.path, problem));
            }
        }
    }
    if nodes.is_empty() {
        return Ok(());
    }
    let within = model.within.iter().filter(|(_, owner)| nodes.contains(owner)).map(|(node, _)| *node);
    nodes.extend(within.collect::<Vec<_>>());
    let mut free = 0;
    let mut to = Vec::with_capacity(model.labels.len());
    for label in &model.labels {
        let held = nodes.contains(&label.node);
        to.push((!held).then_some(free));
        free += usize::from(!held);
    }
    // Of an entry between a row that stays and one that is held, either may be the row of the lower triangle.
    let across = model.mass.entries().filter_map(|(i, j, mass)| match (to[i], to[j]) {
        (Some(row), None) => Some((row, model.labels[j], mass)),
        (None, Some(row)) => Some((row, model.labels[i], mass)),
        _ => None,
    });
    model.fixed_mass = across.collect();
    model.keep_rows(&to, free);
    let (held, labels): (Vec<_>, Vec<_>) = model.labels.iter().copied().partition(|label| nodes.contains(&label.node));
    (model.rows, model.labels) = (rows_of(&labels), labels);
    model.fixed.extend(held);
    if model.labels.is_empty() {
        let problem = Problem::Expected { expected: "free nodes".into(), found: "none: all are held".into() };
        return Err(ReadError::whole(&files.stiffness.path, problem));
    }
    Ok(())
}

fn into_si(model: &mut FeModel, files: &FeFiles) {
    let component = |row: usize| model.labels[row].component;
    model.stiffness.scale(|i, j| files.units.stiffness(component(i), component(j)));
    model.mass.scale(|i, j| files.units.mass(component(i), component(j)));
    for (row, held, mass) in &mut model.fixed_mass {
        *mass *= files.units.mass(model.labels[*row].component, held.component);
    }
}

/// A row without stiffness belongs to nothing, and a file that was cut off ends before its last diagonal.
fn check_diagonal(model: &FeModel, files: &FeFiles) -> Result<()> {
    let diagonal = model.stiffness.diagonal();
    match diagonal.iter().position(|value| *value <= 0.0 || !value.is_finite()) {
        None => Ok(()),
        Some(row) => {
            let dof = format!("{} (row {})", model.labels[row], row + 1);
            Err(ReadError::whole(&files.stiffness.path, Problem::Diagonal { dof, value: diagonal[row] }))
        }
    }
}

/// Below this `K_ii/M_ii`, rad²/s², no row of a structure vibrates: that is the frequency which it has where all others
/// are held, above the lowest ones. Of a kilogram on a spring of a newton per metre it is 1.
const NO_STIFFNESS: f64 = 1e-3;

/// Matrices that were given for each other have the inverse of a structure's eigenvalues.
fn check_exchanged(model: &FeModel, files: &FeFiles) -> Result<()> {
    let (stiffness, mass) = (model.stiffness.diagonal(), model.mass.diagonal());
    let squares = stiffness.iter().zip(&mass).filter(|(_, mass)| **mass > 0.0).map(|(k, m)| k / m);
    let highest = squares.fold(f64::NEG_INFINITY, f64::max);
    if !(highest > 0.0 && highest < NO_STIFFNESS) {
        return Ok(());
    }
    let found = format!(
        "a structure whose rows, all others held, vibrate below {:.1e} Hz",
        highest.sqrt() / std::f64::consts::TAU
    );
    let expected =
        "a stiffness here and a mass in the file of the mass (are they exchanged? are the units those of the files?)"
            .into();
    Err(ReadError::whole(&files.stiffness.path, Problem::Expected { expected, found }))
}
