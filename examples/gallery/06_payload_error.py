"""Try many payload errors

How wrong may the payload be before free-drive is refused? `run_many` runs sessions on all cores: seven payload errors, each in
so many postures as the command line says (5 where it says none).
"""

import sys

import numpy as np
from matplotlib.figure import Figure

from pendant_sim import run_many, session

if __name__ == "__main__":
    count, errors = int([*sys.argv, "5"][1]), np.linspace(-1.5, 1.5, 7)
    postures = np.add([0.0, -1.3, 1.6, -1.9, -1.6, 0.0], np.random.default_rng(1).uniform(-0.4, 0.4, (count, 6)))
    base = session({"title": "sweep", "duration": 2.8, "timeline": [{"at": 0.3, "do": "press", "control": "free_drive"}]})
    loads = [{"payload_true": {"mass": 2.0 + error}, "payload_configured": {"mass": 2.0}} for error in errors.tolist()]
    runs = run_many(session(base, posture=posture.tolist(), **load) for load in loads for posture in postures)
    refused = [100.0 * any(event.kind.startswith("refused") for event in run.events) for run in runs]
    shares = np.reshape(refused, (len(errors), count)).mean(axis=1)
    (axes := (figure := Figure()).add_subplot(xlabel="payload error [kg]", ylabel="refused [%]")).plot(errors, shares, "o-")
    figure.savefig("06_payload_error.svg")
    sys.stdout.write(f"refused [%]: {dict(zip(errors.tolist(), shares.tolist(), strict=True))}\n")
