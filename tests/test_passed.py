"""A run is left out only where nothing that it depends on has changed since it passed."""

from pathlib import Path

import pytest

from tests import passed
from tests.app.session.test_claims import ROOTS
from tests.passed import imported, left_out_where_passed

FILES = {
    "app/__init__.py": "",
    "app/run.py": "def run():\n    from sim.tick import step\n    return step()\n",
    "app/page.py": "COLOUR = 1\n",
    "sim/__init__.py": "",
    "sim/tick.py": "from .kernel import force\n\n\ndef step():\n    return force()\n",
    "sim/kernel.py": "def force():\n    return 1.0\n",
    "assets/robots/arm.yaml": "mass: 1\n",
    "assets/sessions/other.yaml": "seed: 1\n",
    "assets/page/page.css": "",
}


@pytest.fixture
def product(tmp_path: Path) -> Path:
    for name, text in FILES.items():
        (tmp_path / name).parent.mkdir(parents=True, exist_ok=True)
        (tmp_path / name).write_text(text)
    return tmp_path


def runs(product: Path, own: str = "seed: 1", *, fails: bool = False, whole: bool = False) -> bool:
    """Whether a run that may be left out is done."""
    passed.shared.cache_clear()
    done = False
    try:
        with left_out_where_passed("one", ("app.run",), own, top=product, folder=product / "out", whole=whole):
            done = True
            if fails:
                raise AssertionError
    except (AssertionError, pytest.skip.Exception):
        pass
    return done


def test_what_passed_is_left_out_and_run_again_when_all_are_asked_for(product: Path) -> None:
    assert runs(product)
    assert not runs(product)
    assert runs(product, whole=True)
    assert not runs(product)


def test_a_run_that_fails_writes_no_digest_and_takes_the_one_away(product: Path) -> None:
    assert runs(product, fails=True)
    assert runs(product)
    assert runs(product, fails=True, whole=True)
    assert runs(product)


@pytest.mark.parametrize("name", ["app/run.py", "sim/tick.py", "sim/kernel.py", "sim/__init__.py", "assets/robots/arm.yaml"])
def test_a_change_of_what_it_calls_by_others_or_reads_runs_it_again(product: Path, name: str) -> None:
    assert runs(product)
    (product / name).write_text(FILES[name] + "# changed\n")
    assert runs(product)
    assert not runs(product)


@pytest.mark.parametrize("name", ["app/page.py", "assets/sessions/other.yaml", "assets/page/page.css"])
def test_a_change_of_what_it_does_not_use_does_not(product: Path, name: str) -> None:
    assert runs(product)
    (product / name).write_text(FILES[name] + "# changed\n")
    assert not runs(product)


def test_another_seed_or_another_package_runs_it_again(product: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    assert runs(product)
    assert runs(product, "seed: 2")
    assert not runs(product, "seed: 2")
    monkeypatch.setattr(passed, "distributions", list)
    assert runs(product, "seed: 2")


def test_claims_depend_on_the_whole_chain_of_a_session() -> None:
    files = {path.relative_to(passed.ROOT).as_posix() for path in imported(ROOTS)}
    for name in (
        "sim/simulation.py",
        "sim/plant/joint_friction.py",
        "pendant/supervisor.py",
        "app/session/measures.py",
        "tests/golden.py",
        "tests/app/session/test_claims.py",
    ):
        assert name in files
    assert not any(name.startswith("app/web/") for name in files)
