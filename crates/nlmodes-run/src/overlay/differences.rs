use std::f64::consts::TAU;
use std::io;
use std::path::Path;

use nlmodes::modal::{Event, ModalBranch, ModalPoint};
use nlmodes::report::{DataTable, ReportError, write_file};

use super::Laid;

/// Most rows of the table on the page.
const SHOWN: usize = 20;

/// A point that is laid over, against the branch at the same modal amplitude, or the same energy where it has no amplitude.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Difference {
    /// Number of the point that is laid over.
    pub point: usize,
    /// Modal amplitude (m√kg) of both, NaN where energies are equal.
    pub amplitude: f64,
    /// Averaged kinetic energy (J) of both, NaN where amplitudes are equal.
    pub energy: f64,
    /// Frequency of the point, Hz.
    pub frequency: f64,
    /// Frequency of the branch there, Hz.
    pub own_frequency: f64,
    /// Integral of all contact forces over a period at the point, N·s, NaN where it is not known.
    pub impulse: f64,
    /// That of the branch there, N·s.
    pub own_impulse: f64,
    /// Largest contact force of the point, N, NaN where it is not known.
    pub force: f64,
    /// That of the branch there, N.
    pub own_force: f64,
}

impl Difference {
    /// Relative difference of the frequencies, over that of the branch.
    pub fn relative(&self) -> f64 {
        self.frequency / self.own_frequency - 1.0
    }
}

/// The differences of all points that are laid over and lie within the amplitudes, or energies, of the branch; the branch is linear between its
/// points, and where it has an amplitude several times, the frequency nearest to that of the point counts. A point that touches no stop is not held against motions that do.
pub fn differences(laid: &Laid, own: &ModalBranch) -> Vec<Difference> {
    laid.branch.points.iter().enumerate().filter_map(|(number, point)| difference(number, point, own)).collect()
}

fn difference(number: usize, point: &ModalPoint, own: &ModalBranch) -> Option<Difference> {
    let by_amplitude = point.modal_amplitude.is_finite();
    let size = |point: &ModalPoint| if by_amplitude { point.modal_amplitude } else { point.kinetic_energy };
    let wanted = size(point);
    let crossings = own.points.windows(2).filter(|pair| !pair[1].has_event(Event::Resumed)).filter_map(|pair| {
        let (a, b) = (size(&pair[0]), size(&pair[1]));
        let share = if a == b { 0.0 } else { (wanted - a) / (b - a) };
        let within = (a.min(b)..=a.max(b)).contains(&wanted);
        let at = |value: fn(&ModalPoint) -> f64| value(&pair[0]) + share * (value(&pair[1]) - value(&pair[0]));
        within.then(|| (at(|p| p.omega), at(impulse), at(|p| p.peak_contact_force)))
    });
    // A branch without forces may touch or not.
    let touches_as_well =
        |(_, _, force): &(f64, f64, f64)| point.peak_contact_force != 0.0 || force.is_nan() || *force <= 0.0;
    let crossings = crossings.filter(touches_as_well);
    let off = |(omega, ..): &(f64, f64, f64)| (omega - point.omega).abs();
    let (omega, own_impulse, force) = crossings.min_by(|a, b| off(a).total_cmp(&off(b)))?;
    Some(Difference {
        point: number,
        amplitude: if by_amplitude { wanted } else { f64::NAN },
        energy: if by_amplitude { f64::NAN } else { wanted },
        frequency: point.omega / TAU,
        own_frequency: omega / TAU,
        impulse: impulse(point),
        own_impulse,
        force: point.peak_contact_force,
        own_force: force,
    })
}

/// That of the point, NaN where no contact is known.
fn impulse(point: &ModalPoint) -> f64 {
    point.impulse().unwrap_or(f64::NAN)
}

/// Mean, least and largest of the relative differences in per cent; none without a pair of values.
fn percent(pairs: impl Iterator<Item = (f64, f64)>) -> Option<[f64; 3]> {
    let all: Vec<f64> = pairs
        .filter(|(_, own)| *own != 0.0)
        .map(|(value, own)| 100.0 * (value / own - 1.0))
        .filter(|p| p.is_finite())
        .collect();
    let (least, most) = all.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(a, b), x| (a.min(*x), b.max(*x)));
    (!all.is_empty()).then(|| [all.iter().sum::<f64>() / all.len() as f64, least, most])
}

/// By how much the impulse differs, and the largest force, which need not converge; nothing where neither is known.
fn of_forces(found: &[Difference]) -> String {
    let text = |name: &str, note: &str, range: Option<[f64; 3]>| {
        range.map_or_else(String::new, |[mean, least, most]| {
            format!("; {name} by {mean:+.3} % ({least:+.3} to {most:+.3} %){note}")
        })
    };
    let impulse = percent(found.iter().map(|d| (d.impulse, d.own_impulse)));
    let force = percent(found.iter().map(|d| (d.force, d.own_force)));
    let note = ", which of short blows need not converge with harmonics";
    text("its impulse a period", "", impulse) + &text("its largest force", note, force)
}

/// Whether what is laid over is softer or stiffer than the branch, in a sentence.
pub fn sentence(laid: &Laid, found: &[Difference]) -> String {
    let name = &laid.branch.label;
    if found.is_empty() {
        return format!("{name}: no point within the amplitudes of the branch");
    }
    let range = percent(found.iter().map(|difference| (difference.frequency, difference.own_frequency)));
    let [mean, least, most] = range.unwrap_or([f64::NAN; 3]);
    let word = match (least > 0.0, most < 0.0) {
        (true, _) => "stiffer than",
        (_, true) => "softer than",
        _ => "softer here and stiffer there than",
    };
    let what = if found[0].amplitude.is_finite() { "modal amplitude" } else { "energy" };
    format!(
        "{name}: {word} this branch; its frequency at equal {what} differs by {mean:+.3} % on average ({least:+.3} to {most:+.3} %, {} points){}",
        found.len(),
        of_forces(found)
    )
}

/// The differences as a table of the page: evenly chosen rows.
pub fn table(laid: &Laid, found: &[Difference]) -> DataTable {
    let title = format!("{} against this branch", laid.branch.label);
    let head = [
        "point",
        "amplitude, m√kg",
        "energy, J",
        "frequency, Hz",
        "this branch, Hz",
        "difference, %",
        "impulse, N s",
        "this branch, N s",
        "force, N",
        "this branch, N",
    ];
    let mut table = DataTable::new(title, &head);
    let n = found.len();
    let shown =
        if n <= SHOWN { (0..n).collect() } else { (0..SHOWN).map(|k| k * (n - 1) / (SHOWN - 1)).collect::<Vec<_>>() };
    let text = |value: f64| if value.is_finite() { format!("{value:.5}") } else { "–".to_owned() };
    let short = |value: f64| if value.is_finite() { format!("{value:.4e}") } else { "–".to_owned() };
    for difference in shown.into_iter().map(|k| &found[k]) {
        table.rows.push(vec![
            difference.point.to_string(),
            short(difference.amplitude),
            short(difference.energy),
            text(difference.frequency),
            text(difference.own_frequency),
            format!("{:.4}", 100.0 * difference.relative()).replace('-', "−"),
            short(difference.impulse),
            short(difference.own_impulse),
            short(difference.force),
            short(difference.own_force),
        ]);
    }
    table
}

/// Writes the differences of all that is laid over, a row a point: `overlay`, `point`, `modal_amplitude`, `energy_j`, `frequency_hz`,
/// `branch_frequency_hz`, `relative_difference`, `peak_contact_force_n`, `branch_peak_contact_force_n`, `impulse_ns`, `branch_impulse_ns`.
///
/// # Errors
/// [`ReportError::Io`] if the file cannot be written.
pub fn write(path: &Path, all: &[(Laid, Vec<Difference>)]) -> Result<(), ReportError> {
    let mut table = csv::Writer::from_writer(Vec::new());
    let failed = |source: csv::Error| ReportError::Io { path: path.to_path_buf(), source: source.into() };
    table.write_record(nlmodes::report::columns::DIFFERENCE_COLUMNS.map(|column| column.name)).map_err(failed)?;
    for (laid, found) in all {
        for difference in found {
            let number = |value: f64| format!("{value:?}");
            let values = [
                difference.amplitude,
                difference.energy,
                difference.frequency,
                difference.own_frequency,
                difference.relative(),
                difference.force,
                difference.own_force,
                difference.impulse,
                difference.own_impulse,
            ];
            let row = [laid.branch.label.clone(), difference.point.to_string()].into_iter().chain(values.map(number));
            table.write_record(row).map_err(failed)?;
        }
    }
    let bytes = table
        .into_inner()
        .map_err(|error| ReportError::Io { path: path.to_path_buf(), source: io::Error::other(error.to_string()) })?;
    write_file(path, &bytes)
}

#[cfg(test)]
mod tests {
    use super::super::read;
    use super::*;
    use nlmodes::modal::ContactPeriod;
    use nlmodes_scene::scene::Overlay;
    use std::fs;

    /// A branch of frequency `10 + a` Hz over amplitudes 0 to 2 in units of `unit`, that turns back at 12 Hz.
    fn laid(text: &str) -> Laid {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        fs::write(&path, text).unwrap();
        read(&Overlay { path, label: "test".into() }).unwrap()
    }

    #[test]
    fn levels_that_had_not_settled_and_responses_to_loads_are_no_points_of_a_mode() {
        let test = laid(
            "record,frequency_hz,modal_amplitude,findings\na,10.3,0.5,\nb,11.0,1.0,aperiodic skew\nc,11.2,1.5,too-few-modes\n",
        );
        let label = &test.branch.label;
        assert_eq!((test.branch.points.len(), label.as_str()), (2, "test, without 1 that had not settled"));
        let test = laid("frequency_hz,modal_amplitude,findings\n10.3,0.5,not-locked\n");
        assert_eq!((test.branch.points.len(), test.branch.label.as_str()), (1, "test, not settled"));
        let responses =
            "frequency_hz,energy_j,kind,response,curve\n10,1,frequency,1,1\n10,2,damped-mode,2,1\n11,3,mode,3,1\n";
        assert_eq!(laid(responses).branch.points.len(), 1);
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("branch.csv");
        fs::write(&path, "frequency_hz,energy_j,kind,response,curve\n10,1,frequency,1,1\n").unwrap();
        let error = read(&Overlay { path, label: "test".into() }).unwrap_err();
        assert!(error.to_string().contains("holds responses to loads, and no mode"), "{error}");
    }

    #[test]
    fn a_softer_test_is_called_so_with_its_difference_in_any_unit() {
        for unit in [1.0, 1e-6] {
            let own = laid(&format!(
                "frequency_hz,modal_amplitude\n10.0,{:e}\n11.0,{:e}\n12.0,{:e}\n",
                0.0,
                unit,
                2.0 * unit
            ));
            let test = laid(&format!(
                "record,frequency_hz,modal_amplitude,peak_contact_force_n\na,10.29,{:e},5\nb,,,\nc,99,{:e},\nd,11.27,{:e},7\n",
                0.5 * unit,
                9.0 * unit,
                1.5 * unit
            ));
            let found = differences(&test, &own.branch);
            assert_eq!(found.iter().map(|d| d.point).collect::<Vec<_>>(), [0, 2], "rows without values are no points");
            for (difference, wanted) in found.iter().zip([10.5, 11.5]) {
                assert!((difference.own_frequency - wanted).abs() < 1e-12, "{difference:?}");
                assert!((difference.relative() + 0.02).abs() < 1e-12);
            }
            assert_eq!(found[1].force, 7.0);
            let said = sentence(&test, &found);
            assert!(said.contains("softer than") && said.contains("-2.000 %"), "{said}");
        }
    }

    #[test]
    fn impulses_are_compared_where_both_are_known() {
        let contact = |impulse: f64| ContactPeriod { impulse, ..ContactPeriod::default() };
        let table = "frequency_hz,modal_amplitude,peak_contact_force_n\n10,1,100\n11,2,300\n12,3,500\n";
        let (mut own, mut other) =
            (laid(table), laid("frequency_hz,modal_amplitude,peak_contact_force_n\n11.5,2.5,800\n"));
        assert!(differences(&other, &own.branch)[0].impulse.is_nan());
        for (k, point) in own.branch.points.iter_mut().enumerate() {
            point.contacts = vec![contact(k as f64), contact(2.0 * k as f64)];
        }
        other.branch.points[0].contacts = vec![contact(1.5), contact(3.6)];
        let found = differences(&other, &own.branch);
        // Half-way between 3 and 6 N s, and between 300 and 500 N.
        assert!((found[0].impulse - 5.1).abs() < 1e-12 && (found[0].own_impulse - 4.5).abs() < 1e-12);
        let said = sentence(&other, &found);
        assert!(
            said.contains("impulse a period by +13.333 %") && said.contains("largest force by +100.000 %"),
            "{said}"
        );
    }

    #[test]
    fn tables_that_hold_no_points_say_what_is_missing() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("table.csv");
        for (text, wanted) in [
            ("a,b\n1,2\n", "no column frequency_hz"),
            ("frequency_hz,level\n1,2\n", "no column modal_amplitude or energy_j"),
            ("frequency_hz,energy_j\n,\n", "no row with a frequency"),
        ] {
            fs::write(&path, text).unwrap();
            let error = read(&Overlay { path: path.clone(), label: String::new() }).unwrap_err().to_string();
            assert!(error.contains(wanted), "{error}");
        }
        let error = read(&Overlay { path: folder.path().join("none.csv"), label: String::new() }).unwrap_err();
        assert!(crate::chain(&error).contains("none.csv"), "{error}");
        let error = read(&Overlay { path: folder.path().to_path_buf(), label: String::new() }).unwrap_err().to_string();
        assert!(error.contains("neither branch.csv nor modal_points.csv"), "{error}");
    }
}
