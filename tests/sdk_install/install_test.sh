#!/bin/sh
# Installs the SDK into a fresh folder, moves that folder, and builds the printed examples against it: once by find_package,
# once by pkg-config. usage: install_test.sh BUILD SOURCE
set -eu
build=$1 source=$2
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
cmake --install "$build" --component sdk --prefix "$work/first" >/dev/null
mv "$work/first" "$work/moved"
if grep -rlE "$source|$build" "$work/moved/lib/cmake" "$work/moved/lib/"*/cmake "$work/moved/lib/"*/pkgconfig 2>/dev/null; then
  echo "the installed tree names the tree it was built in" >&2
  exit 1
fi
if grep -rlE 'include *<(Eigen|boost|nlohmann|sqlite3)' "$work/moved/include"; then
  echo "an installed header needs an outside library" >&2
  exit 1
fi
expect_usage() {  # the examples ask for an address and leave with 2
  status=0
  "$@" 2>"$work/said" || status=$?
  if [ "$status" -ne 2 ] || ! grep -q usage "$work/said"; then
    echo "$1 left with $status:" >&2
    cat "$work/said" >&2
    exit 1
  fi
}
cmake -S "$source/tests/sdk_install/consumer" -B "$work/build" -DCMAKE_PREFIX_PATH="$work/moved" -DEXAMPLES="$source/sdk/examples" \
      -DCMAKE_BUILD_TYPE=Release >"$work/log" 2>&1 && cmake --build "$work/build" >>"$work/log" 2>&1 || { cat "$work/log" >&2; exit 1; }
expect_usage "$work/build/dot_c"
expect_usage "$work/build/dot_cpp"
PKG_CONFIG_PATH=$(dirname "$(find "$work/moved" -name wayfuse.pc)")
export PKG_CONFIG_PATH
# shellcheck disable=SC2046
cc -std=c99 -D_POSIX_C_SOURCE=200809L "$source/sdk/examples/moving_dot.c" $(pkg-config --cflags --libs wayfuse) -o "$work/dot"
LD_LIBRARY_PATH=$(pkg-config --variable=libdir wayfuse) expect_usage "$work/dot"
# The header by itself, by every C compiler here and by C++ of all ages, all warnings on.
for compiler in cc clang clang-14; do
  command -v $compiler >/dev/null || continue
  case $compiler in clang*) warnings="-Weverything -Wno-padded" ;; *) warnings="-Wconversion -Wshadow -Wstrict-prototypes -Wmissing-prototypes" ;; esac
  for standard in c99 c11 c17; do
    # shellcheck disable=SC2086
    echo '#include <wayfuse/sdk/wayfuse.h>' |
      $compiler -std=$standard -Wall -Wextra -Wpedantic $warnings -Werror -x c -fsyntax-only -I"$work/moved/include" -
  done
done
for standard in c++98 c++11 c++20; do
  echo '#include <wayfuse/sdk/wayfuse.h>' | c++ -std=$standard -Wall -Wextra -Wpedantic -Werror -x c++ -fsyntax-only -I"$work/moved/include" -
done
echo "installed, moved, found by CMake and by pkg-config"
