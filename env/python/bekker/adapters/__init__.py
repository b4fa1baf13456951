"""Bridges to libraries of reinforcement learning. Each module needs its library; importing bekker needs none of them.

- :mod:`bekker.adapters.sb3`: the native vector environment as a `VecEnv` of stable-baselines3.
- :mod:`bekker.adapters.torchrl`: as an environment of TorchRL.
- :mod:`bekker.adapters.pufferlib`: as an environment of PufferLib.
- :mod:`bekker.adapters.minari`: episodes of a policy as a data set of Minari.
"""
