"""Drive into a table

The true force on the tool, with the protective stop and without it.
"""

import sys

import numpy as np
from matplotlib.figure import Figure

from pendant_sim import read, run, session

DOWN = {"kind": "linear", "position": [-0.6283, -0.1334, -0.16], "quaternion": [0.0, 0.7071, 0.7071, 0.0], "speed": 0.25}
FIELDS = {
    "title": "into the table",
    "tool": "sphere",
    "world": "table",
    "duration": 4.0,
    "program": {"name": "down", "steps": [{**DOWN, "acceleration": 1.0}]},
    "timeline": [{"at": 0.3, "do": "program", "command": "start"}],
}

if __name__ == "__main__":
    axes = (figure := Figure(layout="constrained")).add_subplot(xlabel="time [s]", ylabel="true force on the tool [N]")
    for stops in (True, False):
        name = "with" if stops else "without"
        run(session(FIELDS, settings={"collision.on": stops}), f"11_a_collision/{name}")
        log = read(f"11_a_collision/{name}/log.mcap")
        force = log.truth["contact_tool"]
        axes.plot(log.t, force, label=f"{name} the protective stop")
        sys.stdout.write(f"{name} the stop: {force[np.flatnonzero(force)[0] + 10 :].max():.0f} N after the first 20 ms\n")
    axes.legend()
    figure.savefig("11_a_collision.svg")
