"""Makes the figures of README and documentation anew, in `docs/images`.

    cargo build --release
    python3 docs/scripts/figures.py [NAME ...] [--cli target/release/nlmodes-cli] [--to docs/images]

Without names all of them but those of the work-precision study, which measures times for some minutes and is drawn by
`cargo run --release -p nlmodes-benchmarks --example work_precision -- docs/images`.
"""

import argparse
import pathlib
import shutil
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]

SKIP = ["continuation.internal_resonance='skip'"]

# Scene and what is set in it -> files of its results and the images that they are.
RUNS = [
    ("strip", [], {"responses": "first_beam_responses"}),
    ("strip_one_level", [], {"gradients_3": "strip_gradients"}),
    ("rod", [], {"frequency_energy": "rod_frequency_energy", "motion_4": "rod_motion_4"}),
    ("rod", ["method.harmonics=[1,2,3]"], {"frequency_energy": "tutorial_rod"}),
    ("rod", ["method.harmonics=[1,2,3,5,10]", *SKIP], {"frequency_energy": "tutorial_rod_skip"}),
    ("beam_methods", [], {"frequency_amplitude": "tutorial_beam"}),
    (
        "beam",
        ["method.harmonics=20", *SKIP, "continuation.frequency_hz=[39,53.5]", "continuation.max_energy_ratio=10"],
        {"frequency_energy": "beam_skip"},
    ),
    ("beam_responses", [], {"responses": "beam_responses"}),
    (
        "virtual_test",
        [],
        {"frequency_amplitude": "tutorial_test", "damping_amplitude": "tutorial_damping", "frequency_contact": "virtual_test"},
    ),
]

# Examples that write figures under the names of the images into a folder, with the package that they are of.
EXAMPLES = [
    ("nlmodes", "mass_redistribution", ["mass_redistribution"]),
    ("nlmodes", "stop_stiffness", ["stop_stiffness"]),
    ("nlmodes", "beam_comparison", ["beam_methods", "beam_histories"]),
]


def made_by_runs(cli, folder):
    """Yields image and file of all that a run makes; each scene is run when the first of its images is asked for."""
    for number, (scene, settings, files) in enumerate(RUNS):
        results = folder / str(number)

        def run(scene=scene, settings=settings, results=results):
            if not results.exists():
                options = [option for setting in settings for option in ("--set", setting)]
                subprocess.run([cli, "run", ROOT / "configs" / f"{scene}.toml", "--out", results, "--quiet", *options], stdin=subprocess.DEVNULL)
            return results

        for file, image in files.items():
            yield image, lambda run=run, file=file: run() / f"{file}.svg"
    yield "study_gap", lambda: study(cli, folder / "study") / "f_10mJ_over_gap_m.svg"


def study(cli, results):
    """Results of the study of the gap."""
    subprocess.run([cli, "study", "run", ROOT / "configs" / "gap_study.toml", "--out", results, "--quiet"], check=True)
    return results


def made_by_examples(folder):
    """Yields image and file of all that an example makes."""
    for package, example, images in EXAMPLES:
        results = folder / example

        def run(package=package, example=example, results=results):
            if not results.exists():
                results.mkdir()
                call = ["cargo", "run", "--release", "--locked", "-p", package, "--example", example, "--", results]
                subprocess.run(call, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
            return results

        for image in images:
            yield image, lambda run=run, image=image: run() / f"{image}.svg"

    def continuous_rod():
        file = folder / "continuous_rod.svg"
        call = ["cargo", "run", "--release", "--locked", "-p", "nlmodes-benchmarks", "--example", "continuous_rod", "--", file]
        subprocess.run(call, cwd=ROOT, check=True, stdout=subprocess.DEVNULL)
        return file

    yield "continuous_rod", continuous_rod


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("names", nargs="*", metavar="NAME", help="images without .svg; default: all")
    parser.add_argument("--cli", type=pathlib.Path, default=ROOT / "target/release/nlmodes-cli")
    parser.add_argument("--to", type=pathlib.Path, default=ROOT / "docs/images")
    arguments = parser.parse_args()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        made = {**dict(made_by_runs(arguments.cli.resolve(), folder)), **dict(made_by_examples(folder))}
        if unknown := set(arguments.names) - set(made):
            sys.exit(f"unknown: {', '.join(sorted(unknown))}; known are {', '.join(sorted(made))}")
        for name in arguments.names or made:
            shutil.copyfile(made[name](), arguments.to / f"{name}.svg")
            print(name)


if __name__ == "__main__":
    main()
