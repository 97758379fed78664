"""Responses of a beam with a stop at three levels of the force, phase resonance through their peaks, and damping of the nonlinear mode."""

import sys
from pathlib import Path

import nlmodes

CONFIGS = Path(__file__).parents[3] / "configs"


def main(figure="response_and_damped_mode.svg", **overrides):
    import matplotlib.pyplot as plt

    result = nlmodes.run(CONFIGS / "beam_responses.toml", out=False, **overrides)
    figure_, (above, below) = plt.subplots(2, figsize=(6.4, 7), layout="constrained")
    for branch in result:
        if branch.kind[0] in ("frequency", "phase-resonance"):
            branch.plot("frequency_hz", "drive_fundamental_m", ax=above)
        elif branch.kind[0] == "damped-mode":
            branch.plot("energy_j", "damping_ratio", ax=below)
    above.legend()
    figure_.savefig(figure)
    return result


if __name__ == "__main__":
    main(*sys.argv[1:])
