"""Examples run, and come to what is known; the blocks of the guide run as they stand."""

import importlib.util
import re
import shutil
from pathlib import Path

import matplotlib
import numpy as np
import pytest

matplotlib.use("Agg")
PACKAGE = Path(__file__).parents[1]
ROOT = PACKAGE.parents[1]


def example(name):
    spec = importlib.util.spec_from_file_location(name, PACKAGE / "examples" / f"{name}.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_fig_3b_has_the_linear_mode_and_the_loop(tmp_path):
    result = example("rod_fig_3b").main(tmp_path / "figure.svg")
    one, two, three = result
    assert all(branch.complete for branch in result) and (tmp_path / "figure.svg").stat().st_size > 1000
    # The paper's linear mode; the loop of the 3:1 resonance is there with the third harmonic only.
    assert one.frequency_hz[0] == pytest.approx(60.8, abs=0.05)
    assert sum("fold" in event for event in three.event) > sum("fold" in event for event in one.event)


def test_the_indenter_converges_to_hertz(tmp_path):
    errors = [abs(example("hertz_indenter").main(tmp_path / f"{n}.svg", n)[0] - 1) for n in (10, 30)]
    assert errors[1] < 0.01 and errors[1] < errors[0] / 2, errors


BLOCKS = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "python.md").read_text(), re.S)


@pytest.mark.parametrize("number", range(len(BLOCKS)))
def test_blocks_of_the_guide_run_as_they_stand(number, tmp_path, monkeypatch):
    shutil.copytree(ROOT / "configs", tmp_path / "configs")
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(compile(BLOCKS[number], f"docs/python.md, block {number}", "exec"), names)
    assert all(np.isfinite(value).all() for value in names.values() if isinstance(value, np.ndarray) and value.dtype == float)
