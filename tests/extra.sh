#!/usr/bin/env bash
# Tests with libraries of reinforcement learning, which are large (some 6 GB with PyTorch as the registry has it): the
# bridges, videos, and a short training. Not part of `.ci/run`; after `bash tests/run.sh`, which builds the package.
set -euo pipefail
cd "$(dirname "$0")/.."
.venv/bin/python -m pip install --quiet --disable-pip-version-check -r tests/extra/requirements.txt
# TorchRL and PufferLib name versions of others that they can do without here.
.venv/bin/python -m pip install --quiet --disable-pip-version-check --no-deps torchrl==0.14.1 tensordict==0.14.3 hoptorch \
    pyvers importlib_metadata orjson pufferlib==2.0.2 gym==0.26.2 gym_notices
.venv/bin/python -m pytest --quiet -W ignore tests/extra
