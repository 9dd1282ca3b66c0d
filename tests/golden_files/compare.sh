#!/usr/bin/env bash
# Compares two commits, or two programs, on this machine to the bit: all outputs of the cases of the golden files, without what is masked.
#
#     tests/golden_files/compare.sh REVISION REVISION
#     tests/golden_files/compare.sh --programs PROGRAM PROGRAM
#
# The tests of this working tree run both programs: their list of cases, and their masks. Commits are built in worktrees beside each other
# with one target folder, so that what they have in common is compiled once. SPRINGFIT_GOLDEN_TESTS names tests that are built already.
set -euo pipefail
cd "$(dirname "$0")/../.."
work="$(mktemp -d)"
trap 'git worktree prune; rm -rf "$work"' EXIT

if [ "${1:-}" = "--programs" ]; then
    first="$(realpath "$2")" second="$(realpath "$3")"
elif [ $# -eq 2 ]; then
    target="$(realpath -m "${CARGO_TARGET_DIR:-target}")/golden"
    for side in first second; do
        revision="$1"
        [ "$side" = first ] || revision="$2"
        # The same folder for both: the paths of sources are part of what cargo knows as built.
        git worktree add --detach --force "$work/tree" "$revision" > /dev/null
        (cd "$work/tree" && CARGO_TARGET_DIR="$target" cargo build --release --locked --bin springfit)
        cp "$target/release/springfit" "$work/$side"
        git worktree remove --force "$work/tree"
    done
    first="$work/first" second="$work/second"
else
    sed -n 's/^#  *\(tests\/golden\)/usage: \1/p' "$0" >&2
    exit 2
fi

tests="${SPRINGFIT_GOLDEN_TESTS:-}"
if [ -z "$tests" ]; then
    tests="$(cargo test --release --test all --no-run --message-format json | sed -n 's/.*"executable":"\([^"]*all-[^"]*\)".*/\1/p' | tail -n 1)"
fi
mkdir "$work/data"
export SPRINGFIT_GOLDEN_EXACT=1 SPRINGFIT_GOLDEN_DATA="$work/data"
SPRINGFIT_GOLDEN_PROGRAM="$first" SPRINGFIT_WRITE_GOLDEN=1 "$tests" golden_files --nocapture > "$work/first.log" 2>&1 ||
    { cat "$work/first.log"; exit 1; }
status=0
SPRINGFIT_GOLDEN_PROGRAM="$second" RUST_BACKTRACE=0 "$tests" golden_files --nocapture > "$work/second.log" 2>&1 || status=1
grep -v '^test \|^running\|^thread\|^note: run with\|^failures:\|^    golden_files\|^$' "$work/second.log" || true
[ "$status" -ne 0 ] || echo "no output differs by a bit"
exit "$status"
