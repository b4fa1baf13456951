#!/usr/bin/env bash
# Builds the command line with FMU libraries that load with glibc 2.17 (2012) and newer, and shows what they need.
# Needs `pip install cargo-zigbuild ziglang` on the PATH. Without this script, plain cargo links with this machine's
# glibc, and FMUs load with that version and newer.
# Argument: the oldest glibc (2.17).
set -euo pipefail
cd "$(dirname "$0")/../.."
BEKKER_FMU_GLIBC=${1:-2.17} cargo build --release -p bekker-cli --features large-library
for library in "${CARGO_TARGET_DIR:-target}"/release/build/bekker-fmu-package-*/out/{PLAIN,RIGID}.so; do
    echo "$library: $(stat -c %s "$library") bytes"
    readelf -d "$library" | grep NEEDED
    objdump -T "$library" | grep -o "GLIBC_[0-9.]*" | sort -Vu | tail -1
done
