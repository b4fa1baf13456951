"""Many rovers as one vector environment, stepped together in the core."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any, TypeAlias

import gymnasium
import numpy as np
from gymnasium.utils import seeding
from gymnasium.vector import AutoresetMode, VectorEnv
from gymnasium.vector.utils import batch_space
from numpy.random import Generator
from numpy.typing import ArrayLike, NDArray
from typing_extensions import Unpack

from .arguments import Arguments, Levelled, Options, Setup
from .env import spaces_of
from .errors import InputError
from .mechanics import Mechanics, MechanicsState
from .models import ModelLike
from .render import Gallery
from .tasks import Task

__all__ = ["RoverVectorEnv", "VectorSnapshot"]

Array: TypeAlias = NDArray[Any]
Bools: TypeAlias = NDArray[np.bool_]
Stepped: TypeAlias = tuple[Array, NDArray[np.float64], Bools, Bools, dict[str, Any]]


@dataclass(frozen=True)
class VectorSnapshot:
    """A moment of a vector environment, which goes on to the same bits."""

    mechanics: MechanicsState
    random: list[Mapping[str, Any]]
    done: Bools


class RoverVectorEnv(Levelled, VectorEnv[Array, Array, Array]):
    """Many rovers, each as :class:`bekker.RoverEnv`: environment i of a batch that is reset with a seed s does, bit for bit,
    what a single one does that is reset with the seed s + i, for any number of environments and threads.

    Args:
        num_envs: number of rovers.
        model, task, render_mode, arguments: as :class:`bekker.RoverEnv`.
        max_episode_steps: steps after which an episode is truncated; never where None.
        autoreset_mode: when an episode that has ended starts anew, as gymnasium defines it.
        threads: threads that step the rovers.
        copy: whether observations are new arrays; else each call overwrites those that the last one returned.
    """

    def __init__(
        self,
        num_envs: int = 1,
        model: ModelLike | None = None,
        *,
        task: str | Task = "Rover",
        max_episode_steps: int | None = None,
        autoreset_mode: AutoresetMode | str = AutoresetMode.NEXT_STEP,
        threads: int = 1,
        copy: bool = True,
        render_mode: str | None = None,
        **arguments: Unpack[Arguments],
    ) -> None:
        for name, number in (("num_envs", num_envs), ("threads", threads)):
            if number < 1:
                raise InputError(f"{name} = {number}: expected 1 at least")
        self.num_envs = num_envs
        self.max_episode_steps = max_episode_steps
        self.autoreset_mode = AutoresetMode(autoreset_mode)
        self.render_mode = render_mode
        self.copy = copy
        self.setup = Setup(task, model, arguments)
        self.mechanics = Mechanics(self.setup, num_envs, threads)
        self._gallery = Gallery(render_mode, self.setup.period)
        self.metadata = self._gallery.metadata | {"autoreset_mode": self.autoreset_mode}
        self.single_observation_space, self.single_action_space = spaces_of(self.setup, self.mechanics)
        self.observation_space = batch_space(self.single_observation_space, num_envs)
        self.action_space = batch_space(self.single_action_space, num_envs)
        self._random: list[Generator | None] = [None] * num_envs
        self._done = np.zeros(num_envs, np.bool_)
        self._observations = np.zeros(self.observation_space.shape or (), np.float32)

    def reset(
        self, *, seed: int | Sequence[int | None] | None = None, options: dict[str, Any] | None = None
    ) -> tuple[Array, dict[str, Any]]:
        """Starts episodes: of all, or of those that ``options["reset_mask"]`` marks.

        Args:
            seed: s for the seeds s, s + 1 ...; or one for each. None leaves a stream as it is.
            options: as :meth:`bekker.RoverEnv.reset`, the same for all, and ``reset_mask``.
        """
        given = dict(options or {})
        mask = self._mask(given.pop("reset_mask", None))
        seeds = self._seeds(seed)
        chosen = Options.of(given, self.setup)
        for index in np.flatnonzero(mask):
            self._start(int(index), seeds[int(index)], chosen)
        self._done[mask] = False
        self._gallery.show(self.mechanics)
        return self._observed(), self._infos(mask)

    def step(self, actions: ArrayLike) -> Stepped:
        """Holds a row of actions in each rover for one period. In the mode NEXT_STEP, rovers whose episodes ended in the last
        step are reset instead, whatever their actions are.

        Raises:
            InputError: actions have the wrong shape, or one is NaN or beyond -1..1; nothing has moved then.
            gymnasium.error.ResetNeeded: a rover has never been reset or, in the mode DISABLED, its episode has ended.
        """
        self._check_ready()
        stale, mechanics = self._done, self.mechanics
        mechanics.step(actions, ~stale if stale.any() else None)
        for index in np.flatnonzero(stale):
            self._start(int(index), None, None)
        rewards, terminated = mechanics.rewards(), mechanics.terminated & ~stale
        limit = self.max_episode_steps
        truncated = ~stale & (mechanics.elapsed >= limit) if limit is not None else np.zeros(self.num_envs, np.bool_)
        done = terminated | truncated
        infos: dict[str, Any] = {}
        if self.autoreset_mode == AutoresetMode.SAME_STEP and done.any():
            infos = self._ended(done)
            for index in np.flatnonzero(done):
                self._start(int(index), None, None)
            self._done = np.zeros(self.num_envs, np.bool_)
        else:
            self._done = done
        everywhere = np.ones(self.num_envs, np.bool_)
        self._gallery.show(mechanics)
        return self._observed(), rewards, terminated, truncated, infos | self._infos(everywhere)

    def _check_ready(self) -> None:
        started = self.mechanics.started
        if not started.all():
            raise gymnasium.error.ResetNeeded(f"environment {np.flatnonzero(~started)[0]} has no episode yet: call reset()")
        if self.autoreset_mode == AutoresetMode.DISABLED and self._done.any():
            ended = np.flatnonzero(self._done).tolist()
            raise gymnasium.error.ResetNeeded(
                f'episodes of the environments {ended} have ended: call reset(options={{"reset_mask": ...}})'
            )

    def _start(self, index: int, seed: int | None, options: Options | None) -> None:
        random = self._random[index]
        if seed is not None or random is None:
            random, _ = seeding.np_random(seed)
            self._random[index] = random
        self.mechanics.start(index, random, seed, options)

    def _mask(self, mask: Any) -> Bools:
        if mask is None:
            return np.ones(self.num_envs, np.bool_)
        if not isinstance(mask, np.ndarray) or mask.dtype != np.bool_ or mask.shape != (self.num_envs,) or not mask.any():
            raise InputError(f"reset_mask = {mask}: expected an array of {self.num_envs} booleans, one of them true")
        return mask

    def _seeds(self, seed: int | Sequence[int | None] | None) -> Sequence[int | None]:
        if seed is None:
            return [None] * self.num_envs
        if isinstance(seed, int | np.integer):
            return [int(seed) + k for k in range(self.num_envs)]
        if len(seed) != self.num_envs:
            raise InputError(f"{len(seed)} seeds: expected {self.num_envs}")
        return seed

    def _observed(self) -> Array:
        return self.mechanics.observations(None if self.copy else self._observations)

    def _ended(self, done: Bools) -> dict[str, Any]:
        """What is known of episodes at their ends, before they start anew."""
        final = np.full(self.num_envs, None, dtype=object)
        observations = self.mechanics.observations()
        for index in np.flatnonzero(done):
            final[index] = observations[index]
        return {"final_obs": final, "_final_obs": done.copy(), "final_info": self._infos(done), "_final_info": done.copy()}

    def _infos(self, where: Bools) -> dict[str, Any]:
        """``info`` of the rovers in ``where``, as gymnasium puts them together: arrays, and under ``_name`` for whom."""
        infos: dict[str, Any] = {}
        for name, column in self.mechanics.columns().items():
            if not where.all():
                column[~where] = None if column.dtype == object else 0
            infos[name], infos[f"_{name}"] = column, where.copy()
        drawn: dict[str, Array] = {}
        for name, (values, mask) in self.mechanics.drawn.items():
            here = mask & where
            if here.any():
                drawn[name], drawn[f"_{name}"] = np.where(here, values, 0.0), here
        return infos | {"drawn": drawn, "_drawn": where.copy()}

    def render(self) -> tuple[Any, ...] | None:
        """A frame (or text) of every rover; a window shows the first."""
        if self.render_mode is None:
            return None
        shown = 1 if self.render_mode == "human" else self.num_envs
        return tuple(self._gallery.render(self.mechanics, index) for index in range(shown))

    def close_extras(self, **kwargs: Any) -> None:
        """Closes the window of the mode "human"."""
        self._gallery.close()

    def snapshot(self) -> VectorSnapshot:
        """This moment; what happens later does not change it."""
        self._check_reset()
        random = [generator.bit_generator.state for generator in self._random if generator is not None]
        return VectorSnapshot(self.mechanics.snapshot(), random, self._done.copy())

    def restore(self, snapshot: VectorSnapshot) -> None:
        """Goes on from a snapshot of a vector environment with the same arguments, to the same bits."""
        self.mechanics.restore(snapshot.mechanics)
        self._random = []
        for state in snapshot.random:
            generator, _ = seeding.np_random(0)
            generator.bit_generator.state = state
            self._random.append(generator)
        self._done = snapshot.done.copy()
        self._gallery.show(self.mechanics)

    def _check_reset(self) -> None:
        if not self.mechanics.started.all():
            raise gymnasium.error.ResetNeeded("there are environments without an episode yet: call reset()")
