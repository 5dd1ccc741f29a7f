"""Push towards a virtual wall

The arm is pushed with and without the resistance before the wall. A session is also made of its fields. Fields that follow a
session replace those of it.
"""

import sys

from matplotlib.figure import Figure

from pendant_sim import read, run, session

if __name__ == "__main__":
    axes = (figure := Figure(layout="constrained")).add_subplot(xlabel="time [s]", ylabel="way towards the wall [m]")
    for resists in (True, False):
        settings = {**session("wall-resists").settings, "walls.resistance": resists}
        folder = f"07_walls/{'with' if resists else 'without'}"
        run(session("wall-resists", settings=settings, expectations=[]), folder)
        log = read(f"{folder}/log.mcap")
        way = log.truth["flange"][:, 1] - log.truth["flange"][0, 1]
        axes.plot(log.t, way, label=f"{folder.partition('/')[2]} resistance")
        sys.stdout.write(f"{folder.partition('/')[2]} resistance: {1000 * way.max():.0f} mm\n")
    axes.legend()
    figure.savefig("07_walls.svg")
