#!/usr/bin/env python3
"""Errors drawn by lot in the kernels, and whether the own tests of their crates see them.

    benchmarks/kernel_mutants.py --seed 1 --count 10 --jobs 2 hbm continuation model modal       # two programs at a time, at a nice of 10
    benchmarks/kernel_mutants.py --functions is_quiet,guess_from_forces hbm contact      # these functions return at once

As many errors of each crate as `--count` are drawn from all places where one of these can be put: a condition turned round, a number changed, an index shifted by one more, `+=` and `-=`
exchanged, a plus or minus between numbers exchanged, a function that returns at once with a plain value. All go into one copy, are switched by the environment variable NLMODES_MUTANT and built once (mutant schemata); what does not
compile is left out, and others are taken for it. Each test is run once without an error, which tells its time and which errors lie on its way. Then for each error those tests are run that
come past it, quick ones first, up to the first that fails or takes five times its time of processor. The copy lies in `target/kernel-mutants`, with a build directory of its own, since cargo
takes two copies of a package for the same one. The table goes to standard output, survivors first; `no test comes past it` stands at those that are not even reached.

`cargo mutants -p nlmodes-hbm --shard 0/40` (crates.io: cargo-mutants) draws from more kinds of errors and builds each of them.
"""

import argparse
import concurrent.futures
import json
import os
import pathlib
import random
import re
import shutil
import signal
import subprocess
import tempfile

ROOT = pathlib.Path(__file__).resolve().parent.parent
PLACE = ROOT / "target/kernel-mutants"
COPY = PLACE / "source"

SWITCH = """
/// Whether the error of this number is switched on; notes in a file that it was asked for, where one is named.
pub(crate) fn mutant(number: u32) -> bool {
    use std::io::Write;
    use std::sync::{OnceLock, atomic::{AtomicBool, Ordering::Relaxed}};
    static CHOSEN: OnceLock<(u32, Option<String>)> = OnceLock::new();
    static SEEN: [AtomicBool; 512] = [const { AtomicBool::new(false) }; 512];
    let (chosen, trace) = CHOSEN.get_or_init(|| {
        let number = std::env::var("NLMODES_MUTANT").ok().and_then(|n| n.parse().ok()).unwrap_or(0);
        (number, std::env::var("NLMODES_MUTANT_TRACE").ok())
    });
    if let Some(path) = trace {
        if !SEEN[number as usize].swap(true, Relaxed) {
            let mut file = std::fs::OpenOptions::new().create(true).append(true).open(path).expect("the trace can be written");
            file.write_all(format!("{number}\n").as_bytes()).expect("the trace can be written");
        }
    }
    *chosen == number
}

/// -1 where the error of this number is switched on, else 1.
pub(crate) fn mutant_sign(number: u32) -> f64 {
    if mutant(number) { -1.0 } else { 1.0 }
}
"""

RETURNS = {"f64": ["0.0", "1.0"], "bool": ["true", "false"], "usize": ["0", "1"], "Vec<f64>": ["Vec::new()"], "": [""]}
ON = "crate::mutant(N)"


def in_index(code, at):
    """Whether a place lies in the brackets of an index, where signs of floats do not compile."""
    open_brackets = []
    for i, c in enumerate(code[:at]):
        if c == "[":
            open_brackets.append(bool(re.match(r"[\w)\]]", code[i - 1:i])))
        elif c == "]" and open_brackets:
            open_brackets.pop()
    return any(open_brackets)


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
            if m.start() > arrow and code.count('"', 0, m.start()) % 2 == 0 and not in_index(code, m.start()):
                yield f"`{m[1]}` before `{code[m.end():m.end() + 20].strip()}` with the other sign", line[:m.end()] + "crate::mutant_sign(N) * " + line[m.end():]
    m = re.fullmatch(r"\s*(?:pub(?:\([a-z]+\))? )?fn (\w+)\(.*\)(?: -> ([^{]+))? \{", code.rstrip())
    if m and (m[2] or "->" not in code):
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
        bad = {(span["file_name"], line) for m in messages if m["reason"] == "compiler-message" and m["message"]["level"] == "error"
               for span in m["message"]["spans"] for line in range(span["line_start"] - 1, span["line_end"])}
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


def run(crate, program, tests, number, seconds, trace=None):
    """Of these tests the first that fails, `hangs` (takes more than so many seconds of processor) or `crashes`; nothing if all pass. And the time of processor."""
    environment = {**os.environ, "NLMODES_MUTANT": str(number), "RUST_TEST_THREADS": "1", "PROPTEST_FAILURE_PERSISTENCE": "off"}
    if trace:
        environment["NLMODES_MUTANT_TRACE"] = str(trace)
    command = ["sh", "-c", f'ulimit -t {int(seconds) + 1}; exec nice -n 10 "$0" "$@"', program, "--exact", *tests]
    call = subprocess.Popen(command, cwd=COPY / f"crates/nlmodes-{crate}", env=environment, stdout=subprocess.PIPE, stderr=subprocess.DEVNULL)
    failed, text = None, b""
    while failed is None and (block := os.read(call.stdout.fileno(), 65536)):
        text += block
        failed = re.search(rb"test (\S+) (?:- should panic )?\.\.\. FAILED", text)
    if failed:
        os.kill(call.pid, signal.SIGKILL)
    call.stdout.close()
    _, status, usage = os.wait4(call.pid, 0)
    call.returncode = os.waitstatus_to_exitcode(status)
    verdict = failed[1].decode() if failed else {0: "", -signal.SIGXCPU: "hangs", -signal.SIGKILL: "hangs"}.get(call.returncode, "crashes")
    return verdict, usage.ru_utime + usage.ru_stime


def looked_at(crate, programs, pool):
    """Of each test: its program, its name, its time of processor, and the errors that it comes past."""
    def look(program, test):
        with tempfile.NamedTemporaryFile(mode="r") as trace:
            wrong, took = run(crate, program, [test], 0, 600, trace.name)
            if wrong:
                raise SystemExit(f"without an error there fails {test} of {program}")
            return program, test, took, set(map(int, trace.read().split()))

    calls = []
    for _, _, program in programs:
        listed = subprocess.run([program, "--list"], cwd=COPY / f"crates/nlmodes-{crate}", stdout=subprocess.PIPE, text=True, check=True).stdout
        calls += [pool.submit(look, program, test) for test in re.findall(r"^(.+): test$", listed, re.M)]
    return [call.result() for call in calls]


def seen_by(crate, tests, number):
    """The first test that sees this error; nothing if none does."""
    calls = {}
    for program, test, took, passed in tests:
        if number in passed:
            calls.setdefault((program, "" if took < 1.0 else test), []).append((test, took))
    for (program, _), own in sorted(calls.items(), key=lambda call: sum(took for _, took in call[1])):
        failed, _ = run(crate, program, [test for test, _ in own], number, 10.0 + 5.0 * sum(took for _, took in own))
        if failed:
            return f"`{failed}`"
    return "**survives**" if calls else "**survives**, no test comes past it"


def main():
    parser = argparse.ArgumentParser(description=__doc__.split("\n")[0])
    parser.add_argument("crates", nargs="+")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--count", type=int, default=10)
    parser.add_argument("--jobs", type=int, default=1)
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
        # What an earlier commit had is no test of this one.
        for there in (COPY / part).rglob("*"):
            if there.is_file() and not (ROOT / there.relative_to(COPY)).is_file():
                there.unlink()
    for file in ("Cargo.toml", "Cargo.lock", "README.md"):
        shutil.copy2(ROOT / file, COPY / file)
    rows, pool = [], concurrent.futures.ThreadPoolExecutor(chosen.jobs)
    for crate in chosen.crates:
        tests = looked_at(crate, built([crate], mutants)[crate], pool)
        print(f"{crate}: {len(tests)} tests take {sum(took for _, _, took, _ in tests):.0f} s", flush=True)
        for program, test, took, _ in sorted(tests, key=lambda test: -test[2])[:8]:
            print(f"  {pathlib.Path(program).name} {test}: {took:.1f} s", flush=True)
        own = [number for number, mutant in mutants.items() if mutant[0] == crate][:chosen.count]
        calls = {pool.submit(seen_by, crate, tests, number): mutants[number] for number in own}
        for call in concurrent.futures.as_completed(calls):
            (_, path, at, what, _), caught = calls[call], call.result()
            place = str(path).removeprefix("crates/nlmodes-")
            rows.append(("survives" not in caught, crate, f"| {place}:{at + 1} | {what} | {caught} |"))
            print(rows[-1][2], flush=True)
    print("\n| place | error | first test that sees it |\n| --- | --- | --- |")
    print(*(row for *_, row in sorted(rows, key=lambda row: row[0])), sep="\n")
    for crate in chosen.crates:
        seen = [row[0] for row in rows if row[1] == crate]
        print(f"{crate}: {sum(seen)} of {len(seen)} seen")


if __name__ == "__main__":
    main()
