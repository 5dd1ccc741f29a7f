"""Many environments of `GuideToPoint` side by side: one process for each core, several environments in each process.

Gymnasium's own `AsyncVectorEnv` gives each environment a process. The system spreads eight of them unevenly over two cores: one
core may have five environments to step, while the other, with three, waits. Here each core has its share.
"""

import multiprocessing
import signal
from collections.abc import Sequence
from contextlib import suppress
from multiprocessing.connection import Connection
from typing import Any

import gymnasium
import numpy as np
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.typing import NDArray

from app.engine.dask_client import cores
from app.files.bad_input import BadInput
from app.learning.environments import GUIDE_TO_POINT

Result = tuple[NDArray[Any], float, bool, bool, dict[str, Any]]
"""Result of `gymnasium.Env.step`; after a reset the reward is 0, and the episode has not ended."""


class InProcesses(VectorEnv[NDArray[Any], NDArray[Any], NDArray[Any]]):
    """A vector of `GuideToPoint` whose steps run on all cores at once.

    Observations, rewards and infos are those of `gymnasium.vector.SyncVectorEnv` for the same seeds and actions, bit for bit.
    An environment that has ended is reset by the next step (`AutoresetMode.NEXT_STEP`), whose action it does not use.

    Args:
        num_envs: number of environments.
        processes: largest number of processes; None: one for each core.
        options: of `gymnasium.make` and of the environment.

    Raises:
        BadInput: there would be no environment or no process. Errors of the environment are raised, too.
    """

    def __init__(self, num_envs: int, processes: int | None = None, **options: Any) -> None:
        for name, value in (("num_envs", num_envs), ("processes", processes)):
            if value is not None and value < 1:
                raise BadInput("InProcesses", name, value, "1 or more")
        self.num_envs = num_envs
        self.metadata = {"autoreset_mode": AutoresetMode.NEXT_STEP}
        count = min(num_envs, processes or cores())
        shares = [list(range(num_envs))[k::count] for k in range(count)]
        context = multiprocessing.get_context("spawn")  # a copy of this process would inherit the locks of its threads
        self._workers: list[tuple[list[int], Connection, Any]] = []
        for share in shares:
            here, there = context.Pipe()
            process = context.Process(target=_work, args=(there, len(share), options), daemon=True)
            process.start()
            there.close()
            self._workers.append((share, here, process))
        told = self._answers()
        self.single_observation_space, self.single_action_space, one = told[0]
        self.metadata |= one
        self.render_mode = options.get("render_mode")
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)

    @property
    def pids(self) -> list[int]:
        """Ids of the processes."""
        return [process.pid for _, _, process in self._workers]

    def reset(
        self, *, seed: int | list[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[NDArray[Any], dict[str, Any]]:
        """As `gymnasium.vector.VectorEnv.reset`: a single seed is that of the first environment, and is counted up for the
        others.

        Raises:
            ValueError: the number of seeds is not that of environments.
        """
        if isinstance(seed, int):
            seed = [seed + k for k in range(self.num_envs)]
        seeds = [None] * self.num_envs if seed is None else seed
        if len(seeds) != self.num_envs:
            raise ValueError(f"seed has {len(seeds)} values, expected one for each of {self.num_envs} environments")
        for share, pipe, _ in self._workers:
            pipe.send(("reset", ([seeds[k] for k in share], options)))
        observations, *_, infos = self._gathered()
        return observations, infos

    def step(
        self, actions: NDArray[Any]
    ) -> tuple[NDArray[Any], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        """As `gymnasium.vector.VectorEnv.step`; `actions` has a row for each environment."""
        for share, pipe, _ in self._workers:
            pipe.send(("step", (np.asarray(actions)[share],)))
        return self._gathered()

    def render(self) -> tuple[Any, ...] | None:
        """A picture of each environment."""
        for _, pipe, _ in self._workers:
            pipe.send(("render", ()))
        return tuple(self._answers())

    def close_extras(self, **_unused: Any) -> None:
        """End the processes."""
        for _, pipe, process in self._workers:
            pipe.close()  # the process ends when its pipe is closed
            process.join()

    def _answers(self) -> list[Any]:
        """The answer of each environment, in order; an error is raised when all have answered."""
        answers: list[Any] = [None] * self.num_envs
        failed: list[BaseException] = []
        for share, pipe, _ in self._workers:
            found = pipe.recv()
            if isinstance(found, BaseException):
                failed.append(found)
                continue
            for k, answer in zip(share, found, strict=True):
                answers[k] = answer
        if failed:
            self.close()
            raise failed[0]
        return answers

    def _gathered(self) -> tuple[NDArray[Any], NDArray[np.float64], NDArray[np.bool_], NDArray[np.bool_], dict[str, Any]]:
        results: list[Result] = self._answers()
        observations, rewards, terminated, truncated, told = zip(*results, strict=True)
        return (
            np.stack(observations),
            np.array(rewards, dtype=np.float64),
            np.array(terminated),
            np.array(truncated),
            self._infos(told),
        )

    def _infos(self, told: Sequence[dict[str, Any]]) -> dict[str, Any]:
        """Infos in Gymnasium's form, but made column by column if all have the same keys, which is faster: all cores wait for
        it."""
        infos: dict[str, Any] = {}
        if any(info.keys() != told[0].keys() for info in told):  # some have just been reset
            for k, info in enumerate(told):
                infos = self._add_info(infos, info, k)
            return infos
        for key, first in told[0].items():
            infos[key] = np.array([info[key] for info in told], dtype=object if isinstance(first, str) else None)
            infos[f"_{key}"] = np.ones(self.num_envs, dtype=np.bool_)
        return infos


class _Share:
    """The environments of one process."""

    def __init__(self, count: int, options: dict[str, Any]) -> None:
        self._envs = [gymnasium.make(GUIDE_TO_POINT, **options) for _ in range(count)]
        self._over = [False] * count

    def spaces(self) -> list[Any]:
        return [(env.observation_space, env.action_space, env.metadata) for env in self._envs]

    def reset(self, seeds: list[int | None], options: dict[str, Any] | None) -> list[Result]:
        self._over = [False] * len(seeds)
        return [_begun(env, seed=seed, options=options) for env, seed in zip(self._envs, seeds, strict=True)]

    def step(self, actions: NDArray[Any]) -> list[Result]:
        beside = zip(self._envs, self._over, actions, strict=True)
        results: list[Any] = [_begun(env) if over else env.step(action) for env, over, action in beside]
        self._over = [bool(terminated or truncated) for _, _, terminated, truncated, _ in results]
        return results

    def render(self) -> list[Any]:
        return [env.render() for env in self._envs]


def _begun(env: gymnasium.Env[Any, Any], **how: Any) -> Result:
    observation, info = env.reset(**how)
    return observation, 0.0, False, False, info


def _work(pipe: Connection, count: int, options: dict[str, Any]) -> None:
    """Answer the requests of the parent process until it closes the pipe. If a request fails, the answer is the error."""
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # the parent process ends this one, not Ctrl-C
    with suppress(EOFError, BrokenPipeError):
        try:
            share = _Share(count, options)
            pipe.send(share.spaces())
        except Exception as error:  # noqa: BLE001 - it is sent to the parent process
            pipe.send(error)
            return
        while True:
            name, arguments = pipe.recv()
            try:
                pipe.send(getattr(share, name)(*arguments))
            except Exception as error:  # noqa: BLE001
                pipe.send(error)
