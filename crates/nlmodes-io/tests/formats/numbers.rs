//! Lists and matrices without names of rows, as NumPy and tables have them.

use std::fs;

use nlmodes_io::{Address, NumberTable, read_numbers};
use tempfile::tempdir;

use crate::agreement::fixture;

const ROWS: [f64; 6] = [1.0, -0.5, 0.25, 2.0, 3.0, -4.0];

fn array(name: &str) -> nlmodes_io::Result<NumberTable> {
    read_numbers(&Address { path: fixture("modes.npz"), name: Some(name.to_owned()) })
}

fn text(name: &str, content: &str) -> nlmodes_io::Result<NumberTable> {
    let folder = tempdir().unwrap();
    let path = folder.path().join(name);
    fs::write(&path, content).unwrap();
    read_numbers(&Address { path, name: None })
}

#[test]
fn arrays_and_lines_are_read_row_by_row() {
    for name in ["rows", "columns", "single"] {
        assert_eq!(array(name).unwrap(), NumberTable { shape: vec![2, 3], values: ROWS.to_vec() }, "{name}");
    }
    let lone = read_numbers(&Address { path: fixture("rows.npy"), name: None }).unwrap();
    assert_eq!((lone.size(), lone.values, lone.shape), ("2 × 3".to_owned(), ROWS.to_vec(), vec![2, 3]));
    let frequencies = array("frequencies").unwrap();
    assert_eq!(frequencies.list(), Some(&[10.0, 20.0, 40.0][..]));
    assert_eq!((frequencies.size(), array("lone").unwrap().size()), ("3 numbers".to_owned(), "1 number".to_owned()));
    assert_eq!(array("whole").unwrap().values, [1.0, 2.0, 3.0]);
    assert_eq!(array("rows").unwrap().list(), None);
    for content in ["# rows\n1,-0.5,0.25\n\n2, 3 ,-4 # the second\n", "1 -5e-1\t2.5D-01\r\n2 3 -4"] {
        assert_eq!(text("rows.csv", content).unwrap().values, ROWS, "{content}");
    }
    assert_eq!(text("column.txt", "1\n2\n3\n").unwrap().list(), Some(&[1.0, 2.0, 3.0][..]));
}

#[test]
fn what_holds_no_numbers_is_refused_with_its_place() {
    let names = ["row", "wrong", "cube", "complex", "empty"];
    let found = names.map(|name| array(name).unwrap_err().to_string());
    let parts = [
        "there is no array `row`; expected one of `columns`, `complex`",
        "entry 1 of `wrong`: the number `NaN` is not a finite number",
        "`cube`: found 3 dimensions; expected an array of one or two dimensions",
        "`complex`: found numbers of type",
        "`empty`: found none; expected at least one number",
    ];
    for (found, part) in found.iter().zip(parts) {
        assert!(found.contains(part), "{found}");
    }
    let several = read_numbers(&Address { path: fixture("modes.npz"), name: None }).unwrap_err().to_string();
    assert!(several.contains("several arrays") && several.contains("modes.npz#columns"), "{several}");
    for (name, content, part) in [
        ("a.csv", "1,2\n3\n", "a.csv:2: numbers in the line, as in the first one: found 1, expected 2"),
        ("a.csv", "hz\n3\n", "a.csv:1: found `hz`; expected a number"),
        ("a.csv", "1,,2\n", "a.csv:1: found nothing; expected a number"),
        ("a.csv", "inf\n", "a.csv:1: the entry of the table `inf` is not a finite number"),
        ("a.csv", "# 1\n", "found none; expected at least one number"),
        ("a.npy", "1 2 3", "a.npy: found"),
        ("a.npz", "1 2 3", "a.npz: found"),
        ("a.xlsx", "1 2 3", "found `.xlsx`; expected numbers in a file .npz, .npy, .csv or .txt"),
    ] {
        let error = text(name, content).unwrap_err().to_string();
        assert!(error.contains(part), "{name}: {error}");
    }
    let named = Address { path: fixture("rows.npy"), name: Some("rows".into()) };
    assert!(read_numbers(&named).unwrap_err().to_string().contains("only an archive .npz holds several arrays"));
}
