# Scenarios: the system as an operator starts it. Sourced by composition_test.sh.

images_are_fit() {
  local version; version=$("$BUILD/server/wayfused" --version | sed 's/^wayfused //')
  check_image wayfuse-test/server "$version"
  check_image wayfuse-test/phone "$version"
  # What both builds share is written once in each: equal, so that it is built once.
  cmp -s <(sed -n '/AS build/,/strip/p' "$SOURCE/docker/server.Dockerfile") <(sed -n '/AS build/,/strip/p' "$SOURCE/docker/phone.Dockerfile") ||
    die "the build stages of server.Dockerfile and phone.Dockerfile differ"
  local package
  for package in $(sed -n '/^PACKAGES=(/,/)$/p' "$SOURCE/run" | tr -d '()' | sed 's/^PACKAGES=//'); do
    [ "$package" = ccache ] || grep -qw -- "$package" "$SOURCE/docker/server.Dockerfile" || die "./run installs $package to build, server.Dockerfile does not"
  done
}

it_comes_up_locked_down() {
  local services=(certificate wayfused metrics-key phones)
  [ -n "${PROMETHEUS_MISSING:-}" ] || services+=(prometheus)
  UP=1
  compose up -d --no-build "${services[@]}" >"$WORK/up.log" 2>&1 || { cat "$WORK/up.log" >&2; die "compose up failed"; }
  wait_for 60 "the server is ready over TLS" ready
  KEY=$(in_server cat /keys/first-admin-key)
  put_tools_beside
  [ "$(in_server id -u)" = 10001 ] || die "the server must not run as root"
  in_server touch /usr/bin/x 2>/dev/null && die "the root file system must be read-only"
  ok "not root, root file system read-only"
  [ "$(docker inspect -f '{{.State.Health.Status}}' "$(container_of wayfused)")" = healthy ] || die "the health check does not say healthy"
  ok "the health check says healthy"
}

keys_are_refused_and_accepted() {
  beside -e WAYFUSE_KEY=wf_wrong wayfuse building list >/dev/null 2>&1 && die "a wrong key must be refused"
  operator building list >/dev/null || die "the first key must be accepted"
  local narrow; narrow=$(operator --json key create narrow --scope track | sed -n 's/.*"key":"\([^"]*\)".*/\1/p')
  beside -e WAYFUSE_KEY="$narrow" wayfuse building list >/dev/null 2>&1 && die "a phone's key must not list buildings"
  ok "wrong and narrow keys are refused, the right one is accepted"
}

the_console_is_reachable() {
  local head; head=$(ask -D - -o /dev/null https://wayfused:8420/console/)
  grep -q '^HTTP/1.1 200' <<<"$head" && grep -qi '^content-security-policy:' <<<"$head" || die "the console: $head"
  ok "the console is reachable over TLS, with its content-security policy"
}

prometheus_scrapes() {
  [ -z "${PROMETHEUS_MISSING:-}" ] || { printf 'NOT CHECKED: Prometheus (apt-get install prometheus)\n' >&2; return; }
  wait_for 60 "Prometheus finds its target up" prometheus_says targets '"health":"up"'
  wait_for 60 "and has positions counted" prometheus_says 'query?query=wayfuse_positions_total%3E0' '"value"'
  prometheus_says rules WayfusedDown || die "the sample alerts are not loaded"
  ok "the sample alerts are loaded"
}
prometheus_says() { ask "http://prometheus:9090/api/v1/$1" | grep -q "$2"; }

the_integration_suite_passes() {
  beside -e WAYFUSE_TEST_SERVER=https://wayfused:8420 -e WAYFUSE_TEST_KEY="$KEY" -e WAYFUSE_TEST_AUTHORITY=/certificates/server.pem \
    test_integration --gtest_filter='Sessions.*:HostileInput.*' --gtest_color=no --gtest_fail_fast >"$WORK/suite.log" 2>&1 ||
    { tail -n 60 "$WORK/suite.log" >&2; die "the integration suite against the composition"; }
  ok "the integration suite against the composition: $(sed -n 's/^\[  PASSED  \] //p' "$WORK/suite.log")"
}

sigterm_drains() {
  docker stop -t 15 "$(container_of wayfused)" >/dev/null
  local code; code=$(docker inspect -f '{{.State.ExitCode}}' "$(container_of wayfused)")
  [ "$code" = 0 ] || die "SIGTERM must drain and leave with 0, not $code"
  ok "SIGTERM drains and leaves with 0"
  docker start "$(container_of wayfused)" >/dev/null
  wait_for 60 "and it starts again" ready
}

# TLS ends at a proxy; the same integration tests go through it.
behind_a_reverse_proxy() {
  [ -x /usr/sbin/haproxy ] || { printf 'NOT CHECKED: the reverse proxy (apt-get install haproxy)\n' >&2; return; }
  local network=$PROJECT-proxied
  docker network create "$network" >/dev/null
  docker run --rm -u 0 -v "${PROJECT}_certificates:/certificates" wayfuse-test/tests \
    sh -ec 'cd /certificates; cat server.pem server.key >haproxy.pem; chown 10001 haproxy.pem; chmod 0400 haproxy.pem'
  docker run -d --name "$PROJECT-backend" --network "$network" --network-alias backend --read-only --tmpfs /var/lib/wayfuse:uid=10001,mode=0750 \
    -e WAYFUSE_LISTEN_PLAIN_BEYOND_LOOPBACK=true -e WAYFUSE_LIMITS_REFUSALS_PER_ADDRESS=10000 -e WAYFUSE_LIMITS_REFUSALS_BURST=20000 \
    -e WAYFUSE_SERVER_FIRST_KEY_FILE=/var/lib/wayfuse/first-admin-key wayfuse-test/server >/dev/null
  docker run -d --name "$PROJECT-proxy" --network "$network" --network-alias wayfused --read-only --entrypoint /usr/sbin/haproxy \
    -v "${PROJECT}_certificates:/certificates:ro" -v "$SOURCE/docker/haproxy.cfg:/etc/haproxy.cfg:ro" wayfuse-test/tests -f /etc/haproxy.cfg >/dev/null
  wait_for 60 "a server is ready behind the proxy" docker exec "$PROJECT-backend" wayfuse status
  local key; key=$(docker exec "$PROJECT-backend" cat /var/lib/wayfuse/first-admin-key)
  docker run --rm --network "$network" "${TEST_MOUNTS[@]}" -e WAYFUSE_TEST_SERVER=https://wayfused:8420 -e WAYFUSE_TEST_KEY="$key" \
    -e WAYFUSE_TEST_AUTHORITY=/certificates/server.pem wayfuse-test/tests test_integration --gtest_filter='Sessions.*' --gtest_color=no --gtest_fail_fast >"$WORK/suite.log" 2>&1 ||
    { tail -n 40 "$WORK/suite.log" >&2; docker logs "$PROJECT-proxy" >&2; die "the integration suite through the proxy"; }
  ok "through HAProxy: $(sed -n 's/^\[  PASSED  \] //p' "$WORK/suite.log")"
  docker rm -f "$PROJECT-backend" "$PROJECT-proxy" >/dev/null
  docker network rm "$network" >/dev/null
}
