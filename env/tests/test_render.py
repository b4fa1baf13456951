"""Frames and text: that they show what is there."""

import copy
import pickle

import gymnasium
import numpy as np
import pytest

import bekker
from bekker.render import SIZE


def made(mode: str | None, task: str = "Rover", **arguments: object) -> gymnasium.Env:
    return gymnasium.make(f"bekker/{task}-v0", render_mode=mode, disable_env_checker=True, **arguments)


@pytest.mark.parametrize("preset", sorted(bekker.presets()))
def test_property_every_vehicle_has_a_frame(preset: str) -> None:
    env = made("rgb_array", model=preset)
    env.reset(seed=1)
    frame = env.render()
    assert frame.shape == (SIZE[1], SIZE[0], 3) and frame.dtype == np.uint8
    # Sky above, soil below, more than a few colours between.
    assert frame[SIZE[1] // 3, 0, 2] > frame[-2, 0, 2]
    assert len(np.unique(frame.reshape(-1, 3), axis=0)) > 200


def test_property_frames_depend_on_state_alone() -> None:
    frames = []
    for _ in range(2):
        env = made("rgb_array")
        env.reset(seed=3)
        env.render()
        for _ in range(20):
            env.step([0.8, 0.8])
            env.render()
        frames.append(env.render())
    assert np.array_equal(*frames)


def soil_rows(frame: np.ndarray) -> np.ndarray:
    """First row of the soil, column by column: there the picture is more red than blue."""
    return np.argmax(frame[:, :, 0].astype(int) > frame[:, :, 2].astype(int) + 30, axis=0)


def test_property_a_wheel_leaves_a_rut_as_deep_as_it_sank() -> None:
    env = made("rgb_array", control="speed", parameters={"soil.k_phi": 2e5})
    _, info = env.reset(seed=0)
    before = env.render()
    deepest = max(info["sinkage"])
    for k in range(200):
        _, _, _, _, info = env.step([0.4, 0.4])
        deepest = max(deepest, *info["sinkage"])
        # Some frames are enough: between two, ruts run straight.
        if k % 10 == 9:
            frame = env.render()
    model = env.unwrapped.setup.model
    length = model.get("wheel[2].x") - model.get("wheel[1].x") + 2 * model.get("wheel.radius")
    # A picture is three vehicles wide.
    pixels = SIZE[0] / (3.0 * length)
    # Behind the vehicle: no wheel hides the soil.
    behind = slice(0, SIZE[0] // 2 - int(0.5 * length * pixels))
    fresh, passed = soil_rows(before)[-5], soil_rows(frame)[behind].max()
    # The edge of the soil is a line of two pixels; one for rounding.
    assert (passed - fresh) / pixels == pytest.approx(deepest, abs=3.0 / pixels)
    # Where no wheel has been, the ground is as it was.
    assert soil_rows(frame)[-5] == fresh


# Colours of the flag and of a drawbar pull; the legend is in the upper right, the numbers in the upper left.
FLAG, PULL = (58, 142, 92), (206, 44, 66)
BELOW_PANELS, RIGHT_OF_PANEL = 180, 300


def count_of(frame: np.ndarray, colour: tuple[int, int, int]) -> int:
    return int((frame == colour).all(axis=2).sum())


def test_property_a_frame_shows_goal_target_and_reward() -> None:
    env = made("rgb_array", "SlopeClimb")
    env.reset(seed=0)
    mechanics = env.unwrapped.mechanics
    row = np.ascontiguousarray(mechanics.signals[0])
    renderer = bekker._bekker.Renderer(mechanics.models[0], *SIZE)
    plain = renderer.frame(0.0, row, "running")
    ahead = renderer.frame(0.0, row, "running", goal=0.8)
    assert count_of(plain[:, RIGHT_OF_PANEL:], FLAG) == 0 and count_of(ahead[:, RIGHT_OF_PANEL:], FLAG) > 300
    numbers = [renderer.frame(0.0, row, "running", target=0.2), renderer.frame(0.0, row, "running", reward=-0.1)]
    for frame in numbers:
        assert not np.array_equal(frame, plain) and np.array_equal(frame[:, RIGHT_OF_PANEL:], plain[:, RIGHT_OF_PANEL:])
    asked = mechanics.asked(0)
    assert asked == {"reward": 0.0, "goal": mechanics.signals[0, mechanics.places["x"]] + 3.0, "target": asked["target"]}
    assert np.array_equal(env.render(), renderer.frame(0.0, row, "running", **asked))


def test_property_loose_soil_is_paler() -> None:
    env = made("rgb_array", "DitchCrossing")
    env.reset(seed=0, options={"x0": 0.6})
    frame = env.render().astype(int)
    length = 0.4 + 2 * 0.064
    pixels = SIZE[0] / (3.0 * length)
    middle = 0.6

    def soil(x: float) -> float:
        """Mean brightness below the surface there, over 40 columns."""
        column = int(SIZE[0] / 2 + (x - middle) * pixels)
        tops = soil_rows(frame)[column - 20 : column + 20]
        return float(np.mean([frame[top + 8 : top + 40, column - 20 + k].mean() for k, top in enumerate(tops)]))

    assert soil(1.0) > soil(0.1) + 10.0


STONE = (112, 104, 98)


def test_property_rocks_are_stone_and_not_loose_soil() -> None:
    bare = {"terrain.rock_coverage": 0.0}
    for parameters, least, most in (({}, 100, 20_000), (bare, 0, 0)):
        env = made("rgb_array", "RockTraverse", parameters=parameters)
        # The seed of a sweep's first episode: a rock within a vehicle's length of 2 m.
        env.reset(seed=20_000, options={"x0": 2.0})
        assert least <= count_of(env.render(), STONE) <= most


def test_property_pulls_are_to_be_seen() -> None:
    """On a slope of 0.1 a wheel pulls with a tenth of its load, which is an arrow of 20 pixels."""
    env = made("rgb_array", "SlopeClimb", parameters={"terrain.slope": 0.1})
    env.reset(seed=0)
    for _ in range(100):
        env.step([0.5, 0.5])
    assert count_of(env.render()[BELOW_PANELS:], PULL) > 60


def test_property_another_episode_starts_on_fresh_ground() -> None:
    env = made("rgb_array")
    env.reset(seed=0)
    first = env.render()
    for _ in range(30):
        env.step([1.0, 1.0])
        env.render()
    env.reset(seed=0)
    assert np.array_equal(env.render(), first)


def test_property_text_has_the_numbers() -> None:
    env = made("ansi", model="rocker_bogie")
    env.reset(seed=0)
    for _ in range(10):
        _, _, _, _, info = env.step([0.5] * 3)
    numbers, profile = env.render().split("\n")
    assert f"x {info['x']:7.3f} m" in numbers and numbers.endswith("running")
    assert profile.count("o") == 3


def test_property_vectors_have_a_frame_each() -> None:
    envs = gymnasium.make_vec("bekker/SlopeClimb-v0", 3, vectorization_mode="vector_entry_point", render_mode="rgb_array")
    envs.reset(seed=5)
    envs.step(np.full(envs.action_space.shape, 0.5, np.float32))
    frames = envs.render()
    assert len(frames) == 3 and not np.array_equal(frames[0], frames[1])
    single = made("rgb_array", "SlopeClimb")
    single.reset(seed=6)
    single.step(np.full(single.action_space.shape, 0.5, np.float32))
    assert np.array_equal(single.render(), frames[1])
    envs.close()


class Screen:
    """A window that counts."""

    def __init__(self, fps: float) -> None:
        self.fps, self.frames, self.closed = fps, [], False

    def show(self, frame: np.ndarray) -> None:
        self.frames.append(frame)

    def close(self) -> None:
        self.closed = True


@pytest.mark.parametrize("vector", [False, True])
def test_property_a_window_shows_every_step_once(monkeypatch: pytest.MonkeyPatch, vector: bool) -> None:
    opened: list[Screen] = []
    monkeypatch.setattr(bekker.render, "_window", lambda fps: opened.append(Screen(fps)) or opened[-1])
    make = gymnasium.make_vec if vector else gymnasium.make
    env = make("bekker/SlopeClimb-v0", render_mode="human", **({"num_envs": 2} if vector else {"disable_env_checker": True}))
    env.reset(seed=0)
    for _ in range(3):
        env.step(np.full(env.action_space.shape, 0.5, np.float32))
        # As in many a loop, though the step has shown it.
        env.render()
    (screen,) = opened
    assert len(screen.frames) == 4 and screen.fps == 50.0 and not np.array_equal(screen.frames[0], screen.frames[-1])
    moment = env.unwrapped.snapshot()
    env.step(np.full(env.action_space.shape, -0.5, np.float32))
    env.unwrapped.restore(moment)
    env.step(np.full(env.action_space.shape, 0.5, np.float32))
    # The same instants, another state.
    assert len(screen.frames) == 7 and not np.array_equal(screen.frames[4], screen.frames[6])
    env.reset(seed=0)
    assert np.array_equal(screen.frames[-1], screen.frames[0])
    env.close()
    assert screen.closed


def test_property_modes_that_do_not_exist_and_frames_too_early_are_refused() -> None:
    with pytest.raises(gymnasium.error.UnsupportedMode, match="expected rgb_array, ansi, human"):
        bekker.RoverEnv(render_mode="hologram")
    with pytest.raises(gymnasium.error.ResetNeeded):
        bekker.RoverEnv(render_mode="rgb_array").render()
    model = bekker.Model.from_preset("two_wheeled")
    with pytest.raises(bekker.InputError, match="width = 8: expected 64 to 8192"):
        bekker._bekker.Renderer(model, 8, 100)
    with pytest.raises(bekker.InputError, match="signals: expected a contiguous row"):
        bekker._bekker.Renderer(model).frame(0.0, np.zeros(3), "running")


def test_property_environments_with_frames_can_be_copied() -> None:
    env = bekker.RoverEnv(render_mode="rgb_array")
    env.reset(seed=0)
    env.render()
    for twin in (copy.deepcopy(env), pickle.loads(pickle.dumps(env))):
        assert twin.render().shape == (SIZE[1], SIZE[0], 3)
