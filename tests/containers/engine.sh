# Finds a Docker engine or starts one for this run; sourced by the container tests.
#
# Order: a reachable engine, one started here (and everything it leaves behind undone), else a loud skip with status 77.

skip() { printf 'SKIPPED: %s\n' "$*" >&2; exit 77; }

# The base image from Debian's own packages, where no registry is reachable.
make_base_image() {
  docker image inspect debian:bookworm-slim >/dev/null 2>&1 && return
  docker pull -q debian:bookworm-slim >/dev/null 2>&1 && return
  command -v mmdebstrap >/dev/null || skip "no registry is reachable and mmdebstrap is not installed"
  local sources=/etc/apt/sources.list
  [ -s $sources ] || sources=$(ls /etc/apt/sources.list.d/*.sources | head -n 1)
  mmdebstrap --quiet --variant=minbase --include=ca-certificates bookworm "$WORK/base.tar" "$sources"
  docker import -c 'CMD ["/bin/sh"]' "$WORK/base.tar" debian:bookworm-slim >/dev/null
}

start_engine() {
  command -v dockerd >/dev/null || skip "no Docker engine is reachable and dockerd is not installed (apt-get install docker.io)"
  [ "$(id -u)" -eq 0 ] || skip "no Docker engine is reachable and starting one needs root"
  FORWARD_BEFORE=$(cat /proc/sys/net/ipv4/ip_forward)
  iptables-save >"$WORK/iptables" 2>/dev/null || skip "iptables does not work here"
  dockerd --data-root "$WORK/engine" --exec-root "$WORK/exec" --pidfile "$WORK/dockerd.pid" --mtu 1400 \
    -H "unix://$WORK/docker.sock" >"$WORK/dockerd.log" 2>&1 &
  ENGINE=$!
  export DOCKER_HOST=unix://$WORK/docker.sock
  local tries=0
  until docker info >/dev/null 2>&1; do
    kill -0 "$ENGINE" 2>/dev/null || skip "dockerd does not start here: $(tail -n 1 "$WORK/dockerd.log")"
    [ $((tries++)) -lt 100 ] || skip "dockerd was not ready within 20 s"
    sleep 0.2
  done
}

stop_engine() {
  [ -n "${ENGINE:-}" ] || return 0
  kill "$ENGINE" 2>/dev/null && wait "$ENGINE" 2>/dev/null
  ip link delete docker0 2>/dev/null
  iptables-restore <"$WORK/iptables"
  echo "$FORWARD_BEFORE" >/proc/sys/net/ipv4/ip_forward
}

find_engine() {
  export DOCKER_BUILDKIT=0
  docker info >/dev/null 2>&1 || start_engine
  make_base_image
}
