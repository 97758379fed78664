#!/usr/bin/env python3
"""A motion of a nonlinear mode in CalculiX's own massless contact: how long does it stay periodic (needs NumPy, SciPy, CalculiX)?

    python3 benchmarks/peers/massless_contact.py PROGRAM FOLDER [--hz 738,741] [--harmonics 20,40] [--steps 4000] [--periods 10] [--ccx ccx]

writes the deck of a cantilever of bricks into FOLDER, has CalculiX write its matrices, takes the mass of the touching nodes away as its massless contact
does, and runs PROGRAM over massless_contact.toml up to a frequency. CalculiX then goes on from the last point (`*CONTACT PAIR, TYPE=MASSLESS`,
`*DYNAMIC, EXPLICIT`): from its displacements half a period from the contact, where all is at rest. So does a leapfrog of the same equations here. The error is the distance from there
after whole periods, over the displacement.
"""

import argparse
import itertools
import os
import pathlib
import resource
import shutil
import subprocess

import numpy as np
import scipy.linalg as sl

BRICKS, EDGE, WIDTH, HEIGHT = 12, 10.0, 10.0, 8.0
YOUNG, POISSON, DENSITY, GAP = 210000.0, 0.3, 7.8e-9, 0.5
# The block is so much stiffer than the beam; explicit steps follow the speed of sound, so it is as much denser.
RIGID = 1e5
# The block reaches so far beyond the brick below it.
MARGIN = 2.0
SCENE = pathlib.Path(__file__).with_name("massless_contact.toml")


def node(x, y, z):
    return 4 * x + 2 * y + z + 1


HELD = [node(0, y, z) for y in range(2) for z in range(2)]
TIP = [node(x, y, 1) for x in (BRICKS - 1, BRICKS) for y in range(2)]


def numbers(values):
    return ", ".join(map(str, values))


def beam():
    nodes = itertools.product(range(BRICKS + 1), range(2), range(2))
    lines = ["*NODE, NSET=BEAM", *(f"{node(x, y, z)}, {x * EDGE}, {y * WIDTH}, {z * HEIGHT}" for x, y, z in nodes)]
    lines.append("*ELEMENT, TYPE=C3D8, ELSET=BODY")
    for e in range(BRICKS):
        low = [node(e, 0, 0), node(e + 1, 0, 0), node(e + 1, 1, 0), node(e, 1, 0)]
        lines.append(numbers([e + 1, *low, *(n + 1 for n in low)]))
    return lines + [f"*NSET, NSET=HELD\n{numbers(HELD)}\n*NSET, NSET=TIP\n{numbers(TIP)}", *material("STEEL", "BODY", 1.0)]


def material(name, elements, factor):
    return [
        f"*MATERIAL, NAME={name}\n*ELASTIC\n{YOUNG * factor}, {POISSON}\n*DENSITY\n{DENSITY * factor}",
        f"*SOLID SECTION, ELSET={elements}, MATERIAL={name}",
    ]


def block():
    """One brick above the last one of the beam, its upper face held; the corners of its lower one have no mass either."""
    along, across = ((BRICKS - 1) * EDGE - MARGIN, BRICKS * EDGE + MARGIN), (-MARGIN, WIDTH + MARGIN)
    corners = [(along[i], across[j], HEIGHT + GAP + up) for up in (0.0, 5.0) for i, j in ((0, 0), (1, 0), (1, 1), (0, 1))]
    lines = ["*NODE", *(f"{1001 + k}, {numbers(place)}" for k, place in enumerate(corners))]
    lines.append(f"*ELEMENT, TYPE=C3D8, ELSET=BLOCK\n500, {numbers(range(1001, 1009))}")
    lines.append(f"*NSET, NSET=TOP\n{numbers(range(1005, 1009))}\n*BOUNDARY\nTOP, 1, 3")
    lines.append(f"*SURFACE, NAME=LOWER\n500, S1\n*SURFACE, NAME=UPPER\n{BRICKS}, S2")
    lines.append("*CONTACT PAIR, INTERACTION=HARD, TYPE=MASSLESS\nUPPER, LOWER")
    return lines + ["*SURFACE INTERACTION, NAME=HARD\n*SURFACE BEHAVIOR, PRESSURE-OVERCLOSURE=HARD", *material("WALL", "BLOCK", RIGID)]


def used():
    """Processor time of the processes that were started and have ended, s."""
    usage = resource.getrusage(resource.RUSAGE_CHILDREN)
    return usage.ru_utime + usage.ru_stime


def calculix(program, folder, name, lines):
    (folder / f"{name}.inp").write_text("\n".join(lines) + "\n")
    before = used()
    environment = {**os.environ, "OMP_NUM_THREADS": "1"}
    with (folder / f"{name}.log").open("w") as log:
        subprocess.run([program, name], cwd=folder, stdout=log, stderr=log, env=environment, check=True)
    return used() - before


def matrices(folder):
    """Names of the rows, stiffness, and the mass without that of the touching nodes, which is written too."""
    names = [tuple(map(int, line.split("."))) for line in (folder / "beam.dof").read_text().split()]
    found, kept = [], []
    for ending in ("sti", "mas"):
        matrix = np.zeros((len(names), len(names)))
        for line in (folder / f"beam.{ending}").read_text().splitlines():
            i, j, value = line.split()
            i, j = int(i) - 1, int(j) - 1
            bare = ending == "mas" and {names[i][0], names[j][0]} & set(TIP)
            if ending == "mas" and (i == j or not bare):
                kept.append(f"{i + 1} {j + 1} {0.0 if bare else value}")
            matrix[i, j] = matrix[j, i] = 0.0 if bare else float(value)
        found.append(matrix)
    (folder / "massless.mas").write_text("\n".join(kept) + "\n")
    return names, *found


def displacements(folder, names, stiffness, mass):
    """Displacements (mm) half a period from the contact and period (s) of the last point, from its modal coefficients."""
    touching = [i for i, name in enumerate(names) if name[0] in TIP]
    free = [i for i, name in enumerate(names) if name[0] not in TIP]
    follows = -np.linalg.solve(stiffness[np.ix_(touching, touching)], stiffness[np.ix_(touching, free)])
    condensed = stiffness[np.ix_(free, free)] + stiffness[np.ix_(free, touching)] @ follows
    _, modes = sl.eigh(0.5 * (condensed + condensed.T), mass[np.ix_(free, free)])
    shapes = np.zeros((len(names), len(free)))
    shapes[free], shapes[touching] = modes, follows @ modes
    shapes *= np.sign(shapes[np.abs(shapes).argmax(0), range(len(free))])
    results = np.load(folder / "results" / "harmonics.npz")
    coefficients, period = results["coefficients"][-1], 2 * np.pi / results["omega"][-1]
    turned = (coefficients * (-1.0) ** np.arange(coefficients.shape[1])).sum(1).real
    # Shapes have the unit 1/√t, modal coordinates m √kg.
    start = 1e3 * shapes @ turned[: len(free)] / np.sqrt(1e3)
    contacts = [i for i in touching if names[i][1] == 3]
    assert np.allclose(start[contacts], 1e3 * turned[len(free) :], atol=1e-6), "the shapes are not those of the results"
    return start, period


def pressed(flexibility, gaps):
    """The forces `λ ≥ 0` on a few contacts with `g + F λ ≥ 0`, and one of both zero: the first set of closed ones that does it."""
    count = len(gaps)
    for size in range(count + 1):
        for closed in map(list, itertools.combinations(range(count), size)):
            forces = np.zeros(count)
            forces[closed] = np.linalg.solve(flexibility[np.ix_(closed, closed)], -gaps[closed])
            if forces.min() >= 0.0 and (gaps + flexibility @ forces).min() >= -1e-12 * GAP:
                return forces
    raise ArithmeticError("no set of closed contacts holds the gaps open")


def leapfrog(names, stiffness, mass, start, period, steps, periods):
    """Displacements after each of the periods; touching nodes answer statically."""
    touching = [i for i, name in enumerate(names) if name[0] in TIP]
    free = [i for i, name in enumerate(names) if name[0] not in TIP]
    part = lambda matrix, rows, columns: matrix[np.ix_(rows, columns)]
    yielding, inverse = np.linalg.inv(part(stiffness, touching, touching)), np.linalg.inv(part(mass, free, free))
    follows = -yielding @ part(stiffness, touching, free)
    upward = [k for k, i in enumerate(touching) if names[i][1] == 3]
    own = -inverse @ (part(stiffness, free, free) + part(stiffness, free, touching) @ follows)
    push = inverse @ part(stiffness, free, touching) @ yielding[:, upward]
    flexibility, toward = yielding[np.ix_(upward, upward)], follows[upward]
    q, v, dt, states = start[free], np.zeros(len(free)), period / steps, []
    for step in range(steps * periods):
        gaps = GAP - toward @ q
        acceleration = own @ q
        if gaps.min() < 0.0:
            acceleration += push @ pressed(flexibility, gaps)
        v = v + (dt if step else 0.5 * dt) * acceleration
        q = q + dt * v
        if (step + 1) % steps == 0:
            whole = np.zeros(len(names))
            whole[free], whole[touching] = q, follows @ q
            states.append(whole)
    return states


def printed(path, names):
    """Displacements at each time that was printed."""
    states = []
    for line in path.read_text().splitlines():
        if "displacements" in line:
            states.append({})
        elif line.strip():
            words = line.split()
            states[-1][int(words[0])] = list(map(float, words[1:4]))
    return [np.array([state[n][d - 1] for n, d in names]) for state in states]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("folder", type=pathlib.Path)
    parser.add_argument("--hz", default="738,741")
    parser.add_argument("--harmonics", default="20,40")
    parser.add_argument("--steps", default="4000")
    parser.add_argument("--periods", type=int, default=10)
    parser.add_argument("--ccx", default="ccx")
    words = parser.parse_args()
    folder, shown = words.folder, [k for k in (1, 2, 5, 10, 20, 50) if k <= words.periods]
    folder.mkdir(parents=True, exist_ok=True)
    supports = ["*BOUNDARY\nHELD, 1, 3"]
    calculix(words.ccx, folder, "beam", beam() + supports + ["*STEP\n*FREQUENCY, SOLVER=MATRIXSTORAGE\n*END STEP"])
    names, stiffness, mass = matrices(folder)
    shutil.copy(SCENE, folder)
    print(f"| Hz | harmonics | steps a period | in | {' | '.join(f'after {k}' for k in shown)} | CPU, s |")
    print(f"| ---: | ---: | ---: | --- | {' | '.join('---:' for _ in shown)} | ---: |")
    for hertz, harmonics in itertools.product(words.hz.split(","), words.harmonics.split(",")):
        chosen = [f"method.harmonics={harmonics}", f"continuation.frequency_hz=[700.0, {hertz}]"]
        call = [words.program, "run", str(folder / SCENE.name), "--out", str(folder / "results"), "--force", "--quiet"]
        subprocess.run(call + [word for key in chosen for word in ("--set", key)], check=True)
        start, period = displacements(folder, names, stiffness, mass)
        begin = ["*INITIAL CONDITIONS, TYPE=DISPLACEMENT", *(f"{n}, {d}, {u:.12e}" for (n, d), u in zip(names, start))]
        for steps in map(int, words.steps.split(",")):
            def row(what, states, cpu):
                error = [f"{np.linalg.norm(states[k - 1] - start) / np.linalg.norm(start):.1e}" for k in shown]
                print(f"| {hertz} | {harmonics} | {steps} | {what} | {' | '.join(error)} | {cpu} |", flush=True)

            row("leapfrog", leapfrog(names, stiffness, mass, start, period, steps, words.periods), "")
            dt, whole = period / steps, period * words.periods
            step = [f"*STEP, INC={steps * words.periods + 100}\n*DYNAMIC, EXPLICIT\n{dt:.10e}, {whole:.10e}, 0., {dt:.10e}"]
            step.append(f"*NODE PRINT, NSET=BEAM, FREQUENCY={steps}\nU\n*END STEP")
            cpu = calculix(words.ccx, folder, "motion", beam() + block() + supports + begin + step)
            row("CalculiX", printed(folder / "motion.dat", names), f"{cpu:.0f}")


if __name__ == "__main__":
    main()
