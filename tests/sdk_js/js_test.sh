#!/bin/sh
# The JavaScript face in Node: the same recording through it and through the native core, and the printed example.
# usage: js_test.sh SOURCE FOLDER_OF_WAYFUSE.MJS WAYFUSE_PHONE NATIVE_MOTION; without Emscripten or Node it skips (77)
set -eu
source=$1 js=$2 phone=$3 native=$4
command -v node >/dev/null || { echo "SKIPPED: no node (Debian: nodejs)" >&2; exit 77; }
[ -f "$js/wayfuse_motion.mjs" ] || { echo "SKIPPED: not built, Emscripten was missing at configuration (Debian: emscripten)" >&2; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
"$phone" record --minutes 2 --carrying changing "$work/walk.jsonl"
"$native" "$work/walk.jsonl" >"$work/native"
node "$source/tests/sdk_js/compare.mjs" "$js" "$work/walk.jsonl" "$work/native"
node "$source/sdk/examples/moving_dot.mjs" "$work/walk.jsonl" "$js" >"$work/said"
steps=$(sed -n 's/^\([0-9]*\) steps, the phone is .*/\1/p' "$work/said")
[ "${steps:-0}" -gt 50 ] || { echo "the example counted '$steps' steps:" >&2; tail -3 "$work/said" >&2; exit 1; }
grep -qE '^-?[0-9.]+ m east, -?[0-9.]+ m north' "$work/said"
stat -c 'wayfuse_motion.mjs: %s bytes' "$js/wayfuse_motion.mjs"
