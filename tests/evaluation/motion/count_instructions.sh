#!/usr/bin/env bash
# Instructions a sample of every heading estimator: callgrind over N and over no samples of one BROAD trial, divided.
# usage: count_instructions.sh BUILD/tests/evaluation/attitude-cost TRIAL.csv
set -euo pipefail
program=$1 trial=$2
command -v valgrind >/dev/null || { echo "count_instructions.sh: valgrind is not installed" >&2; exit 2; }
out=$(mktemp -d)
trap 'rm -rf "$out"' EXIT
instructions() { valgrind --tool=callgrind --callgrind-out-file="$out/cg" "$program" "$trial" "$1" "$2" "$3" 2>&1 | awk '/Collected/ {print $4}'; }
printf '%-26s %12s %12s\n' estimator 'at 285.7 Hz' 'at 47.6 Hz'
for estimator in block_marg complementary complementary_as_printed compass madgwick_baseline; do
  fast=$(( ($(instructions $estimator 8000 1) - $(instructions $estimator 0 1)) / 8000 ))
  slow=$(( ($(instructions $estimator 8000 6) - $(instructions $estimator 0 6)) / 8000 ))
  printf '%-26s %12d %12d\n' "$estimator" "$fast" "$slow"
done
