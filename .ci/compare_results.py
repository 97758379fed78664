#!/usr/bin/env python3
"""Compares two directories of results: .ci/compare_results.py BEFORE AFTER [TOLERANCE]

Every number of every file, row by row and key by key, may differ by TOLERANCE (1e-10 by default), relative to the largest one of its
column, array or file; everything else has to be the same. Times by the clock, versions and the directory itself do not count.
"""

import csv
import json
import pathlib
import re
import struct
import sys
import zipfile

IGNORED = {"wall_time_s", "time_s", "version", "output_directory", "file"}
NUMBER = re.compile(r"[-+]?(?:\d+\.?\d*|\.\d+)(?:[eE][-+]?\d+)?")
FORMATS = {"<f8": ("d", 1), "<c16": ("d", 2), "<i8": ("q", 1), "<u8": ("Q", 1), "|b1": ("?", 1)}


def number(text):
    try:
        return float(text)
    except (TypeError, ValueError):
        return None


def of_csv(path):
    """Numbers column by column, and the rest of the table."""
    rows = list(csv.DictReader(path.open(newline="")))
    columns = {} if not rows else {key: [row[key] for row in rows] for key in rows[0] if key not in IGNORED}
    values = {key: [number(x) for x in column] for key, column in columns.items()}
    rest = {key: [x for x in column if number(x) is None] for key, column in columns.items()}
    return {key: [x for x in column if x is not None] for key, column in values.items()}, rest


def of_json(text, name=""):
    """Numbers by the names of their keys, lists of numbers together, and the rest."""
    values, rest = {}, {}

    def walk(key, value):
        if isinstance(value, dict):
            for inner in value:
                if inner not in IGNORED:
                    walk(f"{key}.{inner}", value[inner])
        elif isinstance(value, list):
            rest[f"{key}.length"] = len(value)
            if value and all(isinstance(x, (int, float)) and not isinstance(x, bool) for x in value):
                values[key] = [float(x) for x in value]
            else:
                for i, inner in enumerate(value):
                    walk(f"{key}.{i}", inner)
        elif isinstance(value, (int, float)) and not isinstance(value, bool):
            values[key] = [float(value)]
        elif isinstance(value, str):
            values[key], rest[key] = of_text(value)
        else:
            rest[key] = value

    walk(name, json.loads(text))
    return values, rest


def of_lines(path):
    values, rest = {}, {}
    for i, line in enumerate(path.read_text().splitlines()):
        found = of_json(line, str(i))
        values.update(found[0])
        rest.update(found[1])
    return values, rest


def of_npz(path):
    values, rest = {}, {}
    archive = zipfile.ZipFile(path)
    for name in sorted(archive.namelist()):
        data = archive.read(name)
        start = 10 if data[6] == 1 else 12
        length = struct.unpack("<H" if data[6] == 1 else "<I", data[8:start])[0]
        header = data[start : start + length].decode("latin1")
        rest[name] = " ".join(header.split())
        kind = re.search(r"'descr': '([^']*)'", header)
        if kind and kind.group(1) in FORMATS:
            code, parts = FORMATS[kind.group(1)]
            body = data[start + length :]
            values[name] = [float(x) for x in struct.unpack(f"<{len(body) // struct.calcsize(code)}{code}", body)]
        else:
            rest[name + " data"] = data[start + length :]
    return values, rest


def of_text(text):
    return [float(x) for x in NUMBER.findall(text)], NUMBER.sub("#", text)


def read(path):
    match path.suffix:
        case ".csv":
            return of_csv(path)
        case ".json":
            return of_json(path.read_text())
        case ".jsonl":
            return of_lines(path)
        case ".npz":
            return of_npz(path)
        case _:
            text = re.sub(r"(\d+ points? in )[\d.]+ s|\"wall_time_s\":\s*[\d.e+-]+", r"\1", path.read_bytes().decode("utf-8", "replace"))
            values, rest = of_text(text)
            return {"": values}, {"": rest}


def difference(before, after):
    """Largest difference of two lists over the largest number of the first; `None` where they have not the same length."""
    if len(before) != len(after):
        return None
    scale = max((abs(x) for x in before if abs(x) < float("inf")), default=0.0) or 1.0
    return max((0.0 if x == y or (x != x and y != y) else abs(x - y) / scale for x, y in zip(before, after)), default=0.0)


def compare(before, after, tolerance):
    """What differs between two files, in words, and the largest difference of their numbers."""
    if before.read_bytes() == after.read_bytes():
        return [], 0.0
    (values, rest), (other_values, other_rest) = read(before), read(after)
    wrong = [f"{key or 'text'} differs" for key in sorted(rest.keys() | other_rest.keys()) if rest.get(key) != other_rest.get(key)]
    largest = 0.0
    for key in sorted(values.keys() | other_values.keys()):
        found = difference(values.get(key, []), other_values.get(key, []))
        if found is None:
            wrong.append(f"{key or 'text'} has another number of numbers")
        elif not found <= tolerance:
            wrong.append(f"{key or 'text'} differs by {found:.1e}")
        largest = max(largest, found or 0.0)
    return wrong, largest


def main():
    before, after = (pathlib.Path(name) for name in sys.argv[1:3])
    tolerance = float(sys.argv[3]) if len(sys.argv) > 3 else 1e-10
    names = [{str(p.relative_to(d)) for p in d.rglob("*") if p.is_file()} for d in (before, after)]
    if not names[0]:
        sys.exit(f"{before} holds no files")
    failed = [f"{name}: only in one of them" for name in sorted(names[0] ^ names[1])]
    same, worst = 0, 0.0
    for name in sorted(names[0] & names[1]):
        wrong, largest = compare(before / name, after / name, tolerance)
        same += not wrong and (before / name).read_bytes() == (after / name).read_bytes()
        worst = max(worst, largest)
        failed += [f"{name}: {text}" for text in wrong[:5]]
    print(f"{len(names[0] & names[1])} files, {same} of them the same byte by byte; largest difference {worst:.1e}")
    if failed:
        sys.exit("\n".join(failed))


main()
