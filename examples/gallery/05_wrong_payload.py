"""Free an arm with a wrong payload

The flange sensor feels 2 kg that the controller does not know. Freed, the arm would fall; so it stays held, and the event says
why.
"""

import sys

import numpy as np
from matplotlib.figure import Figure

from pendant_sim import read, run

if __name__ == "__main__":
    outcome = run("wrong-payload", "05_wrong_payload")
    refused = next(event for event in outcome.events if event.kind.value == "refused_payload")
    log = read("05_wrong_payload/log.mcap")
    axes = (figure := Figure(layout="constrained")).add_subplot(xlabel="time [s]", ylabel="force that nothing explains [N]")
    axes.plot(log.t, np.linalg.norm(log.state["F_user"][:, :3], axis=1), label="as sensed")
    axes.axhline(2.0 * 9.81, color="gray", linestyle=":", label="weight of 2 kg")
    axes.axvline(0.002 * refused.tick, color="red", label="refused")
    axes.legend()
    figure.savefig("05_wrong_payload.svg")
    sys.stdout.write(f"refused after {0.002 * refused.tick - 0.5:.2f} s: {refused.values['mass']:.2f} kg would explain it\n")
