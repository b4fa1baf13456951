#!/usr/bin/env bash
# Random calls on both C borders under valgrind: no invalid access, no use of unset memory, nothing leaked.
# Arguments: number of calls (5000), first seed (1), number of seeds (2).
set -euo pipefail
cd "$(dirname "$0")/../.."
calls=${1:-5000}
first=${2:-1}
count=${3:-2}
cargo build -p bekker-fmu --example fuzz
program="${CARGO_TARGET_DIR:-target}/debug/examples/fuzz"
for ((seed = first; seed < first + count; seed++)); do
    valgrind --quiet --error-exitcode=99 --leak-check=full --errors-for-leak-kinds=definite "$program" "$calls" "$seed"
done
