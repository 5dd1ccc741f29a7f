"""Watch a joint learn its friction

True friction falls by 40 %, and seconds of work teach the controller that. Two encoders and the motor current of a flexible
joint tell what its friction is; the controller feeds it forward.
"""

import sys

import numpy as np
from matplotlib.figure import Figure

from pendant_sim import read, run

if __name__ == "__main__":
    run("control-friction-learned", "09_friction")
    log = read("09_friction/log.mcap")
    estimated, true = log.state["friction"][:, 0], log.truth["friction"][:, 0]
    axes = (figure := Figure(layout="constrained")).add_subplot(xlabel="time [s]", ylabel="friction of the base joint [N·m]")
    axes.plot(log.t, true, label="true")
    axes.plot(log.t, estimated, label="estimated", linewidth=0.8)
    axes.legend()
    figure.savefig("09_friction.svg")
    error = np.abs(estimated - true)
    early, late = (float(np.median(error[(log.t >= begin) & (log.t < begin + 1.0)])) for begin in (0.5, 6.5))
    sys.stdout.write(f"error in the median: {early:.2f} N·m in the first second of motion, {late:.2f} N·m six seconds later\n")
