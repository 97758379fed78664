#!/usr/bin/env python3
"""Writes the problems of the suite with their references, each computed twice (needs NumPy, SciPy, mpmath and
python-flint).

    python3 benchmarks/nsm/references/problems.py            all problems, into benchmarks/nsm/problems
    python3 benchmarks/nsm/references/problems.py 01 22      these
    python3 benchmarks/nsm/references/problems.py --check    computes all anew and compares with the files

The digits of a value are those to which both computations agree, at most 15.
"""

import json
import math
import pathlib
import sys

import closed_forms
import numpy as np
import twice
import waves
from system import System, of_problem

PLACE = pathlib.Path(__file__).resolve().parents[1] / "problems"
MOST = 15
SHOOTING = "event-driven shooting in double precision (references/flight.py)"
ARCS = "boundary-value problem of matrix exponentials with 50 digits (references/arcs.py)"
CLOSED = "closed form (references/closed_forms.py)"
WAVES = "waves on a grid in exact fractions (references/waves.py)"


def text_of(value):
    """The shortest text of a number of either computation that gives back its double."""
    return float(f"{float(value):.16g}")


def agreed(a, b):
    """Digits to which two numbers agree."""
    a, b = (x if isinstance(x, float) else float(x) for x in (a, b))
    if a == b:
        return MOST
    return min(MOST, int(math.floor(-math.log10(abs(a - b) / max(abs(a), abs(b))))))


def asked(name, unit, exact, coarse, **more):
    digits = agreed(exact, coarse)
    if digits < 4:
        raise ArithmeticError(f"{name}: {float(exact)} and {float(coarse)} do not agree")
    return {"name": name, **more, "unit": unit, "value": text_of(exact), "digits": digits}


def chain(masses, springs, ground=(), last=None):
    """Matrices of masses in a row; `springs` to the one before (the first to the ground), `last` of the last one to the
    ground."""
    n = len(masses)
    k = np.zeros((n, n))
    for i, s in enumerate(springs):
        k[i, i] += s
        if i > 0:
            k[i - 1, i - 1] += s
            k[i, i - 1] -= s
            k[i - 1, i] -= s
    if last is not None:
        k[n - 1, n - 1] += last
    return np.diag(np.array(masses, dtype=float)), k


def rod(elements):
    """Consistent matrices of a clamped rod with L = EA = ρA = 1; the last node has lost its mass, row and column."""
    n, h = elements, 1.0 / elements
    m, k = np.zeros((n + 1, n + 1)), np.zeros((n + 1, n + 1))
    for e in range(elements):
        part = np.ix_([e, e + 1], [e, e + 1])
        k[part] += np.array([[1, -1], [-1, 1]]) / h
        m[part] += np.array([[2, 1], [1, 2]]) * h / 6
    m, k = m[1:, 1:], k[1:, 1:]
    m[-1, :] = m[:, -1] = 0.0
    return m, k


def unit(n, i, sign=1.0):
    w = [0.0] * n
    w[i] = sign
    return w


def stop(n, i, gap, stiffness, sign=1.0):
    return {"direction": unit(n, i, sign), "gap": gap, "stiffness": stiffness}


def problem(identifier, title, kind, matrices, contacts, statement, damping=None, load=None, how=(SHOOTING, ARCS)):
    m, k = matrices
    system = {"mass": np.asarray(m).tolist(), "stiffness": np.asarray(k).tolist()}
    if damping is not None:
        system["damping"] = np.asarray(damping).tolist()
    found = {
        "id": identifier,
        "title": title,
        "kind": kind,
        "statement": statement,
        "system": system,
        "contacts": contacts,
    }
    if load is not None:
        found["load"] = load
    return {**found, "references": list(how), "cases": []}


def open_energies(system, motion):
    """Total energy of an undamped motion: at its start, whichever stops are closed there."""
    n, z = system.n, motion.x[: 2 * system.n]
    q, v = np.array([float(x) for x in z[:n]]), np.array([float(x) for x in z[n:]])
    energy = 0.5 * v @ system.mass @ v + 0.5 * q @ system.stiffness @ q
    for s in system.stops:
        energy += 0.5 * s.stiffness * max(s.direction @ q - s.gap, 0.0) ** 2
    return energy


def free_case(found, name, amplitude, ref, number, closed=None, note="", family=None, start=None):
    """A free motion that begins at rest at an amplitude of a coordinate with mass, followed from a linear mode, or from
    a start (q, T)."""
    system = of_problem(found)
    if start:
        x = np.concatenate([start[0], np.zeros(system.n), [start[1], 0.0]])
        x = twice.follow(family or (lambda s: (system, amplitude)), ref, x)
    else:
        x = twice.follow(
            family or twice.stiffening(system, amplitude), ref, twice.free_start(system, amplitude, ref, number)
        )
    motion = twice.twice_free(system, amplitude, ref, x)
    exact, coarse = motion.fine, motion.coarse
    if closed:
        for other, key in zip(closed, ("frequency", "mean_kinetic_energy")):
            if agreed(float(other), exact[key]) < 14:
                raise ArithmeticError(f"{found['id']}: {key} {other} in closed form, {exact[key]} otherwise")
    at = {"mean_kinetic_energy": text_of(exact["mean_kinetic_energy"])}
    undamped = "damping" not in found["system"]
    if undamped and all(s["gap"] >= 0 for s in found["contacts"]):
        at["total_energy"] = text_of(open_energies(system, motion))
    items = [asked("frequency", "rad/s", exact["frequency"], coarse["frequency"])]
    if not undamped:
        items.append(asked("damping_ratio", "", exact["damping_ratio"], coarse["damping_ratio"]))
    for j in range(len(system.stops)):
        if exact["impulse"][j] > 0:
            items.append(asked(f"impulse[{j}]", "N s", exact["impulse"][j], coarse["impulse"][j]))
    found["cases"].append(
        {"case": f"{found['id']}/{name}", "branch": note or f"linear mode {number}", "at": at, "asked": items}
    )


def driven_case(found, name, driven, z, omega, note):
    motion = twice.twice_driven(driven, z, omega)
    exact, coarse = motion.fine, motion.coarse
    items = []
    heavy = [i for i, row in enumerate(found["system"]["mass"]) if any(row)]
    drive = heavy.index(int(np.flatnonzero(found["load"]["vector"])[0]))
    size = lambda pair: (pair[0] ** 2 + pair[1] ** 2).sqrt()
    items.append(
        asked(f"amplitude[{heavy[drive]}]", "m", size(exact["fundamental"][drive]), abs(coarse["fundamental"][drive]))
    )
    for j in range(len(driven.system.stops)):
        if exact["impulse"][j] > 0:
            items.append(asked(f"impulse[{j}]", "N s", exact["impulse"][j], coarse["impulse"][j]))
    items.append(asked("multiplier", "", exact["multiplier"], coarse["multiplier"]))
    near = {items[0]["name"]: float(f"{items[0]['value']:.2g}")}
    found["cases"].append(
        {"case": f"{found['id']}/{name}", "branch": note, "at": {"frequency": omega}, "near": near, "asked": items}
    )
    return motion


def fold_case(found, name, driven, point, ref, note):
    coarse, exact = twice.fold(driven, point, ref)
    found["cases"].append(
        {
            "case": f"{found['id']}/{name}",
            "branch": note,
            "at": {},
            "near": {"frequency": round(coarse, 2)},
            "asked": [asked("frequency", "rad/s", exact, coarse)],
        }
    )


def folds(points):
    """Points of a curve at which the frequency turns, away from the onset of contact."""
    omega = points[:, -1]
    return [points[i] for i in range(1, len(points) - 1) if (omega[i] - omega[i - 1]) * (omega[i + 1] - omega[i]) < 0]


ALL = {}


def register(function):
    ALL[function.__name__.split("_")[1]] = function
    return function


# One degree of freedom

ONE = ([[1.0]], [[1.0]])
FREE = "Free, undamped motion. The branch begins where the motion of the linear mode just reaches the stop."


@register
def p_01():
    found = problem(
        "01",
        "Oscillator before an elastic stop",
        "free",
        ONE,
        [stop(1, 0, 1.0, 9.0)],
        FREE,
        how=(CLOSED, SHOOTING, ARCS),
    )
    for name, turn in (("a", -1.1), ("b", -1.5), ("c", -4.0)):
        free_case(found, name, turn, 0, 1, closed_forms.one_stop(1, 9, 1, turn))
    return found


@register
def p_02():
    contacts = [stop(1, 0, 1.0, 9.0), stop(1, 0, 1.0, 9.0, -1.0)]
    found = problem(
        "02", "Oscillator between two equal elastic stops", "free", ONE, contacts, FREE, how=(CLOSED, SHOOTING, ARCS)
    )
    for name, top in (("a", 1.1), ("b", 1.5)):
        free_case(found, name, top, 0, 1, closed_forms.two_stops(1, ((1, 9), (1, 9)), top))
    return found


@register
def p_03():
    contacts = [stop(1, 0, 1.0, 9.0), stop(1, 0, 1.5, 30.0, -1.0)]
    found = problem(
        "03",
        "Oscillator between two different elastic stops",
        "free",
        ONE,
        contacts,
        FREE,
        how=(CLOSED, SHOOTING, ARCS),
    )
    free_case(
        found,
        "a",
        1.5,
        0,
        1,
        closed_forms.two_stops(1, ((1, 9), (1.5, 30)), 1.5),
        "linear mode 1; both stops are touched",
    )
    return found


@register
def p_04():
    statement = "Free, undamped motion. The gap is zero: the frequency does not depend on the energy."
    found = problem(
        "04",
        "Oscillator that touches an elastic stop at rest",
        "free",
        ONE,
        [stop(1, 0, 0.0, 8.0)],
        statement,
        how=(CLOSED, SHOOTING, ARCS),
    )
    free_case(found, "a", -1.0, 0, 1, closed_forms.one_stop(1, 8, 0, -1), "the only one")
    return found


@register
def p_05():
    statement = (
        "Free, undamped motion about rest. The gap is negative: at rest the stop of 20 N/m presses with 1 N, and small motions "
        "never leave it. Kinetic energies are those of the motion; displacements count from the drawing, where the spring is relaxed."
    )
    found = problem(
        "05",
        "Oscillator that a stop presses at rest",
        "free",
        ONE,
        [stop(1, 0, -1.05, 20.0)],
        statement,
        how=(CLOSED, SHOOTING, ARCS),
    )
    # 0.15 m on the closed side of rest, which is at −1: the motion turns at −0.85 there.
    turn = -1.0 + 0.15
    energy = 0.5 * turn**2 + 10.0 * (turn + 1.05) ** 2
    far = -math.sqrt(2 * energy)
    top = closed_forms.one_stop(1, 20, -1.05, far)
    family = lambda s: (
        System(np.eye(1), np.eye(1), 0 * np.eye(1), np.zeros(1), [twice_stop(20.0 * max(s, 1e-9) ** 2, -1.05)]),
        far,
    )
    free_case(found, "a", far, 0, 1, top, "the motion that lifts off", family)
    return found


def twice_stop(stiffness, gap):
    from system import Stop

    return Stop(np.array([1.0]), gap, stiffness)


@register
def p_06():
    found = problem(
        "06",
        "Oscillator thrown back by a rigid stop",
        "impact",
        ONE,
        [stop(1, 0, 1.0, None)],
        "Free, undamped motion of a mass that a rigid stop throws back without loss of energy.",
        how=(CLOSED, SHOOTING),
    )
    return impact_cases(found, False, (("a", 1.05), ("b", 1.25), ("c", 4.0)))


@register
def p_07():
    found = problem(
        "07",
        "Oscillator between two rigid stops",
        "impact",
        ONE,
        [stop(1, 0, 1.0, None), stop(1, 0, 1.0, None, -1.0)],
        "Free, undamped motion of a mass that rigid stops throw back without loss of energy.",
        how=(CLOSED, SHOOTING),
    )
    return impact_cases(found, True, (("a", 1.05), ("b", 2.0)))


def impact_cases(found, two_sided, cases):
    """Energies as if the mass swung to an amplitude; the second computation integrates the motion to its impacts."""
    from scipy.integrate import solve_ivp

    for name, swing in cases:
        closed = closed_forms.impact_two_sided(1, swing) if two_sided else closed_forms.impact(1, swing)
        hit = lambda t, y: y[0] - 1.0
        hit.terminal, hit.direction = True, 1
        start = [0.0, swing, 0.0] if two_sided else [-swing, 0.0, 0.0]
        run = solve_ivp(
            lambda t, y: [y[1], -y[0], y[1] ** 2], (0, 10), start, "DOP853", rtol=3e-14, atol=1e-16, events=hit
        )
        t, e = run.t[-1] * (4 if two_sided else 2), run.y[2, -1] * (4 if two_sided else 2)
        omega, kinetic = 2 * math.pi / t, e / (2 * t)
        at = {"mean_kinetic_energy": text_of(closed[1]), "total_energy": swing**2 / 2}
        if agreed(float(closed[1]), kinetic) < 11:
            raise ArithmeticError("kinetic energies differ")
        found["cases"].append(
            {
                "case": f"{found['id']}/{name}",
                "branch": "linear mode 1",
                "at": at,
                "asked": [asked("frequency", "rad/s", closed[0], omega)],
            }
        )
    return found


@register
def p_08():
    found = problem(
        "08",
        "Code_Aster's SDND122: mass of 1 kg on 10 N/m, stop of 50 N/m at 10 mm",
        "free",
        ([[1.0]], [[10.0]]),
        [stop(1, 0, 0.01, 50.0)],
        FREE,
        how=(CLOSED, SHOOTING, ARCS),
    )
    for name, energy in (("a", 0.00650108331626), ("b", 0.0065812965423), ("c", 0.02)):
        far = -math.sqrt(energy / 5.0)
        free_case(found, name, far, 0, 1, closed_forms.one_stop(10, 50, 0.01, far))
    return found


@register
def p_09():
    matrices = ([[1.0, 0.0], [0.0, 0.0]], [[4.0, -2.0], [-2.0, 2.0]])
    found = problem(
        "09",
        "Mass with a light tip before a rigid stop",
        "free",
        matrices,
        [stop(2, 1, 1.0, None)],
        FREE + " The tip has no mass and hangs on a spring of 2 N/m; the stop is rigid.",
        how=(CLOSED, SHOOTING, ARCS),
    )
    free_case(found, "a", -1.5, 0, 1, closed_forms.one_stop(2, 2, 1, -1.5))
    return found


# Several degrees of freedom, free

PAIR = ([[1.0, 0.0], [0.0, 1.0]], [[2.0, -1.0], [-1.0, 2.0]])


@register
def p_10():
    found = problem(
        "10", "After Code_Aster's SDND123: two masses, one stop", "free", PAIR, [stop(2, 0, 1.0, 30.0)], FREE
    )
    free_case(found, "a", -1.1, 0, 1)
    free_case(found, "b", -1.6, 0, 1)
    return found


@register
def p_11():
    contacts = [stop(2, 0, 1.0, 30.0), stop(2, 0, 1.0, 30.0, -1.0)]
    found = problem("11", "After Code_Aster's SDND123: two masses, two stops", "free", PAIR, contacts, FREE)
    free_case(found, "a", 1.1, 0, 1)
    return found


CHAIN = (np.eye(2), np.array([[1.0, -1.0], [-1.0, 2.0]]))


@register
def p_12():
    found = problem("12", "Two masses and a stiff stop, first mode", "free", CHAIN, [stop(2, 0, 1.0, 100.0)], FREE)
    free_case(found, "a", -1.1, 0, 1)
    free_case(found, "b", -1.5, 0, 1)
    return found


@register
def p_13():
    found = problem("13", "Two masses and a stiff stop, second mode", "free", CHAIN, [stop(2, 0, 1.0, 100.0)], FREE)
    free_case(found, "a", -1.05, 0, 2)
    return found


@register
def p_14():
    found = problem(
        "14",
        "Rod of two elements with a massless tip before a rigid stop",
        "free",
        rod(2),
        [stop(2, 1, 1.0, None)],
        FREE,
    )
    free_case(found, "a", -1.2, 0, 1)
    free_case(found, "b", -2.0, 0, 1)
    return found


@register
def p_15():
    found = problem(
        "15",
        "Five masses in a row, the last one before a stop",
        "free",
        chain([1.0] * 5, [1.0] * 5),
        [stop(5, 4, 1.0, 50.0)],
        FREE,
    )
    free_case(found, "a", -1.05, 4, 1)
    return found


# Rough motions of the rod with ten elements, from which Newton's method begins: displacements as it turns (m), and
# period (s).
ROD_FIRST = ([-0.25734, -0.48988, -0.68871, -0.84273, -0.94309, -0.99694, -1.01667, -1.01982, -1.01887], 3.7097)
ROD_SECOND = (
    [0.54652, 0.86702, 1.06131, 0.97692, 0.57445, 0.12472, -0.39526, -0.87171, -1.034],
    1.2309,
)


@register
def p_16():
    found = problem(
        "16",
        "Rod of ten elements with a massless tip before a rigid stop",
        "free",
        rod(10),
        [stop(10, 9, 1.0, None)],
        FREE,
    )
    free_case(found, "a", -1.02, 8, 1, start=ROD_FIRST)
    return found


@register
def p_17():
    found = problem("17", "Rod of ten elements, second mode", "free", rod(10), [stop(10, 9, 1.0, None)], FREE)
    free_case(found, "a", -1.034, 8, 2, start=ROD_SECOND)
    return found


@register
def p_18():
    statement = "Free, undamped motion. The gap is zero: the frequency does not depend on the energy, and there is one for each mode."
    found = problem(
        "18", "Two masses, one of which touches a stop at rest", "free", PAIR, [stop(2, 0, 0.0, 10.0)], statement
    )
    free_case(found, "a", -1.0, 0, 1, note="first mode")
    return found


@register
def p_19():
    statement = (
        "Free, undamped motion about rest. The gap is negative: the stop presses at rest, and small motions never leave it. "
        "Displacements count from the drawing, where all springs are relaxed."
    )
    found = problem(
        "19", "Two masses, one of which a stop presses at rest", "free", PAIR, [stop(2, 0, -0.2, 20.0)], statement
    )
    free_case(found, "a", -1.0, 0, 1, note="first mode, beyond lift-off")
    return found


@register
def p_20():
    contacts = [stop(3, 0, 1.0, 20.0), stop(3, 2, 1.2, 40.0, -1.0)]
    found = problem(
        "20",
        "Three masses between two stops at different places",
        "free",
        chain([1.0, 2.0, 1.0], [1.0, 1.5, 1.0]),
        contacts,
        FREE,
    )
    whole = of_problem(found)
    family = lambda s: (whole, 1.032 + 0.018 * s)
    free_case(
        found,
        "a",
        1.05,
        0,
        1,
        note="linear mode 1, where both stops are touched for the first time",
        family=family,
        start=([1.032, 0.8455, 1.5954], 1 / 0.0708715),
    )
    return found


@register
def p_21():
    found = {
        "id": "21",
        "title": "Uniform bar before a rigid stop",
        "kind": "bar",
        "statement": "A clamped bar with length, tensile stiffness and mass per length of 1 whose end meets a rigid stop, free and undamped: its first "
        "nonsmooth mode, with one touch a period. No matrices are given: use as many elements or waves as you like.",
        "bar": {"length": 1.0, "tensile_stiffness": 1.0, "mass_per_length": 1.0, "gap": 1.0},
        "references": [CLOSED + ": E = g²/(2 (T − 3)²), 3 < T < 4", WAVES],
        "cases": [],
    }
    for name, numerator, parts in (("a", 15, 4), ("b", 14, 4), ("c", 13, 4)):
        from fractions import Fraction

        period = Fraction(numerator, parts)
        energy, kinetic = waves.mode(period, 1, parts)
        closed = closed_forms.bar_energy(1, closed_forms.mpf(numerator) / parts)
        if agreed(float(closed), float(energy)) < MOST:
            raise ArithmeticError(f"bar: {closed} and {energy}")
        value = 2 * math.pi / float(period)
        found["cases"].append(
            {
                "case": f"21/{name}",
                "branch": "first nonsmooth mode",
                "at": {"total_energy": text_of(energy), "mean_kinetic_energy": text_of(kinetic)},
                "asked": [{"name": "frequency", "unit": "rad/s", "value": text_of(value), "digits": MOST}],
            }
        )
    return found


# Driven

DRIVEN = "Motion with the period of the load f cos Ωt. The multiplier is the largest magnitude of the Floquet multipliers over a period of the motion."


def drive(found, begin, end, step, level=1.0):
    """The curve of responses from a frequency at which nothing touches."""
    driven = twice.Driven(of_problem(found), level)
    points = driven.curve(driven.linear(begin), begin, step, lambda p: (p[-1] - end) * (end - begin) > 0)
    return driven, points


@register
def p_22():
    load = {"vector": [0.2], "harmonic": 1}
    found = problem(
        "22", "Driven oscillator before an elastic stop", "driven", ONE, [stop(1, 0, 1.0, 9.0)], DRIVEN, [[0.1]], load
    )
    driven, points = drive(found, 0.7, 1.6, 0.01)
    names = iter("abcdefgh")
    for omega in (1.0, 1.2):
        for z in twice.crossings(points, omega):
            driven_case(found, next(names), driven, z, omega, "the response with this amplitude")
    for point in folds(points):
        if point[-1] > 1.2:
            fold_case(found, next(names), driven, point, 0, "fold of the response curve with contact")
    # The other fold is where contact begins on the way down: the linear response has the amplitude of the gap.
    b = 0.5 * 0.1**2 - 1.0
    onset = math.sqrt(-b + math.sqrt(b * b - 1.0 + 0.2**2))
    z = driven.linear(onset)
    coarse = math.hypot(z[0], z[1] / onset)
    if agreed(coarse, 1.0) < 14:
        raise ArithmeticError("the onset of contact is not where it was computed")
    found["cases"].append(
        {
            "case": f"22/{next(names)}",
            "branch": "fold where contact begins, of the curve from above",
            "at": {},
            "near": {"frequency": round(onset, 2)},
            "asked": [asked("frequency", "rad/s", onset, onset)],
        }
    )
    return found


@register
def p_23():
    load = {"vector": [0.2], "harmonic": 1}
    contacts = [stop(1, 0, 1.0, 9.0), stop(1, 0, 1.0, 9.0, -1.0)]
    found = problem("23", "Driven oscillator between two elastic stops", "driven", ONE, contacts, DRIVEN, [[0.1]], load)
    driven, points = drive(found, 0.7, 1.8, 0.01)
    names = iter("abcdefgh")
    for z in twice.crossings(points, 1.3):
        driven_case(found, next(names), driven, z, 1.3, "the response with this amplitude")
    for point in folds(points):
        if point[-1] > 1.4:
            fold_case(found, next(names), driven, point, 0, "fold of the response curve with contact")
    return found


def beyond_fold(points):
    """Points of a curve over falling frequency beyond its second fold, at which it turns down again."""
    omega = points[:, -1]
    lowest = next(i for i in range(1, len(omega)) if omega[i + 1] > omega[i])
    return points[lowest + int(np.argmax(omega[lowest:])) :]


def two_masses():
    load = {"vector": [0.0, 0.1], "harmonic": 1}
    return problem(
        "24",
        "Two driven masses and a stiff stop",
        "driven",
        CHAIN,
        [stop(2, 0, 1.0, 100.0)],
        DRIVEN,
        0.03 * CHAIN[1],
        load,
    )


@register
def p_24():
    found = two_masses()
    driven, points = drive(found, 0.8, 0.55, -0.005)
    names = iter("abcdefgh")
    for omega in (0.7, 0.6):
        for z in twice.crossings(points, omega):
            driven_case(found, next(names), driven, z, omega, "the response with this amplitude")
    for point in folds(points):
        if 0.74 < point[-1]:
            fold_case(found, next(names), driven, point, 0, "fold of the response curve with contact")
    return found


@register
def p_25():
    found = two_masses()
    found.update(id="25", title="Two driven masses: where the response loses its stability")
    driven, points = drive(found, 0.8, 0.62, -0.005)
    upper = beyond_fold(points)

    def flip(_, monodromy):
        m = monodromy()
        if isinstance(m, np.ndarray):
            return np.linalg.det(m + np.eye(len(m)))
        return sum_det(m)

    def sum_det(m):
        n = m.nrows()
        return type(m)([[m[i, j] + (1 if i == j else 0) for j in range(n)] for i in range(n)]).det().mid()

    coarse, exact, _ = twice.where(driven, twice.crossings(upper, 0.74)[0], 0.74, flip, -1e-3)
    found["cases"].append(
        {
            "case": "25/a",
            "branch": "a multiplier is −1 (period doubling)",
            "at": {},
            "near": {"frequency": 0.74},
            "asked": [asked("frequency", "rad/s", exact, coarse)],
        }
    )
    return found


@register
def p_26():
    m, k = rod(4)
    load = {"vector": unit(4, 1, 0.15), "harmonic": 1}
    found = problem(
        "26",
        "Driven rod of four elements with a massless tip before a rigid stop",
        "driven",
        (m, k),
        [stop(4, 3, 1.0, None)],
        DRIVEN + " Damping in proportion to the mass.",
        0.05 * m,
        load,
    )
    driven = twice.Driven(of_problem(found))
    z = driven.linear(1.9)
    # Stable motions over rising frequency.
    for omega in (1.9, 1.92, 1.94, 1.96, 1.98, 2.0):
        one = twice.flight.Flight(driven.system, omega, 1.0)
        for _ in range(60):
            z = one.fly(z, 2 * math.pi / omega)[1]
    driven_case(found, "a", driven, z, 2.0, "the response with this amplitude, which is reached over rising frequency")
    return found


@register
def p_27():
    load = {"vector": [0.5], "harmonic": 1}
    statement = (
        "Motion of twice the period of the load f cos Ωt (subharmonic of order 1/2). Its fundamental has half the frequency of the load; "
        "the amplitude asked for is that at the frequency of the load, the impulse and the multiplier are those of two periods of the load."
    )
    found = problem(
        "27",
        "Subharmonic motion of an oscillator that touches a stop at rest",
        "subharmonic",
        ONE,
        [stop(1, 0, 0.0, 8.0)],
        statement,
        [[0.05]],
        load,
    )
    driven = twice.Driven(of_problem(found), 1.0, 2)
    omega = 3.0
    one = twice.flight.Flight(driven.system, omega, 1.0)
    z = np.array([0.3, 0.4])
    for _ in range(300):
        z = one.fly(z, 4 * math.pi / omega)[1]
    driven_case(found, "a", driven, z, omega, "the stable motion of twice the period")
    return found


@register
def p_28():
    load = {"vector": [0.0], "harmonic": 1}
    load["vector"] = [0.3]
    found = problem(
        "28",
        "Driven oscillator that touches a stop at rest",
        "driven",
        ONE,
        [stop(1, 0, 0.0, 8.0)],
        DRIVEN,
        [[0.2]],
        load,
    )
    driven = twice.Driven(of_problem(found), 1.0)
    omega = 1.4
    z = np.zeros(2)
    one = twice.flight.Flight(driven.system, omega, 1.0)
    for _ in range(80):
        z = one.fly(z, 2 * math.pi / omega)[1]
    driven_case(found, "a", driven, z, omega, "the stable motion with the period of the load")
    return found


@register
def p_29():
    found = two_masses()
    found.update(
        id="29",
        title="Phase resonance of two driven masses",
        kind="phase-resonance",
        statement="Motion with the period of the load, in which the fundamental of the driven mass lags the load by 90°: at which frequency, and "
        "with which amplitude of the driven mass?",
    )
    driven, points = drive(found, 0.8, 0.65, -0.005)

    def lag(quantities, _):
        value = quantities["fundamental"][1]
        return value[0].mid() if isinstance(value, tuple) else value.real

    def real(point):
        one, pieces, _ = driven.end(point[:-1], point[-1])
        return one.quantities(pieces, 2 * math.pi / point[-1], point[-1])["fundamental"][1].real

    # Near the upper fold the amplitude is largest.
    near = [p for p in points[len(points) - len(beyond_fold(points)) - 40 :] if p[-1] > 0.73]
    best = min(near, key=lambda p: abs(real(p)))
    coarse, exact, motion = twice.where(driven, best[:-1], best[-1], lag)
    size = lambda pair: (pair[0] ** 2 + pair[1] ** 2).sqrt()
    found["cases"].append(
        {
            "case": "29/a",
            "branch": "the one with contact",
            "at": {"lag_deg": 90.0},
            "near": {"frequency": round(coarse, 2)},
            "asked": [
                asked("frequency", "rad/s", exact, coarse),
                asked("amplitude[1]", "m", size(motion.fine["fundamental"][1]), abs(motion.coarse["fundamental"][1])),
            ],
        }
    )
    return found


DAMPED = (
    "Damped nonlinear mode by the extended periodic motion concept: M q'' + (C − ξ M) q' + K q + contact = 0 has a periodic motion of frequency ω. "
    "The damping ratio is ξ/(2ω)."
)


@register
def p_30():
    found = problem(
        "30",
        "Damped mode of two masses and a stiff stop",
        "damped-mode",
        CHAIN,
        [stop(2, 0, 1.0, 100.0)],
        DAMPED,
        0.03 * CHAIN[1],
    )
    free_case(found, "a", -1.1, 0, 1)
    free_case(found, "b", -1.5, 0, 1)
    return found


@register
def p_31():
    contacts = [stop(3, 0, 1.0, 20.0), stop(3, 2, 1.2, 40.0, -1.0)]
    matrices = chain([1.0, 2.0, 1.0], [1.0, 1.5, 1.0])
    damping = np.zeros((3, 3))
    damping[0, 0] = 0.05
    found = problem(
        "31", "Damped mode of three masses with one dashpot", "damped-mode", matrices, contacts, DAMPED, damping
    )
    free_case(found, "a", -1.0, 0, 1, note="linear mode 1; the second stop is touched first")
    return found


@register
def p_32():
    m, k = rod(10)
    found = problem(
        "32",
        "Damped mode of a rod of ten elements with a massless tip",
        "damped-mode",
        (m, k),
        [stop(10, 9, 1.0, None)],
        DAMPED,
        np.diag([0.0] * 8 + [0.05, 0.0]),
    )
    whole = of_problem(found)
    family = lambda s: (System(whole.mass, whole.stiffness, s * whole.damping, whole.force, whole.stops), -1.02)
    free_case(found, "a", -1.02, 8, 1, family=family, start=ROD_FIRST)
    return found


def same(ours, theirs):
    """Whether two problem files differ in rounding only: values to their digits, and digits by one."""
    if isinstance(ours, dict):
        return ours.keys() == theirs.keys() and all(key == "digits" or same(ours[key], theirs[key]) for key in ours)
    if isinstance(ours, list):
        return len(ours) == len(theirs) and all(map(same, ours, theirs))
    if isinstance(ours, float) or isinstance(theirs, float):
        return math.isclose(ours, theirs, rel_tol=1e-12, abs_tol=1e-300)
    return ours == theirs


def main():
    words = [w for w in sys.argv[1:] if not w.startswith("--")]
    check = "--check" in sys.argv
    PLACE.mkdir(exist_ok=True)
    wrong = []
    for number in words or sorted(ALL):
        found = ALL[number]()
        path = PLACE / f"{number}.json"
        if check:
            if not same(found, json.loads(path.read_text())):
                wrong.append(number)
        else:
            path.write_text(json.dumps(found, indent=1, ensure_ascii=False) + "\n")
        for case in found["cases"]:
            print(case["case"], case["at"], [(a["name"], a["value"], a["digits"]) for a in case["asked"]], flush=True)
    if wrong:
        sys.exit(f"these differ from their files: {', '.join(wrong)}")


if __name__ == "__main__":
    main()
