"""A beam with a stop at its tip, and points of a test of it on the same axes: frequency over modal amplitude."""

import sys
from pathlib import Path

import nlmodes

CONFIGS = Path(__file__).parents[3] / "configs"


def main(figure="beam_with_test.svg", **overrides):
    computed = nlmodes.run(CONFIGS / "beam_hbm.toml", out=False)
    test = nlmodes.run(CONFIGS / "virtual_test.toml", out=False, **overrides)
    axes = computed.plot(x="modal_amplitude")
    test.plot(ax=axes, label="test")
    axes.legend()
    axes.figure.savefig(figure)
    return computed, test


if __name__ == "__main__":
    main(*sys.argv[1:])
