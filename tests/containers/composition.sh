# The composition under test, and short words for what the scenarios do with it. Sourced by composition_test.sh.

PROJECT=wayfuse-test-$$
NETWORK=${PROJECT}_default
export WAYFUSE_PORT=127.0.0.1: PROMETHEUS_PORT=0 PHONES=10   # any free port: another composition may run beside this one
export SERVER_IMAGE=wayfuse-test/server PHONE_IMAGE=wayfuse-test/phone PROMETHEUS_IMAGE=wayfuse-test/prometheus

compose() {
  if docker compose version >/dev/null 2>&1; then docker compose -p "$PROJECT" -f "$SOURCE/docker/compose.yaml" "$@"
  else docker-compose -p "$PROJECT" -f "$SOURCE/docker/compose.yaml" "$@"
  fi
}
container_of() {
  docker ps -a -q --filter "label=com.docker.compose.project=$PROJECT" --filter "label=com.docker.compose.service=$1" | head -n 1
}
in_server() { docker exec "$(container_of wayfused)" "$@"; }

# A container of the tests' programs stands on the network under test, with the certificate and the journals.
TEST_MOUNTS=(-v "${PROJECT}_certificates:/certificates:ro" -v "$PROJECT-journals:/journals" -e WAYFUSE_AUTHORITY=/certificates/server.pem
             -e WAYFUSE_SERVER=https://wayfused:8420)
put_tools_beside() { docker run -d --name "$NETWORK-tools" --network "$NETWORK" "${TEST_MOUNTS[@]}" wayfuse-test/tests sleep 1000000 >/dev/null; }
beside() {  # [DOCKER-EXEC OPTION...] PROGRAM ARGUMENT...
  local options=(-e WAYFUSE_KEY="$KEY")
  while [[ $1 = -* ]]; do
    options+=("$1"); [ "$1" = -i ] || { options+=("$2"); shift; }
    shift
  done
  docker exec "${options[@]}" "$NETWORK-tools" "$@"
}
operator() { beside wayfuse "$@"; }
ask() { beside curl -s --max-time 10 --cacert /certificates/server.pem "$@"; }

PATIENCE=${WAYFUSE_PATIENCE:-3}   # a busy machine has time enough; only a failure waits it out
wait_for() {  # SECONDS WHAT COMMAND...
  local give_up=$((SECONDS + PATIENCE * $1)) what=$2; shift 2
  until "$@" >/dev/null 2>&1; do
    [ $SECONDS -lt $give_up ] || die "$what: not within the time"
    sleep 0.3
  done
  ok "$what"
}
metric() { in_server sh -c "WAYFUSE_KEY=$KEY wayfuse metrics" | sed -n "s/^wayfuse_$1 //p"; }
grows_beyond() { [ "$(metric "$1")" -gt "$2" ]; }
ready() { in_server wayfuse status; }
started_again() { [ "$(docker inspect -f '{{.RestartCount}}' "$1")" -gt "$2" ]; }
demo_points() { operator --json building show 1 | sed -n 's/.*"points":\([0-9]*\).*/\1/p'; }

# ---- surveyors that keep journals
in_journals() { docker exec "$NETWORK-tools" sh -c "$1"; }
acknowledged() { in_journals "cat /journals/$1/*.journal 2>/dev/null | grep -c ^acked || true"; }
acks_beyond() { [ "$(acknowledged "$1")" -gt "$2" ]; }
begin_surveying() {  # JOURNALS BUILDING CLIENTS
  docker run -d --name "$PROJECT-surveyors-$1" --network "$NETWORK" "${TEST_MOUNTS[@]}" -e WAYFUSE_KEY="$KEY" wayfuse-test/tests \
    sh -c "mkdir -p /journals/$1 && exec journalling_surveyor https://wayfused:8420 /journals/$1 $2 $3" >/dev/null
}
end_surveying() {  # JOURNALS: told to stop; what they did is printed
  docker stop -t 30 "$PROJECT-surveyors-$1" >/dev/null
  docker logs "$PROJECT-surveyors-$1" 2>/dev/null | sed 's/^/   surveyors: /'
  docker rm "$PROJECT-surveyors-$1" >/dev/null
}
settle() { beside journalling_surveyor https://wayfused:8420 "/journals/$1" "$2" "$3" settle >/dev/null 2>"$WORK/refusals" || { tail -n 3 "$WORK/refusals" >&2; die "surveyors could not settle"; }; }
# The second opinion: clients' journals against the file, by its own SQL.
nothing_lost() {  # WHAT JOURNALS DATA-VOLUME BUILDING [--settled]
  docker run --rm -v "$3:/data" -v "$PROJECT-journals:/journals" wayfuse-test/tests \
    sh -c "exec nothing_lost_checker $5 /data/building-$4.sqlite /journals/$2/*.journal" >"$WORK/losses" 2>&1 ||
    { head -n 5 "$WORK/losses" >&2; die "$1: something was lost"; }
  ok "$1: nothing lost of $(acknowledged "$2") acknowledged batches${5:+, all that was sent is there}"
}
new_building() {  # NAME -> its number
  printf '{"name":"%s","pipeline":"nn"}' "$1" | beside -i wayfuse --json building create - | sed -n 's/^{"id":\([0-9]*\).*/\1/p'
}
