#!/usr/bin/env bash
# The composition operators run, on a private network: images as the Dockerfiles' runtime stages make them, with binaries
# built outside. Surveys, walks, kills the server under load and looks that nothing acknowledged is gone.
#   composition_test.sh SOURCE BUILD
set -euo pipefail
SOURCE=$1 BUILD=$2
HERE=$(cd "$(dirname "$0")" && pwd)
WORK=$(mktemp -d)
PROJECT=wayfuse-test-$$
# shellcheck source=engine.sh
. "$HERE/engine.sh"

compose() {
  if docker compose version >/dev/null 2>&1; then docker compose -p "$PROJECT" -f "$SOURCE/docker/compose.yaml" "$@"
  elif command -v docker-compose >/dev/null; then docker-compose -p "$PROJECT" -f "$SOURCE/docker/compose.yaml" "$@"
  else skip "neither docker compose nor docker-compose is installed"
  fi
}

clean_up() {
  local status=$?
  if [ -n "${UP:-}" ]; then
    [ $status -eq 0 ] || compose logs --tail 20 >&2 || true
    compose down -v -t 5 >/dev/null 2>&1 || true
  fi
  stop_engine
  rm -rf "$WORK"
  exit $status
}
trap clean_up EXIT
die() { printf 'FAILED: %s\n' "$*" >&2; exit 1; }
ok() { printf 'ok: %s\n' "$*"; }

# The runtime stage of a Dockerfile with the files it copies taken from a folder instead of the build stage.
build_image() {  # NAME DOCKERFILE FILE...
  local name=$1 dockerfile=$2; shift 2
  local context=$WORK/context-${name#*/}
  mkdir -p "$context"
  cp "$@" "$context"
  strip "$context"/wayfuse* 2>/dev/null || true
  sed -n '/AS runtime/,$p' "$SOURCE/docker/$dockerfile" | sed -E 's#--from=build ##; s#/(build|source)/[a-z]+/([a-z-]+)#\2#g' >"$context/Dockerfile"
  docker build -q -t "$name" "$context" >/dev/null
}

in_server() { compose exec -T wayfused "$@"; }
wayfuse() { in_server sh -c 'WAYFUSE_KEY=$(cat /keys/first-admin-key) exec wayfuse "$@"' wayfuse "$@"; }
wait_for() {  # SECONDS WHAT COMMAND...
  local left=$(($1 * 2)) what=$2; shift 2
  until "$@" >/dev/null 2>&1; do
    [ $((left--)) -gt 0 ] || die "$what"
    sleep 0.5
  done
  ok "$what"
}
points() { wayfuse --json building show 1 | sed -n 's/.*"points":\([0-9]*\).*/\1/p'; }
some_connected() { wayfuse --json sessions | grep -q '"connected":true'; }
some_positions() { wayfuse --json sessions | grep -q '"radius68_m"'; }

find_engine
build_image wayfuse/server server.Dockerfile "$BUILD/server/wayfused" "$BUILD/admin/wayfuse"
build_image wayfuse/phone phone.Dockerfile "$BUILD/sdk/wayfuse-phone" "$BUILD/admin/wayfuse" "$SOURCE/docker/survey-and-walk"
for image in wayfuse/server wayfuse/phone; do
  bytes=$(docker image inspect -f '{{.Size}}' $image)
  base=$(docker image inspect -f '{{.Size}}' debian:bookworm-slim)
  printf 'image %s: %d MB, of which base %d MB\n' $image $((bytes / 1000000)) $((base / 1000000))
done
UP=1
compose up -d --no-build certificate wayfused phones
wait_for 60 "the server is ready over TLS" wayfuse status
[ "$(in_server id -u)" = 10001 ] || die "the server must not run as root"
in_server sh -c 'touch /usr/bin/x' 2>/dev/null && die "the root file system must be read-only"
ok "not root, root file system read-only"
in_server sh -c 'WAYFUSE_KEY=wf_wrong wayfuse building list' 2>/dev/null && die "a wrong key must be refused"
ok "a wrong key is refused"
wait_for 90 "phones walk and have positions" some_positions
before=$(points)
[ "$before" -gt 100 ] || die "the survey holds $before points only"

compose kill -s SIGKILL wayfused >/dev/null 2>&1
compose up -d --no-build wayfused >/dev/null 2>&1
wait_for 60 "ready again after kill -9 under load" wayfuse status
[ "$(points)" = "$before" ] || die "acknowledged points were lost: $before before, $(points) after"
ok "all $before acknowledged points are there"
wait_for 60 "phones reconnected by themselves" some_connected
wait_for 60 "and have positions again" some_positions

compose stop -t 15 wayfused >/dev/null 2>&1
code=$(docker inspect -f '{{.State.ExitCode}}' "$(compose ps -q -a wayfused 2>/dev/null || compose ps -q wayfused)")
[ "$code" = 0 ] || die "SIGTERM must drain and leave with 0, not $code"
ok "SIGTERM drains and leaves with 0"
