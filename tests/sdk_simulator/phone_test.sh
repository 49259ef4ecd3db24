#!/bin/sh
# wayfuse-phone from the outside, against a server: record a walk, survey its world, replay the walk and see errors against its truth.
# usage: phone_test.sh WAYFUSE_PHONE WAYFUSED WAYFUSE
set -eu
phone=$1 server=$2 cli=$3
work=$(mktemp -d)
trap 'kill "${pid:-}" 2>/dev/null || true; wait "${pid:-}" 2>/dev/null || true; rm -rf "$work"' EXIT
fail() { echo "$*" >&2; exit 1; }

"$phone" world --kind warehouse --pipeline wknn >"$work/world.json"
"$phone" record --kind warehouse --minutes 0.6 --carrying changing --throttled "$work/walk.jsonl"
"$phone" record --kind warehouse --minutes 0.6 --carrying changing --throttled "$work/again.jsonl"
cmp "$work/walk.jsonl" "$work/again.jsonl" || fail "the same seed gave another walk"
"$phone" record --kind warehouse --minutes 0.6 --walk 1 "$work/other.jsonl"
cmp -s "$work/walk.jsonl" "$work/other.jsonl" && fail "another walk is the same walk"
"$phone" record --kind castle "$work/none" 2>"$work/said" && fail "a castle was built"
grep -q warehouse "$work/said" || fail "the kinds are not named: $(cat "$work/said")"

: >"$work/server"   # before anybody looks for it
"$server" --server.data "$work/data" --listen.port 0 --log.level warn >>"$work/server" &
pid=$!
tail -n +1 -f "$work/server" --pid "$pid" | sed -n '/"event":"ready"/q'
url=$(sed -n 's/.*"url":"\([^"]*\)".*/\1/p' "$work/server")
WAYFUSE_KEY=$(sed -n 's/.*"admin_key":"\([^"]*\)".*/\1/p' "$work/server")
export WAYFUSE_KEY
"$cli" --server "$url" --json building create "$work/world.json" >"$work/building"
building=$(sed -n 's/^{"id":\([0-9]*\).*/\1/p' "$work/building")
socket="ws${url#http}/v1/session"
"$phone" survey --kind warehouse --passes 1 --server "$socket" --building "$building"
"$phone" replay "$work/walk.jsonl" --server "$socket" --building "$building" --speed 12 | tee "$work/replayed"
grep -qE '^  fused +[0-9.]+ .* [1-9][0-9]*$' "$work/replayed" || fail "no errors against the truth"
grep -qE '^  dead reckoning .* [1-9][0-9]*$' "$work/replayed" || fail "no dead reckoning beside it"

# A dense mall: over a thousand transmitters in the air, more than a message takes. The stand-in phone, like any other, hands them all over.
dense="--floors 1 --length 60 --width 50 --transmitters 200 --networks 8"
"$phone" world --kind mall $dense --pipeline default >"$work/mall.json"
"$cli" --server "$url" --json building create "$work/mall.json" >"$work/building"
mall=$(sed -n 's/^{"id":\([0-9]*\).*/\1/p' "$work/building")
"$phone" survey --kind mall $dense --passes 1 --server "$socket" --building "$mall"
"$phone" record --kind mall $dense --minutes 0.5 "$work/mall.jsonl"
for _ in 1 2 3 4 5; do  # its map is made beside the walk, and a busy machine takes longer for it than the walk does at this speed
  "$phone" replay "$work/mall.jsonl" --server "$socket" --building "$mall" --speed 12 | tee "$work/replayed"
  grep -qE '^  fused +[0-9.]+ .* [1-9][0-9]*$' "$work/replayed" && break
done
grep -qE '^  fused +[0-9.]+ .* [1-9][0-9]*$' "$work/replayed" || fail "no position in a mall"

# A recording that is cut off in the middle of a line is named, not guessed at.
head -c 5000 "$work/walk.jsonl" >"$work/cut.jsonl"
"$phone" replay "$work/cut.jsonl" --server "$socket" --building "$building" 2>"$work/said" && fail "a broken recording was replayed"
grep -q "cut.jsonl: line" "$work/said" || fail "the broken line is not named: $(cat "$work/said")"
echo "recorded, surveyed, replayed"
