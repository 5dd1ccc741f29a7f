"""Texts in the picture."""

import numpy as np

from app.web.server import Served
from app.web.widgets.labels import HIGH, WIDE, Labels


def test_texts_at_one_place_stand_above_each_other_by_precedence_and_come_back(still: Served) -> None:
    scene = still.server.scene
    places = ((0.1, 0.2, 0.3), (0.1, 0.2, 0.31), (0.1, 0.2 + WIDE, 0.3), (0.1, 0.2, 0.3))
    labels = [scene.add_label(f"/test/{k}", "text", position=place) for k, place in enumerate(places)]
    apart = Labels(lambda: labels)
    assert apart.show()
    assert not apart.show()
    heights = [float(label.position[2]) for label in labels]
    np.testing.assert_allclose(heights, [0.3, 0.3 + HIGH, 0.3, 0.3 + 2 * HIGH])
    labels[1].visible = False
    assert apart.show()
    assert labels[3].position[2] == 0.3 + HIGH
    labels[0].position = (0.9, 0.9, 0.9)
    assert apart.show()
    assert [float(label.position[2]) for label in labels] == [0.9, 0.3 + HIGH, 0.3, 0.3]
    labels[1].visible = True
    apart.show()
    assert [float(label.position[2]) for label in labels[1:]] == [0.31, 0.3, 0.31 + HIGH]
    for label in labels[:3]:
        label.remove()
    del labels[:3]
    assert apart.show(), "what has been removed takes no room"
    assert labels[0].position[2] == 0.3
