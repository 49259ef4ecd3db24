#!/usr/bin/env bash
# Bytes of code and constants of the attitude filter alone, at -Os for this machine's processor.
# usage: code_size.sh, anywhere in the tree
set -euo pipefail
cd "$(dirname "$0")/../../.."
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
for part in block_heading inertial_kalman magnetic_field sample_gate; do
  g++ -std=c++20 -Os -I. -Iproto/include -Isdk/include -c "sdk/src/attitude/$part.cpp" -o "$out/$part.o"
done
ld -r "$out"/*.o -o "$out/all.o"  # what headers gave to several parts counts once
size -A "$out/all.o" | awk '/^\.(text|rodata)/ {bytes += $2} END {print bytes}'
