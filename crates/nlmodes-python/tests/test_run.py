"""Runs and their results: columns, files, motions, bit by bit those of the command line."""

import gc
import math
import os
import subprocess
import sys
import time
from pathlib import Path

import nlmodes
import numpy as np
import pytest
from nlmodes import _native

CONFIGS = Path(__file__).parents[3] / "configs"


def test_columns_are_arrays_with_an_entry_a_point(rod):
    result = nlmodes.run(rod)
    (branch,) = result.branches
    assert result.complete and result.kind == "structure" and branch.end_reason == "max-energy"
    assert result.frequency_hz.dtype == np.float64 and result.contact_intervals.dtype == np.int64
    assert {len(branch[name]) for name in branch.columns} == {len(branch)}
    assert np.array_equal(result["energy_j"], branch.energy_j) and branch.event[0] == "grazing"
    with pytest.raises(KeyError, match="frequency_hz"):
        result["frequency"]
    with pytest.raises(AttributeError, match="frequency"):
        result.frequency
    with pytest.raises(ValueError, match="read-only"):
        result.frequency_hz[0] = 1.0


def test_the_first_point_is_the_linear_mode_in_any_size(rod):
    """A clamped-free rod of consistent mass: ω = c/h √(6 (1 − cos kh)/(2 + cos kh)), k = π/2L, but for the mass that leaves the tip."""
    first = nlmodes.linear_frequencies(rod)["mass_kept"][0]
    h = 1.0 / 8
    wave = math.sqrt(210e9 / 7800.0)
    exact = wave / h * math.sqrt(6 * (1 - math.cos(math.pi / 2 * h)) / (2 + math.cos(math.pi / 2 * h))) / (2 * math.pi)
    assert first == pytest.approx(exact, rel=1e-10)
    small = nlmodes.run(rod)
    rod["structure"]["length_m"] = rod["contact"][0]["at_m"] = 1e-3
    rod["contact"][0]["gap_m"] = 1e-6
    large = nlmodes.run(rod)
    assert np.allclose(large.frequency_hz, 1000 * small.frequency_hz, rtol=1e-9)
    assert np.allclose(large.contact_fraction, small.contact_fraction, atol=1e-9)


def test_path_text_and_dictionary_give_the_same_branch(rod, tmp_path):
    text = _native.toml_of(rod)
    path = tmp_path / "rod.toml"
    path.write_text(text)
    of_path = nlmodes.run(path, out=tmp_path / "results")
    of_text, of_dict = nlmodes.run(text), nlmodes.run(rod)
    for column in of_path.branches[0].columns:
        assert np.array_equal(of_path[column], of_dict[column], equal_nan=of_path[column].dtype.kind == "f")
        assert np.array_equal(of_text[column], of_dict[column], equal_nan=of_path[column].dtype.kind == "f")
    assert (tmp_path / "results" / "report.html").is_file()


def test_a_scene_names_the_directory_or_nothing_is_left(rod, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = nlmodes.run(rod)
    directory = result.directory
    coefficients = result.branches[0]
    assert directory.is_dir() and not list(tmp_path.iterdir())
    del result
    assert coefficients.coefficients.shape == (len(coefficients), 8, 4)
    del coefficients
    gc.collect()
    assert not directory.exists()
    kept = nlmodes.run(rod, output={"directory": "here"})
    assert kept.directory == Path("here") and (tmp_path / "here" / "branch.csv").is_file()
    assert nlmodes.run(rod, output__directory="here", out=False).directory != Path("here")


def test_results_are_read_again(rod, tmp_path):
    run = nlmodes.run(rod, out=tmp_path / "rod")
    read = nlmodes.read(tmp_path / "rod")
    assert np.array_equal(run.frequency_hz, read.frequency_hz) and read.kind == "structure"
    assert np.array_equal(run.branches[0].coefficients, read.branches[0].coefficients)
    assert read.branches[0].label == run.branches[0].label and read.ended_because == run.ended_because
    assert nlmodes.read(run.save(tmp_path / "copy")).complete
    with pytest.raises(nlmodes.RunError, match="no such directory"):
        nlmodes.read(tmp_path / "nothing")
    with pytest.raises(nlmodes.RunError, match="no results"):
        nlmodes.read(tmp_path)
    with pytest.raises(nlmodes.RunError, match="in memory"):
        read.branches[0].history(0)


def test_a_branch_never_shows_the_files_of_another_run(rod, tmp_path):
    first = nlmodes.run(rod, out=tmp_path / "rod")
    column = first.frequency_hz.copy()
    second = nlmodes.run(rod, out=tmp_path / "rod", force=True, continuation__max_energy_ratio=2.0)
    assert np.array_equal(first.energy_j[[0]], second.energy_j[[0]]) and first.energy_j[-1] > second.energy_j[-1]
    assert np.array_equal(first.frequency_hz, column)
    with pytest.raises(nlmodes.RunError, match="written anew"):
        _ = first.branches[0].coefficients


def test_several_harmonics_are_branches_beside_each_other(rod):
    result = nlmodes.run(rod, method={"harmonics": [1, 2, 3]})
    assert [int(branch.harmonics[0]) for branch in result] == [1, 2, 3]
    assert len({branch.label for branch in result}) == 3
    assert set(result.to_pandas()["branch"]) == {branch.label for branch in result}
    peak = result.branches[2].history(5, samples=2048).force_n.max()
    assert peak == pytest.approx(result.branches[2].peak_contact_force_n[5], rel=1e-2)


def test_motions_and_histories_agree_at_the_contact(rod):
    branch = nlmodes.run(rod).branches[0]
    point = len(branch) - 1
    time_s, displacement = branch.motion(point, 64)
    assert displacement.shape == (64, 8) and time_s[1] == pytest.approx(1 / (64 * branch.frequency_hz[point]))
    # The series of the definition, at one instant.
    tau = branch.omega[point] * time_s[7]
    sums = [sum((c * np.exp(1j * n * tau)).real for n, c in enumerate(row)) for row in branch.coefficients[point]]
    assert np.allclose(displacement[7], sums, atol=1e-15)
    history = branch.history(point, samples=4096)
    assert history.force_n.min() >= 0 and history.stop_m == 1e-3
    closed = history.force_n > 0
    assert np.allclose(history.displacement_m[closed], history.stop_m, rtol=1e-9)
    assert closed.mean() == pytest.approx(branch.contact_fraction[point], abs=2 / 4096)
    assert history.displacement_m.max() <= history.stop_m * (1 + 1e-9)
    for wrong in [-len(branch) - 1, len(branch), 10**30]:
        with pytest.raises(ValueError, match="point is"):
            branch.history(wrong)
    with pytest.raises(IndexError, match="contact 1"):
        branch.history(0, 1)
    stops = branch.contacts
    assert len(stops) == len(branch) and np.array_equal(stops.contact_fraction, branch.contact_fraction)
    # The impulse is the integral of the force over a period.
    impulse = np.trapezoid(history.force_n, history.time_s)
    assert stops.impulse_ns[point] == pytest.approx(impulse, rel=5e-3)
    verified = branch.verify(point)
    assert verified.contact_fraction[0] == pytest.approx(branch.contact_fraction[point], rel=0.2)


def test_progress_is_told_and_may_end_a_run(rod, tmp_path):
    def stop(points, frequency_hz, text):
        if points:
            raise LookupError(f"{points} points are enough, at {frequency_hz} Hz{text}")

    rod["structure"]["elements"] = 60
    rod["method"]["harmonics"] = 40
    # Of a backbone the points on a resonance are found first and left out later.
    rod["continuation"] = {"max_energy_ratio": 40.0, "max_points": 60, "internal_resonance": "follow"}
    with pytest.raises(LookupError, match="points are enough"):
        nlmodes.run(rod, out=tmp_path / "rod", progress=stop)
    left = nlmodes.read(tmp_path / "rod")
    assert len(left.branches[0]) and left.branches[0].end_reason == "stopped" and not left.complete
    whole = nlmodes.run(rod, out=tmp_path / "rod", resume=True)
    assert len(whole.branches[0]) > len(left.branches[0])
    assert np.array_equal(whole.frequency_hz[: len(left.branches[0])], left.frequency_hz)


def test_the_branch_is_bit_by_bit_that_of_the_command_line(tmp_path):
    program = os.environ.get("NLMODES_CLI")
    if not program:
        pytest.skip("NLMODES_CLI does not name the program")
    for scene in ["rod", "beam"]:
        path = CONFIGS / f"{scene}.toml"
        subprocess.run([program, "run", path, "--quiet", "--out", tmp_path / scene], check=True, capture_output=True)
        ours = nlmodes.run(path, out=tmp_path / f"{scene}-python")
        assert (ours.directory / "branch.csv").read_bytes() == (tmp_path / scene / "branch.csv").read_bytes()
        theirs = nlmodes.read(tmp_path / scene)
        assert np.array_equal(ours.branches[0].coefficients, theirs.branches[0].coefficients)


def test_records_and_virtual_tests_are_run_too(tmp_path):
    extracted = nlmodes.run(CONFIGS / "measured_record.toml", out=tmp_path / "record")
    assert extracted.kind == "records" and len(extracted.points) and np.isfinite(extracted.frequency_hz).all()
    assert nlmodes.read(tmp_path / "record").kind == "records"
    assert extracted.to_pandas().shape[0] == len(extracted.points)


def test_figures_are_drawn_on_axes_that_are_returned(rod):
    import matplotlib

    matplotlib.use("Agg")
    result = nlmodes.run(rod, method__harmonics=[1, 3])
    axes = result.plot()
    assert len(axes.lines) == 2 and axes.get_legend() is not None and axes.get_xscale() == "log"
    assert axes.get_xlabel() == "averaged kinetic energy / J" and axes.get_ylabel() == "frequency / Hz"
    again = result.branches[0].plot("peak_m", "contact_fraction", ax=axes, color="k")
    assert again is axes and len(axes.lines) == 3


def test_a_call_costs_less_than_a_millisecond_beside_what_the_command_line_does(rod, tmp_path, monkeypatch):
    """All around the compiled part, which reads the scene, computes and writes; the least of some calls, since others may compute on the machine."""
    beside, compiled = [], []
    run = _native.run

    def timed(*arguments):
        began = time.perf_counter()
        outcome = run(*arguments)
        compiled.append(time.perf_counter() - began)
        return outcome

    monkeypatch.setattr(_native, "run", timed)
    for number in range(20):
        began = time.perf_counter()
        result = nlmodes.run(rod, out=tmp_path / str(number), progress=False)
        beside.append(time.perf_counter() - began - compiled[-1])
        # What is no longer looked at is no part of the next call.
        del result
    assert min(beside) < 1e-3, beside


def test_no_point_costs_anything_in_python(rod, tmp_path):
    """A branch of many points calls as many functions of Python as one of few: points are for the compiled part alone."""

    def calls(name, ratio):
        counted = []
        sys.setprofile(lambda frame, event, argument: counted.append(event))
        try:
            result = nlmodes.run(rod, out=tmp_path / name, progress=False, continuation__max_energy_ratio=ratio)
        finally:
            sys.setprofile(None)
        return len(counted), len(result.branches[0])

    calls("first", 1.5)
    (few, points), (many, more) = calls("few", 1.5), calls("many", 20.0)
    assert more > 1.5 * points and many == few
