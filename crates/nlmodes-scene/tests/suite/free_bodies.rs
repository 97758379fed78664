//! Structures from files whose stiffness is singular, or known to few digits: what strains nothing is distinguished
//! from what vibrates slowly.

use std::error::Error;
use std::f64::consts::TAU;
use std::fmt::Write as _;
use std::fs;
use std::path::Path;

use nlmodes_scene::assemble::{OpenStructure, Structures, free_modes};
use nlmodes_scene::outline::Outline;
use nlmodes_scene::scene::Scene;
use nlmodes_scene::{doubts, parse};

type Outcome<T = ()> = Result<T, Box<dyn Error>>;

fn scene(folder: &Path, structure: &str, contact: &str) -> Outcome<Scene> {
    let text = format!(
        "[structure]\nkind = \"matrices\"\n{structure}\n[[contact]]\n{contact}\n[method]\nharmonics = \
        3\n[continuation]\nmax_energy_ratio = 3.0\n"
    );
    let file = parse(&folder.join("scene.toml").to_string_lossy(), &text, &[]);
    Ok(file.map_err(|refused| refused.text(false))?.scene)
}

const TIP: &str = "nodes = \"TIP\"\nnormal = [0.0, 0.0, 1.0]\ngap_m = 1e-5";

/// Exports of CalculiX 2.20 with `*FREQUENCY, SOLVER=MATRIXSTORAGE`: C3D8 in m, kg, s; C3D8I and C3D4 apart in mm, kg,
/// ms, whose own frequencies CalculiX gives too; C3D8 held and C3D4 free in mm, t, s; and S4 in mm, t, s and B32 in mm,
/// kg, ms, whose nodes are the means of those that come of them. Frequencies of the others are of a dense solution of
/// the same matrices.
#[test]
fn free_bodies_of_calculix_are_none_that_are_held() -> Outcome {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/fixtures");
    for (name, units, rigid, bodies, elastic) in [
        ("bricks", "m-kg-s", 6, 1, 42329.0752),
        ("two_bodies", "mm-kg-ms", 12, 2, 31152.51),
        ("one_held", "mm-t-s", 6, 1, 7850.40423),
        ("free_shell", "mm-t-s", 6, 1, 1314.75829),
        ("free_beam", "mm-kg-ms", 6, 1, 1552.56633),
    ] {
        let structure = format!(
            "stiffness = \"{name}.sti.gz\"\nmass = \"{name}.mas.gz\"\ndofs = \"{name}.dof\"\nmesh = \
            \"{name}.inp\"\nunits = \"{units}\""
        );
        let (modes, strainless) =
            free_modes(&scene(&folder, &structure, TIP)?, &Structures::default())?.ok_or("none")?;
        let found = (strainless.rigid, strainless.mechanisms, strainless.floating.len());
        assert_eq!(found, (rigid, 0, bodies), "{name}");
        assert!(modes.omega_squared()[..rigid].iter().all(|square| *square == 0.0), "{name}");
        let hz = modes.omega_squared()[rigid].sqrt() / TAU;
        assert!((hz / elastic - 1.0).abs() < 1e-6, "{name}: {hz}");
    }
    Ok(())
}

/// A beam of Euler and Bernoulli in `n` uneven elements along x, 1 m long, EI = 2 N m², 0.3 kg/m, that bends along z;
/// its matrices as numbers of so many digits in Matrix Market, in single precision for none. Places only if asked for.
fn beam(folder: &Path, (n, held): (usize, bool), digits: Option<usize>, places: bool) -> Outcome {
    let length: Vec<f64> = (0..n).map(|e| 1.0 + 0.37 * (1.7 * e as f64).sin()).collect();
    let whole: f64 = length.iter().sum();
    let first = if held { 2 } else { 0 };
    let order = 2 * (n + 1) - first;
    let mut entries = vec![std::collections::BTreeMap::<(usize, usize), f64>::new(); 2];
    for (e, l) in length.iter().map(|l| l / whole).enumerate() {
        let k = [
            [12.0, -6.0 * l, -12.0, -6.0 * l],
            [0.0, 4.0 * l * l, 6.0 * l, 2.0 * l * l],
            [0.0, 0.0, 12.0, 6.0 * l],
            [0.0, 0.0, 0.0, 4.0 * l * l],
        ];
        let m = [
            [156.0, -22.0 * l, 54.0, 13.0 * l],
            [0.0, 4.0 * l * l, -13.0 * l, -3.0 * l * l],
            [0.0, 0.0, 156.0, 22.0 * l],
            [0.0, 0.0, 0.0, 4.0 * l * l],
        ];
        for (i, j) in (0..4).flat_map(|i| (i..4).map(move |j| (i, j))) {
            let (row, column) = (2 * e + j, 2 * e + i);
            if column >= first {
                let at = (row - first, column - first);
                *entries[0].entry(at).or_default() += 2.0 / l.powi(3) * k[i][j];
                *entries[1].entry(at).or_default() += 0.3 * l / 420.0 * m[i][j];
            }
        }
    }
    for (name, entries) in ["k.mtx", "m.mtx"].iter().zip(&entries) {
        let mut text = format!("%%MatrixMarket matrix coordinate real symmetric\n{order} {order} {}\n", entries.len());
        for ((i, j), value) in entries {
            match digits {
                Some(digits) => writeln!(text, "{} {} {value:.*e}", i + 1, j + 1, digits - 1)?,
                None => writeln!(text, "{} {} {:e}", i + 1, j + 1, f64::from(*value as f32))?,
            }
        }
        fs::write(folder.join(name), text)?;
    }
    let mut table = if places { "row,node,component,x,y,z\n" } else { "row,node,component\n" }.to_owned();
    let mut x = 0.0;
    for node in 0..=n {
        for (i, component) in ["uz", "roty"].iter().enumerate().filter(|_| 2 * node >= first) {
            let place = if places { format!(",{x},0,0") } else { String::new() };
            writeln!(table, "{},{},{component}{place}", 2 * node + i + 1 - first, node + 1)?;
        }
        x += length.get(node).map_or(0.0, |l| l / whole);
    }
    fs::write(folder.join("dofs.csv"), table)?;
    Ok(())
}

const MATRICES: &str = "stiffness = \"k.mtx\"\nmass = \"m.mtx\"\ndofs = \"dofs.csv\"";

fn at_node(node: usize) -> String {
    format!("node = {node}\nnormal = [0.0, 0.0, 1.0]\ngap_m = 1e-4")
}

/// (β L)² √(EI/m L⁴)/2π of the cantilever, and of the free beam.
fn exact(beta: f64) -> f64 {
    beta.powi(2) * (2.0 / 0.3_f64).sqrt() / TAU
}

#[test]
fn a_free_beam_is_free_with_any_digits_and_without_places() -> Outcome {
    for (digits, n, off) in
        [(Some(14), 40, 1e-6), (Some(10), 40, 1e-5), (Some(10), 10, 1e-4), (Some(7), 12, 1e-3), (None, 12, 1e-3)]
    {
        for places in [true, false] {
            let folder = tempfile::tempdir()?;
            beam(folder.path(), (n, false), digits, places)?;
            let scene = scene(folder.path(), MATRICES, &at_node(1))?;
            let (modes, strainless) = free_modes(&scene, &Structures::default())?.ok_or("none")?;
            assert_eq!((strainless.rigid, strainless.mechanisms), (2, 0), "{digits:?} {places}");
            let hz = modes.omega_squared()[2].sqrt() / TAU;
            assert!((hz / exact(4.730_040_745) - 1.0).abs() < off, "{digits:?}: {hz}");
        }
    }
    Ok(())
}

/// The frequency of a fine cantilever is given with what its digits leave open, and that is not far from what they
/// change; where they leave nothing of it, it is refused, and never taken for a free body.
#[test]
fn what_digits_leave_open_of_a_held_beam_is_said_or_refused() -> Outcome {
    let mut squares = Vec::new();
    for (digits, n) in
        [(Some(10), 100), (Some(10), 110), (Some(10), 120), (Some(9), 60), (Some(9), 70), (None, 24), (None, 28)]
    {
        let folder = tempfile::tempdir()?;
        beam(folder.path(), (n, true), digits, n % 20 == 0)?;
        let scene = scene(folder.path(), MATRICES, &at_node(n + 1))?;
        let open = OpenStructure::of(&scene, &Structures::default())?;
        assert_eq!(open.strainless.count(), 0);
        let (share, hz) = (open.modes.left_open(1).ok_or("known")?, open.modes.omega_squared()[0].sqrt() / TAU);
        assert!((1e-4..0.1).contains(&share), "{digits:?} {n}: {share}");
        squares.push(((hz / exact(1.875_104_069) - 1.0) / share).powi(2));
        let outline = Outline::of_structure(&scene, (Some(&open), None), false).to_string();
        assert!(outline.contains(", which leaves mode 1 open by ±"), "{outline}");
        assert_eq!(doubts::of(&scene, &open).iter().any(|text| text.contains("open by ±")), share > 1e-3);
    }
    let mean = squares.iter().sum::<f64>() / squares.len() as f64;
    assert!((0.1..4.0).contains(&mean), "{squares:?}");
    for (digits, n) in [(Some(10), 600), (Some(8), 150), (None, 100), (None, 140)] {
        for places in [true, false] {
            let folder = tempfile::tempdir()?;
            beam(folder.path(), (n, true), digits, places)?;
            let scene = scene(folder.path(), MATRICES, &at_node(n + 1))?;
            let error = OpenStructure::of(&scene, &Structures::default()).err().ok_or("taken")?;
            assert_eq!(error.path(), "structure.stiffness");
            assert!(error.to_string().contains("which leaves nothing of its lowest mode"), "{digits:?} {n}: {error}");
        }
    }
    Ok(())
}

/// Two masses apart, each on a spring of its own: before a rigid stop between them nothing is left that could be
/// pressed, an elastic one has its own.
#[test]
fn masses_that_pound_each_other_need_an_elastic_stop() -> Outcome {
    for unit in [1.0, 2.5e6] {
        let folder = tempfile::tempdir()?;
        let matrix =
            |a: f64, b: f64| format!("%%MatrixMarket matrix coordinate real symmetric\n2 2 2\n1 1 {a}\n2 2 {b}\n");
        fs::write(folder.path().join("k.mtx"), matrix(1000.0 * unit, 4000.0 * unit))?;
        fs::write(folder.path().join("m.mtx"), matrix(unit, 1.2 * unit))?;
        fs::write(folder.path().join("dofs.csv"), "row,node,component,x,y,z\n1,1,ux,0,0,0\n2,2,ux,1,0,0\n")?;
        fs::write(folder.path().join("pairs.csv"), "node_a,node_b,nx,ny,nz,gap_m\n1,2,1,0,0,0.01\n")?;
        let rigid =
            OpenStructure::of(&scene(folder.path(), MATRICES, "pairs = \"pairs.csv\"")?, &Structures::default());
        let error = rigid.err().ok_or("taken")?;
        assert!(error.source().is_some_and(|why| why.to_string().contains("one with a stiffness needs nothing")));
        let stiffness = 1e5 * unit;
        let contact = format!("pairs = \"pairs.csv\"\nstiffness_n_m = {stiffness:e}");
        let open = OpenStructure::of(&scene(folder.path(), MATRICES, &contact)?, &Structures::default())?;
        // Closed, the structure has both masses on the spring between them.
        let (k, m): ([f64; 2], [f64; 2]) = ([1000.0, 4000.0], [1.0, 1.2]);
        let (a, b) = ((k[0] + 1e5) / m[0], (k[1] + 1e5) / m[1]);
        let exact = 0.5 * (a + b) - (0.25 * (a - b).powi(2) + 1e10 / (m[0] * m[1])).sqrt();
        let model = open.reduced.model();
        let compliance = model.contacts()[0].law.compliance() + 1.0 / model.stiffness()[(2, 2)];
        assert!((compliance * stiffness - 1.0).abs() < 1e-9, "{compliance}");
        let closed = open.modes.closed_modes(&[true])?.omega_squared[0];
        assert!((closed / exact - 1.0).abs() < 1e-9, "{closed} {exact}");
    }
    Ok(())
}
