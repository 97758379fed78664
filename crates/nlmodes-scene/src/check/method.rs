use super::contact::Body;
use super::{Subject, shooting};
use crate::raw::{DEFAULT_MAX_HARMONICS, RawAnalysis, RawMethod};
use crate::scene::{
    Accuracy, AtBranchPoint, Contact, ContactSolver, MassRule, Method, MethodKind, StructureKind, Support, Switching,
    Symmetry, free_dofs,
};
use crate::{Diagnostic, Diagnostics};

/// Fewest samples a period where the scene does not say.
const MIN_DEFAULT_SAMPLES: usize = 256;

/// Fewest harmonics that an accuracy chooses where the scene does not say.
const FEWEST: usize = 2;

/// The method of a structure whose contacts keep their mass in open modes, or lose it by a rule.
pub fn check(
    (method, is_open): (&RawMethod, bool),
    scene: &RawAnalysis,
    subject: &Subject<'_>,
    contacts: &[Contact],
    diagnostics: &mut Diagnostics<'_>,
) -> Option<Method> {
    let along = subject.places.straight();
    let kind = method.kind.unwrap_or(MethodKind::MsHbm);
    let mass_rule = mass_rule(method, kind, diagnostics);
    let stiffness = stiffness(method, subject.contact_tables, kind, diagnostics);
    let samples = samples(method, diagnostics);
    let accuracy = if kind == MethodKind::Shooting { None } else { accuracy(method, scene, diagnostics) };
    let mode = method.mode.map_or(1, |mode| mode as usize);
    let count = |loses: &dyn Fn(&Contact) -> bool| along.map(|body| modes(body, contacts, loses));
    // Nodes before stops with a law of force keep their mass in any case.
    let keeps_mass = is_open || mass_rule == MassRule::None;
    let available = count(&|contact| !keeps_mass && contact.hertz.is_none());
    if is_open && count(&|contact| contact.hertz.is_none() && contact.stiffness.is_none()) == Some(0) {
        nothing_left(
            "are at rigid stops; take more `structure.elements`, or give a stop its `stiffness_n_m`",
            diagnostics,
        );
        return None;
    }
    check_modes(mode, method.held_modes, available, diagnostics);
    if kind == MethodKind::Shooting {
        shooting::check(method, diagnostics);
        let is_rod = along.is_some_and(|body| body.raw.kind == StructureKind::Rod);
        let all = available.filter(|_| is_rod);
        shooting::check_size(method.held_modes.map(|n| n as usize).or(all), diagnostics);
    }
    Some(Method {
        kind,
        mode,
        harmonics: most_harmonics(method)?,
        accuracy,
        harmonics_list: harmonics_list(method),
        switching: method.switching.unwrap_or(Switching::Exact),
        samples: samples?,
        mass_redistribution: mass_rule,
        contact_solver: method.contact_solver.unwrap_or(ContactSolver::ActiveSet),
        contact_stiffness: stiffness,
        symmetry: method.symmetry.unwrap_or(Symmetry::Even),
        held_modes: method.held_modes.map(|n| n as usize),
    })
}

fn mass_rule(method: &RawMethod, kind: MethodKind, diagnostics: &mut Diagnostics<'_>) -> MassRule {
    let default = match kind {
        MethodKind::MsHbm | MethodKind::Shooting => MassRule::Drop,
        MethodKind::Hbm => MassRule::None,
    };
    let rule = method.mass_redistribution.unwrap_or(default);
    if (kind, rule) == (MethodKind::MsHbm, MassRule::None) {
        let path = "method.mass_redistribution";
        let diagnostic = Diagnostic::error(format!("`{path}` cannot be \"none\" with method \"ms-hbm\""));
        let diagnostic =
            diagnostic.help("ms-hbm rests on contact nodes without mass; \"none\" is for method.kind = \"hbm\"");
        diagnostics.put(path, diagnostic, "expected \"drop\", \"move\" or \"conserve\"");
    }
    rule
}

/// Contact stiffness of the stops that have none of their own; only harmonic balance has such a default.
fn stiffness(method: &RawMethod, contacts: usize, kind: MethodKind, diagnostics: &mut Diagnostics<'_>) -> Option<f64> {
    let path = "method.contact_stiffness_n_m";
    let keys = ["stiffness_n_m", "stiffness_hertz_n_m15"];
    let has_its_own = |i: usize| keys.iter().any(|key| diagnostics.has(&format!("contact.{i}.{key}")));
    let each_has_its_own = contacts > 0 && (0..contacts).all(has_its_own);
    let with_mass = kind == MethodKind::Shooting && method.mass_redistribution == Some(MassRule::None);
    match kind {
        MethodKind::Shooting if with_mass && !diagnostics.has(path) && !each_has_its_own => {
            let diagnostic = Diagnostic::error("contact nodes that keep their mass need elastic stops");
            let diagnostic = diagnostic.help(
                "this for all of them, or `stiffness_n_m` below each [[contact]]; \
                mass_redistribution = \"drop\", \"move\" or \"conserve\" takes rigid ones",
            );
            diagnostics.put(
                path,
                diagnostic,
                "expected `contact_stiffness_n_m` in this table: a number greater than 0, in N/m",
            );
        }
        MethodKind::Hbm if !diagnostics.has(path) && !each_has_its_own => {
            let diagnostic = Diagnostic::error(format!("`{path}` is missing"));
            let diagnostic = diagnostic.help(
                "hbm needs elastic stops: this for all of them, or `stiffness_n_m` below each [[contact]]; \
                    method.kind = \"ms-hbm\" takes rigid ones",
            );
            diagnostics.put(
                path,
                diagnostic,
                "expected `contact_stiffness_n_m` in this table: a number greater than 0, in N/m",
            );
        }
        MethodKind::MsHbm if diagnostics.has(path) => {
            let diagnostic = Diagnostic::warning(format!("`{path}` has no effect"));
            diagnostics.put(
                path,
                diagnostic,
                "only method.kind = \"hbm\" and \"shooting\" use it; `stiffness_n_m` of \
                a [[contact]] makes a stop elastic with ms-hbm too",
            );
        }
        _ => {}
    }
    method.contact_stiffness_n_m.filter(|_| kind != MethodKind::MsHbm)
}

/// The accuracy, with what it cannot be combined with.
fn accuracy(method: &RawMethod, scene: &RawAnalysis, diagnostics: &mut Diagnostics<'_>) -> Option<Accuracy> {
    let path = "method.max_harmonics";
    let Some(error) = method.accuracy else {
        if diagnostics.has(path) {
            let diagnostic = Diagnostic::warning(format!("`{path}` has no effect"));
            diagnostics.put(path, diagnostic, "only `accuracy` chooses a number of harmonics");
        }
        return None;
    };
    let max_harmonics = method.max_harmonics.unwrap_or(DEFAULT_MAX_HARMONICS) as usize;
    let list = harmonics_list(method);
    if list.len() > 1 {
        let diagnostic = Diagnostic::error("`method.accuracy` chooses the number of harmonics, which a list gives too");
        let diagnostic =
            diagnostic.help("leave out one of them; a single number of `harmonics` is the smallest that is used");
        diagnostics.put("method.harmonics", diagnostic, "expected a single number beside `accuracy`");
    } else if let Some(fewest) = list.first().filter(|fewest| **fewest > max_harmonics) {
        let diagnostic = Diagnostic::error("`method.harmonics` is more than `method.max_harmonics`");
        diagnostics.put("method.harmonics", diagnostic, format!("found {fewest}, expected at most {max_harmonics}"));
    }
    if method.switching == Some(Switching::Sampled) {
        let diagnostic = Diagnostic::error("`method.accuracy` does not account for the error of sampling");
        let diagnostic = diagnostic.help("leave `switching` out: exact instants have no such error and cost less");
        diagnostics.put("method.switching", diagnostic, "expected \"exact\" beside `accuracy`");
    }
    if scene.continuation.at_branch_point == AtBranchPoint::All {
        let path = "continuation.at_branch_point";
        let diagnostic = Diagnostic::error("`method.accuracy` cannot follow all half-branches of branch points");
        let diagnostic =
            diagnostic.help("give `method.harmonics` for a tree of branches; `accuracy` takes \"stay\" and \"switch\"");
        diagnostics.put(path, diagnostic, "found \"all\" beside `method.accuracy`");
    }
    Some(Accuracy { error, max_harmonics })
}

/// The numbers of harmonics, ascending, each once; the smallest that an accuracy may choose where only that is given.
fn harmonics_list(method: &RawMethod) -> Vec<usize> {
    let mut list: Vec<usize> = method.harmonics.iter().flatten().map(|h| *h as usize).collect();
    if method.harmonics.is_none() && method.accuracy.is_some() {
        list.push(FEWEST.min(method.max_harmonics.map_or(FEWEST, |most| most as usize)));
    }
    list.sort_unstable();
    list.dedup();
    list
}

fn most_harmonics(method: &RawMethod) -> Option<usize> {
    harmonics_list(method).last().copied()
}

/// The samples of the scene, at least 4 times the harmonics, or enough of them where the scene does not say.
fn samples(method: &RawMethod, diagnostics: &mut Diagnostics<'_>) -> Option<usize> {
    let harmonics = most_harmonics(method)?;
    let Some(samples) = method.samples.map(|n| n as usize) else {
        return Some((32 * harmonics).next_power_of_two().max(MIN_DEFAULT_SAMPLES));
    };
    if samples < 4 * harmonics && method.switching == Some(Switching::Sampled) {
        let path = "method.samples";
        let diagnostic = Diagnostic::error(format!("`{path}` is too small for {harmonics} harmonics")).help(
            "a harmonic needs 4 samples or more in each of its periods: raise `samples`, leave it out, or lower \
                `harmonics`",
        );
        diagnostics.put(
            path,
            diagnostic,
            format!("found {samples}, expected {} or more (4 × {harmonics})", 4 * harmonics),
        );
        return None;
    }
    Some(samples)
}

/// Number of linear modes of a structure some of whose contacts lose their mass.
fn modes(body: &Body<'_>, contacts: &[Contact], loses: &dyn Fn(&Contact) -> bool) -> usize {
    let Body { raw: structure, mesh } = body;
    let ends = [structure.start, structure.end.unwrap_or(Support::Free)];
    let dofs = free_dofs(structure.kind, mesh.elements(), ends);
    let stops = contacts.iter().filter(|contact| loses(contact));
    let mut places: Vec<_> = stops.map(|contact| (contact.node, contact.direction.name())).collect();
    places.sort_unstable();
    places.dedup();
    dofs.saturating_sub(places.len())
}

/// Refuses a structure in which no node with mass can move; `which` tells of the nodes that the supports leave free.
fn nothing_left(which: &str, diagnostics: &mut Diagnostics<'_>) {
    let diagnostic = Diagnostic::error("nothing with mass is left to move");
    let diagnostic = diagnostic.help(format!("all nodes that the supports leave free {which}"));
    let path = "structure.elements";
    diagnostics.put(path, diagnostic, format!("found {}", diagnostics.written(path)));
}

fn check_modes(mode: usize, held_modes: Option<u32>, available: Option<usize>, diagnostics: &mut Diagnostics<'_>) {
    let Some(modes) = available else { return };
    if modes == 0 {
        nothing_left("lose their mass at a stop; take more `structure.elements`", diagnostics);
        return;
    }
    if mode > modes {
        let diagnostic = Diagnostic::error(format!("`method.mode`: the structure has no mode {mode}"));
        let diagnostic =
            diagnostic.help("it has one for each degree of freedom with mass; more `structure.elements` give more");
        diagnostics.put("method.mode", diagnostic, format!("found {mode}, expected a whole number from 1 to {modes}"));
    }
    if let Some(wanted) = held_modes.filter(|wanted| *wanted as usize > modes) {
        let diagnostic = Diagnostic::error("`method.held_modes` is more than the structure has");
        diagnostics.put(
            "method.held_modes",
            diagnostic,
            format!("found {wanted}, expected a whole number from 1 to {modes}"),
        );
    }
}
