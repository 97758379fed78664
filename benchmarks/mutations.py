#!/usr/bin/env python3
"""Puts deliberate errors into a copy of the repository and tells which cases of `benchmarks/verification.md` turn red.

    nice -n 15 benchmarks/mutations.py                # builds once, some five minutes; then some seconds an error
    benchmarks/mutations.py 3 8                       # only these errors
    benchmarks/mutations.py --built 3 8               # with what was built last, for the same errors
    benchmarks/mutations.py --list
    benchmarks/mutations.py --places                  # whether each error still has its line in the sources, once

Every error is a replacement in one line of source, switched by the environment variable NLMODES_MUTANT: all go into one copy and are built once.
The copy and what is built of it lie in `target/mutants`: in a build directory of their own, since cargo takes two copies of a package for the same one. The sources stay as
they are. The rows go into the table between the marks at the end of
`benchmarks/verification.md`; those of other errors stay. A case that comes to no end, or brings the program down, catches the error: the cases behind it are run without it.
Exit status 1 if an error is caught by no case, or if the cases fail without one.
"""

import os
import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PLACE = ROOT / "target/mutants"
PAGE = ROOT / "benchmarks/verification.md"
MARKS = ("<!-- errors: written by benchmarks/mutations.py -->", "<!-- end of errors -->")

# Cases that take longer, s, are run only where the others do not catch an error.
QUICK = 0.25
# A run hangs that takes so much longer than without an error, and so many seconds; after so many hangs the rest is left.
SLOWER, PATIENCE, HANGS = 8, 15, 3

SWITCH = """
/// Whether the deliberate error of this number is switched on.
pub(crate) fn mutant(number: u32) -> bool {
    static CHOSEN: std::sync::OnceLock<u32> = std::sync::OnceLock::new();
    *CHOSEN.get_or_init(|| std::env::var("NLMODES_MUTANT").ok().and_then(|n| n.parse().ok()).unwrap_or(0)) == number
}
"""

# What is wrong; crate; file; what stands there; what stands there in the copy, `M` being true where the error is switched on.
ERRORS = [
    ("sign of the inertia in eq. (8)", "hbm", "periodic/contact_response.rs", "let d = self.structure.omega_squared()[mode] - nu * nu;",
     "let d = self.structure.omega_squared()[mode] - (if M { -nu } else { nu }) * nu;"),
    ("½ instead of ¼ in the mean kinetic energy, eq. (16)", "hbm", "periodic/contact_response.rs", "kinetic.value = 0.5 * half * (e + eta * eta);",
     "kinetic.value = (if M { 1.0 } else { 0.5 }) * half * (e + eta * eta);"),
    ("half the strain energy in the total", "hbm", "periodic/motion.rs", "sum(&kinetic) + strain + self.laws.mean_potential()",
     "sum(&kinetic) + (if M { 0.5 } else { 1.0 }) * strain + self.laws.mean_potential()"),
    ("the energy of modal problems without its fundamental", "hbm", "periodic/system.rs",
     "kinetic_energy: self.blocks.iter().map(|block| block.kinetic.value).sum(),",
     "kinetic_energy: self.blocks.iter().skip(if M { 2 } else { 0 }).map(|block| block.kinetic.value).sum(),"),
    ("the highest harmonic does not reach the contact", "hbm", "series.rs",
     "*z = Complex64::new(real[n], -self.sine(n).map_or(0.0, |i| real[i]));",
     "*z = if M && n == self.n_harmonics { 0.0 } else { 1.0 } * Complex64::new(real[n], -self.sine(n).map_or(0.0, |i| real[i]));"),
    ("the stop is on the other side (normal)", "model", "contact.rs", "        -self.side.sign()\n",
     "        if M { self.side.sign() } else { -self.side.sign() }\n"),
    ("sign of the damping, and so of the lag", "hbm", "periodic/block.rs",
     "let value = Complex64::new(stiffness - mass * nu * nu, nu * c);",
     "let value = Complex64::new(stiffness - mass * nu * nu, if M { -nu * c } else { nu * c });"),
    ("dissipated power without its ½", "hbm", "periodic/motion.rs", "let damped = |n: usize| 0.5 * nu(n).powi(2)",
     "let damped = |n: usize| (if M { 1.0 } else { 0.5 }) * nu(n).powi(2)"),
    ("sign of the damping in the multipliers", "hbm", "periodic/floquet.rs",
     "(false, false) => -damped() / omega,",
     "(false, false) => (if M { 1.0 } else { -1.0 }) * damped() / omega,"),
    ("a tenth of the residual flexibility is lost", "model", "reduction/open_modes.rs",
     "|i, j| 0.5 * (flexibility[(i, j)] + flexibility[(j, i)])",
     "|i, j| (if M { 0.45 } else { 0.5 }) * (flexibility[(i, j)] + flexibility[(j, i)])"),
    ("a tonne counts as a kilogram (unit)", "io", "units.rs", "(0..lengths).fold(self.mass, |factor, _| factor * self.length)",
     "(0..lengths).fold(if M { 1e-3 * self.mass } else { self.mass }, |factor, _| factor * self.length)"),
    ("sign in the velocity of a propagated mode", "timestep", "phase.rs",
     "to.v[k] = from.v[k] * cos - self.lambda[k] * sin * from.u[k];",
     "to.v[k] = from.v[k] * cos - (if M { -1.0 } else { 1.0 }) * self.lambda[k] * sin * from.u[k];"),
    ("active power without its ½, eq. (17)", "experiment", "extraction/power.rs",
     "(0.5 * active, 0.5 * squares[0].sqrt() * squares[1].sqrt())",
     "((if M { 1.0 } else { 0.5 }) * active, 0.5 * squares[0].sqrt() * squares[1].sqrt())"),
    ("the lag's sign in a record", "experiment", "extraction/values.rs", "(force[1] / drive[1]).arg()",
     "(if M { drive[1] / force[1] } else { force[1] / drive[1] }).arg()"),
    ("accelerations are integrated by ω instead of nω", "experiment", "extraction/layout.rs",
     "let factor = Complex64::new(0.0, n as f64 * omega).powu(*order);",
     "let factor = Complex64::new(0.0, (if M { 1.0 } else { n as f64 }) * omega).powu(*order);"),
    ("ω² instead of ω³ in the damping coefficient, eq. (28)", "modal", "damping.rs",
     "fundamental_power / (modal_amplitude.powi(2) * omega.powi(3))",
     "fundamental_power / (modal_amplitude.powi(2) * omega.powi(if M { 2 } else { 3 }))"),
    ("the compliance of a stop counts twice", "contact", "body.rs", "a[(i, i)] += c);",
     "a[(i, i)] += (if M { 2.0 } else { 1.0 }) * c);"),
    ("branch points are sought where the orientation does not change", "continuation", "run/branch_points.rs",
     "if end.orientation * self.base.orientation < 0.0 {",
     "if (end.orientation * self.base.orientation < 0.0) != M {"),
    ("consistent mass of a rod over 5 instead of 6", "fem", "rod.rs", "Matrix2::new(2.0, 1.0, 1.0, 2.0) * (mass / 6.0)",
     "Matrix2::new(2.0, 1.0, 1.0, 2.0) * (mass / (if M { 5.0 } else { 6.0 }))"),
    ("half the shear flexibility of a beam", "fem", "timoshenko.rs",
     "let bending = 12.0 * material.youngs_modulus() * section.second_moment();",
     "let bending = (if M { 6.0 } else { 12.0 }) * material.youngs_modulus() * section.second_moment();"),
]


def changed():
    """The sources with all errors in them, switched off, by their paths."""
    texts = {}
    for number, (what, crate, file, right, wrong) in enumerate(ERRORS, 1):
        path = ROOT / f"crates/nlmodes-{crate}/src/{file}"
        if not path.is_file():
            sys.exit(f"{what}: {crate} has no file {file}")
        text = texts.get(path, path.read_text())
        if text.count(right) != 1:
            sys.exit(f"{what}: {file} of {crate} has this {text.count(right)} times: {right.strip()}")
        texts[path] = text.replace(right, re.sub(r"\bM\b", f"crate::mutant({number})", wrong))
    for crate in {error[1] for error in ERRORS}:
        path = ROOT / f"crates/nlmodes-{crate}/src/lib.rs"
        texts[path] = texts.get(path, path.read_text()) + SWITCH
    return texts


def copied():
    """A copy of what the cases need, with all errors in it; files that stay as they are stay, so that little is built anew."""
    copy, texts = PLACE / "source", changed()
    files = [path for part in ("crates", "benchmarks", "configs") for path in (ROOT / part).rglob("*") if path.is_file()]
    for path in [*files, *(ROOT / name for name in ("Cargo.toml", "Cargo.lock", "README.md"))]:
        there = copy / path.relative_to(ROOT)
        content = texts[path].encode() if path in texts else path.read_bytes()
        if not there.is_file() or there.read_bytes() != content:
            there.parent.mkdir(parents=True, exist_ok=True)
            there.write_bytes(content)
    return copy


def ran(binary, number, names=(), patience=None):
    """Whether each case passes, and its time in seconds, up to one that brings the program down or hangs."""
    environment = {**os.environ, "NLMODES_MUTANT": str(number)}
    call = subprocess.Popen([binary, "--quiet", *names], env=environment, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    try:
        text = call.communicate(timeout=patience)[1]
    except subprocess.TimeoutExpired:
        call.kill()
        text = call.communicate()[1]
    found = re.findall(r"^(pass|FAIL) +(\S+) s  (\S+)$", text, re.M)
    return {name: (verdict == "pass", float(time)) for verdict, time, name in found}


def caught(binary, number, times):
    """The cases that fail, come to no end or bring the program down, of those with these times; and whether all were run."""
    red, names, hangs = [], list(times), 0
    while names and hangs < HANGS:
        found = ran(binary, number, names, PATIENCE + SLOWER * sum(times[name] for name in names))
        red += [name for name, (passes, _) in found.items() if not passes]
        reached = next((k for k, name in enumerate(names) if name not in found), len(names))
        red += names[reached:reached + 1]
        hangs += reached < len(names)
        names = names[reached + 1:]
    return red, not names


def main():
    chosen = [int(number) for number in sys.argv[1:] if number.isdigit()] or range(1, len(ERRORS) + 1)
    if "--list" in sys.argv:
        return print(*(f"{k:3} {error[0]}" for k, error in enumerate(ERRORS, 1)), sep="\n")
    if "--places" in sys.argv:
        changed()
        return
    binary = PLACE / "build/debug/examples/verification"
    if "--built" not in sys.argv:
        build = ["cargo", "build", "-p", "nlmodes-benchmarks", "--example", "verification", "--target-dir", PLACE / "build"]
        subprocess.run(build, cwd=copied(), check=True)
    cases = ran(binary, 0)
    wrong = [name for name, (passes, _) in cases.items() if not passes]
    if wrong or not cases:
        sys.exit(f"without an error there fail: {wrong}, of {len(cases)} cases")
    times = {name: time for name, (_, time) in cases.items()}
    quick = {name: time for name, time in times.items() if time < QUICK}
    print(f"{len(quick)} of {len(cases)} cases take less than {QUICK} s each", flush=True)
    empty = 0
    for number in chosen:
        red, all_run = caught(binary, number, quick)
        if not red:
            red, all_run = caught(binary, number, {name: time for name, time in times.items() if name not in quick})
        empty += not red
        more = f" and {len(red) - 6} more" if len(red) > 6 else ""
        count = f"{len(red)}" if all_run else f"{len(red)} or more"
        row = f"| {ERRORS[number - 1][0]} | {count} | {', '.join(f'`{name}`' for name in red[:6])}{more} |"
        print(row, flush=True)
        write(number, row)
    sys.exit(empty > 0)


def write(number, row):
    """Puts a row into the table of the page."""
    text = PAGE.read_text()
    first, last = (text.index(mark) for mark in MARKS)
    known = {line.split(" | ")[0][2:]: line for line in text[first:last].splitlines() if line.startswith("| ")}
    known[ERRORS[number - 1][0]] = row
    rows = [known.get(error[0], f"| {error[0]} | not run yet | |") for error in ERRORS]
    table = "\n".join(["| error | quick cases that fail | which |", "| --- | --- | --- |", *rows])
    PAGE.write_text(f"{text[:first]}{MARKS[0]}\n\n{table}\n\n{text[last:]}")


if __name__ == "__main__":
    main()
