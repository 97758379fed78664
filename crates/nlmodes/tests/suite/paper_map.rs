//! The page for readers of the paper names items that exist, and every equation.

use std::collections::BTreeSet;
use std::path::Path;

/// Uses each path, so that it has to exist, and gives it as text.
macro_rules! items {
    ($($path:path),* $(,)?) => {{
        $({ #[allow(unused_imports)] use $path as _; })*
        [$(stringify!($path)),*]
    }};
}

fn existing() -> BTreeSet<String> {
    // A method cannot be imported; it is named as a value.
    let _ = nlmodes::model::MasslessContactModel::with_spring_tips;
    let methods = [stringify!(nlmodes::model::MasslessContactModel::with_spring_tips)];
    let items = items![
        nlmodes::contact::ContactBody,
        nlmodes::contact::LcpMatrix,
        nlmodes::contact::Proximal,
        nlmodes::continuation::Continuation,
        nlmodes::experiment::extraction::ExcitationPower,
        nlmodes::experiment::phase_loop::PhaseLockedLoop,
        nlmodes::hbm::CondensedStructure,
        nlmodes::hbm::PeriodicSystem,
        nlmodes::modal::ContactStiffness,
        nlmodes::modal::HarmonicBasis,
        nlmodes::modal::HarmonicCoefficients,
        nlmodes::modal::LinearDissipation,
        nlmodes::modal::NonlinearModeShape,
        nlmodes::modal::Participation,
        nlmodes::modal::Restitution,
        nlmodes::modal::damping_coefficient,
        nlmodes::model::Contact,
        nlmodes::model::ContactLaw,
        nlmodes::model::Drop,
        nlmodes::model::MassRedistribution,
        nlmodes::model::MasslessContactModel,
        nlmodes::model::StructuralModel,
        nlmodes::rig::LinearStructure,
        nlmodes::rig::VirtualRig,
        nlmodes::branches::compute_branch,
        nlmodes::updating::update_parameters,
    ];
    items.into_iter().chain(methods).map(|path| path.replace(' ', "")).collect()
}

fn page() -> String {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../docs/paper.md");
    std::fs::read_to_string(&path).unwrap_or_else(|error| panic!("{}: {error}", path.display()))
}

/// Rows of the table of equations: equation and item.
fn rows(page: &str) -> Vec<(String, String)> {
    let table =
        page.lines().skip_while(|line| *line != "## Equations").skip(1).take_while(|line| !line.starts_with("## "));
    let cells = table.filter(|line| line.starts_with('|')).skip(2);
    cells
        .map(|line| line.split('|').map(str::trim).collect::<Vec<_>>())
        .map(|cells| (cells[1].to_owned(), cells[3].trim_matches('`').to_owned()))
        .collect()
}

#[test]
fn each_item_of_the_page_exists() {
    let named: BTreeSet<String> = rows(&page()).into_iter().map(|(_, item)| item).collect();
    assert_eq!(named, existing());
}

#[test]
fn each_equation_of_the_paper_has_an_item() {
    let mut found = BTreeSet::new();
    for (equation, _) in rows(&page()).into_iter().filter(|(equation, _)| equation.starts_with('(')) {
        for part in equation.split(", ") {
            let bounds: Vec<u32> = part.split('-').map(|n| n.trim_matches(['(', ')']).parse().unwrap()).collect();
            found.extend(bounds[0]..=bounds[bounds.len() - 1]);
        }
    }
    assert_eq!(found, (1..=30).collect());
}
