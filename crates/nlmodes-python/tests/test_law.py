"""Laws of force that are functions."""

from __future__ import annotations

import copy
from typing import Any

import numpy as np
import pytest

import nlmodes

CUBIC = 6e9


def beam(law: Any) -> dict[str, Any]:
    return {
        "structure": {
            "kind": "beam",
            "length_m": 0.7,
            "elements": 8,
            "start": "clamped",
            "material": {"youngs_modulus_pa": 2.05e11, "density_kg_m3": 7800.0, "poissons_ratio": 0.3},
            "section": {"width_m": 0.014, "height_m": 0.014},
        },
        "spring": [{"at_m": 0.7, "direction": "transverse", "law": law}],
        "method": {"harmonics": 5},
        "continuation": {"start_energy_j": 1e-7, "max_energy_ratio": 1e4},
    }


def test_a_function_is_the_polynomial_that_it_computes() -> None:
    law = nlmodes.Law(lambda v: CUBIC * v**3, lambda v: 3 * CUBIC * v**2)
    found, expected = nlmodes.run(beam(law)), nlmodes.run(beam({"polynomial": [0.0, 0.0, CUBIC]}))
    assert found.complete and len(found.frequency_hz) == len(expected.frequency_hz)
    np.testing.assert_allclose(found.frequency_hz, expected.frequency_hz, rtol=1e-10)
    np.testing.assert_allclose(found.total_energy_j, expected.total_energy_j, rtol=1e-9)
    assert found.frequency_hz[-1] > 1.01 * found.frequency_hz[0]


def test_a_damper_is_a_function_of_the_velocity() -> None:
    def damped(law: Any) -> dict[str, Any]:
        scene = beam({"polynomial": [0.0, 0.0, CUBIC]})
        scene["spring"].append({"at_m": 0.35, "direction": "transverse", "law": law})
        scene["damping"] = {"ratio": 0.001}
        scene["response"] = [{"kind": "damped-mode"}]
        scene["output"] = {"stability": "never"}
        return scene

    own = nlmodes.Law(lambda w: 3.0 * abs(w) * w, lambda w: 6.0 * abs(w), velocity=True)
    found, expected = nlmodes.run(damped(own)), nlmodes.run(damped({"damper": {"coefficient": 3.0, "exponent": 2.0}}))
    np.testing.assert_allclose(found.damping_ratio, expected.damping_ratio, rtol=1e-8)


def test_a_wrong_slope_is_named_with_its_difference() -> None:
    law = nlmodes.Law(lambda v: CUBIC * v**3, lambda v: CUBIC * v**2)
    with pytest.raises(ValueError, match=r"slope\(.*\) is .*, but differences of force give"):
        nlmodes.run(beam(law))


def test_what_a_function_raises_is_raised() -> None:
    def force(v: float) -> float:
        raise LookupError("no table at hand")

    with pytest.raises(LookupError, match="no table at hand"):
        nlmodes.run(beam(nlmodes.Law(force, lambda v: 0.0)))


def test_a_force_at_rest_and_numbers_that_are_none_are_refused() -> None:
    with pytest.raises(ValueError, match=r"force\(0\) is"):
        nlmodes.run(beam(nlmodes.Law(lambda v: 1.0 + v, lambda v: 1.0)))
    with pytest.raises(ValueError, match="a finite number was expected"):
        nlmodes.run(beam(nlmodes.Law(lambda v: float("nan"), lambda v: 1.0)))
    with pytest.raises(TypeError, match="force is 3"):
        nlmodes.Law(3, lambda v: 1.0)  # type: ignore[arg-type]


def test_a_scene_without_its_function_says_what_is_missing() -> None:
    scene = copy.deepcopy(beam({"function": "spring_of_somebody"}))
    with pytest.raises(nlmodes.SceneError, match="spring_of_somebody"):
        nlmodes.run(scene)
