import gymnasium
import numpy as np

from app.learning.environments import GUIDE_TO_POINT
from app.learning.guide_to_point import GuideToPoint


def test_a_vector_over_processes_does_what_single_environments_do() -> None:
    # Fresh processes: a copy of this one would inherit the locks of its threads.
    envs = gymnasium.make_vec(GUIDE_TO_POINT, num_envs=2, vectorization_mode="async", vector_kwargs={"context": "spawn"})
    try:
        action = np.array([[5.0, -8.0, 3.0], [0.0, 10.0, 0.0]], dtype=np.float32)
        seen, _ = envs.reset(seed=[3, 4])
        then, rewards, *_, info = envs.step(action)
    finally:
        envs.close()
    one = GuideToPoint()
    for row, seed in enumerate((3, 4)):
        np.testing.assert_array_equal(seen[row], one.reset(seed=seed)[0])
        observation, reward, *_, told = one.step(action[row])
        np.testing.assert_array_equal(then[row], observation)
        assert rewards[row] == reward
        assert info["distance"][row] == told["distance"]
        np.testing.assert_array_equal(info["target"][row], told["target"])
