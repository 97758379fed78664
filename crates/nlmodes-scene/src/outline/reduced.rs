//! What is known of a structure that was reduced elsewhere, so that wrong units and exchanged rows show.

use super::matrices::{FIRST, LISTED, frequencies};
use super::structure::hertz;
use super::{Row, law, row};
use crate::assemble::{OpenStructure, PictureMesh};
use crate::rule::counted;
use crate::scene::{Numbers, Picture, ReducedModel, RowContact, Scene};
use crate::{number, short};

/// The rows of the structure and of its contacts.
pub fn rows(scene: &Scene, open: Option<&OpenStructure>) -> Vec<Row> {
    let (Some(model), Some(open)) = (scene.structure.reduced(), open) else { return Vec::new() };
    let Some(known) = &open.elsewhere else { return Vec::new() };
    let line = if known.is_by_modes { "mode" } else { "row" };
    let (modes, of_rows) = (counted(known.modes, "mode"), counted(known.rows, "row"));
    let mut lines = vec![
        row("structure", "reduced elsewhere"),
        row("modes", format!("{modes}, {}", source(&model.frequencies_hz))),
        row("rows", format!("{of_rows}, a line a {line}, {}", source(&model.contact_rows))),
        row("flexibility", flexibility(model)),
    ];
    lines.extend(open.picture.iter().zip(&model.picture).map(|(mesh, of)| row("picture", picture(mesh, of))));
    lines.extend([
        row("units", format!("{} in files, SI from here on", model.units)),
        row("frequencies", frequencies(scene, open)),
    ]);
    lines.extend((0..known.rows.min(LISTED)).map(|i| row("", share(open, i))));
    lines.extend(model.row_contacts.iter().enumerate().map(|(i, of)| row(format!("contact {i}"), contact(of))));
    let first = model.row_contacts.len();
    lines.extend(model.law_contacts.iter().enumerate().map(|(i, of)| {
        let (gap, law) = (number(of.contact.gap), hertz(&of.hertz));
        let text = format!("row {}, on the {} side, gap {gap} m, {law}", of.contact.row, of.contact.side.name());
        row(format!("contact {}", first + i), text)
    }));
    lines
}

fn flexibility(model: &ReducedModel) -> String {
    let what = match &model.flexibility {
        crate::scene::Flexibility::Static(_) => "static, the share of the modes included",
        crate::scene::Flexibility::Residual(_) => "what the modes leave",
    };
    format!("{what}, {}", source(model.flexibility.numbers()))
}

fn picture(mesh: &PictureMesh, of: &Picture) -> String {
    let (rows, nodes) = (counted(mesh.n_rows(), "displacement"), counted(mesh.mesh.places.len(), "node"));
    let statics = of.flexibility.as_ref().map_or("those of the modes alone".to_owned(), source);
    format!("{rows} of {nodes}, {}; static ones {statics}", source(&of.rows))
}

fn source(numbers: &Numbers) -> String {
    match numbers {
        Numbers::File(address) => address.to_string(),
        Numbers::List(_) | Numbers::Table(_) => "from the scene".to_owned(),
    }
}

/// Static flexibility of a row, and how much of it the modes have.
fn share(open: &OpenStructure, i: usize) -> String {
    let (modes, residual) = (&open.modes, open.modes.residual_flexibility(i));
    let elastic = modes.omega_squared().iter().enumerate().filter(|(_, square)| **square > 0.0);
    let modal: f64 = elastic.map(|(r, square)| modes.shapes()[(i, r)].powi(2) / square).sum();
    let first = modes.shapes().row(i).iter().take(FIRST).map(|y| short(*y)).collect::<Vec<_>>().join(", ");
    let whole = short(residual + modal);
    let percent = number((1000.0 * modal / (residual + modal)).round() / 10.0);
    let of_modes = if residual + modal > 0.0 { format!(", {percent} % of it in the modes") } else { String::new() };
    format!("row {}: {whole} m/N{of_modes}; {first} 1/√kg in the first", i + 1)
}

fn contact(of: &RowContact) -> String {
    let (gap, law) = (number(of.gap), law(of.stiffness));
    format!("row {}, on the {} side, gap {gap} m, {law}", of.row, of.side.name())
}
