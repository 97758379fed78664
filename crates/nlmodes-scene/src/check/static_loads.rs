//! Weight, constant forces and heat: what must hold between their values.

use std::path::Path;

use super::matrices;
use super::response::Places;
use crate::raw::{RawAnalysis, RawGravity, RawStaticForce, RawThermal};
use crate::scene::{BaseDirection, ForcePlace, Gravity, Side, StaticForce, StaticLoads, Thermal};
use crate::{Diagnostic, Diagnostics};

/// The loads that are sound; paths count from `base`.
pub fn check(raw: &RawAnalysis, base: &Path, places: &Places<'_>, diagnostics: &mut Diagnostics<'_>) -> StaticLoads {
    if matches!(places, Places::Rows) {
        return of_rows(raw, places, diagnostics);
    }
    let is_of_files = matches!(places, Places::Nodes);
    let forces = raw.static_force.iter().flatten().enumerate();
    let forces = forces.filter_map(|(i, raw)| force(i, raw, places, diagnostics)).collect();
    let displacement = raw.static_displacement.as_ref().map(|raw| base.join(&raw.file));
    if displacement.is_some() && !is_of_files {
        let diagnostic = Diagnostic::error("`static_displacement` is of a structure from files");
        let label = "expected [gravity], [[static_force]] or [thermal]";
        diagnostics.put("static_displacement", diagnostic, label);
    }
    let beside = [
        ("gravity", raw.gravity.is_some()),
        ("static_force", raw.static_force.is_some()),
        ("thermal", raw.thermal.is_some()),
    ];
    if displacement.is_some()
        && let Some((key, _)) = beside.into_iter().find(|(_, there)| *there)
    {
        let diagnostic = Diagnostic::error(format!("`static_displacement` says already what `{key}` does"));
        let help = "it is the displacement under all static loads together, from another program";
        diagnostics.put(key, diagnostic.help(help), "expected either this table or [static_displacement]");
    }
    StaticLoads {
        gravity: raw.gravity.as_ref().and_then(|raw| gravity(raw, places, diagnostics)),
        forces,
        thermal: raw.thermal.as_ref().and_then(|raw| thermal(raw, base, is_of_files, diagnostics)),
        displacement,
    }
}

/// Those of a structure that was reduced elsewhere: constant forces on its rows. Of the mass and of the heat of places
/// between them its modes tell nothing.
fn of_rows(raw: &RawAnalysis, places: &Places<'_>, diagnostics: &mut Diagnostics<'_>) -> StaticLoads {
    let refused = [
        ("gravity", raw.gravity.is_some()),
        ("thermal", raw.thermal.is_some()),
        ("static_displacement", raw.static_displacement.is_some()),
    ];
    for (key, _) in refused.into_iter().filter(|(_, there)| *there) {
        let title = format!("`{key}` is not possible for a structure that was reduced elsewhere");
        let help = "a static step of the program that reduced it gives the clearance of each contact under this load, \
            with all contacts open: that is its `gap_m`";
        let label = "expected `gap_m` with this load in it, or [[static_force]] at a row";
        diagnostics.put(key, Diagnostic::error(title).help(help), label);
    }
    let forces = raw.static_force.iter().flatten().enumerate();
    let forces = forces.filter_map(|(i, raw)| force(i, raw, places, diagnostics)).collect();
    StaticLoads { forces, ..StaticLoads::default() }
}

fn gravity(raw: &RawGravity, places: &Places<'_>, diagnostics: &mut Diagnostics<'_>) -> Option<Gravity> {
    let direction = places.base_direction("gravity.direction", raw.direction.as_ref(), diagnostics)?;
    if matches!(direction, BaseDirection::Vector(_)) && raw.side.is_some() {
        let diagnostic = Diagnostic::error("`gravity.side` is of rods and beams");
        diagnostics.put("gravity.side", diagnostic, "the vector `direction` says the side already: leave this out");
        return None;
    }
    let sign = if raw.side == Some(Side::Negative) { -1.0 } else { 1.0 };
    Some(Gravity { acceleration: sign * raw.acceleration_m_s2, direction })
}

fn force(
    i: usize,
    raw: &RawStaticForce,
    places: &Places<'_>,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<StaticForce> {
    let path = |key: &str| format!("static_force.{i}.{key}");
    let keys = ["at_m", "node", "direction", "structure", "row"].map(path);
    let Some(nodes) = &raw.nodes else {
        let at = places.place(&raw.place, &keys, diagnostics)?;
        return Some(StaticForce { at: ForcePlace::One(at), force: raw.force_n });
    };
    if !matches!(places, Places::Nodes) {
        let diagnostic = Diagnostic::error(format!("`{}` are nodes of a structure from files", path("nodes")));
        let expected = match places {
            Places::Rows => "expected `row`, the number of a row from 1",
            _ => "expected `at_m`, a position along the axis",
        };
        diagnostics.put(&path("nodes"), diagnostic, expected);
        return None;
    }
    if raw.place.at_m.is_some() || raw.place.node.is_some() {
        let diagnostic = Diagnostic::error(format!("`static_force.{i}` says twice where it acts"));
        diagnostics.put(&path("nodes"), diagnostic, "expected one of `node` and `nodes`");
        return None;
    }
    let nodes = matrices::nodes(nodes);
    let direction = places.base_direction(&path("direction"), raw.place.direction.as_ref(), diagnostics)?;
    let BaseDirection::Vector(direction) = direction else { return None };
    Some(StaticForce { at: ForcePlace::Nodes { nodes, direction }, force: raw.force_n })
}

fn thermal(raw: &RawThermal, base: &Path, is_of_files: bool, diagnostics: &mut Diagnostics<'_>) -> Option<Thermal> {
    let (given, wanted, why) = match is_of_files {
        true => (
            raw.expansion_1_k.is_some() || raw.temperature_k.is_some(),
            "`forces`, a table node,component,force_n",
            "the program does not know the elements of a structure from files: have their thermal forces written",
        ),
        false => (
            raw.forces.is_some(),
            "`expansion_1_k` and `temperature_k`",
            "a rod or beam is warmer by the same everywhere; `forces` are of a structure from files",
        ),
    };
    let found = match (raw.expansion_1_k, raw.temperature_k, &raw.forces) {
        (Some(expansion), Some(temperature), None) if !is_of_files => Some(Thermal::Strain { expansion, temperature }),
        (None, None, Some(path)) if is_of_files => Some(Thermal::Forces(base.join(path))),
        _ => None,
    };
    if found.is_none() {
        let title = if given { "`thermal` does not fit the structure" } else { "`thermal` is not complete" };
        let diagnostic = Diagnostic::error(title).help(why);
        diagnostics.put("thermal", diagnostic, format!("expected {wanted} in this table"));
    }
    found
}
