"""Step a simulation by hand

The arm is freed and its flange pushed. `step` does ticks of 2 ms with the buttons and hands that it is given. Between the steps
everything can be read.
"""

import sys

import numpy as np
from matplotlib.figure import Figure

from pendant_sim import Button, Push, session, step, stepped

PUSH = Push("flange", (0.0, 0.0, 0.0), (0.0, 15.0, 0.0))  # 15 N along y

if __name__ == "__main__":
    simulation = stepped(session({"title": "by hand", "duration": 1.0, "settings": {"activation.period": 0.2}}))
    step(simulation, 700, held=[Button.FREE_DRIVE])
    ways = [np.zeros(3)]
    start = simulation.snapshot().truth_links[-1, :3].copy()
    for k in range(60):
        step(simulation, 10, held=[Button.FREE_DRIVE], touches=[PUSH] if k < 10 else [])
        ways.append(simulation.snapshot().truth_links[-1, :3] - start)
    axes = (figure := Figure(layout="constrained")).add_subplot(xlabel="time [s]", ylabel="way of the flange [mm]")
    axes.plot(0.02 * np.arange(len(ways)), 1000.0 * np.array(ways), label=["x", "y", "z"])
    axes.axvspan(0.0, 0.2, alpha=0.15, label="pushed")
    axes.legend()
    figure.savefig("02_by_hand.svg")
    sys.stdout.write(f"{simulation.snapshot().decision.mode}: the flange went {1000 * float(np.linalg.norm(ways[-1])):.0f} mm\n")
