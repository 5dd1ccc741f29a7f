import gymnasium

from app.learning.environments import GUIDE_TO_POINT, STEPS
from app.learning.guide_to_point import GuideToPoint


def test_the_id_makes_the_environment_with_an_end() -> None:
    env = gymnasium.make(GUIDE_TO_POINT)
    assert isinstance(env.unwrapped, GuideToPoint)
    assert env.spec is not None
    assert env.spec.max_episode_steps == STEPS
