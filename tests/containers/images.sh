# The images of docker/ with binaries built outside: each Dockerfile's last stage, its root folder made here by the same
# docker/slim-root. One more image holds the tests' own programs. Sourced by composition_test.sh.

ROOT_OPTIONS=(--user wayfuse:10001:/var/lib/wayfuse --shell --certificates)

# Everything after `slim-root /image` in a Dockerfile, with its build folder's names turned into ours.
root_arguments() {  # DOCKERFILE
  sed -n '/slim-root \/image/,/^$/p' "$1" | sed 's/\\$//; s#.*slim-root /image##' | tr '\n' ' ' |
    sed -E "s#/build/[a-z/]*/(wayfuse[a-z-]*)=#$WORK/bin/\1=#g; s#/source/#$SOURCE/#g"
}

build_image() {  # NAME DOCKERFILE
  local context=$WORK/context
  rm -rf "$context" && mkdir -p "$context"
  # shellcheck disable=SC2046
  "$SOURCE/docker/slim-root" "$context/image" $(root_arguments "$2")
  sed -n '/^FROM scratch/,$p' "$2" | sed -E 's#--from=root ##; s#/(image[a-z.]*/) #\1 #' >"$context/Dockerfile"
  docker build -q -t "$1" "$context" >/dev/null 2>"$WORK/build.log" || { cat "$WORK/build.log" >&2; die "image $1 does not build"; }
}

build_test_image() {
  local context=$WORK/context program
  rm -rf "$context" && mkdir -p "$context"
  local proxy=(/usr/sbin/haproxy)
  [ -x "${proxy[0]}" ] || proxy=()
  for program in "$WORK"/bin/*; do set -- "$@" "$program=/usr/bin/${program##*/}"; done
  "$SOURCE/docker/slim-root" "$context/image" --user wayfuse:10001:/journals --shell --certificates "$@" /usr/bin/curl /usr/bin/sqlite3 "${proxy[@]}"
  printf 'FROM scratch\nCOPY image/ /\nCOPY --chown=10001:10001 image.home/ /journals/\nUSER 10001:10001\nENV PATH=/usr/bin\n' >"$context/Dockerfile"
  docker build -q -t wayfuse-test/tests "$context" >/dev/null 2>&1
}

build_images() {
  local program
  mkdir -p "$WORK/bin"
  for program in server/wayfused admin/wayfuse sdk/wayfuse-phone tests/integration/test_integration \
                 tests/containers/journalling_surveyor tests/db/nothing_lost_checker; do
    strip -o "$WORK/bin/${program##*/}" "$BUILD/$program"
  done
  build_image wayfuse-test/server "$SOURCE/docker/server.Dockerfile"
  build_image wayfuse-test/phone "$SOURCE/docker/phone.Dockerfile"
  build_test_image
  if [ -x /usr/bin/prometheus ]; then build_image wayfuse-test/prometheus "$SOURCE/docker/prometheus.Dockerfile"; else PROMETHEUS_MISSING=1; fi
}

label() { docker image inspect -f "{{index .Config.Labels \"org.opencontainers.image.$2\"}}" "$1"; }

# Small, named, versioned, unprivileged, and its bill of materials covers every library in it.
check_image() {  # IMAGE VERSION
  local image=$1 bytes container
  bytes=$(docker image inspect -f '{{.Size}}' "$image")
  [ "$bytes" -lt 120000000 ] || die "$image has $bytes bytes, 120 MB are the most"
  [ "$(label "$image" version)" = "$2" ] || die "$image says version $(label "$image" version), its binary $2"
  for name in title description licenses revision vendor; do [ -n "$(label "$image" "$name")" ] || die "$image has no label $name"; done
  [ "$(docker image inspect -f '{{.Config.User}}' "$image")" = 10001:10001 ] || die "$image must not run as root"
  rm -rf "$WORK/rootfs" && mkdir "$WORK/rootfs"
  container=$(docker create "$image")
  docker export "$container" | tar -x -C "$WORK/rootfs" --exclude=dev
  docker rm "$container" >/dev/null
  [ -z "$(find "$WORK/rootfs" -perm /6000)" ] || die "$image holds set-user-id files"
  python3 - "$WORK/rootfs" <<'PY' || die "$image: the bill of materials is not right"
import json, pathlib, subprocess, sys
root = pathlib.Path(sys.argv[1])
bill = json.loads((root / "usr/share/wayfuse/sbom.spdx.json").read_text())
assert bill["spdxVersion"] == "SPDX-2.3" and bill["SPDXID"] == "SPDXRef-DOCUMENT" and bill["documentNamespace"]
ids = [package["SPDXID"] for package in bill["packages"]]
assert len(ids) == len(set(ids)) and "SPDXRef-image" in ids
named = {package["name"]: package for package in bill["packages"]}
related = {relation["relatedSpdxElement"]: relation["relationshipType"] for relation in bill["relationships"]}
assert set(related) == set(ids), "every package is related once"
contained = {p["name"] for p in bill["packages"] if related[p["SPDXID"]] == "CONTAINS"}
assert contained == {f.name for f in (root / "var/lib/dpkg/status.d").iterdir()}
for name in contained:
    assert (root / f"usr/share/doc/{name}/copyright").stat().st_size > 0, name
libraries = ["/" + str(p.relative_to(root)) for p in root.rglob("*.so*") if p.is_file() and not p.is_symlink()]
asked = libraries + [path.removeprefix("/usr") for path in libraries]
owners = subprocess.run(["dpkg-query", "-S", *asked], capture_output=True, text=True).stdout
owned = {line.split(": ")[1].removeprefix("/usr") for line in owners.splitlines() if line.split(":")[0] in contained}
strangers = [path for path in libraries if path.removeprefix("/usr") not in owned]
assert libraries and not strangers, f"in no package of the bill: {strangers}"
print(f"{len(contained)} packages and {len(ids) - 1 - len(contained)} compiled in stand in the bill of materials")
PY
  ok "$image: $((bytes / 1000000)) MB, version $2, labels, not root, bill of materials"
}
