//! Unknowns within elements among displacements of nodes.

use std::fmt::Write as _;
use std::fs;

use nlmodes_io::{FeFiles, FeModel};

/// A chain of springs along x between nodes 1, 2, 3, … and the ground before the first one; each but the first has an
/// unknown of its own, numbered from 101, which answers a difference of its ends, and their sum by `distortion`.
fn chain(distortion: f64, within: bool) -> (String, String) {
    const NODES: usize = 4;
    let n = if within { 2 * NODES - 1 } else { NODES };
    let mut k = vec![vec![0.0; n]; n];
    k[0][0] = 1.0;
    for e in 0..NODES - 1 {
        for (i, j) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            k[e + i][e + j] += if i == j { 2.0 } else { -2.0 };
        }
        if within {
            let inner = NODES + e;
            k[inner][inner] = 5.0;
            for (end, sign) in [(e, 1.0), (e + 1, -1.0)] {
                k[inner][end] = sign + distortion;
                k[end][inner] = sign + distortion;
            }
        }
    }
    let mut text = String::new();
    (0..n).for_each(|j| (0..=j).for_each(|i| _ = writeln!(text, "{} {} {:e}", i + 1, j + 1, k[i][j])));
    let labels = (1..=NODES).chain((101..).take(n - NODES)).map(|node| format!("{node}.1\n")).collect();
    (text, labels)
}

fn without_answer((matrix, labels): (String, String)) -> Vec<u64> {
    let directory = tempfile::tempdir().unwrap();
    let file = |name: &str, text: &str| {
        let path = directory.path().join(name);
        fs::write(&path, text).unwrap();
        path.to_string_lossy().into_owned()
    };
    let mut files = FeFiles::new(&file("x.sti", &matrix), &file("x.mas", &matrix));
    files.dofs = Some(file("x.dof", &labels).into());
    FeModel::read(&files).unwrap().nodes_without_answer()
}

#[test]
fn unknowns_within_elements_do_not_answer_a_rigid_displacement() {
    assert_eq!(without_answer(chain(0.0, true)), [101, 102, 103]);
    assert_eq!(without_answer(chain(0.05, true)), [101, 102, 103], "of elements out of shape");
}

#[test]
fn nodes_do_also_before_a_support() {
    assert_eq!(without_answer(chain(0.0, false)), [0; 0]);
}
