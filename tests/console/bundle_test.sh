#!/usr/bin/env bash
# The committed page (admin/console/dist) is what its source makes, byte for byte. Needs node, npm and the npm registry, or skips.
set -euo pipefail
source_folder=$(cd "$1" && pwd)
command -v npm >/dev/null || { echo "SKIPPED: npm is not installed, so the console's bundle was not compared with its source"; exit 77; }
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT
(cd "$source_folder" && tar --exclude=node_modules --exclude=dist -cf - .) | tar -xf - -C "$work"
cd "$work"
if ! npm ci --ignore-scripts --no-audit --no-fund >npm.log 2>&1; then
  tail -5 npm.log
  grep -qE 'ENOTFOUND|EAI_AGAIN|ECONNREFUSED|ETIMEDOUT|ECONNRESET|ENETUNREACH' npm.log || exit 1
  echo "SKIPPED: the npm registry cannot be reached, so the console's bundle was not compared with its source"
  exit 77
fi
npm run --silent build >build.log 2>&1 || { cat build.log; exit 1; }
diff -r dist "$source_folder/dist" || { echo "admin/console/dist is not what its source makes: run 'npm ci && npm run build' in admin/console and commit"; exit 1; }
echo "the bundle is what its source makes (node $(node --version))"
