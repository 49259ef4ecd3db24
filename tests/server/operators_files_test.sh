#!/usr/bin/env bash
# What operators are handed beside the binaries: unit, alerts, proxy, completion. Tools that are missing are named, not ignored.
#   operators_files_test.sh SOURCE BUILD
set -euo pipefail
SOURCE=$1 BUILD=$2
WORK=$(mktemp -d)
trap 'rm -rf "$WORK"; [ -z "${SERVER:-}" ] || kill "$SERVER" 2>/dev/null || true' EXIT
die() { printf 'FAILED: %s\n' "$*" >&2; exit 1; }
ok() { printf 'ok: %s\n' "$*"; }
have() { command -v "$1" >/dev/null || { printf 'NOT CHECKED LOUDLY: %s (%s is not installed)\n' "$2" "$1" >&2; return 1; }; }

# A running server knows every metric the alerts ask for.
"$BUILD/server/wayfused" --server.data "$WORK/data" --server.first_key_file "$WORK/key" --listen.port 0 >"$WORK/said" 2>"$WORK/log" &
SERVER=$!
for _ in $(seq 300); do grep -q '"ready"' "$WORK/said" && break; sleep 0.1; done
url=$(sed -n 's/.*"event":"ready","url":"\([^"]*\)".*/\1/p' "$WORK/said")
[ -n "$url" ] || { cat "$WORK/log" >&2; die "the server did not become ready"; }
WAYFUSE_KEY=$(cat "$WORK/key") "$BUILD/admin/wayfuse" --server "$url" metrics >"$WORK/metrics"
for name in $(grep -o 'wayfuse_[a-z_]*' "$SOURCE/server/packaging/alerts.yml" | sort -u); do
  grep -q "^$name " "$WORK/metrics" || die "alerts.yml asks for $name, which no server tells"
done
# A counter ends in _total; what is measured ends in its unit, what is counted has none.
sed -n 's/^# TYPE \([a-z_]*\) counter$/\1/p' "$WORK/metrics" | grep -v '_total$' && die "counters that do not end in _total"
ok "$(grep -c '^# TYPE' "$WORK/metrics") metrics; the alerts know theirs"
if have promtool "alerts and metrics by Prometheus' own tool"; then
  promtool check rules "$SOURCE/server/packaging/alerts.yml" >/dev/null || die "alerts.yml"
  promtool check metrics <"$WORK/metrics" || die "the metrics' text"
  ok "promtool accepts alerts and metrics"
fi

if have systemd-analyze "the unit"; then
  sed "s#^ExecStart=/usr/bin/wayfused#ExecStart=$(cd "$BUILD" && pwd)/server/wayfused#" "$SOURCE/server/packaging/wayfused.service" >"$WORK/wayfused.service"
  systemd-analyze verify --man=no "$WORK/wayfused.service" >"$WORK/verify" 2>&1 || die "the unit: $(cat "$WORK/verify")"
  level=$(systemd-analyze security --offline=yes "$WORK/wayfused.service" 2>/dev/null | sed -n 's/.*exposure level[^0-9]*\([0-9.]*\).*/\1/p')
  awk -v level="$level" 'BEGIN { exit !(level != "" && level <= 2.0) }' || die "exposure level $level, 2.0 is the most"
  ok "the unit is valid; exposure level $level of 10"
fi
if have haproxy "the sample proxy"; then
  openssl req -x509 -newkey ec -pkeyopt ec_paramgen_curve:prime256v1 -nodes -days 2 -subj /CN=x -keyout "$WORK/key.pem" -out "$WORK/pem" 2>/dev/null
  cat "$WORK/pem" "$WORK/key.pem" >"$WORK/haproxy.pem"
  sed "s#/certificates/#$WORK/#; s#backend:8420#127.0.0.1:8420#" "$SOURCE/docker/haproxy.cfg" >"$WORK/haproxy.cfg"
  haproxy -q -c -f "$WORK/haproxy.cfg" || die "haproxy.cfg"
  ok "haproxy accepts the sample"
fi

# Completion as bash runs it.
completed=$(PATH=$BUILD/admin:$PATH bash -c "source '$SOURCE/server/packaging/wayfuse.bash-completion'; COMP_WORDS=(wayfuse key cr); COMP_CWORD=2; _wayfuse; echo \"\${COMPREPLY[*]}\"")
[ "$completed" = create ] || die "completion says '$completed' for 'wayfuse key cr'"
ok "bash completes commands"
