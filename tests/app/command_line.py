"""The command `pendant`, run in the process of a test."""

import sys

import pytest

from app import cli


def pendant(monkeypatch: pytest.MonkeyPatch, *arguments: str) -> int:
    """Run it with these arguments; its exit code."""
    monkeypatch.setattr(sys, "argv", ["pendant", *arguments])
    with pytest.raises(SystemExit) as ended:
        cli.main()
    assert isinstance(ended.value.code, int)
    return ended.value.code
