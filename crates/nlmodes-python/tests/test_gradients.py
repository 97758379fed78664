"""Derivatives of the points of a branch by parameters of its scene."""

import numpy as np
import pytest

import nlmodes

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
    "method": {"harmonics": 5},
    "continuation": {"max_energy_ratio": 3.0, "internal_resonance": "follow"},
}


def test_gradients_are_columns_by_key_and_what_is_missing_is_said():
    keys = ["contact.0.gap_m", "structure.material.youngs_modulus_pa", "structure.material.density_kg_m3"]
    result = nlmodes.run({**ROD, "sensitivity": [{"key": key} for key in keys]}, out=False)
    branch = result.branches[0]
    gap, modulus, density = (branch.gradient(key) for key in keys)
    assert gap.shape == branch.frequency_hz.shape and np.all(gap[1:] < 0.0)
    # By units: 2 E f_E - g f_g = f without elastic stops, and E f_E + r f_r = g f_g / 2.
    gap, modulus, density = gap * 1e-3, modulus * 210e9, density * 7800.0
    np.testing.assert_allclose(2.0 * modulus - gap, branch.frequency_hz, rtol=1e-8)
    np.testing.assert_allclose(modulus + density, 0.5 * gap, rtol=1e-6, atol=1e-8 * branch.frequency_hz[0])
    assert np.all(branch.gradient(keys[0], of="peak_force")[1:] != 0.0)
    with pytest.raises(KeyError, match="there is no gradient by"):
        branch.gradient("contact.1.gap_m")
    with pytest.raises(KeyError, match="there is no gradient of"):
        branch.gradient(keys[0], of="colour")
    with pytest.raises(KeyError, match="needs"):
        nlmodes.run(ROD, out=False).branches[0].gradient(keys[0])
