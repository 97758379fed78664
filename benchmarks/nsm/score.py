#!/usr/bin/env python3
"""Scores the answers of programs to the problems of NSM-Bench (standard library only).

    python3 benchmarks/nsm/score.py ANSWERS.json ...          a table of the programs, and one of the cases
    python3 benchmarks/nsm/score.py --blank > mine.json       a file of answers to be filled in
    python3 benchmarks/nsm/score.py --list                    the problems in words

The error of a case is the largest relative error of the quantities that it asks for, those that are not answered left
out but counted; below the agreement of the two references it counts as that. A case is solved to three digits if all
its quantities are answered with errors of at most 1e-3.
"""

import argparse
import json
import math
import pathlib
import statistics
import sys

PROBLEMS = pathlib.Path(__file__).resolve().parent / "problems"


def problems():
    return [json.loads(path.read_text()) for path in sorted(PROBLEMS.glob("*.json"))]


def cases(found):
    return {case["case"]: (problem, case) for problem in found for case in problem["cases"]}


def error_of(asked, value):
    """Relative error of a value, at least that of the reference."""
    return max(abs(value - asked["value"]) / abs(asked["value"]), 10.0 ** -asked["digits"])


class Score:
    """Errors of one program: by case, the largest error and how many of the asked quantities were answered."""

    def __init__(self, answers, known):
        self.program, self.settings = answers["program"], answers.get("settings", "")
        self.errors, self.whole, self.cpu, self.notes = {}, {}, {}, {}
        unknown = sorted(set(answers["answers"]) - set(known))
        if unknown:
            sys.exit(f"{self.program}: there is no case {unknown[0]}")
        for name, answer in answers["answers"].items():
            asked = known[name][1]["asked"]
            values = {a["name"]: answer[a["name"]] for a in asked if answer.get(a["name"]) is not None}
            for quantity, value in values.items():
                if not isinstance(value, (int, float)) or not math.isfinite(value):
                    sys.exit(f"{self.program}, {name}: {quantity} is {value!r}; a finite number was expected")
            self.notes[name] = answer.get("note", "")
            if answer.get("cpu_s") is not None:
                self.cpu[name] = answer["cpu_s"]
            if values:
                self.errors[name] = max(error_of(a, values[a["name"]]) for a in asked if a["name"] in values)
                self.whole[name] = len(values) == len(asked)

    def solved(self, digits):
        return sum(self.whole[name] and error <= 10.0**-digits for name, error in self.errors.items())


def summary(scores, known):
    print(
        f"| program | settings | answered, of {len(known)} | to 2 digits | to 3 | to 6 | to 9 | median error | CPU, s, median |"
    )
    print("| --- | --- | ---: | ---: | ---: | ---: | ---: | ---: | ---: |")
    for s in scores:
        middle = f"{statistics.median(s.errors.values()):.0e}" if s.errors else ""
        cpu = f"{statistics.median(s.cpu.values()):.2g}" if s.cpu else ""
        solved = " | ".join(str(s.solved(d)) for d in (2, 3, 6, 9))
        print(f"| {s.program} | {s.settings} | {len(s.errors)} | {solved} | {middle} | {cpu} |")


def by_case(scores, known):
    print("| case | problem | asked | " + " | ".join(s.program for s in scores) + " |")
    print("| --- | --- | --- |" + " ---: |" * len(scores))
    for name, (problem, case) in known.items():
        asked = ", ".join(a["name"] for a in case["asked"])
        print(f"| {name} | {problem['title']} | {asked} | " + " | ".join(cell(s, name) for s in scores) + " |")


def cell(score, name):
    if name not in score.errors:
        return score.notes.get(name) or "–"
    cpu = f", {score.cpu[name]:.2g} s" if name in score.cpu else ""
    return f"{score.errors[name]:.0e}{'' if score.whole[name] else ' (part)'}{cpu}"


def blank(known):
    answers = {name: {**{a["name"]: None for a in case["asked"]}, "cpu_s": None} for name, (_, case) in known.items()}
    print(json.dumps({"program": "name and version", "settings": "", "answers": answers}, indent=1))


def listing(found):
    for problem in found:
        print(f"{problem['id']}  {problem['title']}\n    {problem['statement']}")
        for case in problem["cases"]:
            at = ", ".join(
                f"{k} {v:.9g}"
                for k, v in {**case["at"], **{f"near {k}": v for k, v in case.get("near", {}).items()}}.items()
            )
            print(f"    {case['case']}: {case['branch']}; {at}: {', '.join(a['name'] for a in case['asked'])}?")


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("answers", nargs="*")
    parser.add_argument("--blank", action="store_true")
    parser.add_argument("--list", action="store_true")
    words = parser.parse_args()
    found = problems()
    known = cases(found)
    if words.blank:
        return blank(known)
    if words.list:
        return listing(found)
    if not words.answers:
        parser.error("files of answers are missing")
    scores = [Score(json.loads(pathlib.Path(path).read_text()), known) for path in words.answers]
    summary(scores, known)
    print()
    by_case(scores, known)


if __name__ == "__main__":
    main()
