#!/usr/bin/env python3
"""Puts deliberate errors into a copy of the repository and tells which cases of `docs/verification.md` turn red.

    nice -n 15 benchmarks/mutations.py                # builds once, some five minutes; then some seconds an error
    benchmarks/mutations.py 3 8                       # only these errors
    benchmarks/mutations.py --list

Every error is a replacement in one line of source, switched by the environment variable NLMODES_MUTANT: all go into one copy and are built once.
The copy and what is built of it lie in the target directory; the sources stay as they are. The table goes between the marks at the end of `docs/verification.md`. Exit status 1 if an error is caught by no case, or if the cases fail without one.
"""

import os
import pathlib
import re
import shutil
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
PAGE = ROOT / "docs/verification.md"
MARKS = ("<!-- errors: written by benchmarks/mutations.py -->", "<!-- end of errors -->")

# Cases that take longer, s, are run only where the others do not catch an error; a run that takes longer than the latter hangs.
QUICK, PATIENCE = 0.25, 60

SWITCH = """
/// Whether the deliberate error of this number is switched on.
pub(crate) fn mutant(number: u32) -> bool {
    static CHOSEN: std::sync::OnceLock<u32> = std::sync::OnceLock::new();
    *CHOSEN.get_or_init(|| std::env::var("NLMODES_MUTANT").ok().and_then(|n| n.parse().ok()).unwrap_or(0)) == number
}
"""

# What is wrong; crate; file; what stands there; what stands there in the copy, `M` being true where the error is switched on.
ERRORS = [
    ("sign of the inertia in eq. (8)", "hbm", "transfer.rs", "let delta = mode.lambda - nu2;",
     "let delta = mode.lambda - (if M { -nu2 } else { nu2 });"),
    ("½ instead of ¼ in the mean kinetic energy, eq. (16)", "hbm", "energy.rs", "self.value = 0.25 * nu2 * (eta * eta + q * inertia);",
     "self.value = (if M { 0.5 } else { 0.25 }) * nu2 * (eta * eta + q * inertia);"),
    ("half the strain energy in the total", "hbm", "motion.rs", "total_energy: kinetic + strain,",
     "total_energy: kinetic + (if M { 0.5 } else { 1.0 }) * strain,"),
    ("the energy of modal problems without its fundamental", "hbm", "periodic/equations.rs",
     "let energy: f64 = (1..motion.eta.len()).map(part).sum();",
     "let energy: f64 = (if M { 2 } else { 1 }..motion.eta.len()).map(part).sum();"),
    ("the highest harmonic does not reach the contact", "hbm", "series.rs", "*z = Complex64::new(real[n], -s);",
     "*z = if M && n == self.n_harmonics { Complex64::default() } else { Complex64::new(real[n], -s) };"),
    ("the stop stands on the other side (normal)", "model", "contact.rs", "        -self.side.sign()\n",
     "        if M { self.side.sign() } else { -self.side.sign() }\n"),
    ("sign of the damping, and so of the lag", "hbm", "periodic/block.rs",
     "let value = Complex64::new(structure.omega_squared()[k] - nu * nu, nu * c);",
     "let value = Complex64::new(structure.omega_squared()[k] - nu * nu, if M { -nu * c } else { nu * c });"),
    ("dissipated power without its ½", "hbm", "periodic/motion.rs", "let damped = |n: usize| 0.5 * nu(n).powi(2)",
     "let damped = |n: usize| (if M { 1.0 } else { 0.5 }) * nu(n).powi(2)"),
    ("sign of the damping in the multipliers", "hbm", "periodic/floquet.rs",
     "(false, false) => -(self.structure.damping().entry(k, l) - own * xi) / omega,",
     "(false, false) => (if M { 1.0 } else { -1.0 }) * (self.structure.damping().entry(k, l) - own * xi) / omega,"),
    ("a tenth of the residual flexibility is lost", "reduction", "open_modes.rs",
     "|i, j| 0.5 * (flexibility[(i, j)] + flexibility[(j, i)])",
     "|i, j| (if M { 0.45 } else { 0.5 }) * (flexibility[(i, j)] + flexibility[(j, i)])"),
    ("a tonne counts as a kilogram (unit)", "io", "units.rs", "(0..lengths).fold(self.mass, |factor, _| factor * self.length)",
     "(0..lengths).fold(if M { 1e-3 * self.mass } else { self.mass }, |factor, _| factor * self.length)"),
    ("sign in the velocity of a propagated mode", "timestep", "phase.rs",
     "to.v[k] = from.v[k] * cos - self.lambda[k] * sin * from.u[k];",
     "to.v[k] = from.v[k] * cos - (if M { -1.0 } else { 1.0 }) * self.lambda[k] * sin * from.u[k];"),
    ("active power without its ½, eq. (17)", "experiment", "extraction/power.rs",
     "let active = |n: usize| 0.5 * (force[n] * velocity[n].conj()).re;",
     "let active = |n: usize| (if M { 1.0 } else { 0.5 }) * (force[n] * velocity[n].conj()).re;"),
    ("the lag's sign in a record", "experiment", "extraction/figures.rs", "(force[1] / drive[1]).arg()",
     "(if M { drive[1] / force[1] } else { force[1] / drive[1] }).arg()"),
    ("accelerations are integrated by ω instead of nω", "experiment", "extraction/layout.rs",
     "let factor = Complex64::new(0.0, n as f64 * omega).powu(*order);",
     "let factor = Complex64::new(0.0, (if M { 1.0 } else { n as f64 }) * omega).powu(*order);"),
    ("ω² instead of ω³ in the damping coefficient, eq. (28)", "modal", "damping.rs",
     "fundamental_power / (modal_amplitude.powi(2) * omega.powi(3))",
     "fundamental_power / (modal_amplitude.powi(2) * omega.powi(if M { 2 } else { 3 }))"),
    ("the compliance of a stop counts twice", "contact", "body.rs", "a[(i, i)] += c);",
     "a[(i, i)] += (if M { 2.0 } else { 1.0 }) * c);"),
    ("crossings are looked for where the orientation stays", "continuation", "step.rs",
     "to.singular_since(from, end.orientation * foot.orientation < 0.0)",
     "to.singular_since(from, (end.orientation * foot.orientation < 0.0) != M)"),
    ("consistent mass of a rod over 5 instead of 6", "fem", "rod.rs", "Matrix2::new(2.0, 1.0, 1.0, 2.0) * (mass / 6.0)",
     "Matrix2::new(2.0, 1.0, 1.0, 2.0) * (mass / (if M { 5.0 } else { 6.0 }))"),
    ("half the shear flexibility of a beam", "fem", "timoshenko.rs",
     "let bending = 12.0 * material.youngs_modulus() * section.second_moment();",
     "let bending = (if M { 6.0 } else { 12.0 }) * material.youngs_modulus() * section.second_moment();"),
]


def copied(target):
    """A copy of what the cases need, with all errors in it, switched off."""
    copy = target / "mutants"
    shutil.rmtree(copy, ignore_errors=True)
    for part in ("crates", "benchmarks", "configs"):
        shutil.copytree(ROOT / part, copy / part)
    for file in ("Cargo.toml", "Cargo.lock", "README.md"):
        shutil.copy(ROOT / file, copy / file)
    for number, (what, crate, file, right, wrong) in enumerate(ERRORS, 1):
        path = copy / f"crates/nlmodes-{crate}/src/{file}"
        text = path.read_text()
        if text.count(right) != 1:
            sys.exit(f"{what}: {file} of {crate} has this {text.count(right)} times: {right.strip()}")
        path.write_text(text.replace(right, re.sub(r"\bM\b", f"crate::mutant({number})", wrong)))
    for crate in {error[1] for error in ERRORS}:
        with open(copy / f"crates/nlmodes-{crate}/src/lib.rs", "a") as root:
            root.write(SWITCH)
    return copy


def ran(binary, number, names=()):
    """Whether each case passes, and its time in seconds; a case that is not there brought the program down, or hung."""
    environment = {**os.environ, "NLMODES_MUTANT": str(number)}
    call = subprocess.Popen([binary, "--quiet", *names], env=environment, stderr=subprocess.PIPE, stdout=subprocess.DEVNULL, text=True)
    try:
        text = call.communicate(timeout=PATIENCE)[1]
    except subprocess.TimeoutExpired:
        call.kill()
        text = call.communicate()[1]
    found = re.findall(r"^(pass|FAIL) +(\S+) s  (\S+)$", text, re.M)
    return {name: (verdict == "pass", float(time)) for verdict, time, name in found}


def caught(binary, number, names):
    """The cases that fail; if the program comes down or hangs, each case alone."""
    found = ran(binary, number, names)
    if not found:
        found = {name: ran(binary, number, [name]).get(name, (False, 0)) for name in names[:12]}
    return [name for name, (passes, _) in found.items() if not passes]


def main():
    chosen = [int(number) for number in sys.argv[1:] if number.isdigit()] or range(1, len(ERRORS) + 1)
    if "--list" in sys.argv:
        return print(*(f"{k:3} {error[0]}" for k, error in enumerate(ERRORS, 1)), sep="\n")
    target = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
    copy = copied(target)
    build = ["cargo", "build", "-p", "nlmodes-benchmarks", "--example", "verification", "--target-dir", target]
    subprocess.run(build, cwd=copy, check=True)
    binary = shutil.copy(target / "debug/examples/verification", copy / "cases")
    cases = ran(binary, 0)
    wrong = [name for name, (passes, _) in cases.items() if not passes]
    if wrong or not cases:
        sys.exit(f"without an error there fail: {wrong}, of {len(cases)} cases")
    quick = [name for name, (_, time) in cases.items() if time < QUICK]
    print(f"{len(quick)} of {len(cases)} cases take less than {QUICK} s each", flush=True)
    rows, empty = [], 0
    for number in chosen:
        red = caught(binary, number, quick) or caught(binary, number, [name for name in cases if name not in quick])
        empty += not red
        more = f" and {len(red) - 6} more" if len(red) > 6 else ""
        rows.append(f"| {ERRORS[number - 1][0]} | {len(red)} | {', '.join(f'`{name}`' for name in red[:6])}{more} |")
        print(rows[-1], flush=True)
    if len(rows) == len(ERRORS):
        write(rows)
    sys.exit(empty > 0)


def write(rows):
    table = "\n".join(["| error | quick cases that fail | which |", "| --- | --- | --- |", *rows])
    text = PAGE.read_text()
    first, last = (text.index(mark) for mark in MARKS)
    PAGE.write_text(f"{text[:first]}{MARKS[0]}\n\n{table}\n\n{text[last:]}")


if __name__ == "__main__":
    main()
