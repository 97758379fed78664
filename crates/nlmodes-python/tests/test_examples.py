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


*BLOCKS, FOR_MATLAB = re.findall(r"```python\n(.*?)```", (ROOT / "docs" / "python.md").read_text(), re.S)


@pytest.mark.parametrize("number", range(len(BLOCKS)))
def test_blocks_of_the_guide_run_as_they_stand(number, tmp_path, monkeypatch):
    shutil.copytree(ROOT / "configs", tmp_path / "configs")
    monkeypatch.chdir(tmp_path)
    names = {}
    exec(compile(BLOCKS[number], f"docs/python.md, block {number}", "exec"), names)
    assert all(np.isfinite(value).all() for value in names.values() if isinstance(value, np.ndarray) and value.dtype == float)


def test_the_plate_lies_between_a_beam_and_a_wide_plate(tmp_path):
    module = example("plate_from_scikit_fem")
    result = module.main(tmp_path / "plate.svg")
    # f = 1.875² / (2π L²) √(E h² / 12 ρ): of a beam, and with E/(1 − ν²) where the sides cannot contract.
    beam = 1.8751040687**2 / (2 * np.pi * 0.3**2) * np.sqrt(210e9 * 4e-3**2 / (12 * 7800.0))
    assert 0.995 * beam < result.frequency_hz[0] < 1.01 * beam / np.sqrt(1 - 0.3**2)
    assert result.complete and result.frequency_hz[-1] > 1.05 * result.frequency_hz[0]
    history = result.branches[0].history(len(result.branches[0]) - 1)
    assert history.displacement_m.max() <= 0.5e-3 * (1 + 1e-6) and history.force_n.max() > 0


def test_points_of_the_test_lie_on_the_branch_of_the_beam(tmp_path):
    few = {
        "schedule": {"levels_v": [1.4, 2.0], "order": "once"},
        "records": {"levels": [1]},
        "backbone": {"methods": ["hbm"], "harmonics": 5},
    }
    computed, test = example("beam_with_test").main(tmp_path / "beam.svg", virtual_test=few)
    assert len(test.points) == 2 and computed.complete
    # At the same frequency; the models differ in their modulus and in what is measured.
    at = np.interp(test.frequency_hz, computed.frequency_hz, computed.modal_amplitude)
    assert np.allclose(test.modal_amplitude, at, rtol=2e-2)


def test_the_script_for_matlab_runs(monkeypatch):
    names = {"scene": str(ROOT / "configs" / "rod.toml"), "harmonics": 2.0}
    exec(compile(FOR_MATLAB, "docs/python.md", "exec"), names)
    assert np.isfinite(names["branch"]["frequency_hz"]).all() and len(names["branch"]["energy_j"]) > 10


def test_phase_resonance_goes_through_the_peaks_of_the_responses(tmp_path):
    result = example("response_and_damped_mode").main(tmp_path / "response.svg", method__harmonics=3)
    kinds = {str(branch.kind[0]): branch for branch in result}
    # With few harmonics the window ends between the folds of some levels, where another motion begins at its upper end.
    responses = [branch for branch in result if branch.kind[0] == "frequency" and "upper end" not in branch.label]
    resonance, damped = kinds["phase-resonance"], kinds["damped-mode"]
    assert len(responses) == 3 and np.allclose(resonance.drive_lag_deg, 90.0, atol=1e-4)
    for branch in responses:
        assert np.allclose(branch.input_power_w, branch.dissipated_power_w, rtol=1e-6)
    # The largest force is that of the largest response, at whose peak the lag is 90 degrees.
    strong = responses[2].drive_fundamental_m > 0.5 * responses[2].drive_fundamental_m.max()
    peak = responses[2].frequency_hz[strong].max()
    assert resonance.frequency_hz[-1] == pytest.approx(peak, rel=2e-2)
    assert damped.damping_ratio[0] == pytest.approx(0.0019, rel=0.05)
