"""A recording in which a hand leads the arm twice."""

from pathlib import Path

import pytest

from app.api import run, session


@pytest.fixture(scope="session")
def led(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Free-drive, a way of 1.2 s, left; free-drive again, a way of 0.8 s with a pause, and the end."""
    free = [
        {"at": 0.2, "do": "press", "control": "free_drive"},
        {"after": "mode FREE_DRIVE", "delay": 0.1, "do": "release", "control": "free_drive"},
        {"after": "mode FREE_DRIVE", "delay": 0.3, "do": "hold", "for": 1.2, "carry": [0.1, 0.12, 0.05]},
        {"after": "mode FREE_DRIVE", "delay": 2.0, "do": "tap", "control": "leave_free_drive"},
        {"at": 5.4, "do": "press", "control": "free_drive"},
        {"after": "mode FREE_DRIVE", "nth": 2, "delay": 0.1, "do": "release", "control": "free_drive"},
        {"after": "mode FREE_DRIVE", "nth": 2, "delay": 0.2, "do": "hold", "for": 0.8, "carry": [-0.1, -0.08, 0.0]},
    ]
    told = session(
        {
            "title": "led twice",
            "duration": 7.8,
            "seed": 4,
            "settings": {"activation.period": 0.2, "sequence.period": 0.25},
            "timeline": free,
        }
    )
    folder = tmp_path_factory.mktemp("led")
    run(told, folder)
    return folder / "log.mcap"


@pytest.fixture(scope="session")
def idle(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A recording in which nobody touches the arm."""
    folder = tmp_path_factory.mktemp("idle")
    run(session({"title": "nobody", "duration": 0.2}), folder)
    return folder / "log.mcap"
