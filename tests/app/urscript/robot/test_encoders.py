"""Encoders count as their kind says, and wrap around at the ends of their range."""

import pytest

from app.urscript.language.trouble import Misuse
from app.urscript.robot.encoders import RANGES, ConveyorEncoders, Decoder, Encoder

FORWARD = (0b00, 0b01, 0b11, 0b10)
"""Of the bits B A: A comes first."""


@pytest.mark.parametrize(
    ("decoder", "turns", "count"),
    [
        (Decoder.QUADRATURE, FORWARD * 3, 11),
        (Decoder.QUADRATURE, FORWARD[::-1] * 3, -12),
        (Decoder.BOTH_EDGES, FORWARD * 3, 6),
        (Decoder.RISING, FORWARD * 3, 3),
        (Decoder.FALLING, FORWARD * 3, 3),
        (Decoder.NONE, FORWARD * 3, 0),
    ],
)
def test_pulses_count_as_the_decoder_says(decoder: Decoder, turns: tuple[int, ...], count: int) -> None:
    encoder = Encoder()
    encoder.decode(decoder, (0, 1))
    for bits in turns:
        encoder.step(bits)
    assert encoder.count == count
    assert encoder.ready == (decoder is not Decoder.NONE)


def test_other_inputs_are_no_matter() -> None:
    encoder = Encoder()
    encoder.decode(Decoder.QUADRATURE, (2, 3))
    for bits in FORWARD * 2:
        encoder.step(bits)
    assert encoder.count == 0
    for bits in FORWARD:
        encoder.step(bits << 2)
    assert encoder.count == 3


@pytest.mark.parametrize(("range_", "lowest", "many"), [(k, *values) for k, values in enumerate(RANGES)])
def test_a_count_that_is_told_stays_in_its_range_and_is_unwound(range_: int, lowest: int, many: int) -> None:
    encoder = Encoder()
    encoder.be_told(range_)
    for count in (lowest, lowest + many - 1):
        encoder.tell(count)
        assert encoder.count == count
    for count in (lowest - 1, lowest + many):
        with pytest.raises(Misuse, match="allowed"):
            encoder.tell(count)
    assert encoder.unwound(5.0) == 5.0
    assert encoder.unwound(-5.0) == -5.0
    assert encoder.unwound(5.0 - many) == 5.0
    assert encoder.unwound(many - 5.0) == -5.0


def test_a_conveyor_of_the_laboratory_turns_it_evenly_and_rtde_tells_it() -> None:
    shown: list[tuple[int, int]] = []
    encoders = ConveyorEncoders(lambda: 0, lambda: (0.0, -1250.0), lambda index, count: shown.append((index, count)))
    encoders[1].decode(Decoder.QUADRATURE, (0, 1))
    for _ in range(400):
        encoders.step()
    assert encoders[1].count == -1000
    assert shown[-1] == (1, -1000)
    assert {index for index, _ in shown} == {1}
