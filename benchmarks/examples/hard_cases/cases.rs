//! What is asked, and by what it is judged.

use nlmodes::modal::EndReason;
use std::f64::consts::{PI, TAU};

use nlmodes::branches::{BranchSettings, ResonanceRule};
use nlmodes::fem::Mesh;
use nlmodes::model::{Contact, MasslessContactModel, Side, held_modes};
use nlmodes_benchmarks::Failure;

use crate::judge::{Verdict, follow, refused};
use crate::models::{At, beam, chain, massless, oscillator, rod, with_spring_tips};

/// A case of a group.
pub struct Case {
    pub group: &'static str,
    pub name: String,
    pub compute: Compute,
}

type Outcome = Result<Verdict, Failure>;
type Compute = Box<dyn Fn() -> Outcome + std::panic::RefUnwindSafe>;

const TIP: f64 = 1.0;

pub fn all() -> Vec<Case> {
    let groups: [(&'static str, Vec<(String, Compute)>); 10] = [
        ("Stops that touch at rest", touching()),
        ("Stops that press at rest", pressing()),
        ("Gap of 1e-9 m", tiny_gap()),
        ("Stiffness ratios to 1e12", stiffness_ratios()),
        ("Stiff contact springs, conventional harmonic balance", contact_stiffness()),
        ("Slender and stocky beams", beams()),
        ("Meshes graded 1000 : 1", graded()),
        ("Redundant stops", redundant()),
        ("Stops that face each other", facing()),
        ("Size", size()),
    ];
    let named = |(group, cases): (&'static str, Vec<(String, Compute)>)| {
        cases.into_iter().map(move |(name, compute)| Case { group, name, compute }).collect::<Vec<Case>>()
    };
    groups.into_iter().flat_map(named).collect()
}

fn case(
    name: impl Into<String>,
    compute: impl Fn() -> Outcome + std::panic::RefUnwindSafe + 'static,
) -> (String, Compute) {
    (name.into(), Box::new(compute))
}

fn to(max_energy_ratio: f64, harmonics: usize) -> BranchSettings {
    let internal_resonance = ResonanceRule::Follow;
    BranchSettings {
        harmonics,
        max_energy_ratio: Some(max_energy_ratio),
        internal_resonance,
        ..BranchSettings::default()
    }
}

fn two_element_rod(gap: f64) -> Result<MasslessContactModel, Failure> {
    // One mass, 1/3, between a spring of 2 to the wall and one of 2 to the massless tip.
    massless(&chain(&[1.0 / 3.0, 0.0], &[2.0, 2.0], vec![Contact::rigid(1, Side::Positive, gap)])?)
}

fn tip_rod(elements: usize, gap: f64) -> Result<MasslessContactModel, Failure> {
    massless(&rod(Mesh::uniform(20.0, elements)?, &[(TIP, Side::Positive, gap)])?)
}

fn tip_beam(elements: usize, gap: f64) -> Result<MasslessContactModel, Failure> {
    massless(&beam(Mesh::uniform(0.63, elements)?, 0.02, &[(TIP, Side::Positive, gap)])?)
}

/// `2 f₁ f₂/(f₁ + f₂)`: half a period with each frequency.
fn bilinear(f_1: f64, f_2: f64) -> f64 {
    2.0 * f_1 * f_2 / (f_1 + f_2)
}

fn touching() -> Vec<(String, Compute)> {
    let mut cases = Vec::new();
    for k_c in [1e-2, 1.0, 1e2] {
        cases.push(case(format!("mass before a spring, k_c = {k_c:.0e} k, HBM, 60 harmonics"), move || {
            let verdict = follow(oscillator(0.0, k_c)?, &to(20.0, 60))?;
            let closed = bilinear(1.0, (1.0 + k_c).sqrt()) / TAU;
            let off = verdict.last_hz() / closed - 1.0;
            let spread = verdict.spread();
            Ok(verdict.judged(
                "2 f₁f₂/(f₁ + f₂), at every energy",
                off.abs() + spread,
                if k_c > 10.0 { 1e-5 } else { 1e-9 },
            ))
        }));
    }
    for harmonics in [1, 60] {
        cases.push(case(format!("rod of two elements, N_h = {harmonics}"), move || {
            let verdict = follow(two_element_rod(0.0)?, &to(1e4, harmonics))?;
            let off = verdict.last_hz() * TAU / bilinear(6.0_f64.sqrt(), 12.0_f64.sqrt()) - 1.0;
            let spread = verdict.spread();
            Ok(verdict.judged(
                "2 f₁f₂/(f₁ + f₂), at every energy",
                off.abs() + spread,
                if harmonics == 1 { 2e-2 } else { 1e-9 },
            ))
        }));
    }
    for (elements, harmonics, contacts) in [(10, 5, 1), (100, 5, 1), (100, 20, 1), (400, 4, 1), (400, 5, 3)] {
        cases.push(case(format!("rod of {elements}, N_h = {harmonics}"), move || {
            let verdict = follow(tip_rod(elements, 0.0)?, &to(20.0, harmonics))?;
            let continuous = 4.0 / 3.0 * (210e9_f64 / 9000.0).sqrt() / 80.0;
            let (off, spread) = (verdict.last_hz() / continuous - 1.0, verdict.spread());
            let by = format!("4/3 of c/4L, the continuous rod; spread over energy {spread:.0e}");
            // The mass dropped at the tip: half an element of the length, twice that with the tip at rest. Motions that
            // touch more often a period tend to the same frequency.
            let met = verdict.branch().branch.points.last().map_or(0, |p| p.contact_intervals);
            let sound = spread < 1e-9 && met == contacts;
            Ok(verdict.judged(by, if sound { off } else { f64::NAN }, 0.6 * contacts as f64 / elements as f64))
        }));
    }
    cases.push(case("beam of 20, N_h = 3", || {
        let verdict = follow(tip_beam(20, 0.0)?, &to(20.0, 3))?;
        // The gap counts as its share of the amplitude: f(E) = f(∞) − a/√E.
        let [quarter, whole] =
            [2.5e3, 1e4].map(|ratio| follow(tip_beam(20, 1e-3)?, &to(ratio, 3)).map(|v| v.last_hz()));
        let far = 2.0 * whole? - quarter?;
        let (off, spread) = (verdict.last_hz() / far - 1.0, verdict.spread());
        Ok(verdict.judged("1 mm, extrapolated from 2500 and 10⁴ grazing energies", off.abs() + spread, 1e-4))
    }));
    for harmonics in [5, 20] {
        cases.push(case(format!("beam of 20, N_h = {harmonics}"), move || {
            let verdict = follow(tip_beam(20, 0.0)?, &to(20.0, harmonics))?;
            let spread = verdict.spread();
            Ok(verdict.judged("the same at every energy", spread, 1e-9))
        }));
    }
    cases.push(case("rod of 100, gap 0 at the tip and 1 mm in the middle, N_h = 3", || {
        let stops = [(TIP, Side::Positive, 0.0), (0.5, Side::Negative, 1e-3)];
        follow(massless(&rod(Mesh::uniform(20.0, 100)?, &stops)?)?, &to(20.0, 3))
    }));
    cases.push(case("rod of 100, gap 0 on both sides of the tip, N_h = 3", || {
        let stops = [(TIP, Side::Positive, 0.0), (TIP, Side::Negative, 0.0)];
        let verdict = follow(massless(&rod(Mesh::uniform(20.0, 100)?, &stops)?)?, &to(20.0, 3))?;
        let off = verdict.last_hz() / held_rod(100) - 1.0;
        Ok(verdict.judged("the mode with the tip held", off, 1e-9))
    }));
    cases
}

/// First frequency of the paper's rod of `n` consistent elements with its tip held, Hz.
fn held_rod(n: usize) -> f64 {
    let (l, kappa) = (20.0 / n as f64, PI / n as f64);
    (6.0 * 210e9 / (9000.0 * l * l) * (2.0 - 2.0 * kappa.cos()) / (4.0 + 2.0 * kappa.cos())).sqrt() / TAU
}

/// The pressed rod of two elements, `x` from −b to … about the place where it is held: frequency, averaged kinetic
/// energy and share of the period in contact.
fn pressed_closed_form(b: f64) -> (f64, f64, f64) {
    let a = (1.0 + 2.0 * (b * b - 0.25)).sqrt();
    let (omega_c, omega_f) = (12.0_f64.sqrt(), 6.0_f64.sqrt());
    let (held, free) = (PI - (0.5 / b).acos(), (1.0 / a).acos());
    let period = 2.0 * (held / omega_c + free / omega_f);
    let integral = |theta: f64| theta - theta.sin() * theta.cos();
    // ½ m ẋ² with m = ⅓: ⟨·⟩ over the stretches with each frequency.
    let kinetic = (2.0 * b * b / omega_c * integral(held) + a * a / omega_f * integral(free)) / period;
    (1.0 / period, kinetic, 2.0 * held / omega_c / period)
}

fn pressing() -> Vec<(String, Compute)> {
    let mut cases = Vec::new();
    for (share, b) in [("99 %", 0.500_31), ("70 %", 0.9)] {
        cases.push(case(
            format!("rod of two elements, in contact during {share} of the period, N_h = 100"),
            move || {
                let (hz, kinetic, contact) = pressed_closed_form(b);
                let verdict = follow(two_element_rod(-1.0)?, &to(kinetic / 0.25, 100))?;
                let last = verdict.branch().branch.points.last().map_or(f64::NAN, |p| p.contact_fraction);
                let off = (verdict.last_hz() / hz - 1.0).abs();
                Ok(verdict.judged(
                    format!("closed form, contact {:.3} % (here {:.3} %)", 100.0 * contact, 100.0 * last),
                    off,
                    1e-9,
                ))
            },
        ));
    }
    for (pressed, harmonics) in [(0.1, 1), (0.1, 5), (1e-9, 3)] {
        cases.push(case(format!("rod of 100 pressed by {pressed} m, N_h = {harmonics}"), move || {
            let verdict = follow(tip_rod(100, -pressed)?, &to(20.0, harmonics))?;
            let first = verdict.branch().grazing.omega / TAU;
            Ok(verdict.judged("starts at the mode with the tip held", first / held_rod(100) - 1.0, 1e-9))
        }));
    }
    for harmonics in [1, 3, 5, 10] {
        cases.push(case(format!("beam of 20 pressed by 1 mm, N_h = {harmonics}"), move || {
            let model = tip_beam(20, -1e-3)?;
            let held = held_modes(&model, 12)?;
            let verdict = follow(model, &to(20.0, harmonics))?;
            if verdict.branch().branch.end.has(EndReason::MinEnergy) {
                // It may lead to another mode with the tip held, as its n-th harmonic, and out along that as it fades.
                let off = |omega: f64, n: usize| n as f64 * TAU * verdict.last_hz() / omega - 1.0;
                let pairs = held.omega.iter().flat_map(|omega| (1..=harmonics).map(move |n| off(*omega, n)));
                let nearest = pairs.min_by(|a, b| a.abs().total_cmp(&b.abs())).unwrap_or(f64::NAN);
                return Ok(verdict.judged("ends in a higher mode with the tip held, over n", nearest, 1e-9));
            }
            let flat = follow(tip_beam(20, 0.0)?, &to(1.1, harmonics))?;
            let [first, last, low] = [verdict.branch().grazing.omega / TAU, verdict.last_hz(), flat.last_hz()];
            let between = if last > low && last < 1.1 * first { 0.0 } else { 1.0 };
            Ok(verdict.judged(format!("between held, {first:.3} Hz, and gap 0, {low:.3} Hz"), between, 0.5))
        }));
    }
    cases.push(case("beam of 20 pressed by 1 mm, N_h = 20, tongues skipped", || {
        let settings = BranchSettings { internal_resonance: ResonanceRule::Skip, ..to(20.0, 20) };
        follow(tip_beam(20, -1e-3)?, &settings)
    }));
    cases.push(case("graded beam of the paper pressed by 1 mm, N_h = 5", || {
        let mesh = Mesh::graded(0.629_755_2, 21, 9.195_853_6)?;
        follow(massless(&beam(mesh, 0.02, &[(TIP, Side::Positive, -1e-3)])?)?, &to(20.0, 5))
    }));
    cases
}

fn tiny_gap() -> Vec<(String, Compute)> {
    let compare = |tiny: MasslessContactModel, large: MasslessContactModel, settings: &BranchSettings| {
        let (tiny, large) = (follow(tiny, settings)?, follow(large, settings)?);
        let count = (tiny.branch().branch.points.len() as f64) - (large.branch().branch.points.len() as f64);
        let off = tiny.last_hz() / large.last_hz() - 1.0;
        Ok(tiny.judged(format!("the gap multiplied; points differ by {count}"), off, 1e-11))
    };
    vec![
        case("rod of 100, N_h = 3, beside 0.5 m", move || {
            compare(tip_rod(100, 1e-9)?, tip_rod(100, 0.5)?, &to(20.0, 3))
        }),
        case("beam of 20, N_h = 5, beside 1 mm", move || {
            compare(tip_beam(20, 1e-9)?, tip_beam(20, 1e-3)?, &to(5.0, 5))
        }),
        case("rod of 100 pressed by 1e-9 m, N_h = 1, beside 0.1 m", move || {
            compare(tip_rod(100, -1e-9)?, tip_rod(100, -0.1)?, &to(5.0, 1))
        }),
    ]
}

fn stiffness_ratios() -> Vec<(String, Compute)> {
    let mut cases = Vec::new();
    for exponent in [3, 6, 9, 12] {
        let stiff = 10_f64.powi(exponent);
        cases.push(case(
            format!("chain of 12 masses, every other spring 1e{exponent} times stiffer, N_h = 5"),
            move || {
                // Springs 1, s, 1, s, …: masses 2 and 3, 4 and 5 … move together; the last spring leads to the massless
                // node.
                let springs: Vec<f64> = (0..12).map(|i| if i % 2 == 1 { stiff } else { 1.0 }).chain([1.0]).collect();
                let masses: Vec<f64> = vec![1.0; 12].into_iter().chain([0.0]).collect();
                let contacts = vec![Contact::rigid(12, Side::Positive, 1.0)];
                let verdict = follow(massless(&chain(&masses, &springs, contacts)?)?, &to(3.0, 5))?;
                let merged: Vec<f64> = vec![2.0; 6].into_iter().chain([0.0]).collect();
                let rigid = follow(
                    massless(&chain(&merged, &[1.0; 7], vec![Contact::rigid(6, Side::Positive, 1.0)])?)?,
                    &to(3.0, 5),
                )?;
                let off = verdict.last_hz() / rigid.last_hz() - 1.0;
                // A spring that gives way by 1/s, and entries 1 + s of K that keep 1 to the rounding of s.
                Ok(verdict.judged("pairs of masses as one", off, 1.0 / stiff + 4.0 * stiff * f64::EPSILON))
            },
        ));
    }
    for exponent in [-12, -6, 6, 12] {
        let k_c = 10_f64.powi(exponent);
        cases.push(case(format!("rod of two elements, stop of 1e{exponent} K_NN, MS-HBM, N_h = 60"), move || {
            let stop = Contact::elastic(1, Side::Positive, 1.0, 2.0 * k_c);
            let model = massless(&chain(&[1.0 / 3.0, 0.0], &[2.0, 2.0], vec![stop])?)?;
            let verdict = follow(model, &to(4.0, 60))?;
            // A soft stop is none; a hard one is rigid up to 1/k_c.
            let limit =
                if k_c < 1.0 { 6.0_f64.sqrt() / TAU } else { follow(two_element_rod(1.0)?, &to(4.0, 60))?.last_hz() };
            let off = verdict.last_hz() / limit - 1.0;
            let by = if k_c < 1.0 { "no stop" } else { "rigid stop" };
            Ok(verdict.judged(by, off, k_c.min(1.0 / k_c) + 1e-11))
        }));
    }
    for exponent in [3, 6, 9, 12] {
        let softer = 10_f64.powi(-exponent);
        cases.push(case(format!("rod of 100, tip spring of 1e-{exponent} EA/l before the stop, N_h = 3"), move || {
            let (n, k, m) = (100, 1.0, 1.0);
            let springs: Vec<f64> = vec![k; n].into_iter().chain([softer]).collect();
            let masses: Vec<f64> = vec![m; n].into_iter().chain([0.0]).collect();
            let model = massless(&chain(&masses, &springs, vec![Contact::rigid(n, Side::Positive, 1.0)])?)?;
            // Held and free frequency differ by less than ω can tell.
            if exponent > 6 {
                return refused(follow(model, &to(3.0, 3)));
            }
            let verdict = follow(model, &to(3.0, 3))?;
            let free = (PI / (2.0 * (2 * n + 1) as f64)).sin() / PI;
            // By how much the spring stiffens the mode at most: half of k/(m N/2)/ω², ω ≈ π/2N.
            let most = softer * (n as f64) * 8.0 / (PI * PI);
            let off = verdict.last_hz() / free - 1.0;
            Ok(verdict.judged("no stop", off, most + 1e-10))
        }));
    }
    cases
}

fn contact_stiffness() -> Vec<(String, Compute)> {
    let mut cases = Vec::new();
    for exponent in [2, 4, 6, 7, 8, 9, 12] {
        cases.push(case(format!("rod of 8, k_c = 1e{exponent} EA/L, HBM, N_h = 3"), move || {
            let k_c = 10_f64.powi(exponent) * 210e9 / 20.0;
            let model = rod(Mesh::uniform(20.0, 8)?, &[(TIP, Side::Positive, 0.5)])?;
            let stop = Contact::elastic(7, Side::Positive, 0.5, k_c);
            let (m, k, d) = (model.mass().clone(), model.stiffness().clone(), model.dofs().to_vec());
            let model = nlmodes::model::StructuralModel::new(m, k, d, vec![stop])?;
            let outcome = with_spring_tips(&model).and_then(|model| follow(model, &to(3.0, 3)));
            if exponent > 8 { refused(outcome) } else { outcome }
        }));
    }
    cases
}

fn beams() -> Vec<(String, Compute)> {
    let slender = |over: f64| -> Result<MasslessContactModel, Failure> {
        massless(&beam(Mesh::uniform(0.63, 20)?, 0.63 / over, &[(TIP, Side::Positive, 1e-3)])?)
    };
    let ratios = [1e4, 1e3, 100.0, 10.0, 4.0, 2.0];
    ratios
        .map(|over| {
            case(format!("L/h = {over}, 20 elements, N_h = 3"), move || {
                let verdict = follow(slender(over)?, &to(5.0, 3))?;
                let thin = follow(slender(1e3)?, &to(5.0, 3))?;
                let off = verdict.last_ratio() / thin.last_ratio() - 1.0;
                Ok(verdict.judged(
                    "f/f₁ of L/h = 1000 at the same energy ratio",
                    off,
                    2.0 * (1e-6_f64).max(1.0 / (over * over)),
                ))
            })
        })
        .into()
}

fn graded() -> Vec<(String, Compute)> {
    let mut cases = Vec::new();
    for grading in [1e3, 1e-3] {
        cases.push(case(format!("rod of 60 elements graded {grading}, N_h = 1"), move || {
            let stops: [At; 1] = [(TIP, Side::Positive, 0.5)];
            let verdict = follow(massless(&rod(Mesh::graded(20.0, 60, grading)?, &stops)?)?, &to(5.0, 1))?;
            let fine = follow(massless(&rod(Mesh::uniform(20.0, 400)?, &stops)?)?, &to(5.0, 1))?;
            let off = verdict.last_hz() / fine.last_hz() - 1.0;
            // With 1e-3 the last element is a ninth of the rod, and a third of its mass is dropped.
            Ok(verdict.judged("400 equal elements", off, 3e-2))
        }));
        cases.push(case(format!("beam of 40 elements graded {grading}, N_h = 3"), move || {
            let stops: [At; 1] = [(TIP, Side::Positive, 1e-3)];
            let verdict = follow(massless(&beam(Mesh::graded(0.63, 40, grading)?, 0.02, &stops)?)?, &to(5.0, 3))?;
            let fine = follow(massless(&beam(Mesh::uniform(0.63, 200)?, 0.02, &stops)?)?, &to(5.0, 3))?;
            let off = verdict.last_hz() / fine.last_hz() - 1.0;
            // With 1e-3 the last element is a sixth of the beam, and the mass of its tip is dropped.
            Ok(verdict.judged("200 equal elements", off, if grading > 1.0 { 1e-2 } else { 0.25 }))
        }));
    }
    cases
}

fn redundant() -> Vec<(String, Compute)> {
    let one = || follow(tip_rod(100, 0.5)?, &to(20.0, 3));
    let ten = |gap: f64| -> Vec<At> { (0..10).map(|i| (1.0 - 0.01 * i as f64, Side::Positive, gap)).collect() };
    vec![
        case("rod of 100, two equal stops at the tip, N_h = 3", move || {
            let stops = [(TIP, Side::Positive, 0.5), (TIP, Side::Positive, 0.5)];
            let verdict = follow(massless(&rod(Mesh::uniform(20.0, 100)?, &stops)?)?, &to(20.0, 3))?;
            let off = verdict.last_hz() / one()?.last_hz() - 1.0;
            Ok(verdict.judged("one stop", off, 1e-11))
        }),
        case("rod of 100, a second stop at the tip 1e-12 m behind the first, N_h = 3", move || {
            let stops = [(TIP, Side::Positive, 0.5), (TIP, Side::Positive, 0.5 + 1e-12)];
            let verdict = follow(massless(&rod(Mesh::uniform(20.0, 100)?, &stops)?)?, &to(20.0, 3))?;
            let off = verdict.last_hz() / one()?.last_hz() - 1.0;
            Ok(verdict.judged("one stop", off, 1e-11))
        }),
        case("rod of 100, two stops at the tip that press by 0.1 m, N_h = 1", move || {
            let stops = [(TIP, Side::Positive, -0.1), (TIP, Side::Positive, -0.1)];
            let verdict = follow(massless(&rod(Mesh::uniform(20.0, 100)?, &stops)?)?, &to(5.0, 1))?;
            let off = verdict.last_hz() / follow(tip_rod(100, -0.1)?, &to(5.0, 1))?.last_hz() - 1.0;
            Ok(verdict.judged("one stop", off, 1e-11))
        }),
        case("rod of 100, stops at its last ten nodes, N_h = 3", move || {
            follow(massless(&rod(Mesh::uniform(20.0, 100)?, &ten(0.5))?)?, &to(5.0, 3))
        }),
        case("rod of 100, stops at its last ten nodes, gap 0, N_h = 3", move || {
            follow(massless(&rod(Mesh::uniform(20.0, 100)?, &ten(0.0))?)?, &to(5.0, 3))
        }),
        case("beam of 100, stops at its last ten nodes, N_h = 3", move || {
            follow(massless(&beam(Mesh::uniform(0.63, 100)?, 0.02, &ten(1e-3))?)?, &to(3.0, 3))
        }),
    ]
}

fn facing() -> Vec<(String, Compute)> {
    let both = |gap: f64| [(TIP, Side::Positive, gap), (TIP, Side::Negative, gap)];
    let mut cases = Vec::new();
    for (ratio, permitted) in [(1e2, 0.2), (1e6, 1e-2), (1e9, 3e-5)] {
        cases.push(case(
            format!("rod of 100, 1e-6 m on each side, to {ratio:.0e} grazing energies, N_h = 1"),
            move || {
                let verdict = follow(massless(&rod(Mesh::uniform(20.0, 100)?, &both(1e-6))?)?, &to(ratio, 1))?;
                let off = verdict.last_hz() / held_rod(100) - 1.0;
                Ok(verdict.judged("the mode with the tip held", off, permitted))
            },
        ));
    }
    cases.push(case("rod of 100, 1e-6 m on each side, N_h = 5", move || {
        follow(massless(&rod(Mesh::uniform(20.0, 100)?, &both(1e-6))?)?, &to(5.0, 5))
    }));
    cases.push(case("beam of 20, 1e-6 m on each side, N_h = 3", move || {
        follow(massless(&beam(Mesh::uniform(0.63, 20)?, 0.02, &both(1e-6))?)?, &to(100.0, 3))
    }));
    cases.push(case("beam of 20, 1e-6 m on one side, 1 mm on the other, N_h = 3", move || {
        let stops = [(TIP, Side::Positive, 1e-6), (TIP, Side::Negative, 1e-3)];
        follow(massless(&beam(Mesh::uniform(0.63, 20)?, 0.02, &stops)?)?, &to(100.0, 3))
    }));
    cases
}

fn size() -> Vec<(String, Compute)> {
    vec![
        case("rod of 10, N_h = 3", || follow(tip_rod(10, 0.5)?, &to(20.0, 3))),
        case("rod of 10 000, N_h = 3", || follow(tip_rod(10_000, 0.5)?, &to(3.0, 3))),
        case("beam of 10 000, N_h = 3", || follow(tip_beam(10_000, 1e-3)?, &to(3.0, 3))),
        case("rod of 10, N_h = 100", || follow(tip_rod(10, 0.5)?, &to(3.0, 100))),
        case("rod of 100, N_h = 100", || follow(tip_rod(100, 0.5)?, &to(1.2, 100))),
        case("beam of 20, N_h = 100", || follow(tip_beam(20, 1e-3)?, &to(2.0, 100))),
        case("beam of 10, N_h = 3", || follow(tip_beam(10, 1e-3)?, &to(5.0, 3))),
    ]
}
