//! `nlmodes-cli lcp`: archives made and read with npyz.

use std::error::Error;
use std::fs::File;
use std::io::Write;
use std::process::Output;

use assert_cmd::Command;
use npyz::npz::{NpzArchive, NpzWriter};
use npyz::{AutoSerialize, Order, WriterBuilder};
use tempfile::{TempDir, tempdir};

type Outcome = Result<(), Box<dyn Error>>;
type Writer = NpzWriter<File>;
/// Number of contacts, `A`, `b`, and what the message must say.
type Case<'a> = (u64, &'a [f64], &'a [f64], &'a [&'a str]);

/// A beam under two stops: 2 µm/N under a load, 1 µm/N across.
const BEAM: [f64; 4] = [2e-6, 1e-6, 1e-6, 2e-6];
/// One, both and no contact closed.
const GAPS: [f64; 6] = [-1e-3, 2e-4, -1e-3, -1e-3, 1e-3, 2e-3];
const SOLVERS: [&str; 4] = ["active-set", "proximal", "clarabel", "lemke"];

fn put<T: AutoSerialize + Copy>(
    archive: &mut Writer,
    name: &str,
    shape: &[u64],
    order: Order,
    values: &[T],
) -> Outcome {
    let options = archive.array::<T>(name, Default::default())?.default_dtype().shape(shape).order(order);
    let mut array = options.begin_nd()?;
    array.extend(values.iter().copied())?;
    Ok(array.finish()?)
}

fn problem(directory: &TempDir, write: impl FnOnce(&mut Writer) -> Outcome) -> Outcome {
    let mut archive = NpzWriter::new(File::create(directory.path().join("problem.npz"))?);
    write(&mut archive)?;
    archive.zip_writer().finish()?;
    Ok(())
}

/// A problem in C order.
fn plain(directory: &TempDir, c: u64, a: &[f64], b: &[f64]) -> Outcome {
    problem(directory, |archive| {
        put(archive, "A", &[c, c], Order::C, a)?;
        put(archive, "b", &[b.len() as u64 / c, c], Order::C, b)
    })
}

fn solve(directory: &TempDir, more: &[&str]) -> Result<Output, Box<dyn Error>> {
    let mut command = Command::cargo_bin("nlmodes-cli")?;
    command.args(["lcp", "problem.npz", "--out", "solution.npz"]).args(more).current_dir(directory.path());
    Ok(command.output()?)
}

fn read(directory: &TempDir, name: &str) -> Result<(Vec<u64>, Vec<f64>), Box<dyn Error>> {
    let mut archive = NpzArchive::open(directory.path().join("solution.npz"))?;
    let array = archive.by_name(name)?.ok_or("no such array")?;
    assert_eq!(array.order(), Order::C);
    Ok((array.shape().to_vec(), array.into_vec()?))
}

fn assert_close(found: &[f64], expected: &[f64], tolerance: f64) {
    assert_eq!(found.len(), expected.len());
    for (found, expected) in found.iter().zip(expected) {
        assert!((found - expected).abs() <= tolerance, "{found} instead of {expected}");
    }
}

/// The solution for GAPS, by hand.
fn assert_solved(directory: &TempDir) -> Outcome {
    let (shape, lambda) = read(directory, "lambda")?;
    assert_eq!(shape, [3, 2]);
    assert_close(&lambda, &[500.0, 0.0, 1000.0 / 3.0, 1000.0 / 3.0, 0.0, 0.0], 1e-9);
    let (shape, g) = read(directory, "g")?;
    assert_eq!(shape, [3, 2]);
    assert_close(&g, &[0.0, 7e-4, 0.0, 0.0, 1e-3, 2e-3], 1e-15);
    assert!(read(directory, "violation")?.1.iter().all(|v| *v < 1e-10));
    Ok(())
}

#[test]
fn every_solver_finds_the_solution_by_hand() -> Outcome {
    for solver in SOLVERS {
        let directory = tempdir()?;
        plain(&directory, 2, &BEAM, &GAPS)?;
        let output = solve(&directory, &["--contact-solver", solver])?;
        assert_eq!(output.status.code(), Some(0), "{solver}: {output:?}");
        assert_solved(&directory)?;
        let said = String::from_utf8(output.stdout)?;
        for part in [solver, "2 contact(s), 3 sample(s)", "0 to 2 contacts", "violation", "iterations", "µs a sample"]
        {
            assert!(said.contains(part), "{part} is not in\n{said}");
        }
    }
    Ok(())
}

#[test]
fn fortran_order_and_other_types_of_numbers_are_the_same_problem() -> Outcome {
    let directory = tempdir()?;
    problem(&directory, |archive| {
        put(archive, "A", &[2, 2], Order::Fortran, &BEAM)?;
        let by_columns: Vec<f64> = [0, 2, 4, 1, 3, 5].map(|at| GAPS[at]).into();
        put(archive, "b", &[3, 2], Order::Fortran, &by_columns)
    })?;
    assert_eq!(solve(&directory, &[])?.status.code(), Some(0));
    assert_solved(&directory)?;
    problem(&directory, |archive| {
        put(archive, "A", &[2, 2], Order::C, &[2_i64, 1, 1, 2])?;
        put(archive, "b", &[2], Order::C, &[-1.0_f32, 0.25])
    })?;
    assert_eq!(solve(&directory, &[])?.status.code(), Some(0));
    assert_eq!(read(&directory, "lambda")?.0, [1, 2]);
    assert_close(&read(&directory, "lambda")?.1, &[0.5, 0.0], 1e-15);
    assert_close(&read(&directory, "g")?.1, &[0.0, 0.75], 1e-15);
    Ok(())
}

#[test]
fn contradictory_gaps_end_with_status_1_and_the_samples_before_them() -> Outcome {
    for solver in SOLVERS {
        let directory = tempdir()?;
        // Two stops that face each other and overlap by 2 m in the second sample.
        plain(&directory, 2, &[1.0, -1.0, -1.0, 1.0], &[-1.0, 3.0, -1.0, -1.0, 1.0, 1.0])?;
        let output = solve(&directory, &["--contact-solver", solver])?;
        let said = String::from_utf8(output.stderr)?;
        assert_eq!(output.status.code(), Some(1), "{solver}: {said}");
        for part in ["sample 1", "contradictory", "proof", "1 sample(s) before it"] {
            assert!(said.contains(part), "{solver}: {part} is not in\n{said}");
        }
        assert_close(&read(&directory, "lambda")?.1, &[1.0, 0.0], 1e-12);
        plain(&directory, 1, &[0.0], &[-1.0])?;
        std::fs::remove_file(directory.path().join("solution.npz"))?;
        assert_eq!(solve(&directory, &["--contact-solver", solver])?.status.code(), Some(1));
        assert!(!directory.path().join("solution.npz").exists());
    }
    Ok(())
}

/// The call must end with status 2, print all parts, and write nothing.
fn assert_refused(directory: &TempDir, more: &[&str], parts: &[&str]) -> Outcome {
    let output = solve(directory, more)?;
    let said = String::from_utf8(output.stderr)?;
    assert_eq!(output.status.code(), Some(2), "{parts:?}: {said}");
    for part in parts {
        assert!(said.contains(part), "{part} is not in\n{said}");
    }
    assert!(output.stdout.is_empty());
    assert!(
        std::fs::read_dir(directory.path())?.flatten().all(|entry| entry.file_name() == "problem.npz"),
        "{parts:?}"
    );
    Ok(())
}

#[test]
fn what_is_no_contact_problem_is_refused_with_its_place() -> Outcome {
    let cases: [Case; 6] = [
        (2, &[1.0, 0.0, f64::NAN, 1.0], &[1.0, 1.0], &["`A`[1, 0] is NaN"]),
        (2, &BEAM, &[1.0, 1.0, 1.0, f64::INFINITY], &["`b`[1, 1] is inf"]),
        (2, &[1.0, 0.5, 0.4, 1.0], &[1.0, 1.0], &["not symmetric", "A[0,1] = 0.5", "A[1,0] = 0.4"]),
        (2, &[1.0, 2.0, 2.0, 1.0], &[1.0, 1.0], &["not positive semidefinite", "contact 1"]),
        (1, &[-1.0], &[1.0], &["not positive semidefinite", "contact 0"]),
        (2, &BEAM, &[], &["`b` has the shape (0, 2)", "(samples, 2) or (2,)"]),
    ];
    for (c, a, b, parts) in cases {
        let directory = tempdir()?;
        plain(&directory, c, a, b)?;
        assert_refused(&directory, &[], parts)?;
    }
    let directory = tempdir()?;
    let shapes: [(&[u64], &[u64], &str); 5] = [
        (&[1, 4], &[2], "`A` has the shape (1, 4)"),
        (&[4], &[2], "`A` has the shape (4,)"),
        (&[2, 2], &[3], "`b` has the shape (3,)"),
        (&[2, 2], &[2, 3], "`b` has the shape (2, 3)"),
        (&[2, 2], &[1, 1, 2], "3 dimensions"),
    ];
    for (a, b, part) in shapes {
        problem(&directory, |archive| {
            put(archive, "A", a, Order::C, &BEAM)?;
            put(archive, "b", b, Order::C, &vec![1.0; b.iter().product::<u64>() as usize])
        })?;
        assert_refused(&directory, &[], &[part])?;
    }
    problem(&directory, |archive| put(archive, "compliance", &[2, 2], Order::C, &BEAM))?;
    assert_refused(&directory, &[], &["no array `A`", "it has `compliance`"])
}

#[test]
fn an_unknown_solver_is_answered_with_all_names() -> Outcome {
    let directory = tempdir()?;
    plain(&directory, 2, &BEAM, &GAPS)?;
    let names = ["active-set", "proximal", "clarabel", "lemke", "closed-form"];
    assert_refused(&directory, &["--contact-solver", "newton"], &names)?;
    assert_refused(&directory, &["--contact-solver", "closed-form"], &["at most 1 contact(s), not 2"])
}

#[test]
fn files_that_are_no_archives_are_refused() -> Outcome {
    let directory = tempdir()?;
    let path = directory.path().join("problem.npz");
    assert_refused(&directory, &[], &["cannot be read", "problem.npz"])?;
    for garbage in [&b""[..], b"PK\x03\x04", b"\x93NUMPY\x01\x00", &[0xff; 4000]] {
        std::fs::write(&path, garbage)?;
        assert_refused(&directory, &[], &["not a NumPy archive"])?;
    }
    plain(&directory, 2, &BEAM, &GAPS)?;
    let whole = std::fs::read(&path)?;
    for length in (1..whole.len()).step_by(23) {
        std::fs::write(&path, &whole[..length])?;
        assert_refused(&directory, &[], &["error"])?;
    }
    for at in (0..whole.len()).step_by(9) {
        let mut damaged = whole.clone();
        damaged[at] ^= 0x41;
        std::fs::write(&path, damaged)?;
        // The dates in an archive may be anything; the numbers have a checksum.
        match solve(&directory, &[])?.status.code() {
            Some(0) => assert_solved(&directory)?,
            Some(2) => {}
            code => panic!("byte {at}: {code:?}"),
        }
    }
    Ok(())
}

/// A malicious array file.
fn array_file(description: &str, data: &[u8]) -> Vec<u8> {
    let length = u16::try_from(description.len()).unwrap_or(u16::MAX);
    [b"\x93NUMPY\x01\x00", &length.to_le_bytes()[..], description.as_bytes(), data].concat()
}

#[test]
fn arrays_that_claim_more_than_they_have_are_refused_at_once() -> Outcome {
    let shape = |shape: &str| format!("{{'descr': '<f8', 'fortran_order': False, 'shape': {shape}, }}\n");
    let files = [
        array_file(&shape("(100000, 100000)"), &[0; 64]),
        array_file(&shape("(9223372036854775807, 9223372036854775807)"), &[0; 64]),
        array_file(&shape("(4, 4)"), &[0; 127]),
        array_file(&shape("(4, 4)"), &[0; 129]),
        array_file(&shape(&"(".repeat(4000)), &[]),
        array_file(&shape(&"(".repeat(60000)), &[]),
        array_file(&shape("(2, 2)").replace("<f8", "|O"), &[0; 32]),
        array_file(&shape("(2, 2)").replace("<f8", "<U1"), &[0; 16]),
        array_file(&shape("(2, 2)").replace("<f8", "<c16"), &[0; 64]),
        array_file(&shape("(2, 2)").replace("'<f8'", "[('x', '<f8')]"), &[0; 32]),
        array_file(&shape("(2, -2)"), &[0; 32]),
        array_file("{", &[]),
        b"\x93NUMPY\x02\x00\xff\xff\xff\xff{".to_vec(),
        b"\x93NUMPY\x01".to_vec(),
    ];
    for file in files {
        let directory = tempdir()?;
        problem(&directory, |archive| {
            archive.zip_writer().start_file("A.npy", Default::default())?;
            archive.zip_writer().write_all(&file)?;
            put(archive, "b", &[2], Order::C, &[1.0, 1.0])
        })?;
        assert_refused(&directory, &[], &["array `A`"])?;
    }
    Ok(())
}

#[test]
fn a_place_that_cannot_be_written_is_refused_before_solving() -> Outcome {
    let directory = tempdir()?;
    plain(&directory, 2, &BEAM, &GAPS)?;
    for out in ["no/such/place.npz", "."] {
        let mut command = Command::cargo_bin("nlmodes-cli")?;
        let output = command.args(["lcp", "problem.npz", "--out", out]).current_dir(directory.path()).output()?;
        assert_eq!(output.status.code(), Some(2));
        assert!(String::from_utf8(output.stderr)?.contains("cannot be written"), "{out}");
    }
    Ok(())
}
