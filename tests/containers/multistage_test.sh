#!/usr/bin/env bash
# The images as users build them: every stage of the Dockerfiles, from debian:bookworm-slim and this source tree, by the
# composition's own build; then served. Minutes, so it is not part of ./run test: ./run images.
#   multistage_test.sh SOURCE
set -euo pipefail
SOURCE=$1
HERE=$(cd "$(dirname "$0")" && pwd)
WORK=$(mktemp -d)

die() { printf 'FAILED: %s\n' "$*" >&2; exit 1; }
ok() { printf '%4d s  ok: %s\n' "$SECONDS" "$*"; }
for part in engine images composition serving; do
  # shellcheck source=/dev/null
  . "$HERE/$part.sh"
done
clean_up() {
  local status=$?
  trap - EXIT INT TERM
  compose down -v -t 5 >/dev/null 2>&1 || true
  stop_engine
  rm -rf "$WORK"
  exit $status
}
trap clean_up EXIT
trap 'exit 130' INT TERM

ENGINE_NETWORK=host
find_engine
make_base_image
ok "debian:bookworm-slim is there"
compose build >"$WORK/build.log" 2>&1 || { tail -n 40 "$WORK/build.log" >&2; die "the images do not build"; }
ok "built from source"
version=$(docker run --rm "$SERVER_IMAGE" --version | sed 's/^wayfused //')
check_image "$SERVER_IMAGE" "$version"
check_image "$PHONE_IMAGE" "$version"
compose up -d --no-build >"$WORK/up.log" 2>&1 || { cat "$WORK/up.log" >&2; die "compose up failed"; }
wait_for 60 "the server is ready over TLS" ready
KEY=$(in_server cat /keys/first-admin-key)
wait_for 120 "phones are positioned" grows_beyond positions_total 50
