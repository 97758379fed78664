#!/usr/bin/env python3
"""Links of all pages lead to a file of the repository, and to a heading of it where they name one."""

import pathlib
import re
import subprocess
import sys

ROOT = pathlib.Path(__file__).resolve().parent.parent


def headings(page):
    """Anchors of a page, as the usual hosts make them of its headings."""
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.S)
    titles = re.findall(r"^#+ +(.*)$", text, re.M)
    return {re.sub(r"[^\w\- ]", "", title.lower()).replace(" ", "-") for title in titles}


def broken(page):
    """Targets of the links of a page that lead nowhere."""
    text = re.sub(r"```.*?```", "", page.read_text(), flags=re.S)
    # `Type::item` is a link within the documentation of a crate, from which its README is made.
    for target in re.findall(r"\]\(([^)\s]+)\)", text):
        if re.match(r"\w+:", target):
            continue
        path, _, anchor = target.partition("#")
        file = (page.parent / path).resolve() if path else page
        if not file.exists() or (anchor and file.suffix == ".md" and anchor not in headings(file)):
            yield target


def main():
    pages = subprocess.run(["git", "ls-files", "*.md"], cwd=ROOT, capture_output=True, text=True, check=True)
    found = [(page, target) for page in pages.stdout.split() for target in broken(ROOT / page)]
    for page, target in found:
        print(f"{page}: {target} leads nowhere", file=sys.stderr)
    return 1 if found else 0


if __name__ == "__main__":
    sys.exit(main())
