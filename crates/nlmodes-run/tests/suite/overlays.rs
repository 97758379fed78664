//! Responses with other responses laid over them.

use std::fs;
use std::path::Path;

use nlmodes::report::columns::{Cells, Row, StopDifferenceRow};
use nlmodes_run::{Event, Observer, Over, Silent};
use nlmodes_scene::parse;

/// A rod before a stop, driven at two levels around its resonance.
fn run(directory: &Path, overlays: &str) -> String {
    let text = format!(
        "[structure]\nkind = \"rod\"\nlength_m = 1.0\nelements = 6\nstart = \"clamped\"\n\
         material = {{ youngs_modulus_pa = 210e9, density_kg_m3 = 7800.0 }}\nsection = {{ area_m2 = 1e-4 }}\n\
         [[contact]]\nat_m = 1.0\ndirection = \"axial\"\nside = \"positive\"\ngap_m = 1e-4\n[damping]\nratio = \
         0.02\n[[force]]\nat_m = 0.5\n\
         [[response]]\nkind = \"frequency\"\nfrequency_hz = [1200.0, 1400.0]\nlevels_n = [40.0, 300.0]\n\
         [[response]]\nkind = \"damped-mode\"\nfrequency_hz = [1200.0, 1400.0]\n\
         [method]\nharmonics = 5\n[output]\nstability = \"never\"\n{overlays}"
    );
    let mut file = parse("scene.toml", &text, &[]).unwrap_or_else(|refused| panic!("{}", refused.text(false)));
    file.scene.output_directory = directory.to_path_buf();
    nlmodes_run::responses::check(&file, &mut Silent).unwrap();
    let outcome = nlmodes_run::responses::run(&file, Over::Same, &mut Silent).unwrap();
    assert!(outcome.failure.is_none(), "{:?}", outcome.failure);
    fs::read_to_string(directory.join("branch.csv")).unwrap()
}

/// The columns of a table by name, as numbers.
fn column(table: &str, name: &str) -> Vec<f64> {
    let mut lines = table.lines();
    let place = lines.next().unwrap().split(',').position(|column| column == name).unwrap();
    lines.map(|line| line.split(',').nth(place).unwrap().parse().unwrap_or(f64::NAN)).collect()
}

#[test]
fn a_run_laid_over_itself_differs_by_nothing_and_a_measurement_by_what_it_was_changed() {
    let place = tempfile::tempdir().unwrap();
    let first = place.path().join("first");
    let table = run(&first, "");
    assert!(!first.join("response_overlay.csv").exists());
    // Every fifth point of the lower level, ten per cent larger.
    let (hertz, level, tip) =
        (column(&table, "frequency_hz"), column(&table, "level"), column(&table, "fundamental_m"));
    let mut measured = "frequency_hz,level,fundamental_m\n".to_owned();
    let of_level = (0..hertz.len()).filter(|k| level[*k] == 40.0).skip(1).step_by(5);
    let chosen: Vec<usize> = of_level.collect();
    chosen.iter().for_each(|k| measured += &format!("{},40,{}\n", hertz[*k], 1.1 * tip[*k]));
    fs::write(place.path().join("rig.csv"), measured).unwrap();
    let second = place.path().join("second");
    let overlays = format!(
        "[[overlay]]\npath = '{}'\nlabel = \"before\"\n[[overlay]]\npath = '{}'\nlabel = \"rig\"\n",
        first.display(),
        place.path().join("rig.csv").display()
    );
    run(&second, &overlays);
    let compared = fs::read_to_string(second.join("response_overlay.csv")).unwrap();
    let (own, laid) = (column(&compared, "curve_fundamental_m"), column(&compared, "fundamental_m"));
    let names: Vec<&str> = compared.lines().skip(1).map(|line| line.split(',').next().unwrap()).collect();
    assert_eq!(names.iter().filter(|name| **name == "rig").count(), chosen.len());
    assert!(names.len() > 2 * chosen.len() && !compared.contains("mode"), "{compared}");
    for ((name, own), laid) in names.iter().zip(&own).zip(&laid) {
        let expected = if *name == "rig" { 1.1 } else { 1.0 };
        // Points that the curve has itself; a difference by the branch that is nearest cannot be larger.
        assert!((laid / own - expected).abs() < 1e-9, "{name}: {laid:e} beside {own:e}");
    }
    let page = fs::read_to_string(second.join("report.html")).unwrap();
    let n = chosen.len();
    let wanted =
        format!("rig: at equal frequency its fundamental at the first contact differs by +10.0 % at {n} points");
    assert!(
        page.contains(&wanted),
        "{wanted}, not {}",
        page.split("rig: ").nth(1).unwrap_or_default().chars().take(200).collect::<String>()
    );
    let figure = fs::read_to_string(second.join("responses.svg")).unwrap();
    assert_eq!(figure.matches("class=\"measured\"").count(), chosen.len());
}

#[test]
fn a_table_without_amplitudes_is_refused_at_its_place() {
    let place = tempfile::tempdir().unwrap();
    fs::write(place.path().join("rig.csv"), "frequency_hz,modal_amplitude\n40,1e-3\n").unwrap();
    let overlay = format!("[[overlay]]\npath = '{}'\n", place.path().join("rig.csv").display());
    let refused = std::panic::catch_unwind(|| run(&place.path().join("out"), &overlay)).unwrap_err();
    let text = refused.downcast_ref::<String>().unwrap();
    assert!(text.contains("fundamental_m or drive_fundamental_m"), "{text}");
}

/// A beam before two stops of unlike gaps, with so many harmonics.
fn two_stops(harmonics: &str) -> Vec<nlmodes_scene::SceneFile> {
    let text = format!(
        "[structure]\nkind = \"beam\"\nlength_m = 0.31\nelements = 8\nstart = \"clamped\"\n\
         material = {{ youngs_modulus_pa = 70e9, density_kg_m3 = 2700.0 }}\nsection = {{ width_m = 0.02, height_m = \
         0.004 }}\n\
         [[contact]]\nat_m = 0.31\ndirection = \"transverse\"\nside = \"positive\"\ngap_m = 3e-4\n\
         [[contact]]\nat_m = 0.155\ndirection = \"transverse\"\nside = \"negative\"\ngap_m = 1.1e-4\n\
         [method]\nharmonics = {harmonics}\n[continuation]\nmax_energy_ratio = 3.0\ninternal_resonance = \"skip\"\n"
    );
    nlmodes_scene::parse_each_method("beam.toml", &text, &[])
        .unwrap_or_else(|refused| panic!("{}", refused.text(false)))
}

/// The cells of a column as they are.
fn cells(table: &str, name: &str) -> Vec<String> {
    let mut rows = csv::Reader::from_reader(table.as_bytes());
    let place = rows.headers().unwrap().iter().position(|column| column == name).unwrap();
    rows.records().map(|row| row.unwrap()[place].to_owned()).collect()
}

/// The same as numbers.
fn numbers(table: &str, name: &str) -> Vec<f64> {
    cells(table, name).iter().map(|cell| cell.parse().unwrap_or(f64::NAN)).collect()
}

#[test]
fn the_impulse_of_each_stop_is_compared_at_equal_amplitude_and_at_equal_frequency() {
    let place = tempfile::tempdir().unwrap();
    let mut scenes = two_stops("[3, 6]");
    scenes[0].scene.output_directory = place.path().to_path_buf();
    let outcome = nlmodes_run::run(scenes, Over::Same, &mut Silent).unwrap();
    assert!(outcome.failure.is_none(), "{:?}", outcome.failure);
    let compared = fs::read_to_string(place.path().join("methods_stops.csv")).unwrap();
    let header = StopDifferenceRow::unknown().header().join(",");
    assert_eq!(compared.lines().next().unwrap(), header);
    let read = |name: &str| fs::read_to_string(place.path().join(name)).unwrap();
    let (few, many) = (read("h3/branch.csv"), read("h6/branch.csv"));
    let stop_of = |branch: &str, stop: usize| {
        let table = read(&format!("{branch}/contacts.csv"));
        let all = cells(&table, "contact").into_iter().zip(numbers(&table, "impulse_ns"));
        all.filter(|(contact, _)| *contact == stop.to_string()).map(|(_, impulse)| impulse).collect::<Vec<f64>>()
    };
    // By a search of its own for the pair of points around the frequency or the amplitude.
    let around = |of: &[f64], wanted: f64, values: &[f64]| {
        let pairs = (1..of.len()).filter(|k| (of[k - 1].min(of[*k])..=of[k - 1].max(of[*k])).contains(&wanted));
        let value = |k: usize| values[k - 1] + (wanted - of[k - 1]) / (of[k] - of[k - 1]) * (values[k] - values[k - 1]);
        pairs.map(value).collect::<Vec<f64>>()
    };
    let (points, stops, equal) = (cells(&compared, "point"), cells(&compared, "contact"), cells(&compared, "equal"));
    let (laid, own) = (numbers(&compared, "impulse_ns"), numbers(&compared, "branch_impulse_ns"));
    let mut seen = [0; 2];
    let motions = cells(&compared, "motions");
    for row in (0..laid.len()).filter(|row| motions[*row] == "1").step_by(7) {
        let (point, stop): (usize, usize) = (points[row].parse().unwrap(), stops[row].parse().unwrap());
        let by = if equal[row] == "frequency" { "frequency_hz" } else { "modal_amplitude" };
        assert_eq!(laid[row], stop_of("h6", stop)[point]);
        let expected = around(&numbers(&few, by), numbers(&many, by)[point], &stop_of("h3", stop));
        let scale = stop_of("h3", stop).into_iter().fold(0.0, f64::max);
        assert!(
            expected.iter().any(|value| (value - own[row]).abs() < 1e-9 * scale),
            "{by} {point} {stop}: {expected:?}"
        );
        seen[usize::from(by == "frequency_hz")] += 1;
    }
    assert!(seen.iter().all(|count| *count > 3), "{seen:?}");
    // In words and on the page.
    let lines = outcome.compared.join("\n");
    let page = read("report.html");
    for name in ["stop 0 at 0.31 m", "stop 1 at 0.155 m"] {
        assert!(lines.contains(&format!("impulse of {name}: at equal modal amplitude")), "{lines}");
        assert_eq!(page.matches(&format!("<td>{name}</td>")).count(), 2, "a row for each comparison");
    }
    assert_eq!(lines.matches("at equal frequency").count(), 2, "{lines}");
}

/// What a check warns of.
#[derive(Default)]
struct Warnings(Vec<String>);

impl Observer for Warnings {
    fn event(&mut self, event: Event<'_>) {
        if let Event::Warning(text) = event {
            self.0.push(text.to_owned());
        }
    }
}

/// Checks a beam with this table laid over it: what is reported of the table, as a warning or an error.
fn said_of(table: &[u8]) -> Result<Vec<String>, String> {
    let place = tempfile::tempdir().unwrap();
    let path = place.path().join("rig.csv");
    fs::write(&path, table).unwrap();
    let text = format!(
        "[structure]\nkind = \"beam\"\nlength_m = 0.31\nelements = 8\nstart = \"clamped\"\n\
         material = {{ youngs_modulus_pa = 70e9, density_kg_m3 = 2700.0 }}\nsection = {{ width_m = 0.02, height_m = \
         0.004 }}\n\
         [[contact]]\nat_m = 0.31\ndirection = \"transverse\"\nside = \"positive\"\ngap_m = 3e-4\n\
         [method]\nharmonics = 3\nmass_redistribution = \"conserve\"\n[continuation]\nmax_energy_ratio = \
         3.0\n[[overlay]]\npath = '{}'\n",
        path.display()
    );
    let file = parse("beam.toml", &text, &[]).unwrap();
    let mut warnings = Warnings::default();
    let checked = nlmodes_run::check(&file, &mut warnings);
    let short = |text: &String| text.replace(path.to_str().unwrap(), "rig.csv");
    checked.map(|_| warnings.0.iter().map(short).filter(|said| said.contains("rig.csv")).collect()).map_err(|error| {
        match error {
            nlmodes_run::RunError::Scene(said) => short(&said.text(false)),
            other => panic!("{other}"),
        }
    })
}

#[test]
fn tables_of_spreadsheets_are_read_and_rows_that_are_not_used_are_counted() {
    let plain = "# rig of 3 May\nfrequency_hz,modal_amplitude\n40,1e-3\n41,2e-3\n";
    assert_eq!(said_of(plain.as_bytes()), Ok(vec![]));
    let spreadsheet = "\u{feff}Frequency_Hz;Modal_Amplitude;;\r\n40;1e-3;;\r\n41;2e-3;;\r\n";
    assert_eq!(said_of(spreadsheet.as_bytes()), Ok(vec![]));
    let holes = "frequency_hz\tenergy_j\n40\t1e-3\n\t2e-3\n# lost\n0\t1\n43\t\n";
    let wanted = "rig.csv: 3 of 4 rows are not used: 2 without a frequency above 0 Hz (first in line 3), 1 with \
        neither an amplitude nor an energy (line 6)";
    assert_eq!(said_of(holes.as_bytes()), Ok(vec![wanted.to_owned()]));
}

#[test]
fn tables_that_cannot_be_read_are_refused_with_their_line_and_what_was_expected() {
    let cases: [(&[u8], &str); 6] = [
        (b"f;A\n40;1e-3\n", "rig.csv, line 1: no column frequency_hz; there are f, A"),
        (
            b"# A\nfrequency_hz;A\n40;1e-3\n",
            "rig.csv, line 2: no column modal_amplitude or energy_j; there are frequency_hz, A",
        ),
        (
            b"frequency_hz;energy_j\n40,7;1e-3\n",
            "rig.csv, line 2: frequency_hz is \"40,7\", expected a number with a decimal point, 40.7",
        ),
        (
            b"frequency_hz,energy_j\n40,7,1,5\n",
            "rig.csv, line 2: 4 cells in a table of 2 columns; decimal commas? expected decimal points",
        ),
        (
            b"frequency_hz,energy_j\n\n40\n",
            "rig.csv, line 3: 1 cell in a table of 2 columns; the row is cut or damaged",
        ),
        (b"\xff\xfef\0r\0", "rig.csv, line 1: this is no text in UTF-8, expected a table as text"),
    ];
    for (table, wanted) in cases {
        let said = said_of(table).unwrap_err();
        assert!(said.contains(wanted), "{said}");
    }
}
