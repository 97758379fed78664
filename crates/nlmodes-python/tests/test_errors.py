"""What is wrong is said with key, line and help, or the name of the argument; nothing else comes out."""

import pickle
import warnings

import nlmodes
import numpy as np
import pytest
from nlmodes import contact, continuation, experiment


def test_a_mistake_has_its_key_line_and_help(rod, tmp_path):
    from nlmodes import _native

    text = _native.toml_of(rod).replace("gap_m", "gap_in")
    path = tmp_path / "slip.toml"
    path.write_text(text)
    with pytest.raises(nlmodes.SceneError) as raised:
        nlmodes.run(path)
    error = raised.value
    line = 1 + next(k for k, line in enumerate(text.splitlines()) if "gap_in" in line)
    assert "contact.0.gap_in" in {mistake.key for mistake in error.mistakes}
    assert line in {mistake.line for mistake in error.mistakes}
    assert "did you mean `gap_m`?" in str(error) and f"{path}:{line}" in str(error)
    again = pickle.loads(pickle.dumps(error))
    assert (str(again), again.mistakes) == (str(error), error.mistakes)
    assert not (tmp_path / "results").exists()


def test_a_value_that_is_wrong_is_shown(rod):
    with pytest.raises(nlmodes.SceneError) as raised:
        nlmodes.run(rod, method__harmonics=-3)
    assert raised.value.key == "method.harmonics" and raised.value.line is None
    rod["structure"]["length_m"] = -1.0
    with pytest.raises(nlmodes.SceneError) as raised:
        nlmodes.check(rod)
    assert raised.value.key == "structure.length_m" and raised.value.line is not None


def test_results_of_another_scene_are_left_alone(rod, tmp_path):
    nlmodes.run(rod, out=tmp_path / "rod")
    with pytest.raises(nlmodes.RunError, match="force=True"):
        nlmodes.run(rod, out=tmp_path / "rod", method__harmonics=5)
    assert nlmodes.run(rod, out=tmp_path / "rod", method__harmonics=5, force=True).complete


def test_a_branch_that_ends_early_is_returned(rod):
    result = nlmodes.run(rod, continuation__max_points=4)
    assert not result.complete and "4 points" in result.ended_because and len(result.branches[0]) == 4


def test_warnings_are_warnings_of_python(rod):
    rod["method"]["mass_redistribution"] = "drop"
    with pytest.warns(nlmodes.SceneWarning, match="mode 1"):
        nlmodes.run(rod)
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        with pytest.raises(nlmodes.SceneWarning):
            nlmodes.run(rod)


@pytest.mark.parametrize("scene", [None, 3, 4.5, b"rod.toml", [], object(), {1: 2}, {"structure": object()}, "a\0b"])
def test_what_is_no_scene_is_refused(scene):
    with pytest.raises((TypeError, ValueError)):
        nlmodes.run(scene)


@pytest.mark.parametrize("scene", ["", "no such file", "\n", "[[[\n", "\0\n", {}, {"x": float("nan")}, {"structure": {"a": {}}}])
def test_what_is_a_wrong_scene_is_a_scene_error_or_names_the_argument(scene):
    with pytest.raises((nlmodes.SceneError, ValueError)):
        nlmodes.run(scene)


def test_numbers_that_toml_cannot_hold_are_refused_by_their_key(rod):
    with pytest.raises(OverflowError, match=r"structure\.elements"):
        nlmodes.run({**rod, "structure": {**rod["structure"], "elements": 10**30}})
    loop = {}
    loop["a"] = loop
    with pytest.raises(ValueError, match="nested"):
        nlmodes.run(loop)


A, B = np.array([[2.0, 1.0], [1.0, 2.0]]), np.array([[-1.0, 1.0], [-1.0, -1.0]])


@pytest.mark.parametrize(
    ("a", "b", "message"),
    [
        ([[1.0, np.nan], [np.nan, 1.0]], [1.0, 1.0], r"A\[0, 1\] is nan"),
        ([[1.0, 2.0]], [1.0], r"A has the shape \(1, 2\)"),
        ([1.0], [1.0], "A has the shape"),
        (np.zeros((0, 0)), [], "A is empty"),
        (A, np.zeros((0, 2)), "b is empty"),
        (A, [1.0], r"b has the shape \(1,\); \(2,\)"),
        (A, np.zeros((3, 3)), r"b has the shape \(3, 3\); \(samples, 2\)"),
        (A, [1.0, np.inf], r"b\[1\] is inf"),
        (A, np.ma.masked_invalid([1.0, np.nan]), "b has masked entries"),
        ([[1.0, 0.5], [0.4, 1.0]], [1.0, 1.0], "not symmetric"),
        ([[1.0, 2.0], [2.0, 1.0]], [1.0, 1.0], "not positive semidefinite"),
    ],
)
def test_wrong_contact_problems_are_named(a, b, message):
    with pytest.raises(ValueError, match=message):
        contact.solve(a, b)


@pytest.mark.parametrize("wrong", [A + 0j, A.astype(object), [["a", "b"], ["c", "d"]], [[1], [1, 2]], None, A > 1])
def test_what_is_no_array_of_real_numbers_is_a_type_error(wrong):
    with pytest.raises(TypeError, match="^A"):
        contact.solve(wrong, [1.0, 1.0])
    with pytest.raises(TypeError, match="^b"):
        contact.solve(A, wrong)


@pytest.mark.parametrize(
    "of",
    [
        lambda x: x.astype(np.int32),
        lambda x: x.astype(np.float32),
        lambda x: x.astype(">f8"),
        lambda x: x.astype(np.longdouble),
        lambda x: np.asfortranarray(x),
        lambda x: np.repeat(np.repeat(x, 2, 0), 2, 1)[::2, ::2],
        lambda x: x[::-1][::-1],
        lambda x: x.tolist(),
        lambda x: np.lib.stride_tricks.as_strided(x, x.shape, x.strides, writeable=False),
    ],
)
def test_arrays_of_every_kind_are_the_same_problem(of):
    found, expected = contact.solve(of(A), of(B)), contact.solve(A, B)
    assert all(np.array_equal(a, b) for a, b in zip(found, expected, strict=True))


def test_functions_that_fail_are_told():
    def circle(x, p):
        return [x[0] ** 2 + p**2 - 1]

    with pytest.raises(ValueError, match=r"f\(x, p\) has 2 entries, x has 1"):
        continuation.trace(lambda x, p: [1.0, 2.0], None, [1.0], 0.0)
    with pytest.raises(ValueError, match=r"jac\(x, p\) has the shape \[1, 1\]"):
        continuation.trace(circle, lambda x, p: [[1.0]], [1.0], 0.0)
    with pytest.raises(KeyError, match="mine"):
        continuation.trace(lambda x, p: {}["mine"], None, [1.0], 0.0)
    with pytest.raises(TypeError, match=r"f\(x, p\)"):
        continuation.trace(lambda x, p: [1j], None, [1.0], 0.0)
    with pytest.raises(nlmodes.RunError, match="starting point"):
        continuation.trace(lambda x, p: [1 / 0], None, [1.0], 0.0)
    with pytest.raises(ValueError, match="x0 is empty"):
        continuation.trace(circle, None, [], 0.0)
    with pytest.raises(ValueError, match="bounds"):
        continuation.trace(circle, None, [1.0], 0.0, bounds={3: (0, 1)})
    with pytest.raises(IndexError, match="outside of its bounds"):
        continuation.trace(circle, None, [1.0], 0.0, bounds={"p": (1, 2)})


def test_records_that_are_none_are_named():
    channels = [{"name": "f", "quantity": "force", "unit": "N", "role": "excitation"}]
    with pytest.raises(ValueError, match="records has the shape"):
        experiment.extract(np.zeros((2, 100)), 1000.0, channels)
    with pytest.raises(ValueError, match="sample_rate_hz"):
        experiment.extract(np.zeros((1, 100)), -1.0, channels)
    with pytest.raises(nlmodes.SceneError, match="quantity"):
        experiment.extract(np.zeros((1, 100)), 1000.0, [{**channels[0], "quantity": "power"}])
    with pytest.raises(TypeError, match="channels"):
        experiment.extract(np.zeros((1, 100)), 1000.0, "f")
