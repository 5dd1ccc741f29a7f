from app.web.access.operator import SILENCE, Operator


def test_the_first_to_act_takes_control() -> None:
    operator = Operator()
    assert operator.free(0.0)
    assert operator.claim(3, 0.0)
    assert operator.holder == 3
    assert not operator.claim(4, 1.0)
    assert operator.holder == 3


def test_a_released_control_is_anyones() -> None:
    operator = Operator()
    operator.claim(1, 0.0)
    assert not operator.leave(2)
    assert operator.holder == 1
    assert operator.leave(1)
    assert operator.holder is None
    assert operator.claim(2, 0.1)


def test_silence_frees_control_after_ten_seconds_and_not_before() -> None:
    operator = Operator()
    operator.claim(1, 100.0)
    operator.claim(1, 105.0)
    assert not operator.claim(2, 105.0 + SILENCE - 0.001)
    assert operator.claim(2, 105.0 + SILENCE)
    assert operator.holder == 2
    assert not operator.claim(1, 105.0 + SILENCE)
    assert SILENCE == 10.0


def test_a_hand_that_holds_the_arm_still_is_no_silence() -> None:
    operator = Operator()
    operator.claim(1, 0.0)
    operator.engage(1, True, 0.0)
    assert not operator.claim(2, 1000.0)
    operator.engage(1, False, 1000.0)
    assert not operator.claim(2, 1009.0)
    assert operator.claim(2, 1010.0)


def test_a_watcher_cannot_engage() -> None:
    operator = Operator()
    operator.claim(1, 0.0)
    operator.engage(2, True, 5.0)
    assert operator.claim(2, 10.0)


def test_the_next_operator_starts_unengaged() -> None:
    operator = Operator()
    operator.claim(1, 0.0)
    operator.engage(1, True, 0.0)
    operator.leave(1)
    operator.claim(2, 0.0)
    assert operator.free(10.0)
