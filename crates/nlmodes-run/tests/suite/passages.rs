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
    // A point exactly there is reported once, and a value beyond all points is reported as such.
    assert_eq!(at(folder.path(), frequency(-2.0)).0[0].points, [0, 0]);
    assert_eq!(at(folder.path(), 50.0).0.len(), 3);
    let (none, curves) = at(folder.path(), 60.0);
    assert!(none.is_empty());
    let said = self::text(folder.path(), Abscissa::FrequencyHz, 60.0, &curves);
    assert!(said.contains("60 Hz is not passed; 81 points lie between 48 Hz and 52 Hz"), "{said}");
}

/// Straight pieces on both sides of a kink are reproduced exactly only if they are independent, and there is nothing
/// where an internal resonance was skipped.
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
    assert!(said.contains("between points 1 and 2 an internal-resonance branch was left out"), "{said}");
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

/// Two values that differ in the eighth digit.
#[test]
fn digits_tell_the_ends_of_a_branch_and_its_passages_apart() {
    let folder = tempfile::tempdir().unwrap();
    let rows = [([60.791_712, 1.0], "", [1.0; 2]), ([60.791_723, 2.0], "", [2.0; 2])];
    write(folder.path(), &rows);
    let said = |value: f64| {
        let (_, curves) = at(folder.path(), value);
        text(folder.path(), Abscissa::FrequencyHz, value, &curves)
    };
    let told = said(60.7918);
    assert!(told.contains("60.7918 Hz is not passed; 2 points lie between 60.79171 Hz and 60.79172 Hz"), "{told}");
    let told = said(60.791_715_5);
    assert!(told.contains("60.7917155 Hz is passed once"), "{told}");
    // A fold whose two sides are close together.
    let rows =
        [([50.0, 1.0], "", [1.0; 2]), ([51.0, 1.1], "frequency-fold", [1.0; 2]), ([50.0, 1.1 + 1e-7], "", [1.0; 2])];
    write(folder.path(), &rows);
    let told = said(50.999_999_9);
    let energies: Vec<&str> =
        told.lines().filter_map(|line| line.split(", ").nth(1)).filter(|x| x.ends_with(" J")).collect();
    assert!(energies.len() == 2 && energies[0] != energies[1], "{told}");
    // Where all lie at one frequency up to rounding, there is no between.
    write(folder.path(), &[([50.0, 1.0], "", [1.0; 2]), ([50.0 + 1e-13, 2.0], "", [1.0; 2])]);
    assert!(said(40.0).contains("40 Hz is not passed; all 2 points lie at 50 Hz"), "{}", said(40.0));
}

#[test]
fn what_is_rounding_is_zero_and_an_unknown_stability_is_said() {
    let folder = tempfile::tempdir().unwrap();
    let branch = "point,frequency_hz,energy_j,modal_amplitude,peak_m,stable,level,force_n,acceleration_m_s2\n\
                  0,50,1.0,0.5,1e-3,true,6,,6\n1,51,2.0,1e-148,1e-3,,6,,6\n2,52,3.0,1e-148,1e-3,,6,,6\n";
    fs::write(folder.path().join("branch.csv"), branch).unwrap();
    let contacts = "point,contact,peak_force_n,impulse_ns\n0,0,1e3,2\n1,0,1e-10,1e-18\n2,0,1e-10,1e-18\n";
    fs::write(folder.path().join("contacts.csv"), contacts).unwrap();
    let (found, curves) = at(folder.path(), 51.5);
    assert_eq!((found[0].modal_amplitude, found[0].contacts[0].peak_force_n), (0.0, 0.0));
    assert_eq!(found[0].contacts[0].impulse_ns, 0.0);
    let told = text(folder.path(), Abscissa::FrequencyHz, 51.5, &curves);
    for part in ["modal amplitude 0: the fundamental takes no part", "level 6 m/s²", "its stability was not found out"]
    {
        assert!(told.contains(part), "{part}: {told}");
    }
    let (_, curves) = at(folder.path(), 50.5);
    let told = text(folder.path(), Abscissa::FrequencyHz, 50.5, &curves);
    assert!(told.contains("its stability was found out at one of the points only"), "{told}");
}

#[test]
fn a_table_is_named_and_what_is_damaged_is_said_with_its_row() {
    let folder = tempfile::tempdir().unwrap();
    let rows: Vec<_> = (0..4).map(|k| ([50.0 + f64::from(k), 1.0], "", [1.0; 2])).collect();
    write(folder.path(), &rows);
    let table = folder.path().join("branch.csv");
    let curves = passages(&table, Abscissa::FrequencyHz, 51.5).unwrap();
    assert_eq!(curves[0].passages[0].contacts.len(), 2);
    let told = text(&table, Abscissa::FrequencyHz, 51.5, &curves);
    assert!(told.starts_with(&format!("{}: 51.5 Hz is passed once", table.display())), "{told}");
    let refused = |name: &str, text: &str| {
        let path = folder.path().join(name);
        let whole = fs::read_to_string(&path).unwrap();
        fs::write(&path, text).unwrap();
        let said = passages(folder.path(), Abscissa::FrequencyHz, 51.5).unwrap_err().to_string();
        fs::write(&path, whole).unwrap();
        assert!(said.contains(path.to_str().unwrap()), "{said}");
        said
    };
    let [branch, contacts] =
        ["branch.csv", "contacts.csv"].map(|name| fs::read_to_string(folder.path().join(name)).unwrap());
    let cut = |whole: &str, less: usize| whole[..whole.len() - less].to_owned();
    let last = branch.lines().last().unwrap().len();
    let said = refused("branch.csv", &cut(&branch, last - 4));
    assert!(said.contains("line 5: 2 cells in a table of 7 columns; the row is cut or damaged"), "{said}");
    let said = refused("branch.csv", &cut(&branch, 1));
    assert!(said.contains("line 5: the last line has no end; the file is cut"), "{said}");
    let said = refused("branch.csv", &branch.replace("52.0", ""));
    assert!(said.contains("line 4: frequency_hz is \"\", expected a number"), "{said}");
    // Cut within a row, within its last number, and between the rows of a point.
    let said = refused("contacts.csv", &cut(&contacts, 12));
    assert!(said.contains("line 9: ") && said.contains("the row is cut or damaged"), "{said}");
    assert!(refused("contacts.csv", &cut(&contacts, 2)).contains("line 9: the last line has no end"));
    let line = contacts.lines().last().unwrap().len() + 1;
    let said = refused("contacts.csv", &cut(&contacts, line));
    assert!(said.contains("point 3 has 1 of 2 stops; the table is cut or damaged"), "{said}");
    assert!(refused("contacts.csv", &contacts.replace(",impulse_ns", ",sum")).contains("no column impulse_ns"));
    // Missing points: the branch is otherwise unaffected, and unknown values are reported.
    fs::write(folder.path().join("contacts.csv"), cut(&contacts, 2 * line)).unwrap();
    let curves = passages(folder.path(), Abscissa::FrequencyHz, 52.5).unwrap();
    let told = text(folder.path(), Abscissa::FrequencyHz, 52.5, &curves);
    assert!(told.contains("contacts.csv beside the table has no rows of these points, it is cut"), "{told}");
    fs::remove_file(folder.path().join("contacts.csv")).unwrap();
    let told = text(
        folder.path(),
        Abscissa::FrequencyHz,
        52.5,
        &passages(folder.path(), Abscissa::FrequencyHz, 52.5).unwrap(),
    );
    assert!(told.contains("there is no contacts.csv beside the table"), "{told}");
}
