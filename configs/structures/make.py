#!/usr/bin/env python3
"""Makes the finite-element files of the example structures anew, with Gmsh and CalculiX (Debian: packages gmsh and calculix-ccx).

    python3 configs/structures/make.py

For each geometry NAME.geo: the mesh NAME.msh, the deck NAME.inp that CalculiX computes, its matrices NAME.sti.gz, NAME.mas.gz and NAME.dof,
and its own natural frequencies NAME.hz, one a line. Units mm, t, s, N.
"""

import gzip
import pathlib
import re
import shutil
import subprocess
import tempfile

HERE = pathlib.Path(__file__).resolve().parent
STEEL = """*MATERIAL, NAME=STEEL
*ELASTIC
210000, 0.3
*DENSITY
7.85e-9
*SOLID SECTION, ELSET={solid}, MATERIAL=STEEL
*BOUNDARY
{clamped}, 1, 3
*STEP
{step}
*END STEP
"""
MATRICES = "*FREQUENCY, SOLVER=MATRIXSTORAGE"
FREQUENCIES = "*FREQUENCY\n8"


def solids_only(deck):
    """The blocks of a deck that Gmsh wrote, without elements on faces and edges, which would have stiffness of their own."""
    blocks = re.split(r"(?m)^(?=\*[A-Za-z])", deck)
    wanted = [b for b in blocks if re.match(r"\*NODE|\*NSET|\*ELEMENT, type=C3D", b, re.I)]
    elements = r"(?i)^(\*ELEMENT, type=C3D\w+), ELSET=\w+"
    wanted = [re.sub(elements, r"\1, ELSET=SOLID", b) for b in wanted]
    return "".join(re.sub(r"(?m)^\*{3,}.*\n", "", b) for b in wanted)


def calculix(folder, name, mesh, step):
    (folder / f"{name}.inp").write_text(mesh + STEEL.format(solid="SOLID", clamped="FOOT", step=step))
    subprocess.run(["ccx", "-i", name], cwd=folder, check=True, stdout=subprocess.DEVNULL)


def packed(source, target):
    """Without a time, so that the same content gives the same file."""
    with target.open("wb") as raw, gzip.GzipFile(filename="", mode="wb", fileobj=raw, mtime=0, compresslevel=9) as out:
        out.write(source.read_bytes())


def frequencies(report):
    """Cycles per time of the table of eigenvalues."""
    table = report.split("E I G E N V A L U E   O U T P U T")[1].split("P A R T I C I P A T I O N")[0]
    rows = [line.split() for line in table.splitlines()]
    return [row[3] for row in rows if len(row) == 5 and row[0].isdigit()]


def make(name):
    with tempfile.TemporaryDirectory() as temporary:
        folder = pathlib.Path(temporary)
        shutil.copy(HERE / f"{name}.geo", folder)
        for target in [f"{name}.msh", "mesh.inp"]:
            subprocess.run(["gmsh", "-3", "-v", "2", f"{name}.geo", "-o", target], cwd=folder, check=True)
        mesh = solids_only((folder / "mesh.inp").read_text())
        calculix(folder, "open", mesh, FREQUENCIES)
        calculix(folder, name, mesh, MATRICES)
        hz = frequencies((folder / "open.dat").read_text())
        (HERE / f"{name}.hz").write_text("\n".join(hz) + "\n")
        for ending in ["msh", "inp", "dof"]:
            shutil.copy(folder / f"{name}.{ending}", HERE)
        for ending in ["sti", "mas"]:
            packed(folder / f"{name}.{ending}", HERE / f"{name}.{ending}.gz")


if __name__ == "__main__":
    for geometry in sorted(HERE.glob("*.geo")):
        make(geometry.stem)
