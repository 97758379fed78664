//! Structures that other programs computed.

use std::f64::consts::TAU;
use std::path::{Path, PathBuf};

use nlmodes::linalg::lowest_modes;
use nlmodes::model::reduction::{ModeCount, OpenModes};
use nlmodes_io::{ElementKind, FeFiles, FeModel, Mesh, NodeContact, Skin};

use super::{Case, Check, Kind};
use crate::Failure;

pub(super) const CASES: &[Case] = &[
    Case {
        name: "bracket-frequencies",
        problem: "Steel angle bracket with a clamped foot, 10-node tetrahedra meshed by Gmsh, matrices exported by \
            CalculiX in mm, t, s (`configs/structures`).\nEight lowest frequencies from the matrices.",
        kind: Kind::OtherProgram,
        reference: "those that CalculiX 2.20 prints itself, seven digits (`bracket.hz`)",
        remark: "",
        compute: frequencies,
    },
    Case {
        name: "bracket-open-modes",
        problem: "The same bracket with a rigid wall before the nodes of its edge, reduced to eight modes with \
            residual flexibility.\nIts frequencies; the contact nodes have lost their mass.",
        kind: Kind::OtherProgram,
        reference: "the frequencies of CalculiX: the reduction leaves them as they are",
        remark: "dropping the mass of these nodes instead moves them by some tenths of a percent",
        compute: open_modes,
    },
    Case {
        name: "bracket-volume",
        problem: "The skin of the bracket's mesh, as read from the deck of CalculiX and from the file of \
            Gmsh.\nVolume that it encloses.",
        kind: Kind::Exact,
        reference: "`30·20·4 + 4·20·36 = 5280 mm³`",
        remark: "",
        compute: volume,
    },
    Case {
        name: "bracket-mass",
        problem: "The mass matrix of the bracket in t and mm, `ρ = 7.85·10⁻⁹ t/mm³`; displacements of the clamped \
            foot are left out.\nMass that moves with a translation along x, in kg.",
        kind: Kind::Independent,
        reference: "`∫ρ (Σ N_i)² dV` over the shape functions of the free nodes, from the mesh, by the rule of four \
            points that CalculiX has for these elements",
        remark: "the exact integral has 0.5 % more: the elements at the foot are under-integrated",
        compute: mass,
    },
    Case {
        name: "bracket-statics",
        problem: "The bracket pressed by 100 N along z at the first free node of its set `edge`, with no stop, \
            through two, eight and 16 free-interface modes and their residual flexibility.\nDisplacement of the node \
            along the force.",
        kind: Kind::Independent,
        reference: "the solution of `K q = f` by conjugate gradients with Jacobi's preconditioner, written for the \
            case",
        remark: "",
        compute: statics,
    },
];

fn structures(name: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../configs/structures").join(name)
}

fn bracket() -> Result<FeModel, Failure> {
    let text = |name: &str| structures(name).to_string_lossy().into_owned();
    let files = FeFiles {
        dofs: Some(structures("bracket.dof")),
        mesh: Some(structures("bracket.inp")),
        units: "mm-t-s".parse()?,
        ..FeFiles::new(&text("bracket.sti.gz"), &text("bracket.mas.gz"))
    };
    Ok(FeModel::read(&files)?)
}

fn printed() -> Result<Vec<f64>, Failure> {
    let text = std::fs::read_to_string(structures("bracket.hz"))?;
    Ok(text.lines().map(str::parse).collect::<Result<_, _>>()?)
}

fn beside(eigenvalues: &[f64]) -> Result<Vec<Check>, Failure> {
    let expected = printed()?;
    let pairs = eigenvalues.iter().zip(&expected).enumerate();
    let check = |(k, (square, hertz)): (usize, (&f64, &f64))| {
        Check::relative(format!("f_{}, Hz", k + 1), square.sqrt() / TAU, *hertz, 1e-6, "seven digits are printed")
    };
    Ok(pairs.map(check).collect())
}

fn frequencies() -> Result<Vec<Check>, Failure> {
    let model = bracket()?;
    let (k, m) = (model.stiffness.symmetric()?, model.mass.symmetric()?);
    beside(&lowest_modes(&k, &m, 8)?.eigenvalues)
}

/// The nodes of the edge that have a displacement along z, before a wall there.
fn walls(model: &FeModel) -> Result<Vec<NodeContact>, Failure> {
    let mesh = model.mesh.as_ref().ok_or("no mesh")?;
    let nodes = mesh.node_set("edge").ok_or("no edge")?;
    let free = nodes.iter().filter(|node| model.translations_of(**node)[2].is_some());
    let wall = |node: &u64| NodeContact {
        node: *node,
        against: None,
        normal: [0.0, 0.0, 1.0],
        gap: 1e-4,
        stiffness: None,
        damping: None,
        origin: 0,
    };
    Ok(free.map(wall).collect())
}

fn reduced(model: &FeModel, contacts: &[NodeContact], modes: usize) -> Result<OpenModes, Failure> {
    let directions = model.contact_directions(contacts)?;
    let (gaps, compliance) = (vec![1e-4; contacts.len()], vec![0.0; contacts.len()]);
    let (m, k) = (model.mass.symmetric()?, model.stiffness.symmetric()?);
    Ok(OpenModes::new(m, k, directions, gaps, compliance, ModeCount::Lowest(modes))?)
}

fn open_modes() -> Result<Vec<Check>, Failure> {
    let model = bracket()?;
    let contacts = walls(&model)?;
    let mut checks = beside(reduced(&model, &contacts, 8)?.omega_squared())?;
    checks.push(Check::count("contact nodes, more than one (1: yes)", usize::from(contacts.len() > 1), 1));
    Ok(checks)
}

fn volume() -> Result<Vec<Check>, Failure> {
    let mut checks = Vec::new();
    for name in ["bracket.inp", "bracket.msh"] {
        let mesh = Mesh::read(&structures(name))?;
        let mut volume = 0.0;
        for cell in Skin::of(&mesh).cells.iter().filter(|cell| cell.kind == ElementKind::Triangle) {
            // Divergence theorem over flat triangles.
            let [a, b, c] = [0, 1, 2].map(|k| mesh.places[cell.nodes[k] as usize]);
            let u: [f64; 3] = std::array::from_fn(|k| b[k] - a[k]);
            let v: [f64; 3] = std::array::from_fn(|k| c[k] - a[k]);
            let n = [u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]];
            volume += (0..3).map(|k| a[k] * n[k]).sum::<f64>() / 6.0;
        }
        checks.push(Check::relative(
            format!("volume of {name}, mm³"),
            volume,
            5280.0,
            1e-8,
            "the digits of the coordinates",
        ));
    }
    Ok(checks)
}

fn statics() -> Result<Vec<Check>, Failure> {
    let model = bracket()?;
    let contacts = walls(&model)?;
    let one = contacts.get(..1).ok_or("no contact")?;
    let at = model.translations_of(one[0].node)[2].ok_or("the node is held")?;
    let n = model.n_dofs();
    let k = model.stiffness.symmetric()?;
    let mut force = vec![0.0; n];
    force[at] = 100.0;
    let exact = conjugate_gradients(&k, &force)[at];
    let mut checks = Vec::new();
    for modes in [2, 8, 16] {
        let open = reduced(&model, one, modes)?;
        let y = open.contact_rows();
        let modal: f64 = (0..modes).map(|r| y[(0, r)].powi(2) / open.omega_squared()[r]).sum();
        // The wall's direction is against the displacement: both signs cancel.
        let found = 100.0 * (modal + open.flexibility()[(0, 0)]);
        checks.push(Check::relative(
            format!("displacement with {modes} modes, m"),
            found,
            exact,
            1e-8,
            "rounding, times the condition of the stiffness",
        ));
    }
    Ok(checks)
}

fn conjugate_gradients(k: &nlmodes::linalg::SparseMatrix, force: &[f64]) -> Vec<f64> {
    let n = force.len();
    let mut diagonal = vec![1.0; n];
    nlmodes::linalg::triplets(k).filter(|(i, j, _)| i == j).for_each(|(i, _, v)| diagonal[i] = v);
    let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
    let (mut x, mut r) = (vec![0.0; n], force.to_vec());
    let mut z: Vec<f64> = r.iter().zip(&diagonal).map(|(r, d)| r / d).collect();
    let (mut p, mut rz) = (z.clone(), dot(&r, &z));
    let mut kp = vec![0.0; n];
    for _ in 0..20 * n {
        kp.fill(0.0);
        nlmodes::linalg::triplets(k).for_each(|(i, j, v)| kp[i] += v * p[j]);
        let step = rz / dot(&p, &kp);
        x.iter_mut().zip(&p).for_each(|(x, p)| *x += step * p);
        r.iter_mut().zip(&kp).for_each(|(r, kp)| *r -= step * kp);
        z.iter_mut().zip(r.iter().zip(&diagonal)).for_each(|(z, (r, d))| *z = r / d);
        let next = dot(&r, &z);
        if next.abs() < 1e-30 * dot(force, force) / diagonal[0] {
            break;
        }
        let ratio = next / rz;
        rz = next;
        p.iter_mut().zip(&z).for_each(|(p, z)| *p = z + ratio * *p);
    }
    x
}

fn mass() -> Result<Vec<Check>, Failure> {
    let model = bracket()?;
    let mesh = Mesh::read(&structures("bracket.inp"))?;
    let free = |node: u32| model.translations_of(mesh.numbers[node as usize])[0].is_some();
    let mut sum = 0.0;
    for element in mesh.elements.iter().filter(|e| e.kind == ElementKind::Tetrahedron) {
        let corner = |k: usize| mesh.places[element.nodes[k] as usize];
        let edge = |k: usize| -> [f64; 3] { std::array::from_fn(|x| corner(k)[x] - corner(0)[x]) };
        let [a, b, c] = [edge(1), edge(2), edge(3)];
        let cross = [a[1] * b[2] - a[2] * b[1], a[2] * b[0] - a[0] * b[2], a[0] * b[1] - a[1] * b[0]];
        let volume = (cross[0] * c[0] + cross[1] * c[1] + cross[2] * c[2]).abs() / 6.0;
        // Four points; in each the shape functions of the free nodes together.
        let (near, far) = (0.585_410_196_624_968_5, 0.138_196_601_125_010_5);
        for point in 0..4 {
            let l: [f64; 4] = std::array::from_fn(|k| if k == point { near } else { far });
            let shape = |k: usize| match k {
                0..4 => l[k] * (2.0 * l[k] - 1.0),
                _ => element.kind.edges()[k - 4].iter().map(|c| l[*c]).product::<f64>() * 4.0,
            };
            let moved: f64 = (0..10).filter(|k| free(element.nodes[*k])).map(shape).sum();
            sum += 0.25 * volume * moved * moved;
        }
    }
    // t/mm³ to kg/mm³.
    let expected = sum * 7.85e-9 * 1e3;
    Ok(vec![Check::relative(
        "mass, kg",
        model.mass_along_axes()[0],
        expected,
        1e-6,
        "fourteen digits of the matrix, seven of the coordinates",
    )])
}
