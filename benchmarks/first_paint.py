"""How soon a browser shows something: a picture of the arm after it asks, the page after `pendant serve`, then the arm itself.

Chromium draws in software. Each case starts a server of its own and a window without a cache; the program is installed.
"""

import socket
import subprocess
import sys
import time
import urllib.request
from collections.abc import Iterator
from contextlib import contextmanager

from playwright.sync_api import sync_playwright

from benchmarks.common import Report, main
from tests.e2e.conftest import FLAGS, chromium_path

PAINT, SERVED = 3.0, 6.0
"""Bars: after the browser asks, and after the start of the program [s]."""

COMMAND = "from app.cli import main; main()"

SEEN = """() => new Promise((done) => {
  const look = () => {
    const picture = document.querySelector("img[alt*='robot arm']");
    const paint = performance.getEntriesByName("first-contentful-paint")[0];
    if (picture && picture.complete && picture.getBoundingClientRect().width > 50 && paint) done(paint.startTime);
    else requestAnimationFrame(look);
  };
  look();
})"""
"""When the first content was painted, once the picture of the arm is there [ms]."""


@contextmanager
def serving(port: int) -> Iterator[None]:
    """`pendant serve` in a process of its own."""
    process = subprocess.Popen(
        [sys.executable, "-c", COMMAND, "serve", "--port", str(port), "--fresh"],
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
    )
    try:
        yield
    finally:
        process.terminate()
        process.wait()


def free_port() -> int:
    """One that nobody listens at."""
    with socket.socket() as one:
        one.bind(("127.0.0.1", 0))
        return int(one.getsockname()[1])


def answered(url: str) -> None:
    """Wait until the page is served."""
    end = time.monotonic() + 60.0
    while True:
        try:
            urllib.request.urlopen(url, timeout=5.0).close()
            return
        except OSError:
            assert time.monotonic() < end, f"{url}: no answer"
            time.sleep(0.02)


def measure(report: Report) -> None:
    """Fill the report."""
    served, painted, alive = [], [], []
    with sync_playwright() as playwright:
        browser = playwright.chromium.launch(executable_path=chromium_path(), args=list(FLAGS))
        for _ in range(10 if report.options.full else 3):
            port = free_port()
            url = f"http://127.0.0.1:{port}/"
            start = time.perf_counter()
            with serving(port):
                answered(url)
                page = browser.new_context(viewport={"width": 1440, "height": 900}).new_page()
                asked = time.perf_counter()
                page.goto(url, wait_until="commit")
                painted.append(float(page.evaluate(SEEN)) / 1000.0)
                served.append(asked - start + painted[-1])
                page.get_by_role("button", name="EMERGENCY STOP").wait_for(timeout=60_000)
                page.locator("#pd-opening").wait_for(state="detached", timeout=60_000)
                alive.append(time.perf_counter() - asked)
                page.context.close()
        browser.close()
    count = len(served)
    report.row("first paint with a picture of the arm, after the browser asks, worst", max(painted), "s", n=count, at_most=PAINT)
    report.row("page shown after the start of pendant serve, worst", max(served), "s", n=count, at_most=SERVED)
    report.row("the arm itself and its pendant, after the browser asks, worst", max(alive), "s", n=count)


if __name__ == "__main__":
    main("first_paint", measure)
