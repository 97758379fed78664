//! Matrices, labels, mesh and units together.

use std::fs;
use std::path::Path;

use nlmodes_io::{Address, Component, FeFiles, FeModel, NodeChoice};

use crate::sample::{N, mass, stiffness};
use crate::writers;

/// What makes good files bad.
type Change<'a> = Box<dyn Fn(&mut FeFiles) + 'a>;

fn written(directory: &Path, name: &str, text: &str) -> String {
    let path = directory.join(name);
    fs::write(&path, text).unwrap();
    path.to_string_lossy().into_owned()
}

/// The sample in CalculiX's files.
fn calculix(directory: &Path) -> FeFiles {
    let stiffness = written(directory, "x.sti", &writers::calculix(&stiffness()));
    let mass = written(directory, "x.mas", &writers::calculix(&mass()));
    let dofs = written(directory, "x.dof", &writers::dof());
    FeFiles { dofs: Some(dofs.into()), ..FeFiles::new(&stiffness, &mass) }
}

fn close(a: &FeModel, b: &FeModel, tolerance: f64) {
    assert_eq!(a.labels, b.labels);
    for (a, b) in [(&a.stiffness, &b.stiffness), (&a.mass, &b.mass)] {
        assert_eq!(a.n_entries(), b.n_entries());
        for (p, q) in a.entries().zip(b.entries()) {
            assert!((p.0, p.1) == (q.0, q.1) && (p.2 - q.2).abs() <= tolerance * q.2.abs(), "{p:?} {q:?}");
        }
    }
}

#[test]
fn models_of_all_programs_are_one_model() {
    let directory = tempfile::tempdir().unwrap();
    let of_calculix = FeModel::read(&calculix(directory.path())).unwrap();
    let dofs = written(directory.path(), "x.csv", &writers::table());
    let mapping = written(directory.path(), "x.mapping", &writers::mapping());
    let pairs = [
        ("k.mtx", writers::matrix_market(&stiffness()), "m.mtx", writers::matrix_market(&mass()), Some(&dofs), 1e-13),
        (
            "k.hb",
            writers::harwell_boeing(&stiffness()),
            "m.hb",
            writers::harwell_boeing(&mass()),
            Some(&mapping),
            1e-13,
        ),
        ("ka.mtx", writers::abaqus(&stiffness(), true), "ma.mtx", writers::abaqus(&mass(), false), None, 1e-13),
        ("k.pch", writers::dmig("KAAX", &stiffness()), "m.pch", writers::dmig("MAAX", &mass()), None, 1e-9),
    ];
    for (k, k_text, m, m_text, dofs, tolerance) in pairs {
        let (k, m) = (written(directory.path(), k, &k_text), written(directory.path(), m, &m_text));
        let files = FeFiles { dofs: dofs.map(Into::into), ..FeFiles::new(&k, &m) };
        let model = FeModel::read(&files).unwrap_or_else(|error| panic!("{k}: {error}"));
        close(&model, &of_calculix, tolerance);
    }
    // Both matrices of Nastran in one file, by their names.
    let both = writers::dmig("KAAX", &stiffness()) + &writers::dmig("MAAX", &mass());
    let punch = written(directory.path(), "both.pch", &both);
    let model = FeModel::read(&FeFiles::new(&format!("{punch}#KAAX"), &format!("{punch}#MAAX"))).unwrap();
    close(&model, &of_calculix, 1e-9);
    let unnamed = FeModel::read(&FeFiles::new(&punch, &punch)).unwrap_err().to_string();
    assert!(
        unnamed.contains("found several matrices: `KAAX`, `MAAX`") && unnamed.contains("both.pch#KAAX"),
        "{unnamed}"
    );
}

#[test]
fn one_model_in_three_systems_of_units_is_one_model_in_si() {
    let directory = tempfile::tempdir().unwrap();
    // A displacement and a rotation: beam elements of 0.5 m, in kg, m, s; mm, t, s; mm, kg, ms.
    let (k, m) = ([1.2e6, -3.0e5, 1.0e5], [4.0, 0.1, 0.02]);
    let systems = [("m-kg-s", [1.0, 1.0, 1.0]), ("mm-t-s", [1e-3, 1e3, 1.0]), ("mm-kg-ms", [1e-3, 1.0, 1e-3])];
    let models = systems.map(|(name, [length, mass, time])| {
        let matrix = |entries: [f64; 3], per_time: f64| {
            // The file's number is the SI number over the file's units: mass per time², and a length for each rotation.
            let unit = |rotations: i32| mass * f64::powi(length, rotations) / per_time;
            let [a, b, c] = [0, 1, 2].map(|k| entries[k] / unit(k as i32));
            format!("1 1 {a:e}\n1 2 {b:e}\n2 2 {c:e}\n")
        };
        let stiffness = written(directory.path(), "u.sti", &matrix(k, time * time));
        let mass = written(directory.path(), "u.mas", &matrix(m, 1.0));
        let place = 0.25 / length;
        let table = written(directory.path(), "u.csv", &format!("1,5,uz,{place},0,0\n2,5,roty,{place},0,0\n"));
        let files =
            FeFiles { dofs: Some(table.into()), units: name.parse().unwrap(), ..FeFiles::new(&stiffness, &mass) };
        FeModel::read(&files).unwrap()
    });
    for model in &models {
        close(model, &models[0], 1e-14);
        let [x, ..] = model.place_of(5).unwrap();
        assert!((x - 0.25).abs() < 1e-16);
        assert!((model.stiffness.get(0, 1) + 3.0e5).abs() < 1e-9 && (model.mass.get(1, 1) - 0.02).abs() < 1e-16);
    }
}

#[test]
fn nodes_that_the_files_leave_free_are_held_by_number_and_by_set() {
    let directory = tempfile::tempdir().unwrap();
    let mut files = calculix(directory.path());
    let deck = "*NODE\n10,0,0,0\n20,1,0,0\n30,2,0,0\n*NSET, NSET=CLAMP\n10, 30\n*NSET, NSET=NONE\n";
    files.mesh = Some(written(directory.path(), "x.inp", deck).into());
    let free = FeModel::read(&files).unwrap();
    files.fixed = vec![NodeChoice::Set("CLAMP".into()), NodeChoice::Node(80)];
    let held = FeModel::read(&files).unwrap();
    assert_eq!((held.n_dofs(), held.fixed.len()), (N - 9, 9));
    assert_eq!(held.row_of(10, Component::X), None);
    for (i, a) in held.labels.iter().enumerate() {
        for (j, b) in held.labels.iter().enumerate() {
            let (p, q) = (free.row_of(a.node, a.component).unwrap(), free.row_of(b.node, b.component).unwrap());
            assert_eq!(held.stiffness.get(i, j), free.stiffness.get(p, q));
            assert_eq!(held.mass.get(i, j), free.mass.get(p, q));
        }
    }
    assert_eq!(held.nodes_without_place(), [40, 50, 60, 70]);
    // Where all nodes have places, or none is known, the base moves all of them; the rows of the whole mass tell the
    // inertia.
    files.mesh = None;
    files.fixed = vec![NodeChoice::Node(10), NodeChoice::Node(80)];
    let (free, held) =
        (FeModel::read(&FeFiles { fixed: Vec::new(), ..files.clone() }).unwrap(), FeModel::read(&files).unwrap());
    let along = [0.6, 0.0, -0.8];
    let whole = free.inertia_along(along);
    for (label, inertia) in held.labels.iter().zip(held.inertia_along(along)) {
        let expected = whole[free.row_of(label.node, label.component).unwrap()];
        assert!((inertia - expected).abs() < 1e-15, "{label}: {inertia} {expected}");
    }
    assert!(!held.fixed_mass.is_empty());
    files.mesh = Some(directory.path().join("x.inp"));
    for (choice, says) in [
        (NodeChoice::Node(7), "found node 7, which is to be held and has none; expected nodes with rows"),
        (NodeChoice::Set("TOP".into()), "there is no node set `TOP`; expected one of `CLAMP`, `NONE`"),
        (NodeChoice::Set("NONE".into()), "found the node set `NONE` of 0 nodes, none with a row of its own"),
    ] {
        files.fixed = vec![choice];
        let message = FeModel::read(&files).unwrap_err().to_string();
        assert!(message.contains(says), "{message}");
    }
}

/// What some programs leave in the place of a row that they take out: one value on both diagonals and nothing beside
/// it.
#[test]
fn rows_with_equal_values_on_both_diagonals_are_held() {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| written(directory.path(), name, text);
    let banner = "%%MatrixMarket matrix coordinate real symmetric\n";
    let table = file("d.csv", "1,1,ux\n2,2,ux\n3,3,ux\n4,4,ux\n");
    let model = |k: &str, m: &str, units: &str| {
        let mut files = FeFiles::new(&file("k.mtx", &format!("{banner}{k}")), &file("m.mtx", &format!("{banner}{m}")));
        files.dofs = Some(table.clone().into());
        files.units = units.parse().unwrap();
        FeModel::read(&files).unwrap()
    };
    let beside = "4 4 5\n1 1 1\n2 2 7.5\n3 2 -2.5\n3 3 2.5\n4 4 1\n";
    for (units, a, b) in [("m-kg-s", "1", "1"), ("mm-t-s", "1", "1"), ("m-kg-s", "1e6", "1e6"), ("mm-t-s", "3.7", "55")]
    {
        let (k, m) = (
            format!("4 4 5\n1 1 {a}\n2 2 7.5\n3 2 -2.5\n3 3 2.5\n4 4 {b}\n"),
            format!("4 4 4\n1 1 {a}\n2 2 3\n3 3 0.5\n4 4 {b}\n"),
        );
        let held = model(&k, &m, units);
        let nodes = |labels: &[nlmodes_io::DofLabel]| labels.iter().map(|label| label.node).collect::<Vec<_>>();
        assert_eq!((nodes(&held.labels), nodes(&held.held_on_diagonals)), (vec![2, 3], vec![1, 4]));
        assert_eq!((held.fixed.len(), held.row_of(3, Component::X), held.row_of(4, Component::X)), (2, Some(1), None));
        assert_eq!(held.stiffness.get(1, 0) / held.stiffness.get(0, 0), -1.0 / 3.0);
        assert_eq!(held.is_held(1, Component::X), Some(true));
        // A mass on a spring of its own is none that is held, nor are masses on springs of one alone.
        assert_eq!(model(beside, "4 4 4\n1 1 2\n2 2 3\n3 3 0.5\n4 4 0.1\n", units).n_dofs(), 4);
        let alone = "4 4 4\n1 1 1\n2 2 7.5\n3 3 2.5\n4 4 1\n";
        assert_eq!(model(alone, "4 4 4\n1 1 1\n2 2 3\n3 3 0.5\n4 4 1\n", units).n_dofs(), 4);
    }
    // A large value on both diagonals, beside which the entries of the row are left but do not count.
    let large = "4 4 6\n1 1 1e30\n2 1 -4e6\n2 2 7.5e6\n3 2 -2.5e6\n3 3 2.5e6\n4 4 3\n";
    let held = model(large, "4 4 5\n1 1 1e30\n2 1 0.5\n2 2 3\n3 3 0.5\n4 4 3.1\n", "m-kg-s");
    assert_eq!((held.n_dofs(), held.row_of(1, Component::X), held.row_of(2, Component::X)), (3, None, Some(0)));
    // One that is not so large leaves them: the rows feel each other.
    let coupled = "4 4 6\n1 1 1e15\n2 1 -4e6\n2 2 7.5e6\n3 2 -2.5e6\n3 3 2.5e6\n4 4 3\n";
    assert_eq!(model(coupled, "4 4 4\n1 1 1e15\n2 2 3\n3 3 0.5\n4 4 3.1\n", "m-kg-s").n_dofs(), 4);
}

/// Takes a mass of a millionth of the stiffness for the stiffness, and the other way round.
fn exchange(files: &mut FeFiles) {
    let lower = stiffness().into_iter().map(|(i, j, k)| (i, j, 1e-6 * k)).collect::<Vec<_>>();
    let path = files.stiffness.path.with_file_name("exchanged.sti");
    fs::write(&path, writers::calculix(&lower)).unwrap();
    files.mass = std::mem::replace(&mut files.stiffness, Address { path, name: None });
}

#[test]
fn files_that_do_not_belong_together_are_refused() {
    let directory = tempfile::tempdir().unwrap();
    let good = calculix(directory.path());
    let path = |name: &str, text: &str| written(directory.path(), name, text);
    let with = |change: &dyn Fn(&mut FeFiles)| {
        let mut files = good.clone();
        change(&mut files);
        FeModel::read(&files).unwrap_err().to_string()
    };
    let short = path("short.dof", &writers::dof().lines().take(20).map(|l| format!("{l}\n")).collect::<String>());
    let long = path("long.dof", &(writers::dof() + "90.1\n"));
    let mesh = path("other.inp", "*NODE\n1,0,0,0\n");
    let none = path("none.mas", &writers::calculix(&[]));
    let mut entries = stiffness();
    entries.retain(|e| (e.0, e.1) != (23, 23));
    let soft = path("soft.mtx", &writers::matrix_market(&entries));
    let mut entries = stiffness();
    entries[0].2 = -1.0;
    let negative = path("negative.sti", &writers::calculix(&entries));
    let cases: [(&str, Change); 11] = [
        ("x.sti:126: found `21`; expected a column from 1 to 20", Box::new(|f| f.dofs = Some(short.clone().into()))),
        ("expected entries up to the diagonal of row 25", Box::new(|f| f.dofs = Some(long.clone().into()))),
        ("found a matrix of the format calculix, whose rows have no names", Box::new(|f| f.dofs = None)),
        (
            "other.inp: found no node of theirs; expected the mesh of the matrices",
            Box::new(|f| f.mesh = Some(mesh.clone().into())),
        ),
        ("none.mas: found zeros only; expected a mass", Box::new(|f| f.mass = Address::parse(&none))),
        (
            "the stiffness of uz of node 80 (row 24) is 0e0; expected a positive value",
            Box::new(|f| f.stiffness = Address::parse(&soft)),
        ),
        (
            "the stiffness of ux of node 10 (row 1) is -1e0; expected a positive value",
            Box::new(|f| f.stiffness = Address::parse(&negative)),
        ),
        ("x.sti: found `.none`", Box::new(|f| f.stiffness = Address::parse("x.none"))),
        ("cannot be read: No such file", Box::new(|f| f.mass = Address::parse("not-there.mas"))),
        (
            "CalculiX writes .sti, .mas and .dof where the step has *FREQUENCY, SOLVER=MATRIXSTORAGE",
            Box::new(|f| f.stiffness = Address::parse("not-there.sti.gz")),
        ),
        ("(are they exchanged? are the units those of the files?)", Box::new(exchange)),
    ];
    for (says, change) in cases {
        let message = with(&*change);
        assert!(
            message.contains(says) || (says.contains(".none") && message.contains("found `.none`")),
            "{message}\n{says}"
        );
    }
}

/// Directions of a deck that are not those of its matrices.
#[test]
fn transformed_nodes_are_those_of_the_matrices_only_where_these_say_so() {
    let directory = tempfile::tempdir().unwrap();
    let mut files = calculix(directory.path());
    let free = FeModel::read(&files).unwrap();
    let deck = "*NODE\n10,0,0,0\n20,1,0,0\n*NSET, NSET=END\n20\n*TRANSFORM, NSET=END\n0.8,0.6,0.,-0.6,0.8,0.\n*STEP\n";
    let global = "*FREQUENCY, SOLVER=MATRIXSTORAGE\n*END STEP\n";
    files.mesh = Some(written(directory.path(), "x.inp", &format!("{deck}{global}")).into());
    close(&FeModel::read(&files).unwrap(), &free, 0.0);
    let local = "*FREQUENCY, SOLVER=MATRIXSTORAGE, GLOBAL=NO\n*END STEP\n";
    written(directory.path(), "x.inp", &format!("{deck}{local}"));
    let message = FeModel::read(&files).unwrap_err().to_string();
    assert!(
        message.contains("found node 20 with directions of its own") && message.contains("GLOBAL=YES"),
        "{message}"
    );
    // Abaqus writes its matrices along them.
    let path = |name: &str, text: String| written(directory.path(), name, &text);
    let (k, m) =
        (path("ka.mtx", writers::abaqus(&stiffness(), false)), path("ma.mtx", writers::abaqus(&mass(), false)));
    let abaqus = FeFiles { mesh: files.mesh.clone(), ..FeFiles::new(&k, &m) };
    let message = FeModel::read(&abaqus).unwrap_err().to_string();
    assert!(message.contains("write the matrices without *TRANSFORM"), "{message}");
}

/// The rotations of a rigid body are named as displacements of a node; that node has no mass along an axis, and nothing
/// touches there.
#[test]
fn nodes_of_rotations_have_no_displacements() {
    let directory = tempfile::tempdir().unwrap();
    let mut files = calculix(directory.path());
    let free = FeModel::read(&files).unwrap();
    let deck =
        "*NODE\n10,0,0,0\n20,1,0,0\n80,1,0,0\n*NSET, NSET=END\n10\n*RIGID BODY, NSET=END, REF NODE=20, ROT NODE=80\n";
    files.mesh = Some(written(directory.path(), "x.inp", deck).into());
    files.units = "mm-t-s".parse().unwrap();
    let model = FeModel::read(&files).unwrap();
    assert_eq!(model.translations_of(80), [None; 3]);
    let (row, before) = (model.row_of(80, Component::RX).unwrap(), free.row_of(80, Component::X).unwrap());
    assert!((model.stiffness.get(row, row) / (1e-3 * free.stiffness.get(before, before)) - 1.0).abs() < 1e-14);
}
