#!/usr/bin/env python3
"""Writes the reference pages from what the program says of itself: every key of a scene and of a study, every command.

    python3 docs/scripts/reference.py PROGRAM            # writes docs/keys.md, docs/commands.md and docs/files_and_columns.md
    python3 docs/scripts/reference.py PROGRAM --check    # only says which differ; exit status 1 if one does
"""

import json
import pathlib
import re
import subprocess
import sys
import textwrap

DOCS = pathlib.Path(__file__).resolve().parent.parent
WIDTH = 100
NAMES = ("Young", "Sobol", "Latin")


def said(program, *arguments):
    """What a call of the program prints."""
    return subprocess.run([program, *arguments], capture_output=True, text=True, check=True).stdout


# Keys.

def variants(node):
    """A node and its alternatives, of which each may have properties of its own."""
    yield node
    for word in ("anyOf", "oneOf"):
        for other in node.get(word, []):
            yield from variants(other)
    if isinstance(node.get("items"), dict):
        yield from variants(node["items"])


def properties(node):
    """Keys below a node with their descriptions; of alternatives the first that has a key."""
    found = {}
    for variant in variants(node):
        for name, child in variant.get("properties", {}).items():
            found.setdefault(name, child)
    return found


def number(value):
    return f"{value:g}" if isinstance(value, float) else str(value).lower() if isinstance(value, bool) else str(value)


def choices(node):
    """Words that a key may have, with what each means."""
    return [(v["const"], v.get("description", "")) for v in variants(node) if isinstance(v.get("const"), str)]


def lowered(text):
    """A text as it goes on within a sentence: names keep their capital."""
    return text if text.startswith(NAMES) else text[:1].lower() + text[1:]


def limits(node):
    """Default and limits of a value."""
    notes = []
    if "default" in node and node["default"] not in ([], {}, None):
        notes.append(f"default `{json.dumps(node['default'], ensure_ascii=False)}`")
    flat = {k: v for variant in reversed(list(variants(node))) for k, v in variant.items()}
    if "exclusiveMinimum" in flat:
        notes.append(f"above {number(flat['exclusiveMinimum'])}")
    elif "minimum" in flat and flat["minimum"] is not None:
        notes.append(f"at least {number(flat['minimum'])}")
    if "maximum" in flat:
        notes.append(f"at most {number(flat['maximum'])}")
    return ", ".join(notes)


def cell(text):
    text = re.sub(r"\s+", " ", text).strip().rstrip(".")
    return text.replace("|", "\\|")


def table_of(path, node, suffix=""):
    """The tables of a key that is a table, and of those below it; a suffix of their headings tells them apart."""
    rows, below = [], []
    units = {}
    for name, child in properties(node).items():
        other = re.match(r"`(\w+)` in (.+)$", child.get("description", ""))
        if other:
            units.setdefault(other[1], []).append(f"`{name}`")
    for name, child in sorted(properties(node).items()):
        text = child.get("description", "")
        if re.match(r"`(\w+)` in (.+)$", text):
            continue
        if properties(child):
            array = any(v.get("type") == "array" for v in variants(child))
            inner = f"{path}.{name}" if path else name
            below.append((inner, array, child))
            rows.append((f"[{name}](#{inner.replace('.', '')}{suffix})", text, "", []))
            continue
        words = choices(child)
        if words:
            text += ": " + "; ".join(f"`\"{word}\"` {lowered(meaning)}".rstrip() for word, meaning in words)
        rows.append((name, text, limits(child), units.get(name, [])))
    out = ["", "| key | meaning | default and limits | other units |", "| --- | --- | --- | --- |"]
    out += [f"| {name if name.startswith('[') else f'`{name}`'} | {cell(text)} | {cell(notes)} | {', '.join(also)} |" for name, text, notes, also in rows]
    for inner, array, child in below:
        mark = f"[[{inner}]]" if array else f"[{inner}]"
        level = "##" if "." not in inner else "###"
        out += ["", f"{level} `{mark}`"]
        if child.get("description"):
            out += ["", cell(child["description"]) + "."]
        out += table_of(inner, child, suffix)
    return out


def keys(program):
    scene = json.loads(said(program, "schema"))
    study = json.loads(said(program, "schema", "study"))
    out = [
        "# Every key of a scene, and of a study",
        "",
        "Made from `nlmodes-cli schema` and `nlmodes-cli schema study`, which print the same as JSON schemas, with what excludes what.",
        "The headings are those of the TOML file: `[table]` stands once, `[[table]]` any number of times. A key whose name ends with a",
        "unit may end with another unit of the last column instead.",
    ]
    out += table_of("", scene)
    text = table_of("", study, "-of-a-study")
    out += ["", "## Every key of a study"] + [re.sub(r"^(##+) (`\[.*\]`)$", r"#\1 \2 of a study", line) for line in text]
    return "\n".join(out) + "\n"


# Commands.

def wrapped(text):
    """Long lines of a help text, with their continuation below where the text of the line begins."""
    out = []
    for line in text.rstrip().splitlines():
        if len(line) <= WIDTH:
            out.append(line)
            continue
        column = re.match(r"(\s*(?:\S+(?: \S+)*? {2,})?)", line).end()
        indent = " " * (column if column < 40 else len(line) - len(line.lstrip()) + 8)
        out += textwrap.wrap(line, WIDTH, subsequent_indent=indent, drop_whitespace=True, replace_whitespace=False)
    return out


def names(text):
    """Names of the commands in a help text."""
    part = re.search(r"^Commands:\n((?:  .*\n)+)", text, re.M)
    return [name for name in re.findall(r"^  (\S+)", part[1], re.M) if name != "help"] if part else []


def of_command(program, path):
    text = said(program, *path, "--help")
    out = ["", f"{'#' * (1 + len(path))} `{' '.join(path)}`", "", "```text", *wrapped(text), "```"]
    for name in names(text):
        out += of_command(program, [*path, name])
    return out


def commands(program):
    text = said(program, "--help")
    out = [
        "# Every command",
        "",
        "What `nlmodes-cli COMMAND --help` prints. From a checkout write `cargo run --` for `nlmodes-cli`; the Python package installs it under the",
        "shorter name `nlmodes`, too.",
        "",
        "```text",
        *wrapped(text),
        "```",
    ]
    for name in names(text):
        out += of_command(program, [name])
    return "\n".join(out) + "\n"


def main():
    program = str(pathlib.Path(sys.argv[1]).resolve())
    pages = {
        "keys.md": keys(program),
        "commands.md": commands(program),
        "files_and_columns.md": said(program, "columns", "--markdown"),
    }
    stale = [name for name, text in pages.items() if not (DOCS / name).exists() or (DOCS / name).read_text() != text]
    if "--check" not in sys.argv[2:]:
        for name in stale:
            (DOCS / name).write_text(pages[name])
    elif stale:
        sys.exit("these differ from what the program says; run docs/scripts/reference.py: " + ", ".join(stale))


main()
