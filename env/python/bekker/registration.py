"""The tasks in gymnasium's registry."""

import gymnasium

from .tasks import TASKS


def register() -> None:
    """Registers the tasks, once: importing again, or reloading, changes nothing."""
    for task in TASKS.values():
        if task.id not in gymnasium.registry:
            gymnasium.register(
                task.id,
                entry_point="bekker.env:RoverEnv",
                vector_entry_point="bekker.vector_env:RoverVectorEnv",
                max_episode_steps=task.max_episode_steps,
                kwargs={"task": task.name},
            )
