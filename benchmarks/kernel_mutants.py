#!/usr/bin/env python3
"""Errors drawn by lot in the kernels, and whether the own tests of their crates see them.

    nice -n 15 benchmarks/kernel_mutants.py --seed 1 --count 10 hbm continuation model modal
    benchmarks/kernel_mutants.py --functions is_quiet,guess_from_forces hbm contact      # these functions return at once

As many errors of each crate as `--count` are drawn from all places where one of these can be put: a condition turned round, a number changed, an index shifted by one more, `+=` and `-=`
exchanged, a plus or minus between numbers exchanged, a function that returns at once with a plain value. All go into one copy, are switched by the environment variable NLMODES_MUTANT and built once (mutant schemata); what does not
compile is left out, and others are taken for it. Then all tests of the crate, unit tests first, are run for each, up to the first that fails. The copy lies in `target/kernel-mutants`, with
a build directory of its own, since cargo takes two copies of a package for the same one. The table goes to standard output, survivors first.

`cargo mutants -p nlmodes-hbm --shard 0/40` (crates.io: cargo-mutants) draws from more kinds of errors and builds each of them.
"""

import argparse
import json
import os
import pathlib
import random
import re
import selectors
import shutil
import subprocess
import time

ROOT = pathlib.Path(__file__).resolve().parent.parent
PLACE = ROOT / "target/kernel-mutants"
COPY = PLACE / "source"

SWITCH = """
/// Whether the error of this number is switched on.
pub(crate) fn mutant(number: u32) -> bool {
    static CHOSEN: std::sync::OnceLock<u32> = std::sync::OnceLock::new();
    *CHOSEN.get_or_init(|| std::env::var("NLMODES_MUTANT").ok().and_then(|n| n.parse().ok()).unwrap_or(0)) == number
}

/// -1 where the error of this number is switched on, else 1.
pub(crate) fn mutant_sign(number: u32) -> f64 {
    if mutant(number) { -1.0 } else { 1.0 }
}
"""

RETURNS = {"f64": ["0.0", "1.0"], "bool": ["true", "false"], "usize": ["0", "1"], "Vec<f64>": ["Vec::new()"], "": [""]}
ON = "crate::mutant(N)"


def kinds(line):
    """What can be done to a line: name, and the line with the error behind its switch."""
    for m in re.finditer(r"\bif (?!let\b)([^{}=]*(?:[<>!=]=[^{}=]*)*) \{", line):
        if " let " not in m[1]:
            yield f"`{m[1]}` turned round", f"{line[:m.start(1)]}({m[1]}) != {ON}{line[m.end(1):]}"
    code = line.split("//")[0]
    arrow = code.find("=>")
    for m in re.finditer(r"(?<![\w.\"])(\d+\.\d+(?:e-?\d+)?)(?![\w.(\"])", code):
        if m.start() > arrow:
            new = f"(if {ON} {{ 1.25 * {m[1]} + 0.125 }} else {{ {m[1]} }})"
            yield f"`{m[1]}` changed", line[:m.start()] + new + line[m.end():]
    for m in re.finditer(r"(?<= [+-] )(\d+)(?![\w.\"])", code):
        if m.start() > arrow:
            new = f"(if {ON} {{ {int(m[1]) + 1} }} else {{ {m[1]} }})"
            yield f"`{m[1]}` is one more", line[:m.start()] + new + line[m.end():]
    m = re.fullmatch(r"(\s*)(\*?[a-z][\w.\[\]()*, +-]*) ([+-])= (.+);", code.rstrip())
    if m and m[4].count("(") == m[4].count(")"):
        sign = "-" if m[3] == "+" else "+"
        text = f"{m[1]}if {ON} {{ {m[2]} {sign}= {m[4]}; }} else {{ {m[2]} {m[3]}= {m[4]}; }}"
        yield f"`{m[2]} {m[3]}= …` with the other sign", text
    if not re.search(r"\b(?:fn|impl|dyn|where|for|type)\b|'", code):
        for m in re.finditer(r"(?<=[\w)\]] )([+-]) (?=[a-z(*])", code):
            if m.start() > arrow and code.count('"', 0, m.start()) % 2 == 0:
                yield f"`{m[1]}` before `{code[m.end():m.end() + 20].strip()}` with the other sign", line[:m.end()] + "crate::mutant_sign(N) * " + line[m.end():]
    m = re.fullmatch(r"\s*(?:pub(?:\([a-z]+\))? )?fn (\w+)\(.*\)(?: -> ([^{]+))? \{", code.rstrip())
    if m:
        values = ["None"] if (m[2] or "").startswith("Option<") else ["Ok(())"] if (m[2] or "").startswith("Result<(),") else RETURNS.get(m[2] or "", [])
        for value in values:
            yield f"`{m[1]}` returns {value or 'at once'}", f"{line} if {ON} {{ return {value}; }}"


def places(crate):
    """All errors that can be put into a crate."""
    source = ROOT / f"crates/nlmodes-{crate}/src"
    for path in sorted(source.rglob("*.rs")):
        if {"tests", "tests.rs", "conformance", "conformance.rs", "test_chain.rs"} & set(path.relative_to(source).parts):
            continue
        for number, line in enumerate(path.read_text().split("\n")):
            text = line.strip()
            if text.startswith("#[cfg(test)]"):
                break
            if text.startswith(("//", "#", "use ", "const ", "pub const ", "static ", "assert", "debug_assert")) or "const fn" in text:
                continue
            for what, changed in kinds(line):
                yield crate, path.relative_to(ROOT), number, what, changed


def written(mutants):
    """The copy with these errors, a line with one each at most."""
    lines = {}
    for number, (_, path, at, _, changed) in mutants.items():
        lines.setdefault(path, {})[at] = re.sub(r"(crate::mutant(?:_sign)?)\(N\)", rf"\1({number})", changed)
    for path in {p for p in (ROOT / "crates").rglob("src/**/*.rs")}:
        relative = path.relative_to(ROOT)
        text = path.read_text().split("\n")
        for at, changed in lines.get(relative, {}).items():
            text[at] = changed
        text = "\n".join(text) + (SWITCH if path.parent.name == "src" and path.name == "lib.rs" else "")
        there = COPY / relative
        if not there.is_file() or there.read_text() != text:
            there.parent.mkdir(parents=True, exist_ok=True)
            there.write_text(text)


def built(crates, mutants):
    """Test programs of each crate; errors that do not compile are taken out."""
    command = ["cargo", "test", "--no-run", "--message-format=json"] + [f"-pnlmodes-{crate}" for crate in crates]
    while True:
        written(mutants)
        done = subprocess.run(command, cwd=COPY, stdout=subprocess.PIPE, env={**os.environ, "CARGO_TARGET_DIR": str(PLACE / "build")}, text=True)
        messages = [json.loads(line) for line in done.stdout.splitlines() if line.startswith("{")]
        if done.returncode == 0:
            break
        bad = {(span["file_name"], span["line_start"] - 1) for m in messages if m["reason"] == "compiler-message"
               and m["message"]["level"] == "error" for span in m["message"]["spans"]}
        wrong = [n for n, mutant in mutants.items() if (str(mutant[1]), mutant[2]) in bad]
        if not wrong:
            raise SystemExit("\n".join(m["message"]["rendered"] for m in messages if m["reason"] == "compiler-message" and m["message"]["level"] == "error"))
        for number in wrong:
            print(f"does not compile: {mutants.pop(number)[1:4]}", flush=True)
    programs = {}
    for m in messages:
        if m["reason"] == "compiler-artifact" and m.get("executable") and m["profile"]["test"]:
            crate = pathlib.Path(m["manifest_path"]).parent.name.removeprefix("nlmodes-")
            programs.setdefault(crate, []).append((m["target"]["kind"] != ["lib"], m["target"]["name"], m["executable"]))
    return {crate: sorted(found) for crate, found in programs.items()}


def fails(crate, program, number, patience):
    """The first test that fails, `hangs` or `crashes`; nothing if all pass."""
    environment = {**os.environ, "NLMODES_MUTANT": str(number)}
    call = subprocess.Popen([program], cwd=COPY / f"crates/nlmodes-{crate}", env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    end, text = time.monotonic() + patience, b""
    selector = selectors.DefaultSelector()
    selector.register(call.stdout, selectors.EVENT_READ)
    try:
        while time.monotonic() < end:
            if selector.select(max(0.0, end - time.monotonic())):
                block = os.read(call.stdout.fileno(), 65536)
                text += block
                failed = re.search(rb"test (\S+) (?:- should panic )?\.\.\. FAILED", text)
                if failed:
                    return failed[1].decode()
                if not block:
                    return "" if call.wait() == 0 else "crashes"
        return "hangs"
    finally:
        call.kill()
        call.wait()


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("crates", nargs="+")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--functions", type=lambda text: text.split(","))
    chosen = parser.parse_args()
    drawn = []
    for crate in chosen.crates:
        found = list(places(crate))
        if chosen.functions:
            wanted = [f"`{name}` returns" for name in chosen.functions]
            found = [m for m in found if m[3].startswith(tuple(wanted))]
        one_a_line = {(m[1], m[2]): m for m in random.Random(chosen.seed).sample(found, k=len(found))}
        drawn += random.Random(chosen.seed).sample(sorted(one_a_line.values(), key=str), k=min(chosen.count * 7 // 5, len(one_a_line)))
    mutants = dict(enumerate(drawn, 1))
    for part in ("crates", "benchmarks", "configs"):
        shutil.copytree(ROOT / part, COPY / part, dirs_exist_ok=True, copy_function=lambda a, b: a if a.endswith(".rs") and "/src/" in a and "/crates/" in a else shutil.copy2(a, b))
    for file in ("Cargo.toml", "Cargo.lock", "README.md"):
        shutil.copy2(ROOT / file, COPY / file)
    times, rows = {}, []
    for crate in chosen.crates:
        programs = built([crate], mutants)[crate]
        for _, name, program in programs:
            began = time.monotonic()
            wrong = fails(crate, program, 0, 600)
            times[program] = time.monotonic() - began
            if wrong:
                raise SystemExit(f"without an error there fails {wrong} of {crate}")
            print(f"{crate}: {name} takes {times[program]:.1f} s", flush=True)
        own = [(number, *mutant[1:4]) for number, mutant in mutants.items() if mutant[0] == crate]
        for number, path, at, what in own[:chosen.count]:
            tries = (fails(crate, program, number, 20 + 6 * times[program]) for *_, program in programs)
            caught = next((failed for failed in tries if failed), "")
            place = str(path).removeprefix("crates/nlmodes-")
            rows.append((caught != "", crate, f"| {place}:{at + 1} | {what} | {f'`{caught}`' if caught else '**survives**'} |"))
            print(rows[-1][2], flush=True)
    print("\n| place | error | first test that sees it |\n| --- | --- | --- |")
    print(*(row for *_, row in sorted(rows, key=lambda row: row[0])), sep="\n")
    for crate in chosen.crates:
        seen = [row[0] for row in rows if row[1] == crate]
        print(f"{crate}: {sum(seen)} of {len(seen)} seen")


if __name__ == "__main__":
    main()
