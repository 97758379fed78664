#!/usr/bin/env python3
"""Writes the README of each crate from its crate documentation; with --check only says which differ.

The documentation at the head of `src/lib.rs` is the one source: its examples are run as tests, and whoever looks at the crate in a
browser reads the same text.
"""

import pathlib
import re
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent
LINK = re.compile(r"\[(`[^`\]]+`)\](?:\(([^)]*)\))?")


def plain(match):
    """Links to items mean something only within rustdoc; those to the network stay."""
    target = match.group(2)
    return match.group(0) if target and "://" in target else match.group(1)


def readme(crate):
    lines = []
    for line in (crate / "src" / "lib.rs").read_text().splitlines():
        if not line.startswith("//!"):
            break
        lines.append(line[3:].removeprefix(" "))
    out, code, hidden = [], False, False
    for line in lines:
        if line.startswith("```"):
            code = not code
            hidden = code and line == "```"
            line = "```rust" if hidden else line
        elif code and (line == "#" or line.startswith("# ")):
            continue  # lines that only the compiler needs
        elif not code:
            line = LINK.sub(plain, line)
            line = re.sub(r"^(#+) ", r"#\1 ", line)
        out.append(line)
    examples = sorted(path.stem for path in (crate / "examples").glob("*.rs"))
    tail = ["", "## Part of nlmodes", ""]
    tail += [f"Needs Rust 1.95 or newer. Licence: MIT. Changes: those of the workspace, in its `CHANGELOG.md`."]
    if examples:
        tail += ["", "Examples, for a checkout of the workspace:", "", "```sh"]
        tail += [f"cargo run -p {crate.name} --example {name}" for name in examples]
        tail += ["```"]
    return "\n".join([f"# {crate.name}", "", *out, *tail]) + "\n"


def main():
    check = "--check" in sys.argv[1:]
    stale = []
    for crate in sorted(path.parent for path in (ROOT / "crates").glob("*/Cargo.toml")):
        if (crate / "pyproject.toml").exists():
            continue  # a package of Python, which is shown elsewhere
        path, text = crate / "README.md", readme(crate)
        if not path.exists() or path.read_text() != text:
            stale.append(str(path.relative_to(ROOT)))
            if not check:
                path.write_text(text)
    if check and stale:
        sys.exit("these differ from their crate documentation; run .ci/readmes.py: " + ", ".join(stale))


main()
