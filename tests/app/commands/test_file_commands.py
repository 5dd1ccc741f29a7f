from pathlib import Path

import jsonschema
import msgspec
import pytest

from tests.app.command_line import pendant
from tests.app.studies.study_fakes import BASE, FIELDS


def test_a_study_is_checked(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    session = {**BASE, "posture": [0.0, -1.2, 1.5, -1.87, -1.57, 0.0]}
    path = tmp_path / "s.yaml"
    path.write_bytes(msgspec.yaml.encode({**FIELDS, "session": session}))
    assert pendant(monkeypatch, "check", str(path)) == 0
    assert "s.yaml: a valid study of 16 runs" in capsys.readouterr().out
    path.write_bytes(msgspec.yaml.encode({**FIELDS, "session": session, "samples": 0}))
    assert pendant(monkeypatch, "check", str(path)) == 2
    assert "samples" in capsys.readouterr().err


def test_a_study_has_a_schema(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    assert pendant(monkeypatch, "schema", "study") == 0
    schema = msgspec.json.decode(capsys.readouterr().out)
    jsonschema.Draft202012Validator.check_schema(schema)
    jsonschema.validate(FIELDS, schema)
    with pytest.raises(jsonschema.ValidationError):
        jsonschema.validate({**FIELDS, "factors": []}, schema)
