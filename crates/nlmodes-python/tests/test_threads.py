"""Other threads go on while a branch is computed, two branches are computed at once, and Ctrl-C ends one within its step."""

import contextlib
import os
import random
import signal
import threading
import time

import nlmodes
import numpy as np
import pytest
from nlmodes import contact, continuation

CTRL_C = int(os.environ.get("NLMODES_CTRL_C", "8"))


@pytest.fixture
def long(rod):
    """A branch that takes some seconds."""
    rod["structure"]["elements"] = 60
    rod["method"]["harmonics"] = 60
    rod["continuation"] = {"max_energy_ratio": 1e3, "max_points": 100000}
    return rod


def test_another_thread_counts_on_while_a_branch_is_computed(long):
    counted, done = [0], threading.Event()

    def count():
        while not done.is_set():
            counted[0] += 1
            time.sleep(1e-3)

    def enough(points, frequency_hz, text):
        if points > 3:
            raise StopIteration

    counter = threading.Thread(target=count)
    counter.start()
    before, began = counted[0], time.perf_counter()
    with pytest.raises(StopIteration):
        nlmodes.run(long, progress=enough)
    elapsed = time.perf_counter() - began
    done.set()
    counter.join()
    # At least a quarter of what it counts alone, on a machine that others use too.
    assert counted[0] - before > 0.25 * elapsed / 1.5e-3 - 5, (counted, elapsed)


def test_branches_in_two_threads_are_those_of_one(rod):
    alone = [nlmodes.run(rod, method__harmonics=h).frequency_hz for h in (5, 9)]
    found = {}

    def run(h):
        found[h] = nlmodes.run(rod, method__harmonics=h).frequency_hz

    threads = [threading.Thread(target=run, args=(h,)) for h in (5, 9)]
    [thread.start() for thread in threads]
    [thread.join() for thread in threads]
    assert np.array_equal(found[5], alone[0]) and np.array_equal(found[9], alone[1])


@pytest.mark.skipif((os.cpu_count() or 1) < 2, reason="one core")
@pytest.mark.skipif(os.getloadavg()[0] > 2 * (os.cpu_count() or 1), reason="others leave no second core")
def test_two_threads_get_twice_the_processor_time_of_one(long):
    """Whoever waits for the interpreter gets no more than one does; a share, since others may compute on the machine."""

    def share(threads):
        def enough(points, frequency_hz, text):
            if time.perf_counter() - began > 0.5:
                raise StopIteration

        def run():
            # On a fast machine the branch may be there before.
            with contextlib.suppress(StopIteration):
                nlmodes.run(long, progress=enough)

        own = [threading.Thread(target=run) for _ in range(threads)]
        began, before = time.perf_counter(), time.process_time()
        [thread.start() for thread in own]
        [thread.join() for thread in own]
        return (time.process_time() - before) / (time.perf_counter() - began)

    # Under one lock no try comes near; others on the machine spoil some.
    assert any(share(2) > 1.5 * share(1) for _ in range(10))


def test_ctrl_c_at_any_instant_leaves_a_sane_state(long, tmp_path):
    """What is on disk is a branch or nothing, the next call works, and it ends soon."""
    times = random.Random(3)
    small = contact.solve([[2.0]], [-1.0])
    late, interrupted = [], 0
    for number in range(CTRL_C):
        out = tmp_path / str(number)
        timer = threading.Timer(times.uniform(0.0, 0.5), signal.raise_signal, [signal.SIGINT])
        asked = time.perf_counter()
        timer.start()
        try:
            nlmodes.run(long, out=out, progress=False)
            timer.join()
        except KeyboardInterrupt:
            interrupted += 1
            late.append(time.perf_counter() - asked - timer.interval)
        if (out / "branch.csv").is_file():
            left = nlmodes.read(out)
            assert all(np.isfinite(branch.frequency_hz).all() and not branch.complete for branch in left)
        assert np.array_equal(contact.solve([[2.0]], [-1.0]).lambda_, small.lambda_)
    assert interrupted == CTRL_C
    assert max(late) < 3.0, late


def test_ctrl_c_ends_a_branch_of_functions():
    timer = threading.Timer(0.2, signal.raise_signal, [signal.SIGINT])
    timer.start()
    with pytest.raises(KeyboardInterrupt):
        # A curve without an end.
        continuation.trace(lambda x, p: [x[0] - np.sin(p)], None, [0.0], 0.0, max_points=10**9)
    assert continuation.trace(lambda x, p: [x[0] - p], None, [0.0], 0.0, max_points=3).p.shape == (3,)
