"""`pendant_sim`, the command and the plugin of pytest: each by itself, and in a project that has folders of the same names."""

import os
import subprocess
import sys
from pathlib import Path

import pytest

import pendant_sim
from app.commands.command_exit import run_command_line
from app.commands.run_command import run_
from app.engine.spreading import spread
from app.files import extras
from pendant_sim.ours import hidden


def python(folder: Path, *arguments: str) -> subprocess.CompletedProcess[str]:
    """Python in a project of somebody else, whose folder is found first."""
    environment = {**os.environ, "PYTHONPATH": str(folder)}
    return subprocess.run([sys.executable, *arguments], cwd=folder, env=environment, capture_output=True, text=True, check=False)


@pytest.fixture(params=["app", "assets"])
def project(request: pytest.FixtureRequest, tmp_path: Path) -> Path:
    """A project with a package of a name that the product uses, too."""
    (tmp_path / request.param).mkdir()
    (tmp_path / request.param / "__init__.py").write_text("mine = True\n")
    (tmp_path / "test_mine.py").write_text(f"import {request.param}\n\ndef test_mine():\n    assert {request.param}.mine\n")
    return tmp_path


def test_each_name_is_there() -> None:
    assert all(callable(getattr(pendant_sim, name)) for name in pendant_sim.__all__)
    with pytest.raises(AttributeError, match="nothing"):
        _ = pendant_sim.nothing


def test_nothing_hides_the_product_here() -> None:
    assert hidden() is None


def test_the_import_alone_loads_nothing_of_the_product(tmp_path: Path) -> None:
    look = "import pendant_sim, pendant_sim.pytest_plugin, sys; print('app' in sys.modules, 'numpy' in sys.modules)"
    assert python(tmp_path, "-c", look).stdout == "False False\n"


def test_another_folder_of_the_name_is_told_in_one_line(project: Path) -> None:
    said = python(project, "-c", "from pendant_sim import run")
    assert said.returncode == 1
    line = said.stderr.strip().splitlines()[-1]
    assert line.startswith("ImportError: ")
    assert str(project) in line
    command = python(project, "-m", "pendant_sim.start", "robots")
    assert command.returncode == 1
    assert command.stderr.startswith(f"pendant: {project}")
    assert len(command.stderr.splitlines()) == 1


def test_the_tests_of_such_a_project_run_as_before(project: Path) -> None:
    said = python(project, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_mine.py")
    assert said.returncode == 0, said.stdout


def test_the_fixture_needs_no_import(tmp_path: Path) -> None:
    (tmp_path / "test_robot.py").write_text("def test_it(robot):\n    assert robot.state()['tick'] > 0\n")
    said = python(tmp_path, "-m", "pytest", "-q", "-p", "no:cacheprovider", "test_robot.py")
    assert said.returncode == 0, said.stdout


def test_a_study_that_is_not_there_is_bad_input(tmp_path: Path) -> None:
    with pytest.raises(pendant_sim.BadInput, match="nowhere"):
        pendant_sim.sweep("nowhere", tmp_path)


@pytest.mark.parametrize(
    ("module", "command", "extra"),
    [
        ("pyarrow.csv", "sweep", "studies"),
        ("pyarrow.csv", "fit", "logs"),
        ("matplotlib.figure", "against", "logs"),
        ("pyarrow.parquet", "export", "learning"),
        ("uvicorn", "robot", "network"),
        ("mcap_ros2.decoder", "", "logs"),
        ("matplotlib", "run", "report"),
    ],
)
def test_a_command_without_its_extra_says_what_to_install(
    module: str, command: str, extra: str, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    import typer

    app = typer.Typer()

    @app.callback()
    def begin() -> None:
        pass

    @app.command(command or "against")
    def needs() -> None:
        raise ModuleNotFoundError(f"No module named {module!r}", name=module)

    monkeypatch.setattr(sys, "argv", ["pendant", command or "against"])
    with pytest.raises(SystemExit) as ended:
        run_command_line(app)
    assert ended.value.code == 2
    said = capsys.readouterr().err
    assert said.endswith(f"not installed: pip install 'pendant-sim[{extra}]'\n")
    assert len(said.splitlines()) == 1


def test_what_no_extra_has_is_an_error_of_ours() -> None:
    assert extras.to_install("numpy") is None
    assert extras.to_install(None) is None


def test_each_extra_is_one_of_the_project() -> None:
    import tomllib

    project = tomllib.loads((Path(__file__).parents[2] / "pyproject.toml").read_text())["project"]
    offered = {name: " ".join(needed).lower().replace("-", "_") for name, needed in project["optional-dependencies"].items()}
    base = " ".join(project["dependencies"]).lower()
    for extra, packages in extras.PACKAGES.items():
        for package in packages:
            assert package.lower() in offered[extra], (extra, package)
            assert package.lower() not in base.replace("mcap>=", ""), package


def test_without_dask_one_process_does_all(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr("app.engine.spreading.there", lambda package: False)
    assert list(spread(lambda k: (k, os.getpid()), range(3))) == [(k, (k, os.getpid())) for k in range(3)]


def test_without_what_draws_a_run_keeps_its_numbers(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    for module in ("app.report.files", "app.commands.run_command"):
        monkeypatch.setattr(f"{module}.there", lambda package: False)
    run_(["hold"], out=tmp_path)
    assert (tmp_path / "summary.json").exists()
    assert not (tmp_path / "report.html").exists()
    assert "pip install 'pendant-sim[report]'" in capsys.readouterr().out
