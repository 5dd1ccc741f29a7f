"""Run a session

The arm is freed, pushed and left alone. A session is a file that says what is simulated, what happens when, and what is
expected. `run` takes the name of a bundled one.
"""

import sys

from matplotlib.figure import Figure

from pendant_sim import read, run

if __name__ == "__main__":
    outcome = run("free-drive", "01_run_a_session")
    log = read("01_run_a_session/log.mcap")
    met = sum(verdict.passed for verdict in outcome.verdicts)
    axes = (figure := Figure(layout="constrained")).add_subplot(xlabel="time [s]", ylabel="flange in B [m]")
    axes.plot(log.t, log.state["p_BF"], label=["x", "y", "z"])
    for begin, mode in outcome.modes:
        axes.axvline(begin, color="gray", linestyle=":")
        axes.text(begin, axes.get_ylim()[1], mode.value, rotation=90, va="top", fontsize=8)
    axes.legend()
    figure.savefig("01_run_a_session.svg")
    sys.stdout.write(f"{met} of {len(outcome.verdicts)} expectations are met; {len(outcome.events)} events\n")
