//! Conversion of the tables of a study file to a study.

mod fit;
mod list;
mod quantity;
mod said;
mod vary;

use std::path::{Path, PathBuf};

use nlmodes_scene::{Diagnostic, Diagnostics};

use crate::design::{MAX_DIMENSIONS, Points};
use crate::distribution::Tolerance;
use crate::raw::{RawDesign, RawStudy};
use crate::study::{Design, DesignKind, Study, Variable};

/// Maximum number of cases of a study.
const MAX_CASES: usize = 10_000_000;

/// Default of `design.box_deviations`: of a normal distribution 0.3 % lie outside.
const BOX_DEVIATIONS: f64 = 3.0;

/// The study, if there is no error; `name` is that of its file, and `scene` the text of the scene at a path.
pub fn study(
    raw: &RawStudy,
    name: &str,
    scene: impl FnOnce(&Path) -> Result<String, String>,
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Study> {
    let base = Path::new(name).parent().unwrap_or(Path::new("")).to_path_buf();
    let stem = Path::new(name).file_stem().map_or_else(|| "study".into(), |stem| stem.to_string_lossy().into_owned());
    let design = design(raw.design.as_ref().unwrap_or(&RawDesign::default()), diagnostics);
    let tables = raw.vary.as_deref().unwrap_or_default();
    let mut variables: Vec<Variable> = tables
        .iter()
        .enumerate()
        .filter_map(|(k, one)| vary::variable(one, (k, raw.fit.is_some()), &design, diagnostics))
        .collect();
    if let Some(file) = raw.design.as_ref().and_then(|design| design.file.as_ref()) {
        variables = list::variables(&base.join(file), &design, tables.len(), diagnostics).unwrap_or_default();
    } else if tables.is_empty() {
        let diagnostic = Diagnostic::error("nothing varies").help(
            "what varies is described under a heading [[vary]]: key = \"contact.0.gap_m\", values = [1e-3, \
                2e-3]",
        );
        diagnostics.put("vary", diagnostic, "");
    }
    vary::same_lengths(&variables, &design, diagnostics);
    let quantities = quantity::quantities(raw.quantity.as_deref().unwrap_or_default(), diagnostics);
    let fit = raw.fit.as_ref().and_then(|raw| fit::measured(raw, &base, diagnostics));
    names_differ(&variables, &quantities, diagnostics);
    let path = base.join(raw.scene.as_ref()?);
    let scene_text = scene(&path)
        .map_err(|reason| diagnostics.put("scene", Diagnostic::error("the scene of the study cannot be read"), reason))
        .ok()?;
    let directory = raw.output.as_ref().and_then(|output| output.directory.clone());
    let keep = raw.output.as_ref().and_then(|output| output.keep).unwrap_or_default();
    let study = Study {
        title: raw.title.clone().unwrap_or_else(|| stem.clone()),
        scene_name: path.display().to_string(),
        scene_text,
        design,
        variables,
        quantities,
        fit,
        directory: directory.map_or_else(|| Path::new("results").join(&stem), PathBuf::from),
        keep,
    };
    (!diagnostics.refuse()).then_some(())?;
    fits(&study, diagnostics);
    said::first_case(&study, diagnostics);
    Some(study)
}

fn design(raw: &RawDesign, diagnostics: &mut Diagnostics<'_>) -> Design {
    let kind = raw.kind.unwrap_or(DesignKind::Grid);
    let (sobol_indices, expansion) = (raw.sobol_indices.unwrap_or(false), raw.expansion.unwrap_or(false));
    if kind.is_sampled() && raw.samples.is_none() && !diagnostics.is_meant("design.samples") {
        let diagnostic = Diagnostic::error("`design.samples` is missing");
        diagnostics.put("design", diagnostic, format!("kind \"{}\" needs the number of points", kind.name()));
    }
    if sobol_indices && expansion {
        let diagnostic = Diagnostic::error("`design.sobol_indices` beside `design.expansion`, which has them too");
        let help = "`sobol_indices` computes them from many cases, `expansion` from a tenth of these with gradients";
        diagnostics.put("design.expansion", diagnostic.help(help), "expected one of the two");
    }
    let given = [("samples", raw.samples.is_some()), ("sobol_indices", sobol_indices), ("expansion", expansion)];
    for (key, is_given) in given {
        if is_given && !kind.is_sampled() {
            let diagnostic = Diagnostic::error(format!("`design.{key}` has no meaning for a {}", kind.name()));
            let help = "kind \"sobol\", \"latin-hypercube\" and \"random\" draw points";
            diagnostics.put(&format!("design.{key}"), diagnostic.help(help), "expected to be left out");
        }
    }
    let samples = if kind.is_sampled() { raw.samples.unwrap_or(1) as usize } else { 0 };
    let first_order = raw.first_order.unwrap_or(false) || kind == DesignKind::FirstOrder;
    let box_deviations = raw.box_deviations.unwrap_or(BOX_DEVIATIONS);
    let seed = u64::from(raw.seed.unwrap_or(1));
    Design { kind, samples, seed, sobol_indices, expansion, first_order, box_deviations }
}

/// Limits of counts and random draws.
fn fits(study: &Study, diagnostics: &mut Diagnostics<'_>) {
    for (k, variable) in study.variables.iter().enumerate().filter(|_| study.design.expansion) {
        if let Err(reason) = Tolerance::of(variable, &study.design) {
            let diagnostic = Diagnostic::error(format!("there are no polynomials of `{}`: {reason}", variable.name));
            diagnostics.put(&format!("vary.{k}"), diagnostic, "expected numbers or a distribution");
        }
    }
    let dimensions = study.variables.len() * if study.design.sobol_indices { 2 } else { 1 };
    if study.design.kind == DesignKind::Sobol && dimensions > MAX_DIMENSIONS {
        let diagnostic = Diagnostic::error(format!("a Sobol' sequence of {dimensions} dimensions is asked for"));
        diagnostics.put(
            "design.kind",
            diagnostic.help("\"latin-hypercube\" has no such limit"),
            format!("expected at most {MAX_DIMENSIONS}"),
        );
    }
    let lengths = study.variables.iter().map(|variable| crate::design::n_listed(variable) as f64);
    let grid = if study.design.kind == DesignKind::Grid { lengths.product() } else { 0.0 };
    let drawn =
        study.design.samples as f64 * if study.design.sobol_indices { study.variables.len() as f64 + 2.0 } else { 1.0 };
    let cases = f64::max(grid, drawn);
    if cases > MAX_CASES as f64 {
        let diagnostic = Diagnostic::error(format!("the study has {cases:.0} cases"));
        diagnostics.put("design", diagnostic, format!("expected at most {MAX_CASES}"));
    } else if Points::new(study).is_empty() {
        diagnostics.put("design", Diagnostic::error("the study has no cases"), "");
    }
}

/// Columns of the table have unique names.
fn names_differ(variables: &[Variable], quantities: &[crate::study::Quantity], diagnostics: &mut Diagnostics<'_>) {
    let mut known: Vec<&str> = crate::collect::FIXED.to_vec();
    let named = variables.iter().enumerate().map(|(k, variable)| (format!("vary.{k}"), variable.name.as_str()));
    let wanted = quantities.iter().enumerate().map(|(k, quantity)| (format!("quantity.{k}"), quantity.name.as_str()));
    let errors: Vec<String> = quantities.iter().map(|quantity| crate::table::error_column(&quantity.name)).collect();
    known.extend(errors.iter().map(String::as_str));
    for (path, name) in named.chain(wanted) {
        if known.contains(&name) {
            let diagnostic = Diagnostic::error(format!("two columns of the table would be called `{name}`"));
            diagnostics.put(
                &format!("{path}.name"),
                diagnostic.help("`name` gives a column another name"),
                "expected a name of its own",
            );
        }
        known.push(name);
    }
}
