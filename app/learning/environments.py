"""The ids of the environments: importing this module registers them with Gymnasium.

import gymnasium
import app.learning.environments

one = gymnasium.make("pendant/GuideToPoint-v0", render_mode="rgb_array")
eight = gymnasium.make_vec("pendant/GuideToPoint-v0", num_envs=8)  # on all cores
"""

import gymnasium

GUIDE_TO_POINT = "pendant/GuideToPoint-v0"

STEPS = 120
"""Steps after which an episode is truncated: 6 s."""

gymnasium.register(
    GUIDE_TO_POINT,
    entry_point="app.learning.guide_to_point:GuideToPoint",
    vector_entry_point="app.learning.in_processes:InProcesses",
    max_episode_steps=STEPS,
)
