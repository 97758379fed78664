"""The command line of the package beside that of the workspace."""

import os
import subprocess
import sys
import sysconfig
from pathlib import Path

import pytest
from nlmodes._native import toml_of

NAMES = [
    [str(Path(sysconfig.get_path("scripts")) / "nlmodes")],
    [str(Path(sysconfig.get_path("scripts")) / "nlmodes-cli")],
    [sys.executable, "-m", "nlmodes"],
]


def call(program, *arguments, cwd):
    return subprocess.run([*program, *arguments], cwd=cwd, capture_output=True, text=True, check=False)


@pytest.mark.parametrize("program", NAMES)
def test_results_are_those_of_the_program(program, rod, tmp_path):
    (tmp_path / "rod.toml").write_text(toml_of(rod))
    own = call(program, "run", "rod.toml", "--out", "own", "--quiet", cwd=tmp_path)
    other = call([os.environ["NLMODES_CLI"]], "run", "rod.toml", "--out", "other", "--quiet", cwd=tmp_path)
    assert (own.returncode, other.returncode) == (0, 0), own.stderr + other.stderr
    for table in ["branch.csv", "contacts.csv"]:
        assert (tmp_path / "own" / table).read_bytes() == (tmp_path / "other" / table).read_bytes()


@pytest.mark.parametrize("program", NAMES)
def test_what_is_wrong_is_said_with_status_2(program, rod, tmp_path):
    (tmp_path / "rod.toml").write_text(toml_of(rod).replace("gap_m", "gapp_m"))
    outcome = call(program, "check", "rod.toml", cwd=tmp_path)
    assert outcome.returncode == 2 and "gapp_m" in outcome.stderr, outcome.stderr
    outcome = call(program, "rnu", "rod.toml", cwd=tmp_path)
    assert outcome.returncode == 2 and "run" in outcome.stderr, outcome.stderr
    assert call(program, "--version", cwd=tmp_path).stdout.startswith("nlmodes-cli ")


def test_a_job_of_slurm_calls_the_program_that_wrote_it(rod, tmp_path):
    (tmp_path / "rod.toml").write_text(toml_of(rod))
    (tmp_path / "study.toml").write_text(
        'scene = "rod.toml"\n[design]\nkind = "grid"\n[[vary]]\nkey = "contact.0.gap_m"\nvalues = [1e-3, 2e-3]\n'
        '[[quantity]]\nname = "f"\nof = "frequency_hz"\nat = { energy_ratio = 2.0 }\n'
    )
    program = NAMES[1]
    outcome = call(program, "study", "slurm", "study.toml", "--script", "job.sbatch", cwd=tmp_path)
    assert outcome.returncode == 0, outcome.stderr
    assert program[0] in (tmp_path / "job.sbatch").read_text()
