#!/usr/bin/env bash
# The composition operators run, on a private network, with binaries built outside: served, broken, moved.
#   composition_test.sh SOURCE BUILD [SCENARIO...]
set -euo pipefail
SOURCE=$1 BUILD=$2; shift 2
HERE=$(cd "$(dirname "$0")" && pwd)
WORK=$(mktemp -d)

die() { printf 'FAILED: %s\n' "$*" >&2; exit 1; }
ok() { printf '%4d s  ok: %s\n' "$SECONDS" "$*"; }
for part in engine images composition serving breaking moving; do
  # shellcheck source=/dev/null
  . "$HERE/$part.sh"
done

clean_up() {
  local status=$?
  trap - EXIT INT TERM
  if [ -n "${UP:-}" ]; then
    [ $status -eq 0 ] || compose logs --tail 20 >&2 || true
    local left; left=$(docker ps -a -q --filter "name=$PROJECT")
    [ -z "$left" ] || docker rm -f $left >/dev/null 2>&1
    compose down -v -t 5 >/dev/null 2>&1 || true
    docker network ls -q --filter "name=$PROJECT-" | xargs -r docker network rm >/dev/null 2>&1
    docker volume ls -q --filter "name=$PROJECT-" | xargs -r docker volume rm >/dev/null 2>&1
    docker image rm -f wayfuse-test/{server,phone,prometheus,tests} >/dev/null 2>&1
  fi
  stop_engine
  rm -rf "$WORK"
  exit $status
}
trap clean_up EXIT
trap 'exit 130' INT TERM

find_engine
build_images
it_comes_up_locked_down
[ $# -gt 0 ] || set -- images_are_fit keys_are_refused_and_accepted the_console_is_reachable prometheus_scrapes the_integration_suite_passes behind_a_reverse_proxy \
  killed_under_load disconnected_and_paused memory_limit_reached volume_full rolled_to_a_newer_image an_old_database_is_migrated \
  backed_up_and_restored_elsewhere sigterm_drains
for scenario in "$@"; do
  printf '%4d s  %s\n' "$SECONDS" "$scenario"
  "$scenario"
done
