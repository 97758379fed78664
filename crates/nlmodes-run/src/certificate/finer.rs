//! A few points solved again with twice as many harmonics, and with twice as many held modes.

use nlmodes::branches::{BranchError, ComputedBranch, Ended};
use nlmodes::hbm::CondensedStructure;
use nlmodes::modal::ModalPoint;
use nlmodes::model::reduction::OpenModes;
use nlmodes::response::FinerSettings;
use nlmodes_scene::counted;
use nlmodes_scene::scene::Scene;

use super::{
    BROKEN_OFF, CERTIFY, Check, ErrorSource, Looking, Number, Place, SourceKind, Sources, Worst, listed, named,
};

const HARMONICS: &str = "harmonics";
const MODES: &str = "modes";
/// Forces, impulses and amplitudes below this share of the largest ones of the branch do not count by themselves.
const FLOOR: f64 = 1e-2;

/// Most points that are solved again by `--certify`, and the largest number of unknowns of which so many are.
const MANY: usize = 48;
const SMALL: usize = 500;

/// How points are solved again without `--certify`: few suffice, which may take longer than the branch.
fn quick() -> FinerSettings {
    FinerSettings { enough: 3, tries: 10, share_of_curve: 10.0, ..FinerSettings::default() }
}

/// Points at which a contact opens and closes: at others the motion is linear, and more
/// harmonics change nothing.
pub(super) fn switching(points: &[ModalPoint]) -> Vec<usize> {
    let switches = |point: &ModalPoint| point.contacts.iter().any(|own| own.touches > 0 && own.closed_share < 1.0);
    (0..points.len()).filter(|&k| switches(&points[k])).collect()
}

/// Evenly chosen points beside these few, where solving them again costs next to nothing.
fn many(computed: &ComputedBranch, few: &[usize]) -> Vec<usize> {
    let harmonics = computed.branch.points.iter().map(|p| p.coefficients.n_harmonics()).max().unwrap_or(0);
    let contacts = computed.structure.model().contacts().len();
    let last = computed.branch.points.len().saturating_sub(1);
    let mut points = few.to_vec();
    if contacts * (4 * harmonics + 1) <= SMALL {
        points.extend((0..MANY).map(|k| k * last / (MANY - 1)));
        points.sort_unstable();
        points.dedup();
    }
    points
}

/// What twice as many harmonics change: where an accuracy was asked for, of the frequency by its estimates at all
/// points.
pub fn harmonics(computed: &ComputedBranch, few: &[usize], sources: Sources<'_>, look: Looking<'_>) -> Vec<Check> {
    let source = of_harmonics(computed);
    if computed.is_exact() {
        let words = "exact in time: no harmonics are left out";
        return Number::ALL.map(|n| Check::estimate(HARMONICS, (n, source.clone()), 0.0, words)).to_vec();
    }
    let all = computed.branch.points.len();
    let points = if sources.thorough {
        many(computed, few)
    } else {
        quick().order(few.iter().copied(), &switching(&computed.branch.points))
    };
    let words = |n: usize, lost: &str| match n {
        n if n >= all => format!("with twice as many harmonics at the same energy, all {all} points{lost}"),
        n => format!(
            "with twice as many harmonics at the same energy, {n} of {all} points; others may change by more{lost}"
        ),
    };
    let number = |k: usize| 2 * computed.branch.points[k].coefficients.n_harmonics();
    let solve = |k: usize| computed.refined(k, number(k), &computed.structure);
    let mut checks = again(
        (HARMONICS, "method.harmonics twice as large", source.clone()),
        computed,
        &points,
        words,
        solve,
        (look, sources),
    );
    if let Some(estimated) = estimated(computed, source) {
        checks.retain(|check| check.number != Some(Number::Frequency));
        checks.insert(0, estimated);
    }
    checks
}

/// Harmonics as the source of an error.
pub(super) fn of_harmonics(computed: &ComputedBranch) -> ErrorSource {
    let most = computed.branch.points.iter().map(|p| p.coefficients.n_harmonics()).max().unwrap_or(0);
    let source = too_few(most);
    if computed.is_exact() { ErrorSource { command: String::new(), ..source } } else { source }
}

/// So many harmonics as the source of an error.
fn too_few(harmonics: usize) -> ErrorSource {
    let command = format!("--set method.harmonics={}", 2 * harmonics);
    ErrorSource { kind: SourceKind::Harmonics, name: counted(harmonics, "harmonic"), command }
}

/// What twice as many harmonics change in responses that have these, at points that were solved again.
pub(crate) fn of_responses(compared: Compared, harmonics: usize, all: usize) -> Vec<Check> {
    let words = |n: usize, lost: &str| {
        format!(
            "with twice as many harmonics, {n} of {all} points, the largest motions and folds among them; others may \
             change by more{lost}"
        )
    };
    compared.checks((HARMONICS, "method.harmonics twice as large", too_few(harmonics)), words)
}

/// The estimates of the frequency's error that an accuracy has been asked for with.
fn estimated(computed: &ComputedBranch, source: ErrorSource) -> Option<Check> {
    let mut worst = Worst::default();
    let points = computed.branch.points.iter().enumerate();
    points.for_each(|(k, point)| worst.take(k, point.error_estimate));
    let words = "estimates of what harmonics and modes left out do, of all points that have one";
    let check = Check::estimate(HARMONICS, (Number::Frequency, source), worst.value, words).at(&worst);
    (!worst.all.is_empty()).then_some(check)
}

/// What modes left out do to the linear frequency of a mode with a contact closed: an estimate, or nothing where half
/// as many do not reach the mode.
pub(crate) fn open_modes(scene: &Scene, open: &OpenModes, contact: usize) -> Check {
    let (kept, mode) = (open.n_modes(), scene.method.mode);
    let (name, command) = (counted(kept, "mode"), more_modes(scene, kept));
    let of = (Number::Frequency, ErrorSource { kind: SourceKind::Modes, name, command });
    if open.has_all_modes() {
        return Check::estimate(MODES, of, 0.0, format!("open modes: all {kept} are kept"));
    }
    let mut closed = vec![false; open.n_contacts()];
    if let Some(closed) = closed.get_mut(contact) {
        *closed = true;
    }
    let error = mode.checked_sub(1).and_then(|mode| open.truncation_error(&closed, mode).ok());
    match error.filter(|error| error.is_finite()) {
        Some(error) => {
            let words = "open modes: estimate from half as many, linear frequency with the first contact closed";
            Check::estimate(MODES, of, error, words)
        }
        None => {
            let why = "open modes: half as many do not reach the mode that is computed";
            Check::missing(MODES, Some(Number::Frequency), why, "reduction.modes twice as large")
        }
    }
}

/// What makes twice as many open modes.
pub(crate) fn more_modes(scene: &Scene, kept: usize) -> String {
    match scene.structure.reduced() {
        Some(_) => format!("{} modes of the program that reduced the structure", 2 * kept),
        None => format!("--set reduction.modes={}", 2 * kept),
    }
}

/// What twice as many held modes change.
pub fn modes(computed: &ComputedBranch, points: &[usize], sources: Sources<'_>, look: Looking<'_>) -> Vec<Check> {
    let frequency = Number::Frequency;
    if let Some(open) = sources.open {
        return vec![open_modes(sources.scene, &open.modes, computed.grazing.contact)];
    }
    let structure = &computed.structure;
    let (kept, all) = (structure.n_held_modes(), structure.model().linear_dofs().len());
    let more = (2 * kept).min(all);
    let source = ErrorSource {
        kind: SourceKind::Modes,
        name: format!("{} with the contacts held", counted(kept, "mode")),
        command: format!("--set method.held_modes={more}"),
    };
    if kept >= all {
        return vec![Check::estimate(MODES, (frequency, source), 0.0, format!("all {all} held modes are kept"))];
    }
    if !sources.thorough {
        let most = computed.branch.points.iter().map(|p| p.coefficients.n_harmonics()).max().unwrap_or(0);
        let error = structure.held_modes_error(&computed.grazing, computed.grazing.omega, most);
        let words = format!("{kept} of {all} held modes: a guess of what the others do, at grazing");
        return vec![Check::estimate(MODES, (frequency, source), error, words)];
    }
    let how = "method.held_modes twice as large";
    let finer = match CondensedStructure::new(structure.model().clone(), more) {
        Ok(finer) => finer,
        Err(error) => return vec![Check::missing(MODES, Some(frequency), error.to_string(), how)],
    };
    let at = listed(points, &computed.branch.points);
    let words = |_, lost: &str| format!("with {more} of {all} held modes for {kept} at the same energy, {at}{lost}");
    let number = |k: usize| computed.branch.points[k].coefficients.n_harmonics();
    let solve = |k: usize| computed.refined(k, number(k), &finer);
    again((MODES, how, source), computed, points, words, solve, (look, sources))
}

/// Largest changes of the numbers where points are solved again.
fn again(
    (name, how, source): (&'static str, &'static str, ErrorSource),
    computed: &ComputedBranch,
    points: &[usize],
    words: impl Fn(usize, &str) -> String,
    solve: impl Fn(usize) -> Result<Option<ModalPoint>, BranchError>,
    (look, sources): (Looking<'_>, Sources<'_>),
) -> Vec<Check> {
    let missing = |why: &str, how| Number::ALL.map(|number| Check::missing(name, Some(number), why, how)).to_vec();
    let mut compared = Compared::default();
    let of = &computed.branch.points;
    let found = if sources.thorough {
        let each = points.iter().enumerate().map(|(number, &k)| match look(name, k, [number + 1, points.len()]) {
            true => solve(k).map(|found| (k, found)),
            false => Err(Ended.into()),
        });
        each.collect::<Result<Vec<_>, _>>()
    } else {
        quick().each(points, (sources.points_time, sources.watch), solve)
    };
    match found {
        _ if sources.watch.asks_to_end() => return missing(BROKEN_OFF, CERTIFY),
        Err(BranchError::Ended(_)) => return missing(BROKEN_OFF, CERTIFY),
        Err(error) => return missing(&error.to_string(), how),
        Ok(found) => found.into_iter().for_each(|(k, after)| {
            compared.take(Place::of(k, &of[k]), sizes(&of[k]), after.map(|after| changes(of, &of[k], &after)));
        }),
    }
    compared.checks((name, how, source), words)
}

/// Points that were solved again, and what changed.
#[derive(Debug, Default)]
pub(crate) struct Compared {
    worst: [Worst; 4],
    lost: Vec<Place>,
    solved: usize,
    /// Largest sizes of the motions that have one to compare with, and of those that have none.
    sizes: [[f64; 2]; 2],
}

/// Least share of the largest contact force and of the largest amplitude without a motion to compare with that points
/// with one must have come to, for their changes to stand for the others too: the hardest contacts change most.
const REACH: f64 = 0.5;

/// What makes a motion change with more harmonics: its contact force, N, and its modal amplitude, m·√kg.
pub(crate) fn sizes(point: &ModalPoint) -> [f64; 2] {
    [point.peak_contact_force, point.modal_amplitude]
}

impl Compared {
    /// Takes the changes of the numbers of a point of these sizes; without any no motion was found next to it.
    pub fn take(&mut self, place: Place, sizes: [f64; 2], found: Option<[Option<f64>; 4]>) {
        self.solved += 1;
        let largest = &mut self.sizes[usize::from(found.is_none())];
        largest.iter_mut().zip(sizes).for_each(|(largest, size)| *largest = largest.max(size));
        match found {
            Some(found) => self.worst.iter_mut().zip(found).for_each(|(worst, found)| worst.take(place.point, found)),
            None => self.lost.push(place),
        }
    }

    /// Whether the points with a motion to compare with stand for the others.
    fn stands_for_all(&self) -> bool {
        let [found, lost] = self.sizes;
        found.iter().zip(lost).all(|(found, lost)| *found >= REACH * lost)
    }

    /// How many have a motion to compare with.
    fn found(&self) -> usize {
        self.solved - self.lost.len()
    }

    /// The largest change of each number; none where only much smaller motions have one to compare with.
    pub fn checks(
        self,
        (name, how, source): (&'static str, &'static str, ErrorSource),
        words: impl Fn(usize, &str) -> String,
    ) -> Vec<Check> {
        let (found, stands_for_all) = (self.found(), self.stands_for_all());
        let Self { worst, lost, solved, .. } = self;
        let said = if lost.is_empty() { String::new() } else { format!("; {}", not_found(&lost)) };
        let words = words(solved, &said);
        let of = |(number, worst): (Number, Worst)| match worst.all.len() {
            0 if lost.is_empty() => Check::missing(name, Some(number), UNTOUCHED, TOUCHING),
            n if n == 0 || !stands_for_all => Check::missing(name, Some(number), not_found(&lost), how).without(&lost),
            n => {
                let words = match found - n {
                    0 => words.clone(),
                    silent => format!("{words}; {silent} of them touch no stop and say nothing of this number"),
                };
                Check::estimate(name, (number, source.clone()), worst.value, words).at(&worst).without(&lost)
            }
        };
        Number::ALL.into_iter().zip(worst).map(of).collect()
    }
}

/// That Newton's method leads from these points to no motion with twice as many and back.
pub(super) fn not_found(lost: &[Place]) -> String {
    format!("no motion with twice as many was found next to {}", named(lost))
}

/// What is reported where no point has a force.
pub(super) const UNTOUCHED: &str = "no stop opens or closes at the points that were looked at";
pub(super) const TOUCHING: &str = "a branch that goes on beyond the first touch or lift-off";

/// Relative changes of the numbers of one of all points of a branch, in their order; none of forces where no stop is
/// touched.
pub(crate) fn changes(all: &[ModalPoint], before: &ModalPoint, after: &ModalPoint) -> [Option<f64>; 4] {
    let [force, impulse] = floors(all);
    let amplitude = all.iter().fold(f64::MIN_POSITIVE, |m, p| m.max(p.modal_amplitude));
    let each = before.contacts.iter().zip(&after.contacts);
    // Before a rigid stop the largest displacement is the gap, whatever the harmonics.
    let displacement = relative(before.modal_amplitude, after.modal_amplitude, FLOOR * amplitude);
    let touches = touches(before.peak_contact_force.max(after.peak_contact_force), force);
    [
        Some(relative(before.omega, after.omega, 0.0)),
        Some(relative(before.peak, after.peak, 0.0).max(displacement)),
        touches.then(|| each.map(|(b, a)| relative(b.impulse, a.impulse, impulse)).fold(0.0, f64::max)),
        touches.then(|| relative(before.peak_contact_force, after.peak_contact_force, force)),
    ]
}

/// Force and impulse below which these do not count by themselves.
pub fn floors(points: &[ModalPoint]) -> [f64; 2] {
    let force = points.iter().map(|p| p.peak_contact_force).fold(0.0, f64::max);
    let impulse = points.iter().flat_map(|p| &p.contacts).map(|c| c.impulse).fold(0.0, f64::max);
    [force, impulse].map(|largest| (FLOOR * largest).max(f64::MIN_POSITIVE))
}

/// Whether a largest force is more than rounding, by the one below which forces do not count by themselves.
pub fn touches(force: f64, floor: f64) -> bool {
    force > 1e-7 * floor
}

/// `|before − after|` over the latter, or over `floor` where that is larger.
pub fn relative(before: f64, after: f64, floor: f64) -> f64 {
    if before == after { 0.0 } else { (before - after).abs() / after.abs().max(floor) }
}
