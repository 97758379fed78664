//! Universal Files against pyuff, an independent implementation in Python.
//!
//! Runs if the program in the environment variable `PYTHON`, or `python3`, can import pyuff; otherwise it prints a note
//! and passes.

use std::path::Path;
use std::process::Command;

use nlmodes_experiment::records::{
    Abscissa, Axis, ByteOrder, Dataset58, Ordinates, Precision, Storage, read_uff58, write_uff58,
};
use num_complex::Complex64;

fn python(script: &str, arguments: &[&Path]) -> Result<String, String> {
    let program = std::env::var("PYTHON").unwrap_or_else(|_| "python3".into());
    let output = Command::new(program).arg("-c").arg(script).args(arguments).output().map_err(|e| e.to_string())?;
    if output.status.success() {
        String::from_utf8(output.stdout).map_err(|e| e.to_string())
    } else {
        Err(String::from_utf8_lossy(&output.stderr).into_owned())
    }
}

fn pyuff_is_there() -> bool {
    let found = python("import pyuff", &[]);
    if let Err(reason) = &found {
        let reason = reason.lines().last().unwrap_or_default();
        println!("skipped: pyuff cannot be imported ({reason}); set PYTHON to a Python that has it");
    }
    found.is_ok()
}

fn functions() -> Vec<Dataset58> {
    let real: Vec<f64> = (0..23).map(|j| (0.7 * f64::from(j)).sin() * 10f64.powi(j % 5 - 2)).collect();
    let complex: Vec<Complex64> = real.iter().map(|x| Complex64::new(*x, 1.0 - x)).collect();
    let uneven = Abscissa::Uneven { values: (0..23).map(|j| 0.125 * f64::from(j * j)).collect(), rounding: 0.0 };
    let mut functions = Vec::new();
    for abscissa in [Abscissa::even(0.5, 0.125), uneven] {
        for ordinates in [Ordinates::Real(real.clone()), Ordinates::Complex(complex.clone())] {
            let mut function = Dataset58::real(vec![], abscissa.clone());
            function.ordinates = ordinates;
            function.identification[0] = format!("function {}", functions.len());
            function.response.node = functions.len() as i32;
            function.abscissa_axis = Axis { kind: 17, label: "Time".into(), unit: "s".into(), ..Axis::default() };
            functions.push(function);
        }
    }
    functions
}

const READ: &str = "
import sys, numpy, pyuff
for path in sys.argv[1:]:
    data = pyuff.UFF(path).read_sets()
    for d in data if isinstance(data, list) else [data]:
        y = numpy.asarray(d['data'])
        print('#', d['id1'], '|', d['rsp_node'], '|', d['abscissa_axis_lab'].strip(), '|', d['ordinate_spec_data_type'])
        for x, z in zip(d['x'], y):
            print(repr(float(x)), repr(float(z.real)), repr(float(z.imag)))
";

const WRITE: &str = "
import sys, numpy, pyuff
k = 0
for path, binary in zip(sys.argv[1:], (0, 1)):
    for uneven in (0, 1):
        for complex_ in (0, 1):
            n = 23
            x = 0.125 * numpy.arange(n) ** 2 if uneven else 0.5 + 0.125 * numpy.arange(n)
            y = numpy.sin(0.7 * numpy.arange(n)) * 10.0 ** (numpy.arange(n) % 5 - 2)
            if complex_:
                y = y + 1j * (1 - y)
            pyuff.UFF(path).write_sets({'type': 58, 'func_type': 1, 'rsp_node': k % 4, 'rsp_dir': 3, 'ref_node': 1,
                'ref_dir': 3, 'data': y, 'x': x, 'id1': 'function %d' % (k % 4), 'rsp_ent_name': 'r',
                'ref_ent_name': 's', 'abscissa_spacing': 1 - uneven, 'abscissa_spec_data_type': 17,
                'abscissa_axis_lab': 'Time', 'ordinate_spec_data_type': 0, 'orddenom_spec_data_type': 0,
                'binary': binary}, 'add')
            k += 1
";

#[test]
fn pyuff_reads_what_is_written_here() {
    if !pyuff_is_there() {
        return;
    }
    let directory = tempfile::tempdir().unwrap();
    for storage in [Storage::Text, Storage::Binary(ByteOrder::Little), Storage::Binary(ByteOrder::Big)] {
        for precision in [Precision::Single, Precision::Double] {
            let path = directory.path().join("written.uff");
            let mut file = Vec::new();
            functions().iter().for_each(|f| write_uff58(&mut file, f, storage, precision).unwrap());
            std::fs::write(&path, file).unwrap();
            let said = python(READ, &[&path]).unwrap();
            compare(&said, storage, precision);
        }
    }
}

fn compare(said: &str, storage: Storage, precision: Precision) {
    let relative = match (storage, precision) {
        (Storage::Text, Precision::Double) => 5e-13,
        (Storage::Text, Precision::Single) => 5e-6,
        (_, Precision::Single) => 6e-8,
        (_, Precision::Double) => 0.0,
    };
    let blocks: Vec<&str> = said.split('#').skip(1).collect();
    assert_eq!(blocks.len(), functions().len(), "{storage:?} {precision:?}");
    for (block, function) in blocks.iter().zip(functions()) {
        let mut lines = block.lines();
        let heading = lines.next().unwrap();
        let expected = format!(" {} | {} | Time | 0", function.identification[0], function.response.node);
        assert_eq!(heading.split_whitespace().collect::<String>(), expected.split_whitespace().collect::<String>());
        let rows: Vec<Vec<f64>> =
            lines.map(|line| line.split_whitespace().map(|word| word.parse().unwrap()).collect()).collect();
        assert_eq!(rows.len(), 23);
        for (j, row) in rows.iter().enumerate() {
            let (x, z) = value(&function, j);
            for (found, wanted) in row.iter().zip([x, z.re, z.im]) {
                assert!(
                    (found - wanted).abs() <= relative * wanted.abs(),
                    "{found} {wanted} {storage:?} {precision:?}"
                );
            }
        }
    }
}

fn value(function: &Dataset58, j: usize) -> (f64, Complex64) {
    let x = match &function.abscissa {
        Abscissa::Even { first, step, .. } => first + step * j as f64,
        Abscissa::Uneven { values, .. } => values[j],
    };
    let z = match &function.ordinates {
        Ordinates::Real(values) => values[j].into(),
        Ordinates::Complex(values) => values[j],
    };
    (x, z)
}

#[test]
fn what_pyuff_writes_is_read_here() {
    if !pyuff_is_there() {
        return;
    }
    let directory = tempfile::tempdir().unwrap();
    let paths = [directory.path().join("text.uff"), directory.path().join("binary.uff")];
    python(WRITE, &[&paths[0], &paths[1]]).unwrap();
    for (path, relative) in paths.iter().zip([5e-12, 0.0]) {
        let read = read_uff58(&std::fs::read(path).unwrap()).unwrap();
        assert_eq!(read.len(), 4);
        for (read, function) in read.iter().zip(functions()) {
            assert_eq!(read.identification[0], function.identification[0]);
            assert_eq!((read.response.node, read.ordinates.len()), (function.response.node, 23));
            for j in 0..23 {
                let ((x, z), (wanted_x, wanted)) = (value(read, j), value(&function, j));
                // The abscissa has six digits as text; numpy's sine may differ in the last bit.
                assert!((x - wanted_x).abs() <= 5e-6 * wanted_x.abs());
                assert!((z - wanted).norm() <= (relative + 1e-15) * wanted.norm(), "{z} {wanted}");
            }
        }
    }
}
