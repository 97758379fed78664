"""Modal points of arrays: known answers, in two systems of units, and the same as from a file."""

import nlmodes
import numpy as np
import pytest
from nlmodes import experiment


def channels(force="N", displacement="m"):
    return [
        {"name": "force", "quantity": "force", "unit": force, "role": "excitation", "position_m": 0.0},
        {"name": "q", "quantity": "displacement", "unit": displacement, "role": "drive-point", "position_m": 0.0},
    ]


MODES = {"frequencies_hz": [40.0], "damping_ratios": [0.01], "positions_m": [0.0], "shapes": [[2.0]]}


def record(omega=2 * np.pi * 40.3, force=3.0, amplitude=1e-3, n=8000, rate=4000.0):
    """A force a quarter of a period before the displacement that it drives."""
    t = np.arange(n) / rate
    return np.array([force * np.cos(omega * t), amplitude * np.sin(omega * t)]), rate


def test_a_resonance_has_its_frequency_amplitude_and_damping():
    samples, rate = record()
    found = experiment.extract(samples, rate, channels(), linear_modes=MODES)
    omega = 2 * np.pi * found.frequency_hz[0]
    assert found.frequency_hz[0] == pytest.approx(40.3, rel=1e-9) and found.lag_deg[0] == pytest.approx(90.0, abs=1e-6)
    assert found.modal_amplitude[0] == pytest.approx(1e-3 / 2.0, rel=1e-9) and found.pbmif[0] == pytest.approx(1.0)
    # P = F ω q / 2, δ = P / (q̃² ω³).
    assert found.damping[0] == pytest.approx(0.5 * 3.0 * 1e-3 / (0.5e-3**2 * omega**2), rel=1e-6)
    scaled = experiment.extract(samples * [[1e-3], [1e3]], rate, channels("kN", "mm"), linear_modes=MODES)
    for name in ["frequency_hz", "modal_amplitude", "damping", "lag_deg"]:
        assert scaled[name][0] == pytest.approx(found[name][0], rel=1e-9)


def test_findings_are_names_and_sentences():
    samples, rate = record(n=4000)
    samples[0] *= -1
    found = experiment.extract(samples, rate, channels(), linear_modes=MODES)
    assert "reversed-force" in {finding.name for finding in found.findings[0]}
    assert all(len(finding.text) > 20 for finding in found.findings[0])


def test_several_records_are_rows_and_one_that_is_none_says_why():
    good, rate = record()
    found = experiment.extract({"good": good, "silent": np.zeros_like(good)}, rate, channels())
    assert list(found.record) == ["good", "silent"] and np.isnan(found.frequency_hz[1])
    assert found.frequency_hz[0] == pytest.approx(40.3) and found.findings[1]


def test_arrays_and_a_file_of_them_give_the_same(tmp_path):
    samples, rate = record()
    np.save(tmp_path / "record.npy", samples)
    scene = {
        "recording": {"files": [str(tmp_path / "record.npy")], "sample_rate_hz": rate},
        "channel": channels(),
        "linear_modes": MODES,
        "extraction": {"harmonics": 5},
    }
    of_file = nlmodes.run(scene)
    of_arrays = experiment.extract(samples, rate, channels(), linear_modes=MODES, harmonics=5)
    for name in ["frequency_hz", "modal_amplitude", "damping", "pbmif"]:
        assert of_file[name][0] == of_arrays[name][0]
