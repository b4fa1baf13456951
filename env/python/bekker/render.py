# mypy: disable-error-code="import-untyped,import-not-found"
"""Pictures of rovers: what ``render()`` of the environments gives.

- ``rgb_array``: a frame, height x width x 3 bytes, drawn in Rust without a display: the rover in its cross-section of the
  ground, loose soil paler, ruts as deep as the wheels have sunk, normal forces and drawbar pulls, time, reward, speed and slip,
  and where the task has them the goal's flag and the speed asked for.
- ``ansi``: a line of numbers and the profile of the ground in characters.
- ``human``: the same frames in a window (pygame or, without it, matplotlib), shown by every step, reset and restored
  snapshot; ``render()`` itself has nothing left to do. A process has one window of pygame.
"""

from typing import Any, Protocol

import gymnasium
import numpy as np
from numpy.typing import NDArray

from ._bekker import Model, Renderer
from .mechanics import Mechanics

__all__ = ["RENDER_MODES", "SIZE", "Gallery"]

Frame = NDArray[np.uint8]

RENDER_MODES = ["rgb_array", "ansi", "human"]

SIZE = (960, 540)
"""Width and height of a frame, pixels: both even, as video encoders want them."""


class Window(Protocol):
    """Where frames are shown."""

    def show(self, frame: Frame) -> None:
        """Shows one."""

    def close(self) -> None:
        """Closes it."""


class Gallery:
    """The renderers of some rovers: each remembers the ruts of its episode, so a new model gets a new one."""

    def __init__(self, mode: str | None, period: float) -> None:
        if mode is not None and mode not in RENDER_MODES:
            raise gymnasium.error.UnsupportedMode(f"render_mode = {mode!r}: expected {', '.join(RENDER_MODES)} or None")
        self.mode, self._period = mode, period
        self._renderers: dict[int, tuple[Model, Renderer]] = {}
        self._window: Window | None = None

    @property
    def metadata(self) -> dict[str, Any]:
        """What gymnasium wants to know of an environment's pictures."""
        return {"render_modes": RENDER_MODES, "render_fps": max(round(1.0 / self._period), 1)}

    def render(self, mechanics: Mechanics, index: int) -> Frame | str | None:
        """The rover as it is now; nothing in the mode "human", where it has been shown already."""
        if self.mode is None:
            gymnasium.logger.warn("render() does nothing: the environment was made without a render_mode")
            return None
        if not mechanics.started[index]:
            raise gymnasium.error.ResetNeeded("there is no episode yet: call reset()")
        # Drawn again, a loop that calls render() after each step would take twice the time.
        return None if self.mode == "human" else self._drawn(mechanics, index)

    def show(self, mechanics: Mechanics) -> None:
        """Shows the first rover in the window, in the mode "human"."""
        if self.mode != "human":
            return
        if self._window is None:
            self._window = _window(1.0 / self._period)
        frame = self._drawn(mechanics, 0)
        assert not isinstance(frame, str)
        self._window.show(frame)

    def _drawn(self, mechanics: Mechanics, index: int) -> Frame | str:
        model = mechanics.models[index]
        known, renderer = self._renderers.get(index, (None, None))
        if renderer is None or known is not model:
            renderer = Renderer(model, *SIZE)
            self._renderers[index] = (model, renderer)
        time, row = mechanics.batch.time(index), np.ascontiguousarray(mechanics.signals[index])
        if self.mode == "ansi":
            return renderer.text(time, row, mechanics.status(index))
        return renderer.frame(time, row, mechanics.status(index), **mechanics.asked(index))

    def close(self) -> None:
        """Closes the window, where there is one."""
        if self._window is not None:
            self._window.close()
            self._window = None

    def __deepcopy__(self, memo: dict[int, Any]) -> "Gallery":
        return Gallery(self.mode, self._period)

    def __reduce__(self) -> tuple[type["Gallery"], tuple[str | None, float]]:
        return Gallery, (self.mode, self._period)


def _window(fps: float) -> Window:
    try:
        return _Pygame(fps)
    except ImportError:
        pass
    try:
        return _Matplotlib(fps)
    except ImportError as missing:
        raise gymnasium.error.DependencyNotInstalled(
            'render_mode="human" needs pygame or matplotlib (pip install pygame); "rgb_array" needs neither'
        ) from missing


class _Pygame:
    def __init__(self, fps: float) -> None:
        import pygame

        self._pygame, self._fps = pygame, fps
        # Not all of it: sound would look for a card.
        pygame.display.init()
        pygame.display.set_caption("bekker")
        self._screen = pygame.display.set_mode(SIZE)
        self._clock = pygame.time.Clock()

    def show(self, frame: Frame) -> None:
        self._pygame.event.pump()
        self._pygame.surfarray.blit_array(self._screen, frame.swapaxes(0, 1))
        self._pygame.display.flip()
        self._clock.tick(self._fps)

    def close(self) -> None:
        self._pygame.display.quit()


class _Matplotlib:
    def __init__(self, fps: float) -> None:
        import matplotlib.pyplot as plt

        self._plt, self._pause = plt, 1.0 / fps
        self._figure, axes = plt.subplots(figsize=(9.6, 5.4))
        axes.set_axis_off()
        self._image = axes.imshow(np.zeros((SIZE[1], SIZE[0], 3), dtype=np.uint8))
        self._figure.tight_layout(pad=0.0)

    def show(self, frame: Frame) -> None:
        self._image.set_data(frame)
        self._plt.pause(self._pause)

    def close(self) -> None:
        self._plt.close(self._figure)
