"""A policy learns to bring an arm in free-drive to a point by pushing it: soft actor-critic of Stable-Baselines3, on two cores.

python -m examples.learning.guide train            # 20 minutes at most; writes out/learning/policy.zip and scale.pkl
python -m examples.learning.guide judge            # 100 starts that it has not seen, and a random policy beside it
python -m examples.learning.guide film             # one of them, as out/learning/guide.mp4

It needs torch and more, which nothing else here does: pip install 'pendant-sim[learning,examples]', or for a computer without a
graphics card first: pip install torch --index-url https://download.pytorch.org/whl/cpu
"""

import argparse
import sys
import time
from collections.abc import Callable
from pathlib import Path

import gymnasium
import numpy as np
import torch
from stable_baselines3 import SAC
from stable_baselines3.common.callbacks import BaseCallback
from stable_baselines3.common.monitor import Monitor
from stable_baselines3.common.vec_env import DummyVecEnv, SubprocVecEnv, VecNormalize

from app.learning.environments import GUIDE_TO_POINT

POLICY, SCALE = "policy.zip", "scale.pkl"
UNSEEN = 1_000_000
"""Seeds of starts that are judged begin here; those of training stay below."""

Choose = Callable[[np.ndarray], np.ndarray]


def one(seed: int) -> Callable[[], gymnasium.Env]:
    """A maker of an environment whose starts follow from `seed`."""

    def make() -> gymnasium.Env:
        env = Monitor(gymnasium.make(GUIDE_TO_POINT), info_keywords=("is_success",))
        env.reset(seed=seed)
        return env

    return make


class Told(BaseCallback):
    """Says every 2000 steps how many of the last 100 episodes ended at the point; ends the training when its time is over."""

    def __init__(self, seconds: float) -> None:
        super().__init__()
        self._end = time.monotonic() + seconds
        self._begun = time.monotonic()

    def _on_step(self) -> bool:
        last = self.model.ep_success_buffer
        if self.num_timesteps % 2000 < self.training_env.num_envs and last:
            took = time.monotonic() - self._begun
            reward = np.mean([each["r"] for each in self.model.ep_info_buffer])
            reached = f"{100 * np.mean(last):3.0f} % of the last {len(last)} at the point"
            sys.stdout.write(f"{self.num_timesteps:7d} steps {took / 60:5.1f} min: {reached}, reward {reward:.2f}\n")
            sys.stdout.flush()
        return time.monotonic() < self._end


def train(out: Path, *, steps: int, minutes: float, seed: int) -> None:
    """Learn, and write the policy and the scale of its observations."""
    torch.set_num_threads(1)  # the other core is for the environments
    envs = VecNormalize(SubprocVecEnv([one(seed + k) for k in range(4)]), norm_reward=False, clip_obs=5.0, gamma=0.97)
    model = SAC(
        "MlpPolicy",
        envs,
        learning_rate=7e-4,
        gamma=0.97,
        batch_size=256,
        learning_starts=2000,
        train_freq=1,
        gradient_steps=4,
        ent_coef="auto_0.1",
        policy_kwargs={"net_arch": [128, 128]},
        seed=seed,
        device="cpu",
    )
    model.learn(steps, callback=Told(60.0 * minutes))
    out.mkdir(parents=True, exist_ok=True)
    model.save(out / POLICY)
    envs.save(str(out / SCALE))
    envs.close()


def learned(out: Path) -> Choose:
    """The policy that `train` wrote."""
    model = SAC.load(out / POLICY, device="cpu")
    scale = VecNormalize.load(str(out / SCALE), DummyVecEnv([one(0)]))
    scale.training = False
    return lambda observation: model.predict(scale.normalize_obs(observation), deterministic=True)[0]


def random(seed: int) -> Choose:
    """A policy that pushes anyhow."""
    space = gymnasium.make(GUIDE_TO_POINT).action_space
    space.seed(seed)
    return lambda observation: space.sample()


def judged(choose: Choose, count: int) -> tuple[int, float, float]:
    """Of `count` unseen starts: how many ended at the point, mean true distance at the end [m], mean length [s]."""
    env = gymnasium.make(GUIDE_TO_POINT)
    reached, distances, steps = 0, [], 0
    for k in range(count):
        observation, info = env.reset(seed=UNSEEN + k)
        ended = False
        while not ended:
            observation, _, terminated, truncated, info = env.step(choose(observation))
            steps += 1
            ended = terminated or truncated
        reached += info["is_success"]
        distances.append(info["distance"])
    return reached, float(np.mean(distances)), 0.05 * steps / count


def film(out: Path) -> None:
    """A video of some unseen starts."""
    from app.learning.video import Video

    env, choose = gymnasium.make(GUIDE_TO_POINT, render_mode="rgb_array"), learned(out)
    with Video(out / "guide.mp4", 20) as video:
        for k in range(5):
            observation, _ = env.reset(seed=UNSEEN + k)
            ended = False
            while not ended:
                video.add(env.render())
                observation, _, terminated, truncated, _ = env.step(choose(observation))
                ended = terminated or truncated
            video.add(env.render())
    env.close()


def main() -> None:
    """Do what the command line asks for."""
    parser = argparse.ArgumentParser(prog="python -m examples.learning.guide")
    parser.add_argument("what", choices=("train", "judge", "film"))
    parser.add_argument("--out", type=Path, default=Path("out/learning"))
    parser.add_argument("--steps", type=int, default=60_000)
    parser.add_argument("--minutes", type=float, default=20.0)
    parser.add_argument("--seed", type=int, default=0)
    parser.add_argument("--starts", type=int, default=100)
    told = parser.parse_args()
    if told.what == "train":
        train(told.out, steps=told.steps, minutes=told.minutes, seed=told.seed)
    elif told.what == "film":
        film(told.out)
    else:
        for name, choose in (("learned", learned(told.out)), ("random", random(told.seed))):
            reached, distance, length = judged(choose, told.starts)
            sys.stdout.write(f"{name:8} {reached} of {told.starts} at the point, {1000 * distance:.0f} mm off, {length:.1f} s\n")


if __name__ == "__main__":
    main()
