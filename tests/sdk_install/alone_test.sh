#!/bin/sh
# The SDK alone, from the sources, without what only the server needs. usage: alone_test.sh SOURCE
set -eu
source=$1
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake -S "$source" -B "$work/build" -DWAYFUSE_BUILD_SERVER=OFF -DWAYFUSE_BUILD_TESTS=OFF -DCMAKE_DISABLE_FIND_PACKAGE_Eigen3=ON \
      -DCMAKE_DISABLE_FIND_PACKAGE_SQLite3=ON -DCMAKE_DISABLE_FIND_PACKAGE_GTest=ON >"$work/log" 2>&1 &&
  cmake --build "$work/build" -j 2 --target wayfuse_shared wayfuse_recording >>"$work/log" 2>&1 || { tail -40 "$work/log" >&2; exit 1; }
needs=$(ldd "$(find "$work/build" -name 'libwayfuse.so.0*' -type f | head -1)" | awk '{ print $1 }')
if echo "$needs" | grep -E 'sqlite|sodium|curl|boost|spdlog'; then
  echo "the phone's library needs what only a server should" >&2
  exit 1
fi
echo "built alone"
