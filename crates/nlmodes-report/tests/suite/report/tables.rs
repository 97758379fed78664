use crate::report::samples;
use nlmodes_modal::{ContactPeriod, Driven, InternalResonance, ModalPoint, Stability};
use nlmodes_modal::{Event, HarmonicCoefficients};
use nlmodes_report::columns::{BranchRow, Cells, ContactRow, ResponseOf, ResponseRow, Row};
use nlmodes_report::{BranchWriter, ReportError, write_branch, write_harmonics, write_summary};
use npyz::npz::NpzArchive;
use num_complex::Complex64;
use std::f64::consts::TAU;
use std::fs;
use std::process::Command;
use tempfile::tempdir;

const HEADER: &str = "point,frequency_hz,energy_j,total_energy_j,modal_amplitude,fundamental_m,peak_m,contact_fraction,\
                      contact_intervals,peak_contact_force_n,residual,event,resonance,\
                      stable,largest_multiplier,multiplier_angle_deg,harmonics,error_estimate,impulse_ns,\
                      stress_pa,stress_at";

#[test]
fn branch_reads_back_bit_for_bit() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("branch.csv");
    let mut branch = samples::looped(57);
    branch.points[3].residual = 5e-324;
    branch.points[4].fundamental = -0.0;
    branch.points[5].events = vec![Event::Fold, Event::Kink];
    write_branch(&path, &branch).unwrap();
    let mut table = csv::Reader::from_path(&path).unwrap();
    let rows: Vec<csv::StringRecord> = table.records().map(Result::unwrap).collect();
    assert_eq!(rows.len(), 57);
    for (index, (row, point)) in rows.iter().zip(&branch.points).enumerate() {
        let floats = [
            (2, point.kinetic_energy),
            (3, point.total_energy),
            (4, point.modal_amplitude),
            (5, point.fundamental),
            (6, point.peak),
            (7, point.contact_fraction),
            (9, point.peak_contact_force),
            (10, point.residual),
        ];
        // Half of the 15th digit, and the rounding of the division.
        let hertz: f64 = row[1].parse().unwrap();
        assert!((hertz * TAU / point.omega - 1.0).abs() < 5e-15 + f64::EPSILON && row[1].len() < 20, "{}", &row[1]);
        for (column, value) in floats {
            assert_eq!(
                row[column].parse::<f64>().unwrap().to_bits(),
                value.to_bits(),
                "{}",
                BranchRow::COLUMNS[column].name
            );
        }
        assert_eq!(row[0].parse::<usize>().unwrap(), index);
        assert_eq!(row[8].parse::<usize>().unwrap(), point.contact_intervals);
        assert_eq!(row[11], Event::names(&point.events));
    }
    assert_eq!(&rows[5][11], "fold kink");
}

#[test]
fn header_is_the_agreed_one() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("branch.csv");
    write_branch(&path, &samples::rod(0, 1)).unwrap();
    assert_eq!(fs::read_to_string(&path).unwrap(), format!("{HEADER}\n"));
    assert_eq!(BranchRow::COLUMNS.iter().map(|column| column.name).collect::<Vec<_>>().join(","), HEADER);
}

#[test]
fn incremental_writer_has_each_row_on_disk_at_once() {
    let folder = tempdir().unwrap();
    let (whole, grown) = (folder.path().join("whole.csv"), folder.path().join("grown.csv"));
    let branch = samples::looped(5);
    let mut writer = BranchWriter::create(&grown).unwrap();
    for (index, point) in branch.points.iter().enumerate() {
        writer.append(point).unwrap();
        assert_eq!(fs::read_to_string(&grown).unwrap().lines().count(), index + 2);
    }
    assert_eq!(writer.n_points(), 5);
    write_branch(&whole, &branch).unwrap();
    assert_eq!(fs::read(&grown).unwrap(), fs::read(&whole).unwrap());
}

#[test]
fn harmonics_read_back() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("harmonics.npz");
    let branch = samples::rod(7, 3);
    write_harmonics(&path, &branch).unwrap();
    let mut archive = NpzArchive::open(&path).unwrap();
    let names: Vec<String> = archive.array_names().map(String::from).collect();
    assert_eq!(names.len(), 4, "{names:?}");

    let omega = archive.by_name("omega").unwrap().unwrap().into_vec::<f64>().unwrap();
    assert_eq!(omega, branch.points.iter().map(|point| point.omega).collect::<Vec<_>>());
    let coefficients = archive.by_name("coefficients").unwrap().unwrap();
    assert_eq!(coefficients.shape(), [7, 80, 4]);
    let coefficients = coefficients.into_vec::<Complex64>().unwrap();
    assert_eq!(coefficients[(5 * 80 + 78) * 4..][..4], *branch.points[5].coefficients.of(78));
    let positions = archive.by_name("dof_position_m").unwrap().unwrap().into_vec::<f64>().unwrap();
    assert_eq!(positions[78], 20.0);
    let kinds = archive.by_name("dof_kind").unwrap().unwrap();
    assert_eq!(kinds.dtype().descr(), "'<U8'");
    assert_eq!(kinds.into_vec::<String>().unwrap()[77..], ["rotation", "axial", "rotation"]);
}

/// Skipped without Python with NumPy: the format itself is checked above.
#[test]
fn numpy_loads_the_harmonics_without_pickle() {
    let python = std::env::var("NLMODES_PYTHON").unwrap_or_else(|_| "python3".into());
    if !Command::new(&python).args(["-c", "import numpy"]).output().is_ok_and(|output| output.status.success()) {
        return;
    }
    let folder = tempdir().unwrap();
    let path = folder.path().join("harmonics.npz");
    write_harmonics(&path, &samples::rod(2, 1)).unwrap();
    let script = "import sys, numpy; a = numpy.load(sys.argv[1], allow_pickle=False); c = a['coefficients']\n\
                  print(c.dtype, c.shape, a['omega'].dtype, a['dof_position_m'].shape, *a['dof_kind'][:2])";
    let output = Command::new(&python).args(["-c", script]).arg(&path).output().unwrap();
    let said = String::from_utf8_lossy(&output.stdout).into_owned();
    assert_eq!(said.trim(), "complex128 (2, 80, 2) float64 (80,) axial rotation", "{output:?}");
}

#[test]
fn branch_without_points_is_an_empty_archive() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("harmonics.npz");
    write_harmonics(&path, &samples::rod(0, 1)).unwrap();
    let mut archive = NpzArchive::open(&path).unwrap();
    assert_eq!(archive.by_name("coefficients").unwrap().unwrap().shape(), [0, 80, 1]);
}

#[test]
fn fewer_harmonics_are_padded_and_other_coordinates_refused_by_name() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("harmonics.npz");
    let mut branch = samples::rod(3, 1);
    branch.points[2].coefficients = samples::rod(1, 4).points[0].coefficients.clone();
    write_harmonics(&path, &branch).unwrap();
    let mut archive = NpzArchive::open(&path).unwrap();
    let array = archive.by_name("coefficients").unwrap().unwrap();
    assert_eq!(array.shape(), [3, 80, 5]);
    let all = array.into_vec::<Complex64>().unwrap();
    for (point, row) in branch.points.iter().zip(all.chunks(80 * 5)) {
        let own = point.coefficients.n_harmonics() + 1;
        assert_eq!(row[7 * 5..7 * 5 + own], *point.coefficients.of(7));
        assert!(row[7 * 5 + own..8 * 5].iter().all(|q| *q == Complex64::default()));
    }
    branch.points[2].coefficients = HarmonicCoefficients::zeros(3, 4);
    let other = folder.path().join("other.npz");
    let error = write_harmonics(&other, &branch).unwrap_err();
    assert!(matches!(error, ReportError::CoefficientShape { point: 2, found: (3, 5), expected: (80, 5) }), "{error}");
    assert!(!other.exists());
}

#[test]
fn summary_is_indented_json() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("summary.json");
    write_summary(&path, &serde_json::json!({"version": "0.1.0", "grazing": {"frequency_hz": 60.78660727}})).unwrap();
    let text = fs::read_to_string(&path).unwrap();
    assert!(text.contains("\n  \"grazing\": {\n    \"frequency_hz\": 60.78660727"), "{text}");
    assert_eq!(fs::read_dir(folder.path()).unwrap().count(), 1);
}

#[test]
fn error_names_the_file_that_cannot_be_written() {
    let folder = tempdir().unwrap();
    let path = folder.path().join("missing").join("branch.csv");
    let branch = samples::rod(2, 1);
    let errors = [
        write_branch(&path, &branch).unwrap_err(),
        write_harmonics(&path, &branch).unwrap_err(),
        write_summary(&path, &1).unwrap_err(),
        BranchWriter::create(&path).unwrap_err(),
    ];
    for error in errors {
        assert!(matches!(&error, ReportError::Io { path: named, .. } if *named == path), "{error:?}");
        assert!(error.to_string().contains("branch.csv"), "{error}");
    }
}

#[test]
fn withdrawn_rows_are_off_the_disk_and_others_take_their_place() {
    let folder = tempdir().unwrap();
    let (whole, shortened) = (folder.path().join("whole.csv"), folder.path().join("shortened.csv"));
    let branch = samples::looped(6);
    write_branch(&whole, &branch).unwrap();
    let mut writer = BranchWriter::create(&shortened).unwrap();
    branch.points[..5].iter().for_each(|point| writer.append(point).unwrap());
    writer.truncate(7).unwrap();
    assert_eq!(writer.n_points(), 5);
    writer.truncate(2).unwrap();
    assert_eq!(fs::read_to_string(&shortened).unwrap().lines().count(), 3);
    branch.points[2..].iter().for_each(|point| writer.append(point).unwrap());
    assert_eq!(fs::read_to_string(&shortened).unwrap(), fs::read_to_string(&whole).unwrap());
}

/// The row whose cells are these.
fn read<R: Row>(cells: &[String]) -> R {
    R::read(|column| &cells[column]).unwrap()
}

#[test]
fn what_is_written_of_a_response_reads_back_in_any_unit() {
    for unit in [1.0, 1e-6] {
        let stop = ContactPeriod { impulse: 0.3 * unit, touches: 2, closed_share: 0.25, ..ContactPeriod::default() };
        let point = ModalPoint {
            omega: TAU * 20.0,
            kinetic_energy: 2.0 * unit,
            resonance: Some(InternalResonance { harmonic: 3, mode: 2 }),
            stability: Some(Stability::damped([-1.5, 0.0], 1e-4)),
            contacts: vec![stop, ContactPeriod { impulse: 0.1 * unit, ..stop }],
            events: vec![Event::PeriodDoubling, Event::Kink],
            driven: Some(Driven {
                omega: TAU * 40.0,
                level: Some(4.0 * unit),
                force: None,
                drive: Some(Complex64::new(0.0, -1e-3 * unit)),
                input_power: Some(0.5 * unit),
                dissipated_power: 0.5 * unit,
                damping_ratio: None,
                indicator: Some(f64::NAN),
                mode_distance: None,
            }),
            ..ModalPoint::default()
        };
        let of = ResponseOf { response: 1, kind: "frequency", curve: 2, name: "a, b", is_detached: false, unit: "m" };
        let row = (BranchRow::of(7, &point), ResponseRow::of(of, &point));
        assert_eq!(row.header().len(), row.cells().len());
        let (own, response): (BranchRow, ResponseRow) = (read(&row.0.cells()), read(&row.1.cells()));
        assert_eq!((&own, &response), (&row.0, &row.1));
        // The load has twice the frequency of the motion; lag and level are those of the load, with its unit.
        assert_eq!((own.frequency_hz, own.stable, own.multiplier_angle_deg), (40.0, Some(false), Some(180.0)));
        assert_eq!((response.drive_lag_deg, response.base_amplitude_m), (Some(90.0), Some(4.0 * unit)));
        assert_eq!((response.level_unit(), response.pbmif, response.force_n), (Some("m"), None, None));
        assert_eq!(response.curve_name(), "frequency of response 1, a, b, curve 2");
        // All but its motion and its load is there again.
        let periods: Vec<ContactPeriod> =
            ContactRow::of(7, &point).map(|row| read::<ContactRow>(&row.cells()).period()).collect();
        let again = own.point(periods);
        assert_eq!(
            (&again.contacts, &again.events, again.resonance),
            (&point.contacts, &point.events, point.resonance)
        );
        assert!((again.impulse().unwrap() / (0.4 * unit) - 1.0).abs() < 1e-15 && again.driven.is_none());
    }
}

#[test]
fn a_cell_that_holds_something_else_is_named_and_an_unknown_column_is_empty() {
    let wrong = BranchRow::read(|column| if BranchRow::COLUMNS[column].name == "energy_j" { "much" } else { "" });
    assert_eq!(wrong.unwrap_err().name, "energy_j");
    let none = BranchRow::read(|_| "").unwrap();
    assert!(none.frequency_hz.is_nan() && none.stable.is_none() && none.event.is_empty());
    assert_eq!(BranchRow::unknown().header().len(), BranchRow::COLUMNS.len());
}
