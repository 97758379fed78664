//! Derivatives by parameters against differences of whole curves that end at the same energy, frequency or level.

use std::sync::Arc;

use nlmodes::hbm::HertzStop;
use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes::response::{
    Damping, Dashpot, Event, Gradients, ParameterState, ResponseCurve, ResponseModel, ResponsePoint, ResponseSettings,
    conservative_mode, damped_mode, force_response, frequency_response, phase_resonance,
};
use nlmodes_linalg::sparse_from_triplets;
use nlmodes_model::{Contact, ContactLaw, Dof, DofKind, Side, StructuralModel};

/// A chain of masses on springs, the first one held by a wall, with stops at some of the masses.
#[derive(Debug, Clone, Copy)]
struct Chain {
    masses: usize,
    modes: usize,
    /// The masses with a stop, in their order.
    stops: &'static [usize],
    is_rigid: bool,
    /// How many of them, the last ones, have a law of force.
    laws: usize,
    /// Units of mass, length and time.
    units: [f64; 3],
}

/// What may vary, in the order of `values`.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum What {
    Gap,
    Stop,
    StopDamper,
    LawGap,
    LawStiffness,
    Exponent,
    Dissipation,
    Spring,
    Mass,
    Ratio,
    Dashpot,
    Force,
}

impl Chain {
    fn value(&self, what: What) -> f64 {
        let [kg, m, s] = self.units;
        match what {
            What::Gap => m,
            What::Stop => 6.0 * kg / (s * s),
            What::StopDamper => 0.7 * kg / s,
            What::LawGap => 0.95 * m,
            What::LawStiffness => 8.0 * kg / (s * s * m.sqrt()),
            What::Exponent => 1.5,
            What::Dissipation => 0.4 * s / m,
            What::Spring => 1.3 * kg / (s * s),
            What::Mass => 1.1 * kg,
            What::Ratio => 0.01,
            What::Dashpot => 0.05 * kg / s,
            What::Force => 0.16 * kg * m / (s * s),
        }
    }

    /// The chain with one value multiplied by `factor`; `used` are the dampers and ratios that it has at all.
    fn model(&self, used: &[What], varied: What, factor: f64) -> ResponseModel {
        let [kg, m, s] = self.units;
        let value = |what: What| self.value(what) * if what == varied { factor } else { 1.0 };
        let n = self.masses;
        let spring = |i: usize| if i == 1 { value(What::Spring) } else { (1.0 + 0.1 * i as f64) * kg / (s * s) };
        let mass = |i: usize| if i == 1 { value(What::Mass) } else { (1.0 - 0.05 * i as f64) * kg };
        let mut entries = vec![(0, 0, spring(0))];
        for i in 1..n {
            let pairs = [(i - 1, i - 1, 1.0), (i, i, 1.0), (i - 1, i, -1.0), (i, i - 1, -1.0)];
            entries.extend(pairs.map(|(a, b, sign)| (a, b, sign * spring(i))));
        }
        let stiffness = sparse_from_triplets(n, n, &entries).unwrap();
        let of_mass: Vec<_> = (0..n).map(|i| (i, i, mass(i))).collect();
        let masses = sparse_from_triplets(n, n, &of_mass).unwrap();
        let dofs = (0..n).map(|i| Dof { node: i + 1, position: i as f64, kind: DofKind::Axial }).collect();
        let stop = |(j, &at): (usize, &usize)| {
            let gap = if j == 0 { value(What::Gap) } else { (1.05 - 0.12 * j as f64) * m };
            let rigid = Contact::rigid(at, if j % 2 == 0 { Side::Positive } else { Side::Negative }, gap);
            let own = if j == 0 { value(What::Stop) } else { 9.0 * kg / (s * s) };
            if self.is_rigid { rigid } else { Contact { law: ContactLaw::Elastic { stiffness: own }, ..rigid } }
        };
        let linear = self.stops.len() - self.laws;
        let contacts = self.stops.iter().enumerate().take(linear).map(stop).collect();
        let model = StructuralModel::new(masses, stiffness, dofs, contacts).unwrap();
        let open = OpenModes::of_model(&model, ModeCount::Lowest(self.modes)).unwrap();
        let damping = match used.contains(&What::Ratio) {
            true => Damping::Ratios(vec![value(What::Ratio), 2.0 * self.value(What::Ratio)]),
            false => Damping::Ratios(vec![]),
        };
        let mut model = ResponseModel::new(open, &damping).unwrap();
        if used.contains(&What::Dashpot) {
            let at = vec![(n - 1, 1.0)];
            model.add_dashpots(&[Dashpot { at, damping: value(What::Dashpot) }]).unwrap();
        }
        if used.contains(&What::StopDamper) {
            model.add_stop_damper(0, value(What::StopDamper)).unwrap();
        }
        for (j, &at) in self.stops.iter().enumerate().skip(linear) {
            let first = j == linear;
            let of = |what: What| if first { value(what) } else { self.value(what) };
            let dissipation = if used.contains(&What::Dissipation) { of(What::Dissipation) } else { 0.0 };
            let law = HertzStop {
                stiffness: of(What::LawStiffness),
                exponent: of(What::Exponent),
                gap: of(What::LawGap) * if first { 1.0 } else { 0.6 },
                dissipation,
            };
            model.add_law(&vec![(at, if first { 1.0 } else { -1.0 })], Arc::new(law), 256).unwrap();
        }
        if used.contains(&What::Force) {
            model.push_force(1, 1.0, 1, 0.0).unwrap();
        }
        model.set_drive(1).unwrap();
        model
    }

    fn settings(&self, low: f64, high: f64) -> ResponseSettings {
        let [_, _, s] = self.units;
        ResponseSettings { harmonics: 5, stability: false, ..ResponseSettings::new([low / s, high / s]) }
    }
}

/// Relative step of a difference of curves, and that of the difference quotients of a structure.
const STEP: f64 = 2e-5;
const OF_STRUCTURE: f64 = 1.0 / 1024.0;

/// What a point has of a quantity.
type Value<'a> = &'a dyn Fn(&ResponsePoint) -> f64;

/// Followed curves: what the last point is at, from a model, the level of its load and settings.
type Follow<'a> = &'a dyn Fn(&ResponseModel, f64, &ResponseSettings) -> ResponsePoint;

/// What holds a point of a curve.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
enum Held {
    Energy,
    /// Frequency and level, of which neither is a quantity.
    Both,
    /// The level, along which the curve goes: it is no parameter.
    Level,
}

/// Compares the gradients of a point with differences of curves: frequency, amplitude of the drive point, contacts.
fn check(name: &str, chain: &Chain, used: &[What], settings: &ResponseSettings, follow: Follow<'_>, held: Held) {
    let watched = vec![(1, 1.0)];
    let is_forced = used.contains(&What::Force);
    for &what in used.iter().filter(|what| !(held == Held::Level && **what == What::Force)) {
        let value = chain.value(what);
        let level = |factor: f64| match (is_forced, what) {
            (false, _) => 0.0,
            (true, What::Force) => factor * chain.value(What::Force),
            (true, _) => chain.value(What::Force),
        };
        let base = chain.model(used, what, 1.0);
        let state = |times: f64, weight: f64| {
            let factor = 1.0 + times * OF_STRUCTURE;
            let (model, weight) = (chain.model(used, what, factor), weight / (12.0 * OF_STRUCTURE * value));
            ParameterState { model, level: level(factor), watched: Some(watched.clone()), weight }
        };
        let states = [state(1.0, 8.0), state(-1.0, -8.0), state(2.0, -1.0), state(-2.0, 1.0)];
        let gradients = Gradients {
            watched: base.watched(&watched, settings).unwrap(),
            changes: vec![base.change(&states, settings).unwrap()].into(),
        };
        let point = follow(&base, level(1.0), &settings.clone().with_gradients(gradients));
        let [found] = point.gradients[..] else { panic!("{name}, {what:?}: no gradient") };
        let end = |factor: f64| follow(&chain.model(used, what, factor), level(factor), settings);
        let [above, below] = [end(1.0 + STEP), end(1.0 - STEP)];
        let slope = |of: &dyn Fn(&ResponsePoint) -> f64| (of(&above) - of(&below)) / (2.0 * STEP * value);
        let largest = |p: &ResponsePoint| p.motion.contacts.iter().map(|c| c.peak_force).fold(0.0, f64::max);
        let mean = |p: &ResponsePoint| p.motion.contacts.iter().map(|c| c.mean_force).sum::<f64>();
        let impulse = |p: &ResponsePoint| mean(p) * std::f64::consts::TAU / p.motion.at.omega;
        let pairs: [(&str, f64, Value<'_>); 6] = [
            ("frequency", found.omega, &|p| p.motion.at.omega),
            ("amplitude", found.amplitude, &|p| p.drive.norm()),
            ("peak", found.peak, &|p| p.motion.contacts[0].peak),
            ("peak force", found.peak_force, &largest),
            ("impulse", found.impulse, &impulse),
            ("damping ratio", found.damping_ratio, &|p| p.motion.damping_ratio()),
        ];
        for (quantity, gradient, of) in pairs {
            // At a held frequency that of the table is another one: at a constant amplitude.
            let is_other = quantity == "frequency" && held == Held::Both;
            assert!(largest(&point) > 0.0, "{name}: no contact");
            if is_other || gradient.is_nan() || (quantity == "damping ratio" && is_forced) {
                continue;
            }
            let (difference, size) = (slope(of), of(&point).abs() / value);
            // The largest force of a stop that dissipates has ten digits. Second-order differences leave 1.5e-6.
            let is_rough = quantity.starts_with("peak") && used.contains(&What::StopDamper);
            let (least, tolerance) = if is_rough { (1e-1, 2e-5) } else { (1e-3, 2e-6) };
            let error = (gradient - difference).abs() / difference.abs().max(least * size);
            assert!(
                error < tolerance,
                "{name}, {what:?}, {quantity}: {gradient} by gradient, {difference}, {error:.1e}"
            );
        }
    }
}

/// Rigid and elastic, one stop and five, in two systems of units.
fn chains() -> Vec<(&'static str, Chain)> {
    let one = Chain { masses: 3, modes: 2, stops: &[2], is_rigid: true, laws: 0, units: SMALL };
    let five = Chain { masses: 5, modes: 4, stops: &[4, 3, 2, 1, 0], is_rigid: false, laws: 0, units: [1.0; 3] };
    vec![("a rigid stop", one), ("five stops", five)]
}

/// One with a law of force, and two behind three that are elastic.
fn chains_with_laws() -> Vec<(&'static str, Chain)> {
    let [(_, one), (_, five)] = [chains().remove(0), chains().remove(1)];
    let other = |chain: Chain, units: [f64; 3]| Chain { units, ..chain };
    let (one, five) = (Chain { laws: 1, ..one }, Chain { laws: 2, ..five });
    vec![
        ("a law", one),
        ("a law in other units", other(one, [1.0; 3])),
        ("laws beside stops", five),
        ("laws beside stops in other units", other(five, SMALL)),
    ]
}

/// A tenth of a gram, micrometres, milliseconds.
const SMALL: [f64; 3] = [2e-4, 3e-6, 7e-3];

fn last(curve: ResponseCurve) -> ResponsePoint {
    curve.points.into_iter().next_back().unwrap()
}

/// The energy at which a mode ends, as a multiple of that at grazing for the unchanged structure.
fn energy_ratio(chain: &Chain, model: &ResponseModel, times: f64) -> f64 {
    let base = chain.model(&[], What::Force, 1.0).linear_start(1).unwrap().scales().energy;
    times * base / model.linear_start(1).unwrap().scales().energy
}

#[test]
fn conservative_modes_at_constant_energy() {
    for (name, chain) in chains() {
        let settings = chain.settings(1e-2, 1e2);
        let used: &[What] = if chain.is_rigid {
            &[What::Gap, What::Spring, What::Mass]
        } else {
            &[What::Gap, What::Stop, What::Spring, What::Mass]
        };
        let follow = |model: &ResponseModel, _: f64, settings: &ResponseSettings| {
            last(conservative_mode(model, energy_ratio(&chain, model, 3.0), settings).unwrap())
        };
        check(name, &chain, used, &settings, &follow, Held::Energy);
    }
}

#[test]
fn damped_modes_at_constant_energy() {
    for (name, chain) in chains() {
        let settings = chain.settings(1e-2, 1e2);
        let follow = |model: &ResponseModel, _: f64, settings: &ResponseSettings| {
            last(damped_mode(model, energy_ratio(&chain, model, 3.0), settings).unwrap())
        };
        let used: &[What] = match chain.is_rigid {
            true => &[What::Gap, What::Spring, What::Mass, What::Ratio],
            false => &[What::Gap, What::StopDamper, What::Spring, What::Mass, What::Dashpot, What::Ratio],
        };
        check(name, &chain, used, &settings, &follow, Held::Energy);
    }
}

const LAW: [What; 3] = [What::LawGap, What::LawStiffness, What::Exponent];

/// With the gap and the stiffness of an elastic stop where there is one.
fn beside(chain: &Chain, others: &[What]) -> Vec<What> {
    let of_stop = if chain.is_rigid { &[][..] } else { &[What::Gap, What::Stop] };
    [&LAW, of_stop, others].concat()
}

#[test]
fn modes_before_stops_with_a_law_of_force() {
    for (name, chain) in chains_with_laws() {
        let settings = chain.settings(1e-2, 1e2);
        let follow = |model: &ResponseModel, _: f64, settings: &ResponseSettings| {
            last(conservative_mode(model, energy_ratio(&chain, model, 3.0), settings).unwrap())
        };
        let used = beside(&chain, &[What::Dissipation, What::Spring, What::Mass]);
        check(name, &chain, &used, &settings, &follow, Held::Energy);
        let follow = |model: &ResponseModel, _: f64, settings: &ResponseSettings| {
            last(damped_mode(model, energy_ratio(&chain, model, 3.0), settings).unwrap())
        };
        let used = beside(&chain, &[What::Dissipation, What::Spring, What::Mass, What::Ratio]);
        check(name, &chain, &used, &settings, &follow, Held::Energy);
    }
}

#[test]
fn responses_before_stops_with_a_law_of_force() {
    for (name, chain) in chains_with_laws() {
        let omega = first_frequency(&chain);
        let settings = chain.settings(0.6 * omega, 1.05 * omega);
        let others = [What::Dissipation, What::Spring, What::Mass, What::Ratio, What::Force];
        let follow = |model: &ResponseModel, level: f64, settings: &ResponseSettings| {
            last(frequency_response(model, level, settings).unwrap())
        };
        check(name, &chain, &beside(&chain, &others), &settings, &follow, Held::Both);
    }
}

/// Linear frequency of the first mode of the unchanged chain, rad in its unit of time.
fn first_frequency(chain: &Chain) -> f64 {
    chain.model(&[], What::Force, 1.0).linear_start(1).unwrap().omega * chain.units[2]
}

const FORCED: [&[What]; 2] = [
    &[What::Gap, What::Spring, What::Mass, What::Ratio, What::Force],
    &[What::Gap, What::Stop, What::Spring, What::Mass, What::Ratio, What::Dashpot, What::Force],
];

#[test]
fn responses_at_constant_frequency_and_level() {
    for (name, chain) in chains() {
        let omega = first_frequency(&chain);
        let settings = chain.settings(0.6 * omega, 1.05 * omega);
        let follow = |model: &ResponseModel, level: f64, settings: &ResponseSettings| {
            last(frequency_response(model, level, settings).unwrap())
        };
        check(name, &chain, FORCED[usize::from(!chain.is_rigid)], &settings, &follow, Held::Both);
    }
}

#[test]
fn a_damped_stop_in_a_response() {
    let (name, chain) = chains().remove(1);
    let omega = first_frequency(&chain);
    let settings = chain.settings(0.6 * omega, 1.05 * omega);
    let follow = |model: &ResponseModel, level: f64, settings: &ResponseSettings| {
        last(frequency_response(model, level, settings).unwrap())
    };
    check(name, &chain, &[What::Gap, What::StopDamper, What::Ratio, What::Force], &settings, &follow, Held::Both);
}

#[test]
fn responses_over_the_level_at_constant_level() {
    for (name, chain) in chains() {
        let omega = first_frequency(&chain);
        let [kg, m, s] = chain.units;
        let settings = chain.settings(0.6 * omega, 1.5 * omega);
        let follow = |model: &ResponseModel, _: f64, settings: &ResponseSettings| {
            let level = 0.3 * kg * m / (s * s);
            last(force_response(model, 0.9 * omega / s, level, settings).unwrap())
        };
        let used = FORCED[usize::from(!chain.is_rigid)];
        check(name, &chain, used, &settings, &follow, Held::Level);
    }
}

#[test]
fn phase_resonances_at_constant_level() {
    for (name, chain) in chains().into_iter().take(1) {
        let omega = first_frequency(&chain);
        let force = chain.value(What::Force);
        let settings = chain.settings(0.6 * omega, 2.0 * omega);
        let settings = ResponseSettings { levels: vec![0.5 * force], ..settings };
        let follow = |model: &ResponseModel, _: f64, settings: &ResponseSettings| {
            let curve = phase_resonance(model, force, settings).unwrap();
            curve.at_levels.into_iter().next().unwrap()
        };
        let used = FORCED[usize::from(!chain.is_rigid)];
        check(name, &chain, used, &settings, &follow, Held::Level);
    }
}

/// At a fold of a response over the frequency the derivative of the frequency at constant amplitude is that of the
/// fold.
#[test]
fn folds_of_responses_move_as_their_gradients_say() {
    for (name, chain) in chains() {
        let omega = first_frequency(&chain);
        let settings = chain.settings(0.6 * omega, 2.0 * omega);
        let used = FORCED[usize::from(!chain.is_rigid)];
        let follow = |model: &ResponseModel, level: f64, settings: &ResponseSettings| {
            let curve = frequency_response(model, level, settings).unwrap();
            curve.points.into_iter().find(|point| point.events.contains(&Event::Fold)).unwrap()
        };
        for what in [What::Gap, What::Spring, What::Ratio, What::Force] {
            let value = chain.value(what);
            let level = |factor: f64| chain.value(What::Force) * if what == What::Force { factor } else { 1.0 };
            let base = chain.model(used, what, 1.0);
            let states = [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)].map(|(times, weight)| {
                let factor = 1.0 + times * OF_STRUCTURE;
                let weight = weight / (12.0 * OF_STRUCTURE * value);
                let watched = Some(vec![(1, 1.0)]);
                ParameterState { model: chain.model(used, what, factor), level: level(factor), watched, weight }
            });
            let gradients = Gradients {
                watched: base.watched(&vec![(1, 1.0)], &settings).unwrap(),
                changes: vec![base.change(&states, &settings).unwrap()].into(),
            };
            let found = follow(&base, level(1.0), &settings.clone().with_gradients(gradients)).gradients[0].omega;
            let end = |factor: f64| follow(&chain.model(used, what, factor), level(factor), &settings).omega;
            let difference = (end(1.0 + 1e-4) - end(1.0 - 1e-4)) / (2e-4 * value);
            let error = (found / difference - 1.0).abs();
            assert!(error < 1e-5, "{name}, {what:?}: {found} by gradient, {difference}, {error:.1e}");
        }
    }
}

/// The frequency at an energy does not change with the units: of a mass on a spring before an elastic stop
/// `2 (k f_k + k_s f_ks) − g f_g = f` (of time) and `k f_k + k_s f_ks + m f_m = g f_g/2` (of mass), for any number of
/// harmonics.
#[test]
fn one_mass_on_a_spring_scales_with_its_units() {
    for units in [[1.0; 3], [2e-4, 3e-6, 7e-3]] {
        let chain = Chain { masses: 1, modes: 1, stops: &[0], is_rigid: false, laws: 0, units };
        let settings = chain.settings(1e-2, 1e2);
        // The only spring and mass of this chain take the place of those that vary in the others.
        let model = |factors: [f64; 4]| {
            let [kg, m, s] = units;
            let [k, stop, gap, mass] = factors;
            let of = |value: f64| sparse_from_triplets(1, 1, &[(0, 0, value)]).unwrap();
            let contact = Contact {
                law: ContactLaw::Elastic { stiffness: stop * 8.0 * kg / (s * s) },
                ..Contact::rigid(0, Side::Positive, gap * m)
            };
            let dof = Dof { node: 1, position: 0.0, kind: DofKind::Axial };
            let structure =
                StructuralModel::new(of(mass * kg), of(k * kg / (s * s)), vec![dof], vec![contact]).unwrap();
            let open = OpenModes::of_model(&structure, ModeCount::Lowest(1)).unwrap();
            ResponseModel::new(open, &Damping::Ratios(vec![])).unwrap()
        };
        let base = model([1.0; 4]);
        let changes = (0..4).map(|which| {
            let states = [(1.0, 8.0), (-1.0, -8.0), (2.0, -1.0), (-2.0, 1.0)].map(|(times, weight)| {
                let mut factors = [1.0; 4];
                factors[which] += times * OF_STRUCTURE;
                let weight = weight / (12.0 * OF_STRUCTURE);
                ParameterState { model: model(factors), level: 0.0, watched: None, weight }
            });
            base.change(&states, &settings).unwrap()
        });
        let gradients = Gradients { watched: None, changes: changes.collect::<Vec<_>>().into() };
        let curve = conservative_mode(&base, 20.0, &settings.clone().with_gradients(gradients)).unwrap();
        assert!(curve.points.len() > 10);
        for point in &curve.points {
            // Derivatives by the logarithms of the parameters.
            let [k, stop, gap, mass] = [0, 1, 2, 3].map(|which| point.gradients[which].omega);
            let f = point.motion.at.omega;
            assert!((2.0 * (k + stop) - gap - f).abs() < 1e-9 * f, "{k} {stop} {gap} {f}");
            assert!((k + stop + mass - 0.5 * gap).abs() < 1e-9 * f, "{k} {stop} {mass} {gap}");
        }
    }
}
