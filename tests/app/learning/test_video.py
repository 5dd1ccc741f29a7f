import sys
from pathlib import Path

import av
import numpy as np
import pytest

from app.files.bad_input import BadInput
from app.learning.lerobot_files import parquet
from app.learning.video import Video


def test_pictures_come_back_in_their_order(tmp_path: Path) -> None:
    levels = [20, 120, 220, 60]
    with Video(tmp_path / "new/a.mp4", 20) as video:
        for level in levels:
            video.add(np.full((48, 64, 3), level, dtype=np.uint8))
    with av.open(str(tmp_path / "new/a.mp4")) as file:
        stream = file.streams.video[0]
        assert (stream.codec_context.name, stream.pix_fmt, stream.average_rate) == ("h264", "yuv420p", 20)
        frames = [frame.to_ndarray(format="rgb24") for frame in file.decode(video=0)]
    assert [frame.shape for frame in frames] == [(48, 64, 3)] * 4
    np.testing.assert_allclose([frame.mean() for frame in frames], levels, atol=6.0)


def test_a_file_that_cannot_be_written_is_told(tmp_path: Path) -> None:
    (tmp_path / "file").write_text("")
    with pytest.raises(BadInput, match="cannot be written"):
        Video(tmp_path / "file/a.mp4", 20)


@pytest.mark.parametrize(("module", "asked"), [("av", lambda: Video(Path("a.mp4"), 20)), ("pyarrow", parquet)])
def test_what_is_not_installed_is_told_with_how_to_install_it(
    module: str, asked: object, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(sys.modules, module, None)
    assert callable(asked)
    with pytest.raises(BadInput, match=r"pip install 'pendant-sim\[learning\]'"):
        asked()
