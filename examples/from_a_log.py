"""A recording read into numpy: the largest force, and where the flange was. Run: python -m examples.from_a_log"""

import sys
import tempfile
from pathlib import Path

import numpy as np

from pendant_sim import read, run, session

if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        run(session("hold", duration=3.0, expectations=[]), folder)
        log = read(Path(folder) / "log.mcap")
    force = np.linalg.norm(log.state["F_user"][:, :3], axis=1)
    at = int(force.argmax())
    sys.stdout.write(
        f"{force[at]:.1f} N at {log.t[at]:.3f} s, the flange at {np.round(log.truth['flange'][at, :3], 3).tolist()}\n"
    )
