#!/usr/bin/env bash
# Builds the wheel with the command inside, into python/dist.
set -euo pipefail
cd "$(dirname "$0")"
target="$(realpath -m "${CARGO_TARGET_DIR:-../target}")"
export CARGO_TARGET_DIR="$target"
cargo build --release --locked --manifest-path ../Cargo.toml --bin springfit
# What maturin puts into the wheel's scripts.
rm -rf springfit.data
mkdir -p springfit.data/scripts
cp "$target/release/springfit" springfit.data/scripts/springfit
strip springfit.data/scripts/springfit
maturin build --release --locked --out dist
