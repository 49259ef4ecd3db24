#!/usr/bin/env bash
# The Debian package in a Debian of its own: installs, runs, is configured, upgrades, is removed, is purged.
#   package_test.sh BUILD
# Needs root, mmdebstrap and a Debian mirror; skips loudly (status 77) without them.
set -euo pipefail
BUILD=$1
WORK=$(mktemp -d)
ROOT=$WORK/root
die() { printf 'FAILED: %s\n' "$*" >&2; exit 1; }
ok() { printf 'ok: %s\n' "$*"; }
skip() { printf 'SKIPPED LOUDLY: %s\n' "$*" >&2; exit 77; }

clean_up() {
  local status=$?
  [ -z "${SERVER:-}" ] || kill "$SERVER" 2>/dev/null || true
  umount "$ROOT/proc" 2>/dev/null || true
  rm -rf "$WORK"
  exit $status
}
trap clean_up EXIT
trap 'exit 130' INT TERM

[ "$(id -u)" -eq 0 ] || skip "a chroot needs root"
for tool in mmdebstrap cpack dpkg-deb dpkg-shlibdeps; do command -v $tool >/dev/null || skip "$tool is not installed"; done

make_package() {  # VERSION
  mkdir -p "$WORK/$1"
  cpack --config "$BUILD/CPackConfig.cmake" -G DEB -B "$WORK/$1" -D CPACK_PACKAGE_VERSION="$1" >"$WORK/cpack.log" 2>&1 ||
    { tail "$WORK/cpack.log" >&2; die "cpack"; }
  cp "$WORK/$1"/wayfuse_*.deb "$WORK/wayfuse_$1.deb"
}
inside() { chroot "$ROOT" env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin DEBIAN_FRONTEND=noninteractive "$@"; }
install_version() {
  cp "$WORK/wayfuse_$1.deb" "$ROOT/tmp/wayfuse.deb"
  inside apt-get install -y -qq --no-install-recommends /tmp/wayfuse.deb >"$WORK/apt.log" 2>&1 || { tail "$WORK/apt.log" >&2; die "install of $1"; }
  rm "$ROOT/tmp/wayfuse.deb"
}
# The unit's own command line, as the unit's user: there is no systemd in a chroot.
start() {
  local command; read -ra command < <(sed -n 's/^ExecStart=//p' "$ROOT/lib/systemd/system/wayfused.service")
  chroot "$ROOT" env -i PATH=/usr/bin setpriv --reuid wayfuse --regid wayfuse --init-groups --no-new-privs \
    "${command[@]}" --listen.port 18420 >"$WORK/said" 2>"$WORK/log" &
  SERVER=$!
  local tries=0
  until grep -q '"event":"ready"' "$WORK/said"; do
    kill -0 "$SERVER" 2>/dev/null && [ $((tries++)) -lt 300 ] || { cat "$WORK/log" >&2; die "the installed server did not become ready"; }
    sleep 0.1
  done
}
stop() {
  kill "$SERVER"
  wait "$SERVER" || die "the installed server left with $?"
  SERVER=''
}
operator() { inside WAYFUSE_SERVER=http://127.0.0.1:18420 WAYFUSE_KEY="$(cat "$ROOT/var/lib/wayfuse/first-admin-key")" wayfuse "$@"; }

make_package 0.0.1
make_package 0.0.2
# With what it depends on: afterwards no network is needed.
needed=$(dpkg-deb -f "$WORK/wayfuse_0.0.1.deb" Depends | sed 's/([^)]*)//g; s/ //g')
mmdebstrap --quiet --variant=apt --include="$needed" bookworm "$ROOT" >"$WORK/bootstrap.log" 2>&1 || skip "mmdebstrap makes no Debian here: $(tail -n 1 "$WORK/bootstrap.log")"
mount -t proc proc "$ROOT/proc" 2>/dev/null || skip "/proc cannot be mounted in a chroot here"
find "$ROOT"/{etc,usr,var,lib,home} -xdev 2>/dev/null | sort >"$WORK/before"

install_version 0.0.1
inside getent passwd wayfuse >/dev/null || die "the user wayfuse was not made"
[ "$(stat -c '%U %a' "$ROOT/etc/wayfuse/wayfused.toml")" = "root 640" ] || die "the configuration's mode"
[ "$(inside stat -c '%U %a' /var/lib/wayfuse)" = "wayfuse 750" ] || die "the data folder's owner and mode"
inside wayfused --print-config | grep -c ' = ' >"$WORK/keys"
[ "$(grep -c ' = ' "$ROOT/etc/wayfuse/wayfused.toml")" = "$(cat "$WORK/keys")" ] || die "the installed file does not name every key"
ok "installed: user, folder, configuration with all $(cat "$WORK/keys") keys"

inside wayfuse doctor >"$WORK/doctor" || true
grep -q '^ERROR *reachable' "$WORK/doctor" && grep -q 'mend: start it' "$WORK/doctor" || { cat "$WORK/doctor" >&2; die "the doctor must see that nothing runs, and say what to do"; }
start
operator status >/dev/null
printf '{"name":"Package hall"}' | operator building create - >/dev/null
inside WAYFUSE_SERVER=http://127.0.0.1:18420 WAYFUSE_KEY="$(cat "$ROOT/var/lib/wayfuse/first-admin-key")" wayfuse doctor --json >"$WORK/doctor.json" || { cat "$WORK/doctor.json" >&2; die "the doctor finds errors in a fresh install"; }
ok "runs as wayfuse from the unit's command line; the doctor finds no error"
[ "$(inside wayfuse complete -- bui)" = building ] || die "completion"
inside bash -n /usr/share/bash-completion/completions/wayfuse
stop

printf '\n# edited by the operator\n' >>"$ROOT/etc/wayfuse/wayfused.toml"
install_version 0.0.2
grep -q 'edited by the operator' "$ROOT/etc/wayfuse/wayfused.toml" || die "the upgrade overwrote the configuration"
start
operator building list | grep -q 'Package hall' || die "the upgrade lost a building"
stop
ok "upgraded: configuration and building are there"

inside apt-get remove -y -qq wayfuse >/dev/null 2>&1
[ ! -e "$ROOT/usr/bin/wayfused" ] && [ -s "$ROOT/var/lib/wayfuse/building-1.sqlite" ] && [ -s "$ROOT/etc/wayfuse/wayfused.toml" ] || die "remove must keep data and configuration only"
ok "removed: data and configuration stay"
inside apt-get purge -y -qq wayfuse >/dev/null 2>&1
inside getent passwd wayfuse >/dev/null && die "the user stays after purge"
find "$ROOT"/{etc,usr,var,lib,home} -xdev 2>/dev/null | sort | comm -13 "$WORK/before" - | grep -i wayfuse && die "purge leaves the files above behind"
ok "purged: nothing is left"
