"""Let a part slip

A gripped part falls while the arm is guided. The arm, which goes on bearing it, rises, and is stopped.
"""

import sys

from matplotlib.figure import Figure

from pendant_sim import read, run

if __name__ == "__main__":
    outcome = run("part-slips", "12_a_part_slips")
    stopped = next(event for event in outcome.events if event.kind.value == "stopped_payload")
    log = read("12_a_part_slips/log.mcap", begin=0.002 * stopped.tick - 1.0, end=0.002 * stopped.tick + 1.0)
    figure = Figure(layout="constrained")
    above, below = figure.subplots(2, sharex=True)
    above.plot(log.t, log.truth["payload_mass"], label="true")
    above.plot(log.t, log.state["configured_mass"], label="told")
    above.set_ylabel("payload [kg]")
    above.legend()
    below.plot(log.t, 1000.0 * (log.truth["flange"][:, 2] - log.truth["flange"][0, 2]))
    below.set(xlabel="time [s]", ylabel="height of the flange [mm]")
    for axes in (above, below):
        axes.axvline(0.002 * stopped.tick, color="red")
    figure.savefig("12_a_part_slips.svg")
    sys.stdout.write(f"stopped: {stopped.values['mass']:.1f} kg went\n")
