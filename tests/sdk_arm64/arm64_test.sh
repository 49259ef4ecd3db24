#!/bin/sh
# The motion core for a phone's processor: its size against the budget, and its own tests under qemu.
# usage: arm64_test.sh SOURCE WORK       needs g++-aarch64-linux-gnu, qemu-user, libgtest-dev; without them it skips (77)
set -eu
source=$1 work=$2
compiler=aarch64-linux-gnu-g++
for tool in $compiler qemu-aarch64; do
  command -v $tool >/dev/null || { echo "SKIPPED: $tool is not installed (Debian: g++-aarch64-linux-gnu qemu-user)" >&2; exit 77; }
done
[ -f /usr/src/googletest/googletest/src/gtest-all.cc ] || { echo "SKIPPED: no googletest sources" >&2; exit 77; }
mkdir -p "$work/small" "$work/test"
cd "$source"
includes="-I. -Iproto/include -Isdk/include"

# The sources CMake builds the rooms from.
sources_of() {  # sources_of ROOM FOLDER
  awk -v room="wayfuse_room($1" 'index($0, room) { on = 1 } on { print } on && /\)/ { exit }' "$2/CMakeLists.txt" | grep -oE '[A-Za-z0-9_./]+\.cpp' | sed "s#^#$2/#"
}
compile() {  # compile FILE OBJECT FLAGS...
  file=$1 object=$2
  shift 2
  if [ -f "$object" ] && [ -z "$(find proto/include sdk/include sdk/src/attitude sdk/src/walking "$file" -newer "$object" | head -1)" ]; then
    return
  fi
  $compiler -std=c++20 "$@" $includes -c "$file" -o "$object"
}

motion=$(sources_of motion sdk/src/attitude)
for file in $motion; do
  compile "$file" "$work/small/$(basename "$file").o" -Os -ffunction-sections -fdata-sections -fno-asynchronous-unwind-tables \
          -ffp-contract=off -DNDEBUG
done
text=$(aarch64-linux-gnu-size -t "$work"/small/*.o | awk 'END { print $1 }')
echo "motion core: $text bytes of arm64 code and constants, budget 65536"
[ "$text" -le 65536 ]

tests=$(sed -n '/wayfuse_test(sdk_motion/,/LINK/p' tests/sdk_motion/CMakeLists.txt | grep -oE '[A-Za-z0-9_]+\.cpp' | sed 's#^#tests/sdk_motion/#')
for file in $motion $(sources_of vocabulary proto) $tests; do
  compile "$file" "$work/test/$(basename "$file").o" -O1 -ffp-contract=off -DWAYFUSE_SOURCE_DIR="\"$source\""
done
for part in googletest/src/gtest-all.cc googletest/src/gtest_main.cc; do
  object=$work/test/$(basename $part).o
  [ -f "$object" ] || $compiler -O0 -I/usr/src/googletest/googletest -I/usr/src/googletest/googletest/include \
                      -c "/usr/src/googletest/$part" -o "$object"
done
$compiler -static "$work"/test/*.o -lpthread -o "$work/motion_tests"
qemu-aarch64 "$work/motion_tests" --gtest_brief=1
