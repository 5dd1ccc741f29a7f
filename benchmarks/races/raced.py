"""The app as `pendant serve --interfaces --record` serves it, in a process that changes its thread every SWITCH.

Its first line of standard output says where it is. It ends by SIGTERM. Whatever goes wrong is on its standard error.
"""

import json
import sys
from collections import deque
from itertools import islice
from pathlib import Path
from typing import Any

from app.robot_serving import Network
from app.serving import serve_until_interrupted
from app.session.prepare import prepare
from app.session.session_file import FIRST_START
from app.urscript.running.script_runner import KEPT, ScriptRunner
from app.urscript.running.told import Told
from app.web.tabs.script_tab import SHOWN

SWITCH = 2e-5  # [s]


class SharedTold(deque[Told]):
    """What scripts told, as it once was: the page goes through it while others append to it."""

    def __getitem__(self, key: Any) -> Any:
        """The last ones, one by one."""
        return [told for told in islice(reversed(self), SHOWN)]  # noqa: C416 - list() would not let go between two of them


def put_back() -> None:
    """Have the runner of scripts share a list that changes."""

    def tell(runner: ScriptRunner, told: Told) -> None:
        if not isinstance(runner.told, SharedTold):
            runner.told = SharedTold(maxlen=KEPT)  # type: ignore[assignment]
        runner.told.append(told)  # type: ignore[attr-defined]
        for listener in runner._listeners:
            listener(told)

    ScriptRunner.tell = tell  # type: ignore[method-assign]


def run(folder: Path, host: str, *, defect: bool) -> None:
    """Serve until SIGTERM; `defect` puts an old one back."""
    if defect:
        put_back()
    prepared = prepare(FIRST_START, "races")
    with serve_until_interrupted(
        prepared,
        host="127.0.0.1",
        port=0,
        usual=0,
        open_browser=False,
        record=folder,
        network=Network(host),
    ) as serving:
        sys.setswitchinterval(SWITCH)
        assert serving.interfaces is not None
        print(json.dumps({"url": serving.site.url, "token": serving.interfaces.token}), flush=True)


if __name__ == "__main__":
    run(Path(sys.argv[1]), sys.argv[2], defect=sys.argv[3:] == ["defect"])
