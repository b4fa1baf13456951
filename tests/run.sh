#!/usr/bin/env bash
# All tests: Rust, then Python in a virtual environment of its own (.venv), then a small part of the study on hidden effects.
set -euo pipefail
cd "$(dirname "$0")/.."
cargo test --workspace
python3 -m venv .venv
# In the profile of the Rust tests, so that what they have compiled serves here too.
MATURIN_PEP517_ARGS="--profile dev" .venv/bin/python -m pip install --quiet --disable-pip-version-check --upgrade "./env[test]"
.venv/bin/python -m mypy --strict env/python/bekker
.venv/bin/python -m mypy.stubtest bekker._bekker
# `cargo test` has built the examples with which the Python tests compare.
BEKKER_EXAMPLES="$PWD/target/debug/examples" .venv/bin/python -m pytest --quiet -n auto env/tests
.venv/bin/python -m pytest --quiet -n auto tests/generators tests/study
.venv/bin/python tests/study/study.py --quick --bekker target/debug/bekker --out target/study-quick
