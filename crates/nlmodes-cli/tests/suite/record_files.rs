//! Records in the files of MATLAB and HDF5: one of the short records, as other programs wrote it.

use std::error::Error;
use std::fs;
use std::path::Path;

use crate::segments::extract;

type Outcome = Result<(), Box<dyn Error>>;

/// Channels of the short record that are in all files, with quantity, role and position.
const CHANNELS: [(&str, &str, &str, f64); 4] = [
    ("force_N", "force", "excitation", 0.063),
    ("x_drive_m", "displacement", "drive-point", 0.063),
    ("x_tip_m", "displacement", "response", 0.63),
    ("f_contact_N", "force", "contact", 0.63),
];

fn here() -> std::path::PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/records")
}

fn scene(file: &str, sampling: &str, names: [&str; 4], more: &str) -> String {
    let channel = |(name, (_, quantity, role, position)): (&str, (&str, &str, &str, f64))| {
        format!(
            "[[channel]]\nname = \"{name}\"\nquantity = \"{quantity}\"\nrole = \"{role}\"\nposition_m = {position}\n"
        )
    };
    let channels: String = names.into_iter().zip(CHANNELS).map(channel).collect();
    format!("[recording]\nfiles = ['{file}']\n{sampling}\n{channels}[stop]\nposition_m = 0.63\ngap_m = 1e-3\n{more}")
}

#[test]
fn structures_cells_matrices_and_groups_give_the_same_point() -> Outcome {
    let folder = tempfile::tempdir()?;
    let plain = CHANNELS.map(|(name, ..)| name);
    let (time, rate) = ("sample_rate_hz = 8000.0\ntime_column = \"time\"", "sample_rate_hz = 8000.0");
    let csv = here().join("../../../../configs/records/against_stop.csv").display().to_string();
    let text = scene(&csv, "sample_rate_hz = 8000.0\ntime_column = \"time_s\"", plain, "");
    let (status, said, expected) = extract(folder.path(), &text)?;
    assert_eq!((status, expected.len()), (0, 1), "{said}");
    let flag = "[[segment]]\nflag = \"settled\"\n";
    for (file, sampling, names, more) in [
        ("cells.mat#Tests{2}", time, plain, flag),
        ("cells.mat", "sample_rate_hz = 8000.0\ntime_column = \"Tests{2}.time\"", plain, ""),
        ("matrix.mat", rate, ["data(1)", "data(:,2)", "data(:,3)", "data(4)"], ""),
        ("nested73.mat#run", time, plain, flag),
        ("nested73.mat", time, ["run.sig.force_N", "x_drive_m", "run.sig.x_tip_m", "f_contact_N"], ""),
        ("groups.h5#run1", time, ["data(1,:)", "data(2)", "data(3)", "data(4,:)"], ""),
    ] {
        let text = scene(&here().join(file).display().to_string(), sampling, names, more);
        let (status, said, rows) = extract(folder.path(), &text)?;
        assert_eq!((status, rows.len()), (0, 1), "{file}: {said}");
        for (column, value) in &expected[0] {
            if column != "record" {
                assert_eq!(&rows[0][column], value, "{file}: {column}");
            }
        }
    }
    Ok(())
}

#[test]
fn what_is_not_in_such_a_file_is_answered_by_what_is() -> Outcome {
    let folder = tempfile::tempdir()?;
    let plain = CHANNELS.map(|(name, ..)| name);
    let rate = "sample_rate_hz = 8000.0";
    for (file, sampling, names, said) in [
        ("cells.mat#Tests{3}", rate, plain, "Tests{2}.force_N"),
        ("cells.mat", rate, ["a", "b", "c", "d"], "Tests{2}.x_tip_m = x_tip_m"),
        ("nested73.mat", "time_column = \"zeit\"", plain, "there is no column \"zeit\""),
        ("nowhere.mat", rate, plain, "nowhere.mat"),
        ("matrix.mat", "", plain, "no sampling rate is known"),
    ] {
        let text = scene(&here().join(file).display().to_string(), sampling, names, "");
        let (status, found, rows) = extract(folder.path(), &text)?;
        assert!(status == 2 && rows.is_empty() && found.contains(said), "{file}: {status} {found}");
    }
    let broken = folder.path().join("broken.mat");
    let bytes = fs::read(here().join("cells.mat"))?;
    fs::write(&broken, &bytes[..bytes.len() / 2])?;
    let (status, found, _) = extract(folder.path(), &scene("broken.mat", rate, plain, ""))?;
    assert!(status == 2 && found.contains("broken.mat"), "{found}");
    Ok(())
}
