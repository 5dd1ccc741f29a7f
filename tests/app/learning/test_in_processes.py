import os
from collections.abc import Iterator
from typing import Any

import gymnasium
import numpy as np
import psutil
import pytest
from gymnasium.vector import SyncVectorEnv

from app.files.bad_input import BadInput
from app.learning.environments import GUIDE_TO_POINT
from app.learning.in_processes import InProcesses

ACTION = np.array([[5.0, -8.0, 3.0], [0.0, 10.0, 0.0], [0.0, 0.0, 9.0]], dtype=np.float32)


@pytest.fixture(scope="module")
def envs() -> Iterator[InProcesses]:
    made = gymnasium.make_vec(GUIDE_TO_POINT, num_envs=3, processes=2, max_episode_steps=2)
    assert isinstance(made, InProcesses)
    yield made
    made.close()


def test_it_gives_what_environments_in_one_process_give(envs: InProcesses) -> None:
    beside = SyncVectorEnv([lambda: gymnasium.make(GUIDE_TO_POINT, max_episode_steps=2)] * 3)
    assert envs.observation_space == beside.observation_space
    assert envs.action_space == beside.action_space
    ours: list[tuple[Any, ...]] = [envs.reset(seed=[3, 4, 5])]
    theirs: list[tuple[Any, ...]] = [beside.reset(seed=[3, 4, 5])]
    for _ in range(4):  # over the end of an episode, the reset that follows, and on
        ours.append(envs.step(ACTION))
        theirs.append(beside.step(ACTION))
    for our, their in zip(ours, theirs, strict=True):
        for a, b in zip(our[:-1], their[:-1], strict=True):
            np.testing.assert_array_equal(a, b)
        assert our[-1].keys() == their[-1].keys()
        for key, value in their[-1].items():
            np.testing.assert_array_equal(our[-1][key], value)
            assert our[-1][key].dtype == value.dtype
    assert ours[2][3].all()  # truncated after two steps
    assert not ours[3][1].any()  # and reset by the third: no reward


def test_one_seed_is_counted_up(envs: InProcesses) -> None:
    counted = envs.reset(seed=3)[0]
    np.testing.assert_array_equal(counted, envs.reset(seed=[3, 4, 5])[0])
    assert not np.array_equal(counted[0], counted[1])


def test_seeds_are_as_many_as_environments(envs: InProcesses) -> None:
    with pytest.raises(ValueError, match="seed has 2 values, expected one for each of 3 environments"):
        envs.reset(seed=[1, 2])


def test_each_process_has_its_share_and_none_is_left(envs: InProcesses) -> None:
    def ours() -> int:
        return sum("multiprocessing.spawn" in " ".join(each.cmdline()) for each in psutil.Process(os.getpid()).children())

    before = ours()
    made = InProcesses(2, processes=5)
    assert ours() == before + 2  # no process without an environment
    made.close()
    assert ours() == before
    assert envs.num_envs == 3


def test_what_an_environment_raises_is_raised_here() -> None:
    with pytest.raises(BadInput, match="robot = ur4e"):
        InProcesses(2, processes=1, setup={"robot": "ur4e"})
    made = InProcesses(1)
    made.reset(seed=1)
    with pytest.raises(BadInput, match="three finite forces"):
        made.step(np.array([[np.nan, 0.0, 0.0]]))
    assert made.closed


@pytest.mark.parametrize(("num_envs", "processes"), [(0, None), (1, 0)])
def test_there_is_one_at_least(num_envs: int, processes: int | None) -> None:
    with pytest.raises(BadInput, match="1 or more"):
        InProcesses(num_envs, processes=processes)
