//! Values of results at a frequency or an energy, against curves that are known in closed form.

use std::f64::consts::PI;
use std::fs;
use std::path::Path;

use nlmodes_run::passages::{Abscissa, Curve, Passage, PassageError, passages, text};

/// A mass on a spring before a rigid stop that gives back all energy.
struct Oscillator {
    mass: f64,
    stiffness: f64,
    gap: f64,
}

impl Oscillator {
    /// Frequency, energy and impulse at an amplitude over the gap.
    fn at(&self, ratio: f64) -> [f64; 3] {
        let (omega, amplitude) = ((self.stiffness / self.mass).sqrt(), ratio * self.gap);
        let period = 2.0 * (PI - (1.0 / ratio).acos()) / omega;
        let speed = omega * (amplitude * amplitude - self.gap * self.gap).sqrt();
        [1.0 / period, 0.5 * self.stiffness * amplitude * amplitude, 2.0 * self.mass * speed]
    }
}

/// Writes a table with these frequencies, energies, events and impulses of two stops.
fn write(folder: &Path, rows: &[([f64; 2], &str, [f64; 2])]) {
    fs::create_dir_all(folder).unwrap();
    let mut branch = "point,frequency_hz,energy_j,modal_amplitude,peak_m,stable,event\n".to_owned();
    let mut contacts =
        "point,contact,contact_fraction,peak_force_n,mean_force_n,impulse_ns,touches,approach_velocity_m_s\n"
            .to_owned();
    for (k, ([frequency, energy], event, impulses)) in rows.iter().enumerate() {
        branch += &format!("{k},{frequency:?},{energy:?},{:?},1.0,true,{event}\n", energy.sqrt());
        for (stop, impulse) in impulses.iter().enumerate() {
            contacts += &format!("{k},{stop},0.1,{:?},{:?},{impulse:?},1,0.5\n", 2.0 * impulse, impulse * frequency);
        }
    }
    fs::write(folder.join("branch.csv"), branch).unwrap();
    fs::write(folder.join("contacts.csv"), contacts).unwrap();
}

fn at(folder: &Path, frequency: f64) -> (Vec<Passage>, Vec<Curve>) {
    let curves = passages(folder, Abscissa::FrequencyHz, frequency).unwrap();
    (curves[0].passages.clone(), curves)
}

/// Errors fall with the third power of the spacing, the same in metres and kilograms as in millimetres and tonnes.
#[test]
fn between_points_values_are_those_of_the_motion_there() {
    let folder = tempfile::tempdir().unwrap();
    let mut all = Vec::new();
    for (length, mass) in [(1.0, 1.0), (1e3, 1e-3)] {
        let oscillator = Oscillator { mass: 2.0 * mass, stiffness: 8e4 * mass, gap: 1e-3 * length };
        let wanted = oscillator.at(1.537);
        let errors = [10, 20, 40].map(|count| {
            let ratio = |k: usize| 1.2 + 1.8 * k as f64 / count as f64;
            let rows: Vec<_> = (0..=count)
                .map(|k| oscillator.at(ratio(k)))
                .map(|[frequency, energy, impulse]| ([frequency, energy], "", [impulse, 0.25 * impulse]))
                .collect();
            write(folder.path(), &rows);
            let (found, _) = at(folder.path(), wanted[0]);
            let [passage] = &found[..] else { panic!("{found:?}") };
            assert!((passage.frequency_hz / wanted[0] - 1.0).abs() < 1e-12);
            let stops = &passage.contacts;
            assert!((stops[1].impulse_ns / stops[0].impulse_ns - 0.25).abs() < 1e-12);
            assert!((stops[0].peak_force_n / stops[0].impulse_ns - 2.0).abs() < 1e-12);
            let by_energy = passages(folder.path(), Abscissa::EnergyJ, passage.energy_j).unwrap();
            assert!((by_energy[0].passages[0].frequency_hz / wanted[0] - 1.0).abs() < 1e-9);
            [passage.energy_j / wanted[1] - 1.0, stops[0].impulse_ns / wanted[2] - 1.0].map(f64::abs)
        });
        for quantity in 0..2 {
            let [coarse, middle, fine] = errors.map(|of| of[quantity]);
            assert!(coarse < 1e-2 && fine < 1e-4 && fine < middle && coarse > 5.0 * middle, "{errors:?}");
        }
        all.push(errors[2]);
    }
    assert!(all[0].iter().zip(all[1]).all(|(a, b)| (a - b).abs() < 1e-9), "{all:?}");
}

/// Frequency over a parameter: up to a fold, back to another, and up again.
#[test]
fn behind_folds_every_passage_is_told() {
    let folder = tempfile::tempdir().unwrap();
    let frequency = |s: f64| 50.0 + s * s * s - 3.0 * s;
    let rows: Vec<_> = (0..=80)
        .map(|k| -2.0 + 0.05 * f64::from(k))
        .map(|s| {
            (
                [frequency(s), s.exp()],
                if s.abs() > 0.99 && s.abs() < 1.01 { "frequency-fold" } else { "" },
                [s.exp(), 3.0],
            )
        })
        .collect();
    write(folder.path(), &rows);
    let (found, curves) = at(folder.path(), 50.4);
    // Roots of s³ − 3 s = 0.4 by the cosine of a third of an angle.
    let root = |k: f64| 2.0 * ((0.2_f64.acos() + 2.0 * PI * k) / 3.0).cos();
    let mut roots = [root(0.0), root(1.0), root(2.0)];
    roots.sort_by(f64::total_cmp);
    assert_eq!(found.len(), 3);
    for (passage, s) in found.iter().zip(roots) {
        assert!((passage.energy_j / s.exp() - 1.0).abs() < 2e-4, "{passage:?} for {s}");
        assert_eq!(passage.points[1], passage.points[0] + 1);
    }
    let text = text(folder.path(), Abscissa::FrequencyHz, 50.4, &curves);
    assert!(text.contains("is passed 3 times, each with another motion"), "{text}");
    // The second stop has the largest impulse up to s = ln 3.
    assert_eq!(text.matches("stop 1 has the largest impulse").count(), 2, "{text}");
    assert_eq!(text.matches("stop 0 has the largest impulse").count(), 1, "{text}");
    // A point that lies there is told once, and what lies beyond all points is said to.
    assert_eq!(at(folder.path(), frequency(-2.0)).0[0].points, [0, 0]);
    assert_eq!(at(folder.path(), 50.0).0.len(), 3);
    let (none, curves) = at(folder.path(), 60.0);
    assert!(none.is_empty());
    let said = self::text(folder.path(), Abscissa::FrequencyHz, 60.0, &curves);
    assert!(said.contains("60 Hz is not passed; 81 points lie between 48 Hz and 52 Hz"), "{said}");
}

/// Straight pieces on both sides of a corner are met exactly only if neither knows of the other, and where a tongue was left out there is nothing.
#[test]
fn nothing_is_interpolated_across_corners_and_gaps() {
    let folder = tempfile::tempdir().unwrap();
    for corner in ["kink", "contact-change stability-change", "branch-point"] {
        let rows: Vec<_> = (0..=4)
            .map(|k| {
                let s = f64::from(k);
                let impulse = if k <= 2 { 0.0 } else { 100.0 * (s - 2.0) };
                ([10.0 + s, (0.1 * s).exp()], if k == 2 { corner } else { "" }, [impulse, 0.0])
            })
            .collect();
        write(folder.path(), &rows);
        assert_eq!(at(folder.path(), 11.5).0[0].contacts[0].impulse_ns, 0.0);
        // In equal steps of the logarithm of the energy, frequencies are not quite so: the piece is straight over both.
        let impulse = at(folder.path(), 12.5).0[0].contacts[0].impulse_ns;
        assert!((impulse - 50.0).abs() < 0.1, "{corner}: {impulse}");
    }
    let events = ["", "tongue-foot", "resumed", ""];
    let rows: Vec<_> =
        events.iter().enumerate().map(|(k, event)| ([10.0 + k as f64, 1.0 + k as f64], *event, [1.0; 2])).collect();
    write(folder.path(), &rows);
    let (found, curves) = at(folder.path(), 11.5);
    assert!(found.is_empty());
    assert_eq!(curves[0].left_out, [[1, 2]]);
    let said = text(folder.path(), Abscissa::FrequencyHz, 11.5, &curves);
    assert!(said.contains("between points 1 and 2 a tongue was left out"), "{said}");
    assert_eq!(at(folder.path(), 10.5).0.len(), 1);
}

#[test]
fn what_has_no_answer_is_refused() {
    let folder = tempfile::tempdir().unwrap();
    let of = |value| passages(folder.path(), Abscissa::FrequencyHz, value);
    for value in [0.0, -50.0, f64::NAN, f64::INFINITY] {
        assert!(matches!(of(value), Err(PassageError::NotPositive(..))), "{value}");
    }
    assert!(matches!(of(50.0), Err(PassageError::NoBranch(_))));
    fs::write(folder.path().join("branch.csv"), "point,frequency_hz,energy_j\n0,fifty,1\n").unwrap();
    let said = of(50.0).unwrap_err().to_string();
    assert!(said.contains("line 2: frequency_hz is \"fifty\", expected a number"), "{said}");
    fs::write(folder.path().join("branch.csv"), "point,energy_j\n0,1\n").unwrap();
    assert!(of(50.0).unwrap_err().to_string().contains("no column frequency_hz"));
}
