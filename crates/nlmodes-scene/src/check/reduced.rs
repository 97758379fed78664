//! A structure that was reduced elsewhere, and the contacts of its rows.

use std::path::Path;

use nlmodes_io::UnitSystem;

use super::contact::{law, laws_apart};
use super::matrices::parsed;
use crate::raw::{RawReduced, RawReducedScene, RawRowContact};
use crate::scene::{Flexibility, Numbers, Picture, ReducedModel, RowContact, Side};
use crate::{Diagnostic, Diagnostics};

/// What another program computed and the contacts, if all of it is sound; paths count from `base`.
pub fn check(raw: &RawReducedScene, base: &Path, diagnostics: &mut Diagnostics<'_>) -> Option<ReducedModel> {
    let structure = &raw.structure;
    let units = parsed::<UnitSystem>("units", structure.units.as_deref().unwrap_or("m-kg-s"), diagnostics);
    let flexibility = flexibility(structure, base, diagnostics);
    let written = raw.contact.as_deref().unwrap_or_default();
    let contacts = written.iter().enumerate().map(|(i, raw)| contact(raw, written, i, diagnostics));
    let all: Vec<Option<RowContact>> = contacts.collect();
    let laws = written.iter().enumerate().map(|(i, raw)| law(i, &raw.stop, None, diagnostics)).collect();
    let (row_contacts, law_contacts) = laws_apart(all, laws, diagnostics)?;
    Some(ReducedModel {
        frequencies_hz: within(base, &structure.frequencies_hz),
        contact_rows: within(base, &structure.contact_rows),
        flexibility: flexibility?,
        picture: structure.picture.as_ref().map(|raw| Picture {
            rows: within(base, &raw.rows),
            flexibility: raw.flexibility_m_n.as_ref().map(|numbers| within(base, numbers)),
            dofs: base.join(&raw.dofs),
            mesh: base.join(&raw.mesh),
        }),
        units: units?,
        row_contacts,
        law_contacts,
    })
}

/// The numbers, those of a file relative to the directory of the scene.
fn within(base: &Path, numbers: &Numbers) -> Numbers {
    match numbers {
        Numbers::File(address) => Numbers::File(address.clone().within(base)),
        other => other.clone(),
    }
}

fn flexibility(raw: &RawReduced, base: &Path, diagnostics: &mut Diagnostics<'_>) -> Option<Flexibility> {
    match (&raw.flexibility_m_n, &raw.residual_flexibility_m_n) {
        (Some(whole), None) => Some(Flexibility::Static(within(base, whole))),
        (None, Some(residual)) => Some(Flexibility::Residual(within(base, residual))),
        // What is missing was reported already.
        (None, None) => None,
        (Some(_), Some(_)) => {
            let diagnostic = Diagnostic::error("the flexibility of the rows is given twice");
            let help = "`flexibility_m_n` has the share of the modes in it, `residual_flexibility_m_n` has not";
            let label = "expected one of the two";
            diagnostics.put("structure.residual_flexibility_m_n", diagnostic.help(help), label);
            None
        }
    }
}

fn contact(
    raw: &RawRowContact,
    all: &[RawRowContact],
    i: usize,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<RowContact> {
    let place = |raw: &RawRowContact| (raw.row, raw.side.unwrap_or(Side::Positive));
    if let Some(first) = all[..i].iter().position(|before| place(before) == place(raw)) {
        let title = format!("`contact.{i}` is on the same side of row {} as `contact.{first}`", raw.row);
        let label = "expected another row, or the other side of this one";
        diagnostics.put(&format!("contact.{i}.row"), Diagnostic::error(title), label);
        return None;
    }
    let (row, side) = place(raw);
    let (stiffness, damping) = (raw.stop.stiffness_n_m, raw.stop.damping_n_s_m);
    Some(RowContact { row: row as usize, side, gap: raw.gap_m, stiffness, damping })
}
