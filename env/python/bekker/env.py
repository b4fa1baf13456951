"""The gymnasium environment of one rover, ``bekker/Rover-v0`` and its tasks."""

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any, TypeAlias

import gymnasium
import numpy as np
from gymnasium import spaces
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Unpack

from .arguments import Arguments, Levelled, Options, Setup
from .errors import InputError
from .mechanics import Mechanics, MechanicsState, as_array
from .models import ModelLike
from .render import RENDER_MODES, Gallery
from .tasks import Task

__all__ = ["RoverEnv", "RoverSnapshot"]

Observation: TypeAlias = NDArray[np.float32]
Action: TypeAlias = NDArray[np.float32]


@dataclass(frozen=True)
class RoverSnapshot:
    """A moment of an environment, which goes on to the same bits."""

    mechanics: MechanicsState
    random: Mapping[str, Any]
    """State of the random numbers."""


class RoverEnv(Levelled, gymnasium.Env[Observation, Action]):
    """A rover on deformable soil: every wheel sinks, slips and pulls as the stresses under it say.

    The physics is that of `bekker.simulate` to the last bit; a step holds the action for `period`. The page
    `examples/environment.md` describes spaces, rewards, starts and ends of every task.

    Args:
        model: a `bekker.Model`, the name of a preset, TOML text, or the path of a TOML file; the task's where None.
        task: name of a task, `bekker.TASKS`, or a `bekker.Task`.
        render_mode: how to draw, one of ``metadata["render_modes"]``.
        arguments: as :class:`bekker.Arguments`; those left out are the task's.

    Raises:
        UnknownNameError, ModelError, InputError: an argument is wrong; the message names it.

    Attributes:
        mechanics: the rover in motion.
        setup: what does not change from episode to episode.
    """

    metadata: dict[str, Any] = {"render_modes": RENDER_MODES, "render_fps": 50}

    def __init__(
        self,
        model: ModelLike | None = None,
        *,
        task: str | Task = "Rover",
        render_mode: str | None = None,
        **arguments: Unpack[Arguments],
    ) -> None:
        self.setup = Setup(task, model, arguments)
        self.mechanics = Mechanics(self.setup, 1)
        self.observation_space, self.action_space = spaces_of(self.setup, self.mechanics)
        self.render_mode = render_mode
        self._gallery = Gallery(render_mode, self.setup.period)
        self.metadata = self._gallery.metadata

    def reset(
        self, *, seed: int | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Observation, dict[str, Any]]:
        """Starts an episode, at rest, settled on the soil.

        Args:
            seed: decides all that is drawn from here on; its last 32 bits also seed the noise of the sensors. Without one
                the stream of the last seed goes on.
            options: for this episode only, after the drawing: ``parameters`` by name, ``x0``, ``target_velocity``,
                ``level``, ``randomise`` (distributions by name, besides the present ones), ``worlds`` (False where no world
                is to be drawn).

        Raises:
            UnknownNameError, ModelError, InputError: an option is wrong.
            SimulationError: the rover finds no rest on the ground.
        """
        chosen = Options.of(options, self.setup)
        super().reset(seed=seed)
        self.mechanics.start(0, self.np_random, seed, chosen)
        self._gallery.show(self.mechanics)
        return self.mechanics.observations()[0], self.mechanics.info(0)

    def step(self, action: ArrayLike) -> tuple[Observation, float, bool, bool, dict[str, Any]]:
        """Holds ``action`` for one period.

        Raises:
            InputError: the action has the wrong length, is NaN or beyond -1..1; nothing has moved then.
            gymnasium.error.ResetNeeded: there is no episode, or it has terminated.
        """
        mechanics = self.mechanics
        if not mechanics.started[0]:
            raise gymnasium.error.ResetNeeded("there is no episode yet: call reset()")
        if (status := mechanics.status(0)) != "running":
            raise gymnasium.error.ResetNeeded(f"the episode has ended, {status}: call reset()")
        values, expected = as_array(action), mechanics.inputs.shape[1:]
        if values.shape != expected:
            raise InputError(f"the action has shape {values.shape}, expected {expected}")
        mechanics.step(values[np.newaxis])
        info = mechanics.info(0)
        self._gallery.show(mechanics)
        return mechanics.observations()[0], float(mechanics.rewards()[0]), info["status"] != "running", False, info

    def render(self) -> Any:
        """The rover as it is now, by ``render_mode``; see :mod:`bekker.render`. In the mode "human", `reset` and `step`
        have shown it already."""
        return self._gallery.render(self.mechanics, 0)

    def close(self) -> None:
        """Closes the window of the mode "human"."""
        self._gallery.close()

    def snapshot(self) -> RoverSnapshot:
        """This moment; what happens later does not change it."""
        return RoverSnapshot(self.mechanics.snapshot(), self.np_random.bit_generator.state)

    def restore(self, snapshot: RoverSnapshot) -> None:
        """Goes on from a snapshot of an environment with the same arguments, to the same bits."""
        self.mechanics.restore(snapshot.mechanics)
        self.np_random.bit_generator.state = snapshot.random
        self._gallery.show(self.mechanics)


def spaces_of(setup: Setup, mechanics: Mechanics) -> tuple["spaces.Box[np.float32]", "spaces.Box[np.float32]"]:
    """Observation and action space of one rover."""
    limit = setup.observer.limit.astype(np.float32)
    return spaces.Box(-limit, limit, dtype=np.float32), spaces.Box(-1.0, 1.0, mechanics.inputs.shape[1:], np.float32)
