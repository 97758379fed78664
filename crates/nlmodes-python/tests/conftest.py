"""A rod whose branch takes some milliseconds, in two systems of units."""

import copy
import signal

import pytest

ROD = {
    "structure": {
        "kind": "rod",
        "length_m": 1.0,
        "elements": 8,
        "start": "clamped",
        "material": {"youngs_modulus_pa": 210e9, "density_kg_m3": 7800.0},
        "section": {"area_m2": 1e-4},
    },
    "contact": [{"at_m": 1.0, "direction": "axial", "side": "positive", "gap_m": 1e-3}],
    "method": {"harmonics": 3, "mass_redistribution": "conserve"},
    "continuation": {"max_energy_ratio": 3.0},
}


@pytest.fixture
def rod():
    """A scene that a test may change."""
    return copy.deepcopy(ROD)


@pytest.fixture(autouse=True)
def ctrl_c_interrupts():
    """Whoever starts the tests in the background may have them ignore Ctrl-C."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)
