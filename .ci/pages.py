#!/usr/bin/env python3
"""Code blocks of the pages for users do what the pages say.

    .ci/pages.py PROGRAM [PAGE …]

A page is worked through from its top in a folder of its own that holds a copy of `configs`, as its reader would:

- `console`: each line that begins with `$ ` is run; what follows is compared with what the program prints. `…` stands for
  anything within a line, a line of `…` alone for any lines; a command with nothing below it only has to succeed. Times of a run
  are not compared, numbers to the last digit that is shown, and errors behind `±` to a factor of three.
- `toml`: the block is TOML, and each of its keys one of a scene or of a study.
- `python` outside of `docs/python.md`, whose blocks are tests of the Python package: the block compiles.
- `rust`, `matlab`, `text`, `json`: tested elsewhere, or no code.

A comment in the line above a block changes that: `<!-- file: NAME -->` writes the block to this file, `<!-- status: N -->` expects this exit
status, `<!-- not run: REASON -->` leaves the block alone. A block in any other language needs such a reason.
"""

import concurrent.futures
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys
import tempfile
import time

try:
    import tomllib
except ImportError:
    tomllib = None

ROOT = pathlib.Path(__file__).resolve().parent.parent
GENERATED = {"keys.md", "commands.md", "files_and_columns.md"}
BLOCK = re.compile(
    r"(?:^<!-- (?P<what>[\w ]+): (?P<value>.*?) -->\n)?"
    r"^(?P<indent> *)```(?P<language>\w*).*\n(?P<code>(?:.*\n)*?)^ *```$",
    re.M,
)
TIMES = re.compile(r"(\bin )[\d.]+ (µs|ms|s|min)\b|[\d.]+ (?:µs|ms) (?=a sample|in all)")
NUMBER = re.compile(r"(?<![\w.])[-−+]?\d+(?:\.\d+)?(?:e[-+]?\d+)?")
LIMIT_S = 300


def pages():
    """Pages that users read: those of the documentation that are not generated, and the README."""
    return [ROOT / "README.md", *(page for page in sorted((ROOT / "docs").glob("*.md")) if page.name not in GENERATED)]


def near(wanted, found, uncertain):
    """Whether two numbers agree to the last digit of the first; of errors, to a factor of three."""
    value, other = (float(text.replace("−", "-")) for text in (wanted, found))
    if uncertain:
        return value == other or min(abs(value), abs(other)) * 3 > max(abs(value), abs(other))
    mantissa, _, power = wanted.partition("e")
    digits = len(mantissa.partition(".")[2])
    return abs(value - other) <= 1.001 * 10.0 ** (int(power or 0) - digits) if digits or power else value == other


def same(wanted, found):
    """Whether a line that was printed is the one of the page."""
    wanted, found = (TIMES.sub("T", line.rstrip()) for line in (wanted, found))
    pattern = ".*".join(re.escape(NUMBER.sub("\0", part)).replace("\0", f"({NUMBER.pattern})") for part in wanted.split("…"))
    match = re.fullmatch(pattern, found)
    if not match:
        return False
    numbers = [(n[0], "±" in wanted[max(0, n.start() - 3) : n.start() + 1]) for n in NUMBER.finditer(wanted)]
    return all(near(one, other, uncertain) for (one, uncertain), other in zip(numbers, match.groups()))


def differs(wanted, found):
    """The first line of the page that was not printed, or None."""
    at = 0
    for n, line in enumerate(wanted):
        if line.strip() == "…":
            if n + 1 == len(wanted):
                return None
            while at < len(found) and not same(wanted[n + 1], found[at]):
                at += 1
        elif at < len(found) and same(line, found[at]):
            at += 1
        else:
            return f"{line!r} is expected" + (f", {found[at]!r} is printed" if at < len(found) else " and not printed")
    return None if at == len(found) else f"{found[at]!r} is printed beyond what is shown"


def steps(code):
    """Commands of a block, each with the lines below it."""
    found = []
    for line in code.rstrip("\n").splitlines():
        if line.startswith("$ "):
            found.append([line[2:], []])
        elif found and not found[-1][1] and found[-1][0].endswith("\\"):
            found[-1][0] = found[-1][0][:-1] + line.strip()
        elif found:
            found[-1][1].append(line)
    return found


def run(command, folder, program):
    command = command.replace("cargo run -- ", "nlmodes-cli ")
    tools = folder.parent / "bin"
    environment = dict(os.environ, PATH=f"{tools}:{os.environ['PATH']}", NO_COLOR="1")
    if not tools.exists():
        tools.mkdir()
        for name in ("nlmodes-cli", "nlmodes"):
            (tools / name).symlink_to(program)
    done = subprocess.run(["bash", "-c", command], cwd=folder, env=environment, text=True, timeout=LIMIT_S,
                          stdout=subprocess.PIPE, stderr=subprocess.STDOUT, stdin=subprocess.DEVNULL)
    return done.returncode, done.stdout.strip("\n").splitlines() if done.stdout.strip() else []


def children(node):
    """Keys below a node of a schema; None where any key may stand."""
    found, stack = {}, [node]
    while stack:
        one = stack.pop()
        found.update(one.get("properties", {}))
        stack += [*one.get("anyOf", []), *one.get("oneOf", []), *one.get("allOf", [])]
        stack += [one[word] for word in ("items", "then") if isinstance(one.get(word), dict)]
    return found


def unknown(table, node, path=""):
    """Keys of a table that the schema lacks."""
    known = children(node)
    for key, value in table.items():
        if key not in known:
            yield path + key
        for one in value if isinstance(value, list) else [value]:
            if isinstance(one, dict) and key in known and children(known[key]):
                yield from unknown(one, known[key], f"{path}{key}.")


def toml(code, schemas):
    """What is wrong with a block of TOML, or None."""
    if tomllib is None:
        return None
    try:
        table = tomllib.loads(code)
    except tomllib.TOMLDecodeError as error:
        return f"no TOML: {error}"
    wrong = min(([*unknown(table, schema)] for schema in schemas), key=len)
    return f"no such key: {', '.join(wrong)}" if wrong else None


def block(match, page, folder, program, schemas):
    """What is wrong with a block, or None."""
    what, value, language, code = (match[name] for name in ("what", "value", "language", "code"))
    if match["indent"]:
        code = re.sub(rf"^{match['indent']}", "", code, flags=re.M)
    if what == "not run":
        return None
    if what == "file":
        (folder / value).parent.mkdir(parents=True, exist_ok=True)
        (folder / value).write_text(code)
    if language == "console":
        for command, wanted in steps(code):
            try:
                status, found = run(command, folder, program)
            except subprocess.TimeoutExpired:
                return f"`{command}` takes more than {LIMIT_S} s"
            if status != (int(value) if what == "status" else 0):
                return f"`{command}` ends with status {status}:\n" + "\n".join(found[-12:])
            wrong = differs(wanted, found) if wanted else None
            if wrong:
                return f"`{command}`: {wrong}"
    elif language == "toml":
        return toml(code, schemas)
    elif language == "python":
        try:
            compile(code, page.name, "exec")
        except SyntaxError as error:
            return str(error)
    elif language not in ("rust", "matlab", "text", "json") and what != "file":
        return "a block in this language needs a reason why it is not run"
    return None


def check(page, program, schemas):
    """Everything that is wrong on a page, and the time it took."""
    began, wrong, text = time.monotonic(), [], page.read_text()
    with tempfile.TemporaryDirectory() as place:
        folder = pathlib.Path(place) / "work"
        shutil.copytree(ROOT / "configs", folder / "configs")
        for match in BLOCK.finditer(text):
            line = text[: match.start()].count("\n") + 1
            found = block(match, page, folder, program, schemas)
            if found:
                wrong.append(f"{page.relative_to(ROOT)}:{line}: {found}")
    outside = BLOCK.sub(lambda m: "\n" * m[0].count("\n"), text)
    for number, line in enumerate(outside.splitlines(), 1):
        if re.match(r" {4,}(\$ |nlmodes-cli |cargo )", line):
            wrong.append(f"{page.relative_to(ROOT)}:{number}: a command outside of a console block")
    return wrong, time.monotonic() - began


def main():
    program = pathlib.Path(sys.argv[1]).resolve()
    chosen = [pathlib.Path(name).resolve() for name in sys.argv[2:]] or pages()
    schemas = [json.loads(subprocess.run([program, "schema", *word], capture_output=True, check=True).stdout) for word in ([], ["study"])]
    if tomllib is None:
        print("blocks of TOML are not checked: Python is older than 3.11")
    with concurrent.futures.ThreadPoolExecutor(2) as pool:
        results = list(pool.map(lambda page: check(page, program, schemas), chosen))
    for page, (wrong, seconds) in zip(chosen, results):
        print(f"{seconds:6.1f} s  {page.relative_to(ROOT)}")
        for one in wrong:
            print(one, file=sys.stderr)
    return 1 if any(wrong for wrong, _ in results) else 0


if __name__ == "__main__":
    sys.exit(main())
