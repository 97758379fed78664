"""A study with one job, with two, and killed at ten random instants: rate, memory, disk, and the same table to the last bit.

    python benchmarks/studies/killed.py target/release/nlmodes-cli /tmp/studies [SAMPLES]

Needs Python and Linux. Exit status 1 where a case is lost, computed twice, or the tables differ.
"""

import hashlib
import os
import random
import subprocess
import sys
import time
from pathlib import Path

STUDY = Path(__file__).with_name("beams.toml")
TABLES = ["study.csv", "study.parquet", "study.json"]


def start(program, study, out, *arguments):
    return subprocess.Popen([program, "study", "run", study, "--out", out, "--quiet", *arguments], stderr=subprocess.DEVNULL)


def measured(program, study, out, jobs):
    """Runs the study, says what it took, and returns its wall time in seconds."""
    began = time.monotonic()
    _, status, used = os.wait4(start(program, study, out, "--jobs", str(jobs)).pid, 0)
    wall, cases = time.monotonic() - began, len(done(out))
    size = sum(path.stat().st_blocks * 512 for path in out.rglob("*"))
    processor = used.ru_utime + used.ru_stime
    print(
        f"{jobs} at a time: status {os.waitstatus_to_exitcode(status)}, {cases} cases, {cases / wall:.1f} a second, {processor:.1f} s of processor time in"
        f" {wall:.1f} s, {used.ru_maxrss / 1024:.0f} MB of memory, {size / cases / 1e3:.1f} kB a case on disk",
        flush=True,
    )
    return wall


def done(out):
    """The cases that are done, with the instant at which each was."""
    return {path: path.stat().st_mtime_ns for path in out.glob("cases/*/case.json")}


def killed(program, study, out, longest):
    """Kills the study ten times, and lets it come to its end."""
    known = {}
    for _ in range(10):
        process, after = start(program, study, out), random.uniform(0.3, longest)
        time.sleep(after)
        process.kill()
        process.wait()
        known = kept(known, done(out))
        begun = len(list(out.glob("cases/*"))) - len(known)
        print(f"killed after {after:.2f} s: {len(known)} done, {begun} in progress", flush=True)
    start(program, study, out).wait()
    return kept(known, done(out))


def kept(known, now):
    """What is done now, if all that was done before is as it was."""
    if any(now.get(path) != instant for path, instant in known.items()):
        sys.exit("a case is lost, or was computed twice")
    return now


def main(program, place, samples=10000):
    random.seed(5)
    place = Path(place)
    place.mkdir(parents=True)
    study = STUDY.with_name(f".{os.getpid()}.toml")
    study.write_text(STUDY.read_text().replace("samples = 10000", f"samples = {int(samples)}"))
    try:
        one, two = (measured(program, study, place / name, jobs) for name, jobs in [("one", 1), ("two", 2)])
        print(f"wall time of one over that of two, halved: {one / two / 2:.3f}")
        cases = killed(program, study, place / "killed", max(1.0, two / 11))
    finally:
        study.unlink()
    digests = {hashlib.sha256((place / out / name).read_bytes()).hexdigest() for name in TABLES for out in ["one", "two", "killed"]}
    same = len(digests) == len(TABLES)
    print(f"{len(cases)} cases; tables are {'the same to the last bit' if same else 'DIFFERENT'}")
    sys.exit(0 if same and len(cases) == int(samples) else 1)


if __name__ == "__main__":
    main(*sys.argv[1:])
