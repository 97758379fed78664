"""Random calls with hostile arguments: each returns or raises an ordinary exception, and memory stays flat."""

import gc
import os
import random
import resource
import warnings

import nlmodes
import numpy as np
from nlmodes import contact, continuation, experiment

from conftest import ROD

CALLS = int(os.environ.get("NLMODES_HOSTILE_CALLS", "3000"))
ORDINARY = (nlmodes.SceneError, nlmodes.RunError, ValueError, TypeError, OverflowError, KeyError, IndexError, AttributeError)


class Liar:
    """An object that promises what it does not keep."""

    def __array__(self, *_, **__):
        raise ZeroDivisionError("no array")

    def __index__(self):
        raise MemoryError("no index")

    def __float__(self):
        raise LookupError("no number")


class Slippery(list):
    """A list that grows while it is read."""

    def __iter__(self):
        self.append(1)
        return super().__iter__()


def scalar(dice):
    return dice.choice(
        [0, -1, 1, 3, 2**31, 10**40, -(10**40), 0.0, -0.0, 1e-320, 1e308, float("nan"), float("inf"), True, None, "x", "", b"y", 1j,
         np.float32(2), np.int8(-3), np.bool_(True), np.datetime64("2020"), [], {}, (), object(), Liar(), print, "ä" * 50, "\0"]
    )  # fmt: skip


def array(dice, rng):
    shape = dice.choice([(), (0,), (1,), (2,), (3,), (0, 0), (1, 1), (2, 2), (3, 2), (2, 3), (2, 2, 2), (2, 100), (1, 0)])
    kind = dice.choice(["f8", "f4", "f2", "i8", "i1", "u2", "?", "c16", "O", "U3", "S2", "M8[s]", "g", ">f8"])
    made = rng.normal(size=shape) * dice.choice([1, 1e-300, 1e300, 1e3])
    with np.errstate(all="ignore"), warnings.catch_warnings():
        warnings.simplefilter("ignore")
        made = np.asarray(made).astype(kind)
    if made.ndim == 2 and made.shape[0] == made.shape[1] and kind in ("f8", "f4", "g", ">f8") and dice.random() < 0.7:
        made = (made @ made.T).astype(kind) if abs(made).max(initial=0) < 1e100 else made
    twist = dice.randrange(6)
    if twist == 0 and made.ndim:
        made = made[::-1]
    elif twist == 1:
        made = made.T
    elif twist == 2:
        made.flags.writeable = False
    elif twist == 3 and made.size and kind in ("f8", "f4"):
        made.flat[dice.randrange(made.size)] = dice.choice([np.nan, np.inf, -np.inf])
    elif twist == 4:
        return made.tolist()
    return np.ma.masked_array(made, mask=dice.random() < 0.5) if dice.random() < 0.05 else made


def anything(dice, rng, depth=0):
    pick = dice.random()
    if pick < 0.45:
        return array(dice, rng)
    if pick < 0.85 or depth > 3:
        return scalar(dice)
    if pick < 0.92:
        return {dice.choice(["structure", "kind", "a", "", "method", 3]): anything(dice, rng, depth + 1) for _ in range(2)}
    return Slippery([anything(dice, rng, depth + 1) for _ in range(dice.randrange(3))])


VARIED = {"key": "contact.0.gap_m", "name": "gap", "values": [1e-3]}
WANTED = {"name": "f", "of": "frequency_hz", "at": "last"}


def calls(dice, rng, study):
    def some():
        return anything(dice, rng)

    def compliance():
        root = rng.normal(size=(3, 6))
        return (root @ root.T * 10.0 ** dice.randrange(-9, 9)).astype(dice.choice(["f8", "f4", "g", ">f8"]))

    rod = {"structure": {"kind": "rod", "length_m": some(), "elements": some()}, "contact": some(), "method": some()}
    channel = {"name": "f", "quantity": "force", "unit": "N", "role": "excitation"}
    return [
        # Some that are sound: what they take is given back.
        lambda: contact.solve(np.asfortranarray(compliance()), rng.normal(size=(20, 3))[::-1], dice.choice(contact.SOLVERS[:4])),
        lambda: continuation.trace(lambda x, p: x * x + p - 1, None, [1.0], 0.0, max_points=20),
        lambda: experiment.extract(rng.normal(size=(1, 400)), 1000.0, [channel]),
        lambda: nlmodes.run(ROD, continuation__max_points=3) if dice.random() < 0.05 else nlmodes.linear_frequencies(ROD),
        lambda: contact.solve(some(), some(), dice.choice([*contact.SOLVERS, some()])),
        lambda: contact.solve(np.eye(2), some()),
        lambda: contact.solve(array(dice, rng), array(dice, rng), dice.choice(contact.SOLVERS)),
        lambda: contact.Series(np.eye(2)).response(some()),
        lambda: contact.Series([[2.0]]).solve(some(), some()),
        lambda: nlmodes.check(some()),
        lambda: nlmodes.check(rod),
        lambda: nlmodes.check("[structure]\nkind = 'rod'", **{dice.choice(["method", "a.0.b", "structure", ""]): some()}),
        lambda: nlmodes.run(some(), out=False, progress=some(), memory_limit=some()),
        lambda: nlmodes.read(some()),
        lambda: nlmodes.verify(some(), some()),
        lambda: continuation.trace(lambda x, p: some(), None, some(), some(), max_points=3),
        lambda: continuation.trace(lambda x, p: [x[0] - p], lambda x, p: some(), [0.0], some(), max_points=3),
        lambda: continuation.trace(lambda x, p: x * p, None, array(dice, rng), 1.0, direction=some(), max_points=3),
        lambda: continuation.trace(lambda x, p: x - p, None, [0.0], 0.0, bounds=some(), scaling=some(), max_points=some()),
        lambda: nlmodes.Study(some(), out=some()),
        lambda: nlmodes.Study({"scene": dice.choice([ROD, some()]), "design": some(), "vary": some(), "quantity": some()}),
        lambda: nlmodes.Study({"scene": ROD, "vary": [{**VARIED, "values": some()}], "quantity": [{**WANTED, "at": some()}]}),
        lambda: study.evaluate(**{dice.choice(["gap", "method.harmonics", "", "a.0"]): some()}),
        lambda: study.run(jobs=some(), shard=some(), memory_limit=some()),
        lambda: experiment.extract(some(), some(), some()),
        lambda: experiment.extract(some(), some(), [channel], **{dice.choice(["stop", "mode", "linear_modes"]): some()}),
    ]


def resident():
    with open("/proc/self/statm") as statm:
        return int(statm.read().split()[1]) * resource.getpagesize()


def test_hostile_calls_neither_crash_nor_leak():
    dice, rng = random.Random(11), np.random.default_rng(11)
    mine = (*ORDINARY, ZeroDivisionError, MemoryError, LookupError)
    returned, after_warm_up = 0, 0
    study = nlmodes.Study({"scene": ROD, "vary": [VARIED], "quantity": [WANTED]})
    for number in range(CALLS):
        with warnings.catch_warnings(), np.errstate(all="ignore"):
            warnings.simplefilter("ignore")
            try:
                dice.choice(calls(dice, rng, study))()
                returned += 1
            except mine as error:
                assert "mistake of nlmodes" not in str(error), error
        if number == CALLS // 3:
            gc.collect()
            after_warm_up = resident()
    gc.collect()
    grown = resident() - after_warm_up
    assert returned > CALLS // 100
    assert grown < 30e6, f"{grown / 1e6:.1f} MB more after {CALLS} calls"
