#!/usr/bin/env python3
"""Fails where files of different folders of a crate need each other in a circle.

    .ci/circles.py crates/nlmodes-scene crates/nlmodes-run …

A file needs those whose items its `use` lines and paths name: `crate::a::b`, `super::b`, or what the crate's root re-exports. A folder is
what stands directly below `src`: `a.rs` with all of `a/`. Files of one folder may need each other, and tests may need anything.
"""

import pathlib
import re
import sys

PATH = re.compile(r"\b(crate|super(?:::super)*)::((?:\w+::)*)(\{|\w+|\*)")


def modules(source):
    """Module paths of the files below `src`."""
    found = {}
    for path in sorted(source.rglob("*.rs")):
        parts = list(path.relative_to(source).with_suffix("").parts)
        found[tuple([] if parts in (["lib"], ["main"]) else parts)] = path
    return found


def code(path):
    """The text without comments and without tests at its end."""
    text = re.sub(r"//[^\n]*", "", path.read_text())
    return text.split("#[cfg(test)]\nmod tests {")[0]


def group(text, start):
    """The names of a `{…}` group, with their own paths; `start` is behind the brace."""
    depth, end = 1, start
    while depth and end < len(text):
        depth += {"{": 1, "}": -1}.get(text[end], 0)
        end += 1
    names, level, name = [], 0, ""
    for char in text[start : end - 1] + ",":
        level += {"{": 1, "}": -1}.get(char, 0)
        if char == "," and not level:
            names.append(name.strip())
            name = ""
        else:
            name += char
    return [re.split(r"\s|::\{", name)[0] for name in names if name]


def mentioned(module, text):
    """Absolute paths that the file names."""
    for found in PATH.finditer(text):
        root, middle, last = found.groups()
        up = root.count("super")
        base = list(module[: len(module) - up]) if up else []
        base += [part for part in middle.split("::") if part]
        for name in group(text, found.end()) if last == "{" else [last]:
            yield tuple(base + [part for part in name.split("::") if part not in ("", "self")])


def exported(found):
    """What the root re-exports, by name, and the module that it comes from."""
    names = {}
    for use in re.finditer(r"pub(?:\(crate\))? use (?:self::)?(\w+(?:::\w+)*)(?:::\{([^}]*)\})?;", code(found[()])):
        parts = use.group(1).split("::")
        items = [item.split(" as ")[-1].strip() for item in use.group(2).split(",")] if use.group(2) else [parts.pop()]
        names.update({item: tuple(parts) for item in items if item})
    return names


def arrows(found):
    """Which folder needs which, with the files that do."""
    names, arrows = exported(found), {}
    for module, path in found.items():
        for target in mentioned(module, code(path)):
            if len(target) == 1 and (target[0],) not in found:
                target = names.get(target[0], ())
            while target and target not in found:
                target = target[:-1]
            if module and target and module[0] != target[0]:
                arrows.setdefault(module[0], {}).setdefault(target[0], set()).add(str(path))
    return arrows


def circles(arrows):
    """Sets of folders that reach each other."""

    def reach(start):
        seen, waiting = set(), list(arrows.get(start, {}))
        while waiting:
            here = waiting.pop()
            if here not in seen:
                seen.add(here)
                waiting += arrows.get(here, {})
        return seen

    reached = {folder: reach(folder) for folder in arrows}
    return {frozenset(b for b in reached if b in reached[a] and a in reached[b]) for a in reached if a in reached[a]}


def main():
    failed = False
    for name in sys.argv[1:]:
        found = modules(pathlib.Path(name) / "src")
        if not found:
            sys.exit(f"{name} has no sources")
        needed = arrows(found)
        for circle in sorted(circles(needed), key=sorted):
            failed = True
            print(f"{name}: a circle of {', '.join(sorted(circle))}")
            for a in sorted(circle):
                for b in sorted(circle & needed[a].keys()):
                    print(f"  {a} → {b}: {', '.join(sorted(needed[a][b]))}")
    sys.exit(failed)


main()
