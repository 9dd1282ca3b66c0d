#!/usr/bin/env bash
# Builds the wheel with the command inside, into python/dist. SPRINGFIT_PROGRAM names a program that is built already.
set -euo pipefail
cd "$(dirname "$0")"
target="$(realpath -m "${CARGO_TARGET_DIR:-../target}")"
export CARGO_TARGET_DIR="$target"
program="${SPRINGFIT_PROGRAM:-}"
if [ -z "$program" ]; then
    cargo build --release --locked --manifest-path ../Cargo.toml --bin springfit
    program="$target/release/springfit"
fi
# What maturin puts into the wheel's scripts.
rm -rf springfit.data dist
mkdir -p springfit.data/scripts
cp "$program" springfit.data/scripts/springfit
strip springfit.data/scripts/springfit
maturin build --release --locked --out dist
