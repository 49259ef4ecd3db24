# Finds a container engine or starts one for this run; sourced by the container tests.
#
# Order: a reachable Docker engine; a Docker engine started here; podman behind Docker's own interface, started here; else a
# loud skip with status 77 that names what is missing. What was started here is stopped, and what it leaves behind is undone.

MISSING=()
skip() { printf 'SKIPPED LOUDLY: %s\n' "$*" >&2; exit 77; }

wait_for_engine() {  # PROCESS
  local tries=0
  until docker info >/dev/null 2>&1; do
    kill -0 "$1" 2>/dev/null && [ $((tries++)) -lt 100 ] || return 1
    sleep 0.2
  done
}

# In a network namespace of its own, so that bridges, forwarding and iptables of this machine stay as they are; with
# ENGINE_NETWORK=host in this machine's, for builds that fetch packages.
start_docker() {
  command -v dockerd >/dev/null || { MISSING+=("dockerd (apt-get install docker.io)"); return 1; }
  [ "$(id -u)" -eq 0 ] || { MISSING+=("root, to start dockerd"); return 1; }
  command -v iptables-save >/dev/null || { MISSING+=("iptables (apt-get install iptables)"); return 1; }
  export DOCKER_HOST=unix://$WORK/docker.sock
  local daemon=(dockerd --data-root "$WORK/engine" --exec-root "$WORK/exec" --pidfile "$WORK/dockerd.pid" --mtu 1400 -H "$DOCKER_HOST")
  if [ "${ENGINE_NETWORK:-own}" = host ]; then
    FORWARD_BEFORE=$(cat /proc/sys/net/ipv4/ip_forward)
    iptables-save >"$WORK/iptables"
    BRIDGE_BEFORE=$(ip -o link show docker0 2>/dev/null || true)
    "${daemon[@]}" >"$WORK/engine.log" 2>&1 &
  else
    # shellcheck disable=SC2016
    unshare --net sh -c 'ip link set lo up && exec "$@"' sh "${daemon[@]}" >"$WORK/engine.log" 2>&1 &
  fi
  ENGINE=$! ENGINE_KIND=docker
  wait_for_engine "$ENGINE" && return
  MISSING+=("dockerd does not start here: $(tail -n 1 "$WORK/engine.log")")
  stop_engine
  return 1
}

runs_containers() {
  "$SOURCE/docker/slim-root" "$WORK/probe/image" --shell
  printf 'FROM scratch\nCOPY image/ /\n' >"$WORK/probe/Dockerfile"
  docker build -q -t wayfuse-test/probe "$WORK/probe" >/dev/null 2>&1 && docker run --rm wayfuse-test/probe true
}

start_podman() {
  command -v podman >/dev/null || { MISSING+=("podman"); return 1; }
  export DOCKER_HOST=unix://$WORK/podman.sock
  # Its own defaults may be more than this machine allows.
  printf '[containers]\ndefault_ulimits = ["nofile=%s:%s", "nproc=%s:%s"]\n' "$(ulimit -Hn)" "$(ulimit -Hn)" "$(ulimit -Hu)" "$(ulimit -Hu)" \
    >"$WORK/containers.conf"
  CONTAINERS_CONF=$WORK/containers.conf podman --root "$WORK/engine" --runroot "$WORK/exec" system service --time 0 "$DOCKER_HOST" >"$WORK/engine.log" 2>&1 &
  ENGINE=$! ENGINE_KIND=podman
  if wait_for_engine "$ENGINE"; then
    runs_containers 2>"$WORK/probe.log" && return
    MISSING+=("podman runs no container here: $(grep -v -e "^$" -e --help "$WORK/probe.log" | head -n 1 | cut -c1-300)")
  else
    MISSING+=("podman does not serve here: $(tail -n 1 "$WORK/engine.log")")
  fi
  stop_engine
  return 1
}

stop_engine() {
  [ -n "${ENGINE:-}" ] || return 0
  kill "$ENGINE" 2>/dev/null && wait "$ENGINE" 2>/dev/null
  if [ -n "${FORWARD_BEFORE:-}" ]; then
    [ -n "$BRIDGE_BEFORE" ] || ip link delete docker0 2>/dev/null
    iptables-restore <"$WORK/iptables"
    echo "$FORWARD_BEFORE" >/proc/sys/net/ipv4/ip_forward
  fi
  if [ "$ENGINE_KIND" = podman ]; then
    podman --root "$WORK/engine" --runroot "$WORK/exec" system reset --force >/dev/null 2>&1
  fi
  ENGINE=''
  unset DOCKER_HOST
}

find_engine() {
  export DOCKER_BUILDKIT=${DOCKER_BUILDKIT:-0}
  command -v docker >/dev/null || skip "the docker command is missing (apt-get install docker.io)"
  docker compose version >/dev/null 2>&1 || command -v docker-compose >/dev/null || skip "neither docker compose nor docker-compose is installed"
  docker info >/dev/null 2>&1 || start_docker || start_podman || skip "no container engine: $(printf '%s; ' "${MISSING[@]}")"
  printf 'engine: %s, %s\n' "$(docker version -f '{{.Server.Version}}')" "${ENGINE_KIND:-found running}"
}

# debian:bookworm-slim from Debian's own packages, where no registry is reachable.
make_base_image() {
  docker image inspect debian:bookworm-slim >/dev/null 2>&1 && return
  docker pull -q debian:bookworm-slim >/dev/null 2>&1 && return
  command -v mmdebstrap >/dev/null || skip "no registry is reachable and mmdebstrap is not installed"
  mmdebstrap --quiet --variant=minbase --include=ca-certificates bookworm "$WORK/base.tar"
  docker import -c 'CMD ["/bin/sh"]' "$WORK/base.tar" debian:bookworm-slim >/dev/null
  rm "$WORK/base.tar"
}
