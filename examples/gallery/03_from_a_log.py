"""Read a recording into numpy

The force of the user, as it was and as the controller sensed it. `read` opens a recording of any length; a column is read when
it is asked for.
"""

import sys

import numpy as np
from matplotlib.figure import Figure

from pendant_sim import read, run, session

if __name__ == "__main__":
    run(session("hold", duration=3.0, expectations=[]), "03_from_a_log")
    log = read("03_from_a_log/log.mcap")
    sensed, true = (np.linalg.norm(force, axis=1) for force in (log.state["F_user"][:, :3], log.truth["touch_force"]))
    at = int(sensed.argmax())
    axes = (figure := Figure(layout="constrained")).add_subplot(xlabel="time [s]", ylabel="force of the user [N]")
    axes.plot(log.t, true, label="true")
    axes.plot(log.t, sensed, label="sensed", linewidth=0.8)
    axes.legend()
    figure.savefig("03_from_a_log.svg")
    sys.stdout.write(f"{sensed[at]:.1f} N at {log.t[at]:.3f} s, the flange at {log.truth['flange'][at, :3].round(3)}\n")
