"""Studies: cases and table are those of the command line."""

import copy
import os
import signal
import subprocess
import threading

import nlmodes
import numpy as np
import pytest

STUDY = {
    "design": {"kind": "sobol", "samples": 8},
    "vary": [
        {"key": "contact.0.gap_m", "name": "gap_m", "uniform": [1e-3, 2e-3]},
        {"key": "structure.material.youngs_modulus_pa", "name": "modulus_pa", "normal": {"mean": 210e9, "std": 5e9}},
    ],
    "quantity": [
        {"name": "f_2", "of": "frequency_hz", "at": {"energy_ratio": 2.0}},
        {"name": "force", "of": "peak_contact_force_n", "at": "last"},
    ],
}


@pytest.fixture
def study(rod):
    return {**copy.deepcopy(STUDY), "scene": rod}


def test_frequencies_follow_the_wave_speed_and_forces_the_gap(study):
    made = nlmodes.Study(study)
    table = made.run(jobs=2)
    assert table.complete and len(table) == len(made) == 8 and list(table.id) == made.ids()
    # A rod: f ~ sqrt(E), and at the same energy ratio F ~ E A gap / L, whatever the values.
    scaled = table.f_2 / np.sqrt(table.modulus_pa)
    assert np.ptp(scaled) < 1e-6 * scaled[0]
    scaled = table.force / (table.modulus_pa * table.gap_m)
    assert np.ptp(scaled) < 1e-6 * scaled[0]
    frame = table.to_pandas()
    assert list(frame["status"]) == ["complete"] * 8 and np.array_equal(frame["f_2"], table.f_2)
    (spread,) = (s for s in table.statistics if s["quantity"] == "f_2")
    assert spread["spread"]["mean"] == pytest.approx(table.f_2.mean(), rel=1e-12)
    branch = table.case(3).branches[0]
    assert branch.peak_contact_force_n[-1] == table.force[3]
    assert (made.directory / "report.html").is_file() and len(table.plot().lines) == 1


def test_cases_and_table_are_those_of_the_command_line(study, rod, tmp_path):
    program = os.environ.get("NLMODES_CLI")
    if not program:
        pytest.skip("NLMODES_CLI does not name the program")
    (tmp_path / "rod.toml").write_text(nlmodes._native.toml_of(rod))
    (tmp_path / "study.toml").write_text(nlmodes._native.toml_of({**study, "scene": "rod.toml"}))
    subprocess.run([program, "study", "run", tmp_path / "study.toml", "--out", tmp_path / "theirs"], check=True, capture_output=True)
    ours = nlmodes.Study(tmp_path / "study.toml", out=tmp_path / "ours")
    assert ours.run(jobs=1).complete
    assert (tmp_path / "ours/study.csv").read_bytes() == (tmp_path / "theirs/study.csv").read_bytes()
    told = []
    again = nlmodes.Study(tmp_path / "study.toml", out=tmp_path / "theirs").run(progress=lambda *said: told.append(said))
    # Nothing was computed anew.
    assert again.complete and {said[:2] for said in told} == {(8, 8)}


def test_what_is_wrong_is_said(study):
    for key, value, said in [
        ("vary", [{"key": "contact.0.gapm", "values": [1]}], "gap_m"),
        ("design", {"kind": "sobbol"}, "sobol"),
        ("quantity", [{"name": "f", "of": "frequency", "at": "last"}], "frequency_hz"),
    ]:
        with pytest.raises(nlmodes.SceneError, match=said):
            nlmodes.Study({**study, key: value})
    del study["scene"]["contact"][0]["gap_m"]
    with pytest.raises((nlmodes.SceneError, ValueError)):
        nlmodes.Study({**study, "vary": STUDY["vary"][1:]})


def test_a_case_that_fails_is_a_row_with_its_reason(study):
    study["design"] = {"kind": "list"}
    study["vary"] = [{"key": "structure.elements", "name": "elements", "values": [8, 0]}]
    table = nlmodes.Study(study).run()
    assert list(table.status) == ["complete", "failed"] and np.isnan(table.f_2[1]) and table.reason[1]
    with pytest.raises(nlmodes.RunError, match="failed"):
        table.case(1)


def test_single_cases_for_an_optimiser(study):
    made = nlmodes.Study(study)
    one = made.evaluate(gap_m=np.float64(1.5e-3))
    assert one["status"] == "complete" and made.status()["complete"] == 0
    # The modulus of the scene, and a gap by its key.
    assert one == made.evaluate(**{"contact.0.gap_m": 1.5e-3})
    refused = made.evaluate(gap_m="wide")
    assert refused["status"] == "failed" and refused["reason"] and refused["quantities"] == {"f_2": None, "force": None}
    with pytest.raises(ValueError):
        made.evaluate(gap_m=float("nan"))


def test_ctrl_c_and_progress_end_a_study_and_the_same_call_goes_on(study, tmp_path):
    study["scene"]["structure"]["elements"] = 40
    study["scene"]["method"]["harmonics"] = 30
    whole = nlmodes.Study(study, out=tmp_path / "whole").run()

    def enough(done, cases, text):
        if done >= 2:
            raise LookupError(f"{done} of {cases}")

    parts = nlmodes.Study(study, out=tmp_path / "parts")
    with pytest.raises(LookupError, match="of 8"):
        parts.run(jobs=1, progress=enough)
    assert 2 <= parts.status()["complete"] < 8 and parts.status()["missing"] > 0
    timer = threading.Timer(0.02, signal.raise_signal, [signal.SIGINT])
    timer.start()
    try:
        parts.run(jobs=2)
        timer.join()
    except KeyboardInterrupt:
        pass
    assert np.array_equal(parts.run().f_2, whole.f_2)
