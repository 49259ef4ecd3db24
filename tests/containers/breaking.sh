# Scenarios: what breaks in the field, and that nothing acknowledged is lost by it. Sourced by composition_test.sh.

KILLS=3

# kill -9 while surveyors upload and phones walk.
killed_under_load() {
  local building kill before lost
  building=$(new_building "Kill site")
  begin_surveying kill "$building" 4
  docker run -d --name "$PROJECT-walkers" --network "$NETWORK" "${TEST_MOUNTS[@]}" -e WAYFUSE_KEY="$KEY" wayfuse-test/phone \
    walk --server wss://wayfused:8420/v1/session --authority /certificates/server.pem --building 1 --phones 30 --minutes 1 --speed 2 --no-compare >/dev/null
  for kill in $(seq $KILLS); do
    before=$(acknowledged kill)
    wait_for 60 "kill $kill: under load" acks_beyond kill $((before + 60))
    docker kill -s KILL "$(container_of wayfused)" >/dev/null
    docker start "$(container_of wayfused)" >/dev/null
    wait_for 60 "kill $kill: ready again" ready
  done
  before=$(acknowledged kill)
  wait_for 60 "surveyors came back by themselves" acks_beyond kill "$before"
  end_surveying kill
  nothing_lost "$KILLS x kill -9" kill "${PROJECT}_data" "$building" ""
  settle kill "$building" 4
  nothing_lost "after the retries" kill "${PROJECT}_data" "$building" --settled
  lost=$(docker wait "$PROJECT-walkers")
  [ "$lost" = 0 ] || { docker logs --tail 8 "$PROJECT-walkers" >&2; die "phones lost samples over the kills"; }
  docker rm "$PROJECT-walkers" >/dev/null
  ok "30 phones walked through the kills, every sample acknowledged"
}

# Phones whose network goes and comes back with another address, then phones that are frozen: sessions resume whole.
disconnected_and_paused() {
  local resumed status
  docker run -d --name "$PROJECT-walkers" --network "$NETWORK" "${TEST_MOUNTS[@]}" -e WAYFUSE_KEY="$KEY" wayfuse-test/phone \
    walk --server wss://wayfused:8420/v1/session --authority /certificates/server.pem --building 1 --phones 40 --minutes 4 --speed 4 --no-compare >/dev/null
  wait_for 30 "40 phones stream" grows_beyond websockets 39
  resumed=$(metric sessions_resumed_total)
  docker network disconnect "$NETWORK" "$PROJECT-walkers"
  docker run -d --name "$PROJECT-squatter" --network "$NETWORK" wayfuse-test/tests sleep 1000000 >/dev/null   # takes the address that became free
  docker network connect "$NETWORK" "$PROJECT-walkers"
  wait_for 60 "cut off and back under another address: 40 sessions resume whole" grows_beyond sessions_resumed_total "$((resumed + 39))"
  wait_for 30 "the phones are frozen" docker pause "$PROJECT-walkers"   # runc gives up where the machine is busy
  sleep 3   # the pause itself
  docker unpause "$PROJECT-walkers" >/dev/null
  status=$(docker wait "$PROJECT-walkers")
  [ "$status" = 0 ] || { docker logs --tail 8 "$PROJECT-walkers" >&2; die "phones lost samples by the outage"; }
  docker rm -f "$PROJECT-walkers" "$PROJECT-squatter" >/dev/null
  [ "$(metric sequence_gaps_total)" = 0 ] || die "the server saw gaps in sample numbers"
  ok "cut off and frozen: every sample acknowledged, no gap"
}

# A wayfused of its own beside the composition, with the composition's certificate (the name wayfused is its alias).
begin_lone_server() {  # NAME VOLUME DOCKER-OPTION...
  local name=$1 volume=$2; shift 2
  docker network create "$PROJECT-$name" >/dev/null
  docker run -d --name "$PROJECT-$name" --network "$PROJECT-$name" --network-alias wayfused --read-only --restart on-failure \
    -v "$volume:/var/lib/wayfuse" -v "${PROJECT}_certificates:/certificates:ro" \
    -e WAYFUSE_TLS_CERTIFICATE=/certificates/server.pem -e WAYFUSE_TLS_KEY=/certificates/server.key \
    -e WAYFUSE_SERVER_FIRST_KEY_FILE=/var/lib/wayfuse/first-admin-key \
    -e WAYFUSE_SERVER=https://localhost:8420 -e WAYFUSE_AUTHORITY=/certificates/server.pem "$@" >/dev/null
  LONE=$PROJECT-$name NETWORK=$PROJECT-$name
  put_tools_beside
  wait_for 60 "$name: a server is ready" docker exec "$LONE" wayfuse status
  KEY_BEFORE=$KEY KEY=$(docker exec "$LONE" cat /var/lib/wayfuse/first-admin-key 2>/dev/null || printf %s "$KEY")
}
end_lone_server() {
  docker rm -f "$LONE" "$NETWORK-tools" >/dev/null
  docker network rm "$NETWORK" >/dev/null
  NETWORK=${PROJECT}_default KEY=$KEY_BEFORE LONE=''
}
lone_metric() { docker exec "$LONE" sh -c "WAYFUSE_KEY=$KEY wayfuse metrics" | sed -n "s/^wayfuse_$1 //p"; }
lone_grows_beyond() { [ "$(lone_metric "$1")" -gt "$2" ]; }
crowd() {  # PHONES: they walk for four minutes at most
  docker run -d --name "$PROJECT-crowd" --network "$NETWORK" "${TEST_MOUNTS[@]}" -e WAYFUSE_KEY="$KEY" wayfuse-test/phone \
    walk --server wss://wayfused:8420/v1/session --authority /certificates/server.pem --building 1 --phones "$1" --minutes 4 --speed 1 --no-compare >/dev/null
}

# The counted limit refuses newcomers and keeps those that are in; the kernel's limit kills, and nothing acknowledged is lost.
memory_limit_reached() {
  begin_lone_server budget "$PROJECT-budget" --memory 256m -e WAYFUSE_LIMITS_MEMORY_BYTES=8000000 wayfuse-test/server
  new_building Crowded >/dev/null
  crowd 100
  wait_for 60 "at its memory limit the server refuses newcomers" lone_grows_beyond shed_total 20
  [ "$(lone_metric sessions)" -gt 3 ] || die "those that are in must stay in"
  [ "$(docker inspect -f '{{.State.OOMKilled}} {{.RestartCount}}' "$LONE")" = "false 0" ] || die "the server was killed for its memory"
  ok "$(lone_metric sessions) sessions stay, the process lives"
  docker rm -f "$PROJECT-crowd" >/dev/null
  end_lone_server

  begin_lone_server oom "$PROJECT-oom" --memory 24m --memory-swap 24m -e WAYFUSE_LIMITS_MEMORY_BYTES=4000000000 wayfuse-test/server
  local building; building=$(new_building "Small machine")
  begin_surveying oom "$building" 3
  wait_for 60 "surveyors upload" acks_beyond oom 30
  crowd 250
  wait_for 120 "the kernel kills a server that was promised more memory than there is" started_again "$LONE" 0
  docker rm -f "$PROJECT-crowd" >/dev/null
  wait_for 60 "it starts again by itself" docker exec "$LONE" wayfuse status
  end_surveying oom
  settle oom "$building" 3
  nothing_lost "killed for memory" oom "$PROJECT-oom" "$building" --settled
  end_lone_server
}

# The volume fills up: uploads are refused, tracking goes on; once there is room again everything is as if nothing had been.
volume_full() {
  docker volume create -d local -o type=tmpfs -o device=tmpfs -o o=size=24m,uid=10001,gid=10001,mode=0755 "$PROJECT-full" >/dev/null
  begin_lone_server full "$PROJECT-full" wayfuse-test/server
  local building acked positions
  beside wayfuse-phone world | beside -i wayfuse building create - >/dev/null
  beside wayfuse-phone survey --server wss://wayfused:8420/v1/session --authority /certificates/server.pem --building 1 >/dev/null
  building=$(new_building "Full disk")
  begin_surveying full "$building" 3
  crowd 10
  wait_for 60 "surveyors upload" acks_beyond full 30
  docker exec "$LONE" sh -c 'dd if=/dev/zero of=/var/lib/wayfuse/filler bs=64k 2>/dev/null; true'
  wait_for 60 "a full volume: uploads are refused" lone_grows_beyond survey_refused_total 5
  positions=$(lone_metric positions_total)
  wait_for 60 "and tracking goes on" lone_grows_beyond positions_total "$((positions + 20))"
  nothing_lost "while the volume is full" full "$PROJECT-full" "$building" ""
  acked=$(acknowledged full)
  docker exec "$LONE" rm /var/lib/wayfuse/filler
  wait_for 60 "with room again uploads are stored, without a restart" acks_beyond full "$((acked + 20))"
  docker rm -f "$PROJECT-crowd" >/dev/null
  end_surveying full
  settle full "$building" 3
  nothing_lost "after the full volume" full "$PROJECT-full" "$building" --settled
  [ "$(docker inspect -f '{{.RestartCount}}' "$LONE")" = 0 ] || die "the server restarted"
  end_lone_server
}
