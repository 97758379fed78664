#!/usr/bin/env python3
"""The plate of configs/structures through every format: how far its branches are from that of CalculiX's files (needs NumPy, SciPy, h5py).

    python3 benchmarks/studies/plate_formats.py PROGRAM

Writes the matrices of plate.sti.gz and plate.mas.gz as each program would, runs PROGRAM (nlmodes-cli) over each to 1.5 grazing energies, and prints the largest
relative difference of frequency, energy and largest contact force as a Markdown table. A punch file of Nastran has ten digits: its branch is compared with that of the
same rounded matrices in Matrix Market.
"""

import csv
import gzip
import pathlib
import struct
import subprocess
import sys
import tempfile

import h5py
import numpy as np
import scipy.io
import scipy.sparse as sp

PLATE = pathlib.Path(__file__).resolve().parents[2] / "configs" / "structures"
COLUMNS = ["frequency_hz", "energy_j", "peak_contact_force_n"]


def matrix(name):
    rows, columns, values = np.loadtxt(gzip.open(PLATE / name), unpack=True)
    upper = sp.coo_matrix((values, (rows.astype(int) - 1, columns.astype(int) - 1))).tocsc()
    upper.eliminate_zeros()
    return (upper + sp.triu(upper, 1).T).tocsc()


def labels():
    return [tuple(map(int, line.split("."))) for line in (PLATE / "plate.dof").read_text().split()]


def lower(a):
    a = sp.tril(a).tocsc()
    a.sort_indices()
    return a


def matrix_market(path, a, _):
    scipy.io.mmwrite(path, lower(a), symmetry="symmetric", precision=17)


def general(path, a, _):
    scipy.io.mmwrite(path, a, symmetry="general", precision=17)


def abaqus(path, a, of):
    a = lower(a).tocoo()
    with open(path, "w") as file:
        for i, j, v in zip(a.row, a.col, a.data):
            file.write("%d,%d, %d,%d, %.17e\n" % (*of[i], *of[j], v))


def harwell_boeing(path, a, _):
    a = lower(a)

    def lines(fields, count):
        return ["".join(fields[i : i + count]) for i in range(0, len(fields), count)]

    pointers = lines(["%8d" % (p + 1) for p in a.indptr], 10)
    rows = lines(["%8d" % (i + 1) for i in a.indices], 10)
    values = lines([("%25.16E" % v).replace("E", "D") for v in a.data], 3)
    counts = [len(pointers) + len(rows) + len(values), len(pointers), len(rows), len(values), 0]
    head = ["%-72s%-8s" % ("Matrix", "PLATE"), "".join("%14d" % c for c in counts)]
    head += ["%-14s" % "RSA" + "".join("%14d" % c for c in [a.shape[0], a.shape[1], a.nnz, 0])]
    head += ["%-16s%-16s%-20s%-20s" % ("(10I8)", "(10I8)", "(1P,3D25.16)", "")]
    path.write_text("\n".join(head + pointers + rows + values) + "\n")


def punched(path, a, of):
    a, name = lower(a), path.stem.upper() + "AAX"
    lines = ["DMIG    %-8s%8d%8d%8d%8d" % (name, 0, 6, 2, 0)]
    for j in range(a.shape[0]):
        lines.append("DMIG*   %-16s%16d%16d" % (name, *of[j]))
        for i, v in zip(a.indices[a.indptr[j] : a.indptr[j + 1]], a.data[a.indptr[j] : a.indptr[j + 1]]):
            lines.append("*       %16d%16d%16s" % (*of[i], ("%.9E" % v).replace("E", "D")))
    path.write_text("\n".join(lines) + "\n")


def hdf5(path, matrices):
    """As MATLAB writes its version 7.3."""
    with h5py.File(path, "w", userblock_size=512, libver="earliest") as file:
        for name, a in matrices.items():
            group = file.create_group(name)
            group.attrs["MATLAB_class"] = np.bytes_("double")
            group.attrs["MATLAB_sparse"] = np.uint64(a.shape[0])
            group.create_dataset("data", data=a.data, compression="gzip")
            group.create_dataset("ir", data=a.indices.astype(np.uint64), compression="gzip")
            group.create_dataset("jc", data=a.indptr.astype(np.uint64))
    head = b"MATLAB 7.3 MAT-file, Platform: GLNXA64".ljust(116) + bytes(8) + struct.pack("<H", 0x0200) + b"IM"
    with open(path, "r+b") as file:
        file.write(head)


def branch(program, folder, stiffness, mass, dofs):
    scene = (PLATE / "plate.toml").read_text()
    files = {'"plate.sti.gz"': stiffness, '"plate.mas.gz"': mass, '"plate.dof"': dofs, '"plate.inp"': str(PLATE / "plate.inp")}
    for old, new in files.items():
        scene = scene.replace(old, '"%s"' % new)
    if not dofs:
        scene = scene.replace('dofs = ""', "")
    (folder / "scene.toml").write_text(scene)
    words = [program, "run", str(folder / "scene.toml"), "--out", str(folder / "out"), "--force", "--quiet"]
    keys = ["continuation.max_energy_ratio=1.5", "output.figures=false", "output.page=false"]
    subprocess.run(words + [word for key in keys for word in ("--set", key)], check=True)
    rows = list(csv.DictReader(open(folder / "out" / "branch.csv")))
    return np.array([[float(row[column]) for column in COLUMNS] for row in rows])


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    matrices, of = {"K": matrix("plate.sti.gz"), "M": matrix("plate.mas.gz")}, labels()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        (folder / "table.csv").write_text("".join(f"{i + 1},{node},{direction}\n" for i, (node, direction) in enumerate(of)))
        names = {1: "UX", 2: "UY", 3: "UZ"}
        rows = "".join("%12d%12d   %s\n" % (i + 1, node, names[direction]) for i, (node, direction) in enumerate(of))
        (folder / "x.mapping").write_text("  Matrix Eqn        Node   DOF\n" + rows)
        table, mapping, plate = str(folder / "table.csv"), str(folder / "x.mapping"), str(PLATE / "plate.dof")
        expected = branch(program, folder, str(PLATE / "plate.sti.gz"), str(PLATE / "plate.mas.gz"), plate)

        def row(what, found, beside):
            size = np.maximum(np.abs(beside), np.abs(beside).max(axis=0) * [0, 0, 1])
            worst = (np.abs(found - beside) / size).max(axis=0)
            print("| %s | %d | %.1e | %.1e | %.1e |" % (what, len(found), *worst), flush=True)

        def written(ending, write, dofs, source=matrices):
            for key, a in source.items():
                write(folder / (key + ending), a, of)
            return branch(program, folder, *[str(folder / (key + ending)) for key in matrices], dofs)

        print("| format | points | frequency | energy | force |\n| --- | ---: | ---: | ---: | ---: |")
        for kind in (sp.csc_matrix, sp.csr_matrix, sp.coo_matrix):
            found = written("_.npz", lambda path, a, _: sp.save_npz(path, kind(a)), table)
            row("SciPy, " + kind.__name__.split("_")[0], found, expected)
        row("Matrix Market, symmetric", written(".mtx", matrix_market, table), expected)
        row("Matrix Market, general", written("_.mtx", general, table), expected)
        row("Abaqus", written("_a.mtx", abaqus, ""), expected)
        row("Harwell-Boeing with `.mapping`", written(".hb", harwell_boeing, mapping), expected)
        for what, path in (("MATLAB 5", "five.mat"), ("MATLAB 7.3", "seven.mat")):
            if path == "five.mat":
                scipy.io.savemat(folder / path, matrices, do_compression=True)
            else:
                hdf5(folder / path, matrices)
            row(what, branch(program, folder, str(folder / path) + "#K", str(folder / path) + "#M", table), expected)
        digits = np.vectorize(lambda v: float("%.9e" % v))
        rounded = {key: sp.csc_matrix((digits(a.data), a.indices, a.indptr)) for key, a in matrices.items()}
        short = written(".mtx", matrix_market, table, rounded)
        row("Nastran, beside its ten digits in Matrix Market", written(".pch", punched, ""), short)
        print("\nTen digits move the frequency at grazing by %.1e, the branch has %d points." % (short[0, 0] / expected[0, 0] - 1, len(short)))


if __name__ == "__main__":
    main()
