import copy
import warnings

import gymnasium
import numpy as np
import pytest
from gymnasium.utils.env_checker import check_env

from app.files.bad_input import BadInput
from app.learning import guide_to_point
from app.learning.environments import GUIDE_TO_POINT, STEPS
from app.learning.guide_to_point import FORCE, NEAR, SLOW, GuideToPoint
from sim.arm.frames import joint_frames


@pytest.fixture(scope="module")
def env() -> GuideToPoint:
    return GuideToPoint()


def rows(env: GuideToPoint, name: str) -> slice:
    return env.observation_space.part(name)


def test_the_checker_of_gymnasium_passes() -> None:
    with warnings.catch_warnings():
        warnings.simplefilter("error")
        # It recommends -1 to 1 for actions; ours are newtons.
        warnings.filterwarnings("ignore", message=".*symmetric and normalized space.*")
        check_env(gymnasium.make(GUIDE_TO_POINT, render_mode="rgb_array").unwrapped)


def test_the_id_is_registered_and_truncates() -> None:
    made = gymnasium.make(GUIDE_TO_POINT)
    assert made.spec is not None
    assert made.spec.max_episode_steps == STEPS
    assert isinstance(made.unwrapped, GuideToPoint)


def test_spaces_say_names_and_units(env: GuideToPoint) -> None:
    assert [(each.name, each.size, each.unit) for each in env.observation_space.quantities] == [
        ("joint_angle", 6, "rad"),
        ("joint_speed", 6, "rad/s"),
        ("flange_position", 3, "m"),
        ("flange_velocity", 3, "m/s"),
        ("way", 3, "m"),
        ("felt_force", 3, "N"),
    ]
    assert [(each.name, each.size, each.unit) for each in env.action_space.quantities] == [("hand_force", 3, "N")]
    assert float(env.action_space.high[0]) == FORCE


def test_a_seed_gives_the_same_episode_and_another_seed_another(env: GuideToPoint) -> None:
    def episode(seed: int | None) -> list[np.ndarray]:
        seen = [env.reset(seed=seed)[0]]
        return seen + [env.step(np.array([5.0, -8.0, 3.0], dtype=np.float32))[0] for _ in range(5)]

    first, again, other = episode(3), episode(3), episode(4)
    np.testing.assert_array_equal(first, again)
    assert not np.array_equal(first[0], other[0])
    # Without a seed the next episode goes on from the last random number, as Gymnasium has it.
    env.reset(seed=3)
    following = episode(None)
    env.reset(seed=3)
    np.testing.assert_array_equal(following, episode(None))
    assert not np.array_equal(following[0], first[0])


def test_the_arm_is_free_and_follows_the_hand(env: GuideToPoint) -> None:
    _, before = env.reset(seed=1)
    assert before["mode"] == "FREE_DRIVE"
    for _ in range(8):
        _, _, terminated, truncated, info = env.step(np.array([0.0, 15.0, 0.0], dtype=np.float32))
        assert not terminated
        assert not truncated
    way = info["position"] - before["position"]
    assert way[1] > 0.03
    assert abs(way[0]) + abs(way[2]) < way[1]


def test_the_truth_is_in_info_alone(env: GuideToPoint) -> None:
    """What is observed differs from the truth by the errors of encoders and model: small, and not nothing."""
    observation, info = env.reset(seed=2)
    off = observation[rows(env, "flange_position")] - info["position"]
    assert 1e-6 < float(np.linalg.norm(off)) < 0.01
    np.testing.assert_allclose(
        observation[rows(env, "way")], info["target"] - observation[rows(env, "flange_position")], atol=1e-6
    )
    # Nobody touches the arm; the sensor says otherwise, by its offset.
    assert 0.0 < float(np.linalg.norm(observation[rows(env, "felt_force")])) < 10.0


def test_the_reward_is_the_way_made_good(env: GuideToPoint) -> None:
    observation, _ = env.reset(seed=5)
    way = observation[rows(env, "way")]
    observation, reward, *_ = env.step((15.0 * way / np.linalg.norm(way)).astype(np.float32))
    made = np.linalg.norm(way) - np.linalg.norm(observation[rows(env, "way")])
    assert reward == pytest.approx(10.0 * made, abs=1e-5)
    for _ in range(3):
        observation, reward, *_ = env.step((15.0 * way / np.linalg.norm(way)).astype(np.float32))
    assert reward > 0.0


def test_who_comes_to_rest_at_the_point_has_done_it(env: GuideToPoint) -> None:
    """A hand like a spring with a damper, and some newtons more against friction."""
    observation, info = env.reset(seed=0)
    for _ in range(STEPS):
        way, velocity = observation[rows(env, "way")], observation[rows(env, "flange_velocity")]
        force = 100.0 * way - 30.0 * velocity + 3.0 * way / np.linalg.norm(way)
        observation, reward, terminated, _, info = env.step(np.clip(force, -FORCE, FORCE).astype(np.float32))
        if terminated:
            break
    assert terminated
    assert info["is_success"]
    assert info["distance"] <= NEAR
    assert float(np.linalg.norm(observation[rows(env, "flange_velocity")])) <= SLOW
    assert reward > 1.0 - 10.0 * NEAR


def test_an_arm_that_nobody_moves_leaves_free_drive_and_ends_the_episode(env: GuideToPoint) -> None:
    env.reset(seed=6)
    steps, terminated = 0, False
    while not terminated:
        _, reward, terminated, _, info = env.step(np.zeros(3, dtype=np.float32))
        steps += 1
    assert steps * 0.05 == pytest.approx(3.0, abs=0.2)  # the free-drive period
    assert info["mode"] == "TEACH"
    assert "left" in info["events"]
    assert not info["is_success"]
    assert reward == pytest.approx(-1.0, abs=0.05)


def test_options_choose_posture_and_target(env: GuideToPoint) -> None:
    posture = [0.2, -1.1, 1.4, -1.8, -1.5, 0.1]
    arm = env._prepared.arm
    place = joint_frames(arm, posture)[-1, :3, 3]
    observation, info = env.reset(seed=0, options={"posture": posture, "target": [-0.5, -0.2, 0.4]})
    np.testing.assert_allclose(observation[rows(env, "joint_angle")], posture, atol=0.01)
    np.testing.assert_allclose(info["position"], place, atol=0.01)
    np.testing.assert_allclose(info["target"], [-0.5, -0.2, 0.4])


@pytest.mark.parametrize(
    ("options", "field"),
    [
        ({"posture": [0.0]}, "posture"),
        ({"posture": [9.0, 0.0, 0.0, 0.0, 0.0, 0.0]}, "posture"),
        ({"target": [5.0, 0.0, 0.0]}, "target"),
        ({"target": [0.1, 0.0]}, "target"),
    ],
)
def test_options_that_make_no_sense_are_told_in_a_line(env: GuideToPoint, options: dict, field: str) -> None:
    with pytest.raises(BadInput, match=field):
        env.reset(options=options)


def test_an_action_that_is_no_force_is_refused(env: GuideToPoint) -> None:
    env.reset(seed=0)
    with pytest.raises(BadInput, match="three finite forces"):
        env.step(np.array([np.nan, 0.0, 0.0], dtype=np.float32))


def test_an_episode_begins_with_a_reset() -> None:
    with pytest.raises(RuntimeError, match="reset"):
        GuideToPoint().step(np.zeros(3, dtype=np.float32))


def test_a_set_up_that_the_pendant_refuses_is_told(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(guide_to_point, "TRIES", 2)
    wrong = GuideToPoint({"payload_true": {"mass": 3.0}})
    with pytest.raises(RuntimeError, match="refused 2 starts, the last with refused_"):
        wrong.reset(seed=0)


def test_a_start_within_an_object_is_drawn_anew(monkeypatch: pytest.MonkeyPatch) -> None:
    table = {"name": "table", "kind": "box", "position": [-0.6, -0.1, 0.15], "size": [0.6, 0.6, 0.3]}
    blocked = GuideToPoint({"world": [table]})
    monkeypatch.setattr(guide_to_point, "TRIES", 200)
    _, info = blocked.reset(seed=0)
    assert info["mode"] == "FREE_DRIVE"
    monkeypatch.setattr(guide_to_point, "TRIES", 1)
    inside = [0.0, -1.0, 1.9, -2.4, -1.57, 0.0]  # the flange is low in the table
    with pytest.raises(RuntimeError, match="refused 1 starts"):
        blocked.reset(seed=0, options={"posture": inside, "target": [-0.6, -0.1, 0.5]})


def test_a_set_up_is_checked() -> None:
    with pytest.raises(BadInput, match="robot"):
        GuideToPoint({"robot": "none"})
    with pytest.raises(BadInput, match="rgb_array"):
        GuideToPoint(render_mode="human")


def test_another_arm_on_the_wall_with_a_payload() -> None:
    setup = {
        "robot": "ur10e",
        "mounting": "wall",
        "payload_true": {"mass": 2.0},
        "payload_configured": {"mass": 2.0},
    }
    env = GuideToPoint(copy.deepcopy(setup))
    observation, before = env.reset(seed=0)
    assert observation in env.observation_space
    np.testing.assert_allclose(observation[rows(env, "flange_position")], before["position"], atol=0.01)  # both in W
    for _ in range(8):
        *_, info = env.step(np.array([0.0, 20.0, 0.0], dtype=np.float32))
    assert info["position"][1] - before["position"][1] > 0.02
