#!/usr/bin/env bash
# Builds the FMU library for 64 bit Windows, for `bekker fmu --library FILE`: without the plant of rigid bodies or, with
# the second argument `rigid`, with it. Needs Debian's gcc-mingw-w64-x86-64 or another mingw-w64.
# Arguments: where to write the DLL; `rigid` or nothing.
set -euo pipefail
output=$(realpath -m "${1:?where to write the DLL}")
features=${2:-}
cd "$(dirname "$0")/../.."
target=x86_64-pc-windows-gnu
rustup target add "$target"
folder="${CARGO_TARGET_DIR:-$PWD/target}/windows"
# As in fmu/package/build.rs: a panic must be caught at the C border, so it has to unwind.
CARGO_PROFILE_RELEASE_LTO=fat CARGO_PROFILE_RELEASE_CODEGEN_UNITS=1 \
CARGO_PROFILE_RELEASE_PANIC=unwind CARGO_PROFILE_RELEASE_STRIP=symbols \
    cargo rustc -p bekker-fmu --lib --crate-type cdylib --release --target "$target" \
    --no-default-features --features "$features" --target-dir "$folder"
mkdir -p "$(dirname "$output")"
cp "$folder/$target/release/bekker_fmu.dll" "$output"
x86_64-w64-mingw32-objdump -p "$output" | grep "DLL Name"
