//! Forced responses, phase resonance and damped nonlinear modes.

use std::f64::consts::{FRAC_PI_2, TAU};

use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes::model::{Contact, Drop, MasslessContactModel, Side};
use nlmodes::response::{
    Damping, EndReason, Event, ResponseCurve, ResponseModel, ResponsePoint, ResponseSettings, damped_mode,
    force_response, frequency_response, phase_resonance,
};
use num_complex::Complex64;

use super::forced_oscillator::{ForcedOscillator, Response};
use super::tools::{Bilinear, bisect, springs};
use super::{Case, Check, Kind};
use crate::Failure;

const HARMONICS: &str = "the harmonics beyond 40: ~ 40⁻⁵ of the fundamental, 40⁻³ of the share of contact";
const ROUNDING: &str = "an identity at any number of harmonics: rounding, over the residual";

pub(super) const CASES: &[Case] = &[
    Case {
        name: "forced-rod-upper",
        problem: "Rod of two elements, `EA = ρA = L = g₀ = 1`, tip massless, 1 % modal damping with the stop open, \
            0.2 cos Ωt at its middle, 0.42 Hz, 40 harmonics.\nUpper response: fundamental, share of contact, lag, \
            largest multiplier.",
        kind: Kind::Exact,
        reference: "damped harmonic arcs, joined by Newton's method; the multiplier from the product of their matrix \
            exponentials",
        remark: "",
        compute: || forced_rod(false),
    },
    Case {
        name: "forced-rod-middle",
        problem: "The same, the response between both folds, come to from the upper end of the window.\nFundamental, \
            share of contact, lag, largest multiplier.",
        kind: Kind::Exact,
        reference: "as before",
        remark: "",
        compute: || forced_rod(true),
    },
    Case {
        name: "forced-rod-phase-resonance",
        problem: "The same rod in phase resonance at the level 0.2.\nFrequency, fundamental, share of contact, \
            largest multiplier.",
        kind: Kind::Exact,
        reference: "as before, with the frequency as a fourth unknown and the lag of 90° as the fourth equation",
        remark: "",
        compute: rod_in_phase_resonance,
    },
    Case {
        name: "damped-mode-of-the-rod",
        problem: "The damped nonlinear mode of the same rod (extended periodic motion concept), 40 harmonics, to \
            eight times the mean kinetic energy at which it just touches.\nFrequency and damping ratio at the end.",
        kind: Kind::Exact,
        reference: "one mass: `ξ = c/m` takes all damping out, so that the motion is that of the undamped bilinear \
            oscillator, and `D = ζω₁/ω`",
        remark: "",
        compute: damped_rod,
    },
    Case {
        name: "damped-mode-mass-proportional",
        problem: "Wall, 3 N/m, 1 kg, 2 N/m, 0.7 kg, 1 N/m, 0.4 kg, 4 N/m, a massless node, a rigid stop 0.1 m from \
            it, `C = 0.04 M`, 9 harmonics.\nLargest deviation of the damping ratio along the damped nonlinear mode.",
        kind: Kind::Exact,
        reference: "`ξ = 0.04` takes all damping out: `D = 0.04/2ω` at every point, whatever the contact does",
        remark: "",
        compute: mass_proportional,
    },
    Case {
        name: "nlvib-03",
        problem: "NLvib's example 03: `M = I`, `K = [1 −1; −1 2]`, `C = 0.03 K`, one-sided spring 100 with gap 1 at \
            mass 1, 0.1 cos Ωt at mass 2.\nAmplitude of mass 2 at the exact peak, `Ω = 0.7511845540`, with 63 \
            harmonics; largest multiplier.",
        kind: Kind::Independent,
        reference: "shooting with event-driven integration in Python, two integrators that agree to 1e-10: \
            0.9363056809 and −1.1924192; an implementation of the equations of mixed shooting with 63 harmonics in \
            Python: 0.9363067661",
        remark: "",
        compute: nlvib,
    },
    Case {
        name: "linear-response",
        problem: "The two masses of NLvib's example with a thousandth of a newton at mass 2, so that nothing \
            touches.\nComplex amplitude of mass 2 at two frequencies.",
        kind: Kind::Exact,
        reference: "`(K + iΩC − Ω²M) q = f`, two equations by Cramer's rule",
        remark: "",
        compute: linear,
    },
    Case {
        name: "linear-phase-resonance",
        problem: "A mass of 2 kg on 50 N/m with 3 % damping, driven by 4 N, with a stop that it does not \
            reach.\nFrequency and amplitude of phase resonance.",
        kind: Kind::Exact,
        reference: "`ω₀ = 5 rad/s` whatever the damping, `F/(cω₀)`",
        remark: "",
        compute: linear_phase_resonance,
    },
    Case {
        name: "power-balance",
        problem: "The rod of two elements at the level 0.2 over 0.3 to 0.6 Hz, 7 harmonics: through both folds and \
            the stop.\nLargest difference of the power put in and that dissipated; number of folds.",
        kind: Kind::Exact,
        reference: "a rigid stop does no work at any number of harmonics: none",
        remark: "",
        compute: power_balance,
    },
];

/// Two elements: K = 2[2 −1; −1 1], consistent mass 1/3 at the middle.
fn rod() -> Result<ResponseModel, Failure> {
    let stop = Contact::rigid(1, Side::Positive, 1.0);
    let model = springs(&[1.0 / 3.0, 0.0], &[(0, 0, 2.0), (0, 1, 2.0)], vec![stop])?;
    let open = OpenModes::of_massless(&MasslessContactModel::new(&model, &Drop)?, ModeCount::Lowest(10))?;
    let mut model = ResponseModel::new(open, &Damping::Ratios(vec![0.01]))?;
    model.push_force(0, 1.0, 1, 0.0)?;
    model.set_drive(0)?;
    Ok(model)
}

/// The mass at the middle, whose damping ratio is that of the open structure.
fn oscillator() -> ForcedOscillator {
    let (m, k) = (1.0 / 3.0, 2.0_f64);
    ForcedOscillator { m, c: 0.02 * (k * m).sqrt(), k, k_s: 2.0, gap: 1.0, force: 0.2 }
}

fn settings(low: f64, high: f64, harmonics: usize) -> ResponseSettings {
    ResponseSettings { harmonics, ..ResponseSettings::new([low, high]) }
}

fn last(curve: &ResponseCurve) -> Result<&ResponsePoint, Failure> {
    let ends = [EndReason::FrequencyWindow, EndReason::Limit, EndReason::MaxEnergy];
    let is_there = ends.into_iter().any(|reason| curve.end.has(reason));
    match curve.points.last() {
        Some(point) if is_there => Ok(point),
        _ => Err(format!("the curve ended early: {}", curve.end.message).into()),
    }
}

fn beside(point: &ResponsePoint, exact: &Response) -> Result<Vec<Check>, Failure> {
    let contact = point.motion.contacts.first().ok_or("no contact")?;
    let largest = point.stability.ok_or("no multipliers")?.largest_multiplier;
    let lag = -contact.free_fundamental.arg();
    // The gap opens against the displacement: half a turn.
    let lag = (lag + TAU / 2.0).rem_euclid(TAU);
    Ok(vec![
        Check::relative("frequency, Hz", point.omega / TAU, exact.omega / TAU, 1e-8, HARMONICS),
        Check::relative("fundamental, m", contact.free_fundamental.norm(), exact.amplitude, 1e-7, HARMONICS),
        Check::relative("share of contact", contact.closed_share, exact.share, 1e-5, HARMONICS),
        Check::of_size("lag, rad", [lag, exact.lag.rem_euclid(TAU), 1.0], 1e-6, HARMONICS),
        Check::of_size(
            "largest multiplier, real part",
            [largest[0], exact.multiplier.re, 1.0],
            1e-4,
            "contact instants: ~ (3·40)⁻³",
        ),
        Check::of_size(
            "largest multiplier, imaginary part",
            [largest[1], exact.multiplier.im, 1.0],
            1e-4,
            "contact instants: ~ (3·40)⁻³",
        ),
    ])
}

fn forced_rod(middle: bool) -> Result<Vec<Check>, Failure> {
    let at = 0.42 * TAU;
    let settings = ResponseSettings { from_upper_end: middle, ..settings(0.33 * TAU, at, 40) };
    let curve = frequency_response(&rod()?, 0.2, &settings)?;
    let (amplitude, lag, share) = if middle { (1.53, 2.8, 0.25) } else { (2.42, 0.55, 0.32) };
    let guess = Response { omega: at, amplitude, lag, share, multiplier: Complex64::ONE };
    beside(last(&curve)?, &oscillator().near(guess, false)?)
}

fn rod_in_phase_resonance() -> Result<Vec<Check>, Failure> {
    let curve = phase_resonance(&rod()?, 0.2, &settings(0.3 * TAU, 0.6 * TAU, 40))?;
    let guess = Response { omega: 0.44 * TAU, amplitude: 4.4, lag: FRAC_PI_2, share: 0.36, multiplier: Complex64::ONE };
    beside(last(&curve)?, &oscillator().near(guess, true)?)
}

fn damped_rod() -> Result<Vec<Check>, Failure> {
    let curve = damped_mode(&rod()?, 8.0, &settings(0.3 * TAU, 0.6 * TAU, 40))?;
    let motion = &last(&curve)?.motion;
    let closed = |top: f64| Bilinear { m: 1.0 / 3.0, k: 2.0, k_s: 2.0, gap: 1.0, top, two_sided: false };
    // At grazing ¼ · 2 · 1² = ½.
    let exact = closed(bisect(|top| closed(top).kinetic() - 4.0, 1.1, 10.0));
    Ok(vec![
        Check::relative("mean kinetic energy, J", motion.kinetic_energy, 4.0, 1e-9, "the limit that was asked for"),
        Check::relative("ω, rad/s", motion.at.omega, exact.omega(), 1e-8, HARMONICS),
        Check::relative(
            "damping ratio",
            motion.damping_ratio(),
            0.01 * 6.0_f64.sqrt() / exact.omega(),
            1e-8,
            HARMONICS,
        ),
    ])
}

fn mass_proportional() -> Result<Vec<Check>, Failure> {
    let stop = Contact::rigid(3, Side::Positive, 0.1);
    let connections = [(0, 0, 3.0), (0, 1, 2.0), (1, 2, 1.0), (2, 3, 4.0)];
    let model = springs(&[1.0, 0.7, 0.4, 0.0], &connections, vec![stop])?;
    let open = OpenModes::of_massless(&MasslessContactModel::new(&model, &Drop)?, ModeCount::Lowest(10))?;
    let model = ResponseModel::new(open, &Damping::Rayleigh { mass: 0.04, stiffness: 0.0 })?;
    let curve = damped_mode(&model, 4.0, &settings(0.1, 10.0, 9))?;
    last(&curve)?;
    let deviation = |p: &ResponsePoint| (p.motion.damping_ratio() * 2.0 * p.omega / 0.04 - 1.0).abs();
    let worst = curve.points.iter().map(deviation).fold(0.0, f64::max);
    let touching = curve.points.iter().any(|p| p.motion.contacts[0].closed_share > 0.01);
    Ok(vec![
        Check::of_size(
            "largest relative deviation",
            [worst, 0.0, 1.0],
            1e-8,
            "the tolerance of the corrector, 1e-10, over the damping",
        ),
        Check::count("the stop is touched (1: yes)", usize::from(touching), 1),
    ])
}

fn two_masses(level_gap: f64) -> Result<ResponseModel, Failure> {
    let stop = Contact::elastic(0, Side::Positive, level_gap, 100.0);
    let model = springs(&[1.0; 2], &[(0, 1, 1.0), (1, 1, 1.0)], vec![stop])?;
    let mut model = ResponseModel::new(
        OpenModes::of_model(&model, ModeCount::Lowest(2))?,
        &Damping::Rayleigh { mass: 0.0, stiffness: 0.03 },
    )?;
    model.push_force(1, 1.0, 1, 0.0)?;
    model.set_drive(1)?;
    Ok(model)
}

fn nlvib() -> Result<Vec<Check>, Failure> {
    let curve = frequency_response(&two_masses(1.0)?, 0.1, &settings(0.62, 0.7511845540, 63))?;
    let point = last(&curve)?;
    let largest = point.stability.ok_or("no multipliers")?.largest_multiplier[0];
    let found = point.drive.norm();
    Ok(vec![
        Check::relative(
            "amplitude, exact motion",
            found,
            0.9363056809,
            3e-6,
            "the harmonics beyond 63, of a contact of a twentieth of the period: ~ 63⁻³",
        ),
        Check::relative(
            "amplitude, 63 harmonics",
            found,
            0.9363067661,
            1e-8,
            "the peak's own place: second order in 1e-5 of the frequency",
        ),
        Check::relative("largest multiplier", largest, -1.1924192, 3e-3, "contact instants of 63 harmonics"),
    ])
}

fn linear() -> Result<Vec<Check>, Failure> {
    let mut checks = Vec::new();
    for omega in [0.5, 1.7] {
        let curve = force_response(&two_masses(1.0)?, omega, 1e-3, &settings(0.1, 3.0, 3))?;
        let found = last(&curve)?.drive;
        let damped = Complex64::new(1.0, 0.03 * omega);
        let (a, b, d) = (damped - omega * omega, -damped, damped * 2.0 - omega * omega);
        let exact = a / (a * d - b * b) * 1e-3;
        let why = "rounding, over the residual";
        checks.push(Check::of_size(
            format!("real part at {omega} rad/s, m"),
            [found.re, exact.re, exact.norm()],
            1e-8,
            why,
        ));
        checks.push(Check::of_size(
            format!("imaginary part at {omega} rad/s, m"),
            [found.im, exact.im, exact.norm()],
            1e-8,
            why,
        ));
    }
    Ok(checks)
}

fn linear_phase_resonance() -> Result<Vec<Check>, Failure> {
    let stop = Contact::elastic(0, Side::Positive, 10.0, 100.0);
    let model = springs(&[2.0], &[(0, 0, 50.0)], vec![stop])?;
    let open = OpenModes::of_model(&model, ModeCount::Lowest(1))?;
    let mut model = ResponseModel::new(open, &Damping::Ratios(vec![0.03]))?;
    model.push_force(0, 1.0, 1, 0.0)?;
    model.set_drive(0)?;
    let curve = phase_resonance(&model, 4.0, &settings(3.0, 8.0, 3))?;
    let point = last(&curve)?;
    let why = "rounding, over the residual";
    Ok(vec![
        Check::relative("ω, rad/s", point.omega, 5.0, 1e-8, why),
        Check::relative("amplitude, m", point.drive.norm(), 4.0 / (2.0 * 0.03 * 5.0 * 2.0 * 5.0), 1e-8, why),
    ])
}

fn power_balance() -> Result<Vec<Check>, Failure> {
    let curve = frequency_response(&rod()?, 0.2, &settings(0.3 * TAU, 0.6 * TAU, 7))?;
    last(&curve)?;
    let differs = |p: &ResponsePoint| (p.motion.input_power / p.motion.dissipated_power - 1.0).abs();
    let worst = curve.points.iter().map(differs).fold(0.0, f64::max);
    let folds = curve.points.iter().filter(|p| p.events.contains(&Event::Fold)).count();
    Ok(vec![
        Check::of_size("largest relative difference", [worst, 0.0, 1.0], 1e-9, ROUNDING),
        Check::count("folds", folds, 2),
    ])
}
