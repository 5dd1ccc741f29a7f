"""Leave the free arm alone

While a hand moves the arm no period runs. When nobody does, the restart period begins, and at its end the arm is held again.
"""

import sys

from matplotlib.figure import Figure

from pendant_sim import read, run

if __name__ == "__main__":
    outcome = run("left-alone", "04_left_alone")
    log = read("04_left_alone/log.mcap")
    told = {event.kind.value: event.tick * 0.002 for event in outcome.events}
    axes = (figure := Figure(layout="constrained")).add_subplot(xlabel="time [s]", ylabel="speed of the tool [m/s]")
    axes.plot(log.t, log.state["v_tcp"])
    axes.axvspan(told["restarted"], told["left_restart"], alpha=0.2, label="restart period")
    axes.axvline(told["left_restart"], color="red", label="free-drive ends")
    axes.legend()
    figure.savefig("04_left_alone.svg")
    sys.stdout.write(f"left alone at {told['restarted']:.2f} s, held again at {told['left_restart']:.2f} s\n")
