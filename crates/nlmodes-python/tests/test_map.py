"""Studies by executors of others, fits, and what is followed over a parameter."""

import os
import signal
import threading
import time
from concurrent.futures import ProcessPoolExecutor, ThreadPoolExecutor
from multiprocessing import get_context

import nlmodes
import numpy as np
import pytest

#: A rod before an elastic stop, driven at its end.
RESPONSE = {
    "structure": {
        "kind": "rod",
        "length_m": 1.0,
        "elements": 4,
        "start": "clamped",
        "material": {"youngs_modulus_pa": 210e9, "density_kg_m3": 7800.0},
        "section": {"area_m2": 1e-4},
    },
    "contact": [{"at_m": 1.0, "direction": "axial", "side": "positive", "gap_m": 1e-3, "stiffness_n_m": 3e7}],
    "damping": {"ratio": 0.02},
    "force": [{"at_m": 1.0, "direction": "axial"}],
    "response": [{"kind": "frequency", "frequency_hz": [1000.0, 2200.0], "levels_n": [2000.0]}],
    "method": {"harmonics": 3},
    "output": {"stability": "never"},
}


@pytest.fixture
def study(tmp_path):
    (tmp_path / "scene.toml").write_text(nlmodes._native.toml_of(RESPONSE))
    (tmp_path / "study.toml").write_text(
        nlmodes._native.toml_of(
            {
                "scene": "scene.toml",
                "design": {"kind": "sobol", "samples": 8},
                "vary": [{"key": "contact.0.gap_m", "name": "gap_m", "uniform": [0.8e-3, 1.2e-3]}],
                "quantity": [{"name": "peak", "of": "peak"}, {"name": "jump", "of": "jump_up_hz"}, {"name": "force", "of": "max_force"}],
            }
        )
    )
    return tmp_path / "study.toml"


def bits(made):
    return (made.directory / "study.csv").read_bytes()


def test_responses_by_threads_and_processes_are_those_of_a_run(study, tmp_path):
    own = nlmodes.Study(study, out=tmp_path / "own")
    assert own.run(jobs=1).complete
    with ThreadPoolExecutor(2) as workers:
        threads = nlmodes.Study(study, out=tmp_path / "threads")
        table = threads.map(workers)
    assert table.complete and np.all(table.force > 0.0)
    with ProcessPoolExecutor(2, mp_context=get_context("spawn")) as workers:
        processes = nlmodes.Study(study, out=tmp_path / "processes")
        assert processes.map(workers, chunks=3).complete
    assert bits(own) == bits(threads) == bits(processes)


class Lost:
    """An executor whose worker is lost in the middle."""

    def __init__(self, after):
        self.left = after

    def submit(self, function, /, *arguments):
        self.left -= 1
        lost = self.left < 0

        class Future:
            def result(self):
                if lost:
                    raise OSError("the worker is gone")
                return function(*arguments)

        return Future()


def test_a_lost_worker_loses_no_other_case_and_a_later_call_goes_on(study, tmp_path):
    own = nlmodes.Study(study, out=tmp_path / "own")
    own.run(jobs=1)
    made = nlmodes.Study(study, out=tmp_path / "lost")
    with pytest.raises(nlmodes.RunError, match="5 of 8 calls have failed 2 times; the last one said OSError: the worker is gone"):
        made.map(Lost(3), attempts=2)
    assert made.status()["complete"] == 3
    with ThreadPoolExecutor(1) as workers:
        assert made.map(workers).complete
    assert bits(made) == bits(own)


def test_a_dask_cluster_that_loses_a_worker_gives_the_same_bits(study, tmp_path):
    distributed = pytest.importorskip("distributed")
    own = nlmodes.Study(study, out=tmp_path / "own")
    own.run(jobs=1)
    made = nlmodes.Study(study, out=tmp_path / "dask")
    with distributed.LocalCluster(n_workers=2, threads_per_worker=1, processes=True, dashboard_address=None) as cluster:
        with distributed.Client(cluster) as client:
            pids = list(client.run(os.getpid).values())

            def kill():
                while made.status()["complete"] < 2:
                    time.sleep(0.01)
                os.kill(pids[0], signal.SIGKILL)

            killing = threading.Thread(target=kill)
            killing.start()
            table = made.map(client)
            killing.join()
    assert table.complete and bits(made) == bits(own)


def test_a_gap_is_fitted_to_points_of_a_curve(rod, tmp_path):
    del rod["method"]["mass_redistribution"]
    made = nlmodes.run(rod, out=False, **{"contact.0.gap_m": 1.05e-3})
    rows = zip(made.energy_j[2:10].tolist(), made.frequency_hz[2:10].tolist())
    points = tmp_path / "points.csv"
    points.write_text("energy_j,frequency_hz,frequency_hz_std\n" + "".join(f"{e!r},{f!r},0.1\n" for e, f in rows))
    study = {
        "scene": rod,
        "fit": {"measured": str(points), "over": "energy_j"},
        "vary": [{"key": "contact.0.gap_m", "name": "gap_m"}],
    }
    found = nlmodes.Study(study).fit()
    assert found.values["gap_m"] == pytest.approx(1.05e-3, rel=1e-5) and 0.0 < found.std["gap_m"] < 1e-3
    assert found.covariance.shape == (1, 1) and found.covariance[0, 0] == pytest.approx(found.std["gap_m"] ** 2)
    assert len(found.points) == 8 and np.all(abs(found.points.fitted - found.points.measured) < 0.01)
    assert found.overrides == [f"contact.0.gap_m={found.values['gap_m']!r}"] and "gap_m = 0.00105" in repr(found)
    with pytest.raises(nlmodes.SceneError):
        nlmodes.Study({name: table for name, table in study.items() if name != "fit"}).fit()


def test_folds_and_resonances_are_followed_over_a_gap(tmp_path):
    curves = nlmodes.follow(RESPONSE, "contact.0.gap_m", (0.9e-3, 1.1e-3), out=tmp_path / "out")
    assert len(curves) == 2 and all(curve.complete for curve in curves) and (tmp_path / "out/follow_frequency.svg").is_file()
    for curve in curves:
        assert curve.value[0] == pytest.approx(0.9e-3) and curve.value[-1] == pytest.approx(1.1e-3)
        slope = np.polynomial.Polynomial.fit(curve.value, curve.frequency_hz, 4).deriv()
        np.testing.assert_allclose(curve.d_frequency_d_value, slope(curve.value), rtol=2e-2)
    resonance = {**RESPONSE, "response": [{"kind": "phase-resonance", "levels_n": [2000.0]}]}
    (curve,) = nlmodes.follow(resonance, "contact.0.gap_m", (0.9e-3, 1.1e-3), of="resonance")
    there = nlmodes.run(resonance, out=False, **{"contact.0.gap_m": 1.1e-3})
    assert curve.frequency_hz[-1] == pytest.approx(there.frequency_hz[-1], rel=1e-8)
    with pytest.raises(ValueError, match="resonance"):
        nlmodes.follow(RESPONSE, "contact.0.gap_m", (0.9e-3, 1.1e-3), of="fall")
    with pytest.raises(nlmodes.SceneError, match="outside of"):
        nlmodes.follow(RESPONSE, "contact.0.gap_m", (2e-3, 3e-3))
