"""Fig. 3 b of the paper: frequency over energy of a rod whose tip meets a stop, with one, two and three harmonics."""

import sys
from pathlib import Path

import nlmodes

CONFIGS = Path(__file__).parents[3] / "configs"


def main(figure="rod_fig_3b.svg"):
    result = nlmodes.run(CONFIGS / "rod.toml", out=False, method__harmonics=[1, 2, 3])
    axes = result.plot()
    axes.figure.savefig(figure)
    return result


if __name__ == "__main__":
    main(*sys.argv[1:])
