"""`pendant serve` as a process of its own: it says where the page is, serves it, and ends politely."""

import re
import signal
import subprocess
import sys
import urllib.request
from collections.abc import Iterator
from pathlib import Path

import pytest

from app.log_reading.reader import read

COMMAND = [sys.executable, "-u", "-c", "from app.cli import main; main()", "serve"]


@pytest.fixture
def cell(tmp_path: Path) -> Path:
    path = tmp_path / "cell.yaml"
    path.write_text("robot: ur10e\nsettings: {free_drive.period: 5}\nworld: table\nmounting: wall\n")
    return path


@pytest.fixture
def served(cell: Path) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """The process, and the line that says where the page is."""
    options = ["--config", str(cell), "--port", "0", "--record", str(cell.parent / "logs")]
    process = subprocess.Popen([*COMMAND, *options], stdout=subprocess.PIPE, text=True)
    assert process.stdout is not None
    line = next(line for line in process.stdout if line.startswith("Serving"))
    yield process, line
    process.kill()
    process.wait()


def test_the_page_is_where_it_says_and_records_until_the_end_is_asked_for(
    served: tuple[subprocess.Popen[str], str], cell: Path
) -> None:
    process, line = served
    address = re.search(r"http://127\.0\.0\.1:\d+", line)
    assert address is not None
    assert "ur10e" in line
    with urllib.request.urlopen(address[0]) as page:
        assert page.status == 200
    process.send_signal(signal.SIGTERM)
    assert process.wait(timeout=30) == 0
    (path,) = (cell.parent / "logs").iterdir()
    log = read(path)
    assert log.whole
    assert log.arm.name == "ur10e"
    assert log.settings[0][1]["free_drive.period"] == 5.0
    assert len(log.ticks) > 0


def test_a_taken_port_is_refused_only_where_it_was_asked_for(served: tuple[subprocess.Popen[str], str]) -> None:
    taken = re.search(r":(\d+)", served[1].partition("//")[2])
    assert taken is not None
    again = subprocess.run([*COMMAND, "--port", taken[1]], capture_output=True, text=True, check=False, timeout=60)
    assert again.returncode == 2
    assert again.stderr == f"pendant: serve: --port = {taken[1]}: a port that is free\n"
