#!/usr/bin/env bash
# All tests: Rust, then Python in a virtual environment of its own (.venv), then a small part of the study on hidden effects.
# Ends with the tests that did not run, for want of measurements (their folder: BEKKER_DATA) or of a tool.
set -euo pipefail
cd "$(dirname "$0")/.."
mkdir -p target
log=target/tests.log
: >"$log"
# libtest and libtest-mimic say `test NAME ... ignored` and why; a test that another one runs in a child process is no gap.
skipped() {
    local names
    names=$(sed -nE -e '/ child process/d' -e 's/^test (.*[^ ]) +\.\.\. ignored/\1/p' -e 's/^SKIPPED //p' "$log")
    if [ -z "$names" ]; then echo "no test skipped"; else printf '%d tests skipped:\n%s\n' "$(wc -l <<<"$names")" "$names"; fi
}
trap skipped EXIT
cargo test --workspace --no-run
python_package() {
    python3 -m venv .venv
    # In the profile of the Rust tests and with their features, so that what they have compiled serves here too.
    MATURIN_PEP517_ARGS="--profile dev --features as-tested" .venv/bin/python -m pip install --quiet --disable-pip-version-check --upgrade "./env[test]"
    .venv/bin/python -m mypy --strict env/python/bekker
    .venv/bin/python -m mypy.stubtest bekker._bekker
    # FMUs in the Rust crate `fmi`, whose bindings need libclang at build time; the wheel has it, the headers are the C compiler's.
    .venv/bin/python -m pip install --quiet --disable-pip-version-check libclang || echo "no wheel of libclang"
    LIBCLANG_PATH=$(.venv/bin/python -c "import clang, pathlib; print(pathlib.Path(clang.__path__[0]) / 'native')" || true) \
    BINDGEN_EXTRA_CLANG_ARGS="-I$(cc -print-file-name=include)" \
        cargo build --quiet --locked --manifest-path fmu/judge/Cargo.toml --target-dir target/judge || echo "fmu/judge is not built"
    # For the tests in a browser.
    .venv/bin/python -m pip install --quiet --disable-pip-version-check playwright axe-playwright-python || echo "no playwright"
}
python_tests() {
    python_package
    export BEKKER_FMU_JUDGE="$PWD/target/judge/debug/bekker-fmu-judge"
    # `cargo test --no-run` has built the examples with which the Python tests compare.
    BEKKER_EXAMPLES="$PWD/target/debug/examples" .venv/bin/python -m pytest --quiet -rs --no-fold-skipped -n auto env/tests
    .venv/bin/python -m pytest --quiet -rs --no-fold-skipped -n auto tests/study tests/generators
}
# The package is built and tested while the Rust tests run, many of which keep only one core busy; in a shell of its own, so that it
# stops at its first failure.
export -f python_package python_tests
bash -euo pipefail -c python_tests >target/python.log 2>&1 &
python=$!
cargo test --workspace | tee -a "$log"
python3 fmu/scripts/third_party.py --check
tested=0
wait "$python" || tested=$?
tee -a "$log" <target/python.log
[ "$tested" = 0 ]
# Beside the tests in a browser, which wait more than they compute.
.venv/bin/python tests/study/study.py --quick --bekker target/debug/bekker --out target/study-quick >target/study.log 2>&1 &
studying=$!
# The workbench in a browser, where Chromium is installed.
.venv/bin/python -m pytest --quiet -rs --no-fold-skipped studio/tests/browser | tee -a "$log"
studied=0
wait "$studying" || studied=$?
cat target/study.log
exit "$studied"
