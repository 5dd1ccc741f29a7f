"""A simulated hand gives 20 guided demonstrations, each recorded. Run: python -m examples.learning.demonstrate out/hands

Then: pendant export out/hands --out out/demonstrations --pictures
"""

import sys
from pathlib import Path

import numpy as np

from pendant_sim import Session, run, session

COUNT = 20
WAYS, WAY = 3, 1.8  # ways of a demonstration, one after the other, and the length of each [s]


def demonstration(seed: int) -> Session:
    """From a posture of its own a hand carries the flange to three places, the last of them near a shelf."""
    rng = np.random.default_rng(seed)
    home = np.array([0.0, -1.2, 1.5, -1.87, -1.57, 0.0]) + rng.uniform(-0.2, 0.2, 6)
    timeline = [
        {"at": 0.3, "do": "press", "control": "free_drive"},
        {"after": "mode FREE_DRIVE", "delay": 0.2, "do": "release", "control": "free_drive"},
    ]
    ways = np.array([[0.05, 0.15, 0.0], [0.0, 0.05, 0.12], [0.12, 0.05, -0.05]]) + rng.uniform(-0.04, 0.04, (WAYS, 3))
    for k, way in enumerate(ways.tolist()):
        timeline.append({"after": "mode FREE_DRIVE", "delay": 0.5 + k * WAY, "do": "hold", "for": WAY, "carry": way})
    fields = {"title": f"demonstration {seed}", "duration": 9.0, "posture": home.tolist(), "seed": seed, "timeline": timeline}
    return session({**fields, "settings": {"activation.period": 0.2, "sequence.period": 0.25}})


def main() -> None:
    """Record them into the folder that the command line names."""
    if len(sys.argv) not in (2, 3):
        sys.exit("python -m examples.learning.demonstrate FOLDER [COUNT]")
    folder, count = Path(sys.argv[1]), int(sys.argv[2]) if len(sys.argv) == 3 else COUNT
    for seed in range(count):
        outcome = run(demonstration(seed), folder / f"{seed:02d}")
        modes = ", ".join(mode.value for _, mode in outcome.modes)
        sys.stdout.write(f"{seed:2d}: {modes}\n")


if __name__ == "__main__":
    main()
