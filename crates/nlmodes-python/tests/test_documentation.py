"""Docstrings run as they stand, stubs say what is there, and every public function says what it takes."""

import doctest
import inspect
import subprocess
import sys
import warnings
from pathlib import Path

import nlmodes
import pytest
from nlmodes import _branch, _errors, _result, _run, _table

MODULES = [nlmodes, _branch, _errors, _result, _run, _table, nlmodes.contact, nlmodes.continuation, nlmodes.experiment, nlmodes.structure, nlmodes.study]


@pytest.mark.parametrize("module", MODULES, ids=lambda module: module.__name__)
def test_docstrings_run(module):
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        assert doctest.testmod(module).failed == 0


def test_everything_public_is_documented():
    for name in nlmodes.__all__:
        item = getattr(nlmodes, name)
        assert inspect.getdoc(item), name
        if inspect.isclass(item):
            own = [key for key, value in vars(item).items() if not key.startswith("_") and inspect.isfunction(value)]
            assert all(inspect.getdoc(getattr(item, key)) for key in own), name


SETTINGS = str(Path(__file__).parents[1] / "pyproject.toml")
TOOLS = {
    "stubtest": ["mypy.stubtest", "nlmodes", "--mypy-config-file", SETTINGS],
    "mypy": ["mypy", "-p", "nlmodes", "--config-file", SETTINGS],
}


@pytest.mark.parametrize("tool", TOOLS)
def test_types_agree_with_what_is_there(tool, tmp_path):
    pytest.importorskip("mypy")
    command = [sys.executable, "-m", *TOOLS[tool]]
    done = subprocess.run(command, capture_output=True, text=True, cwd=tmp_path)
    assert done.returncode == 0, done.stdout + done.stderr
