#!/usr/bin/env bash
# The page in Debian's chromium: real clicks, real service. Screenshots stay in WORK_DIR/screenshots.
# Says SKIPPED where node, npm or chromium cannot be used, or the page was not built.
# Usage: run.sh SOURCE_DIR BIN_DIR WORK_DIR [bench.mjs]
set -euo pipefail
source=$(cd "$1" && pwd) bin=$(cd "$2" && pwd) work=$3 program=${4:-}
skip() { echo "SKIPPED: $*"; exit 0; }

command -v node >/dev/null || skip 'there is no node'
command -v npm >/dev/null || skip 'there is no npm'
[ "$(node -p 'process.versions.node.split(".")[0]')" -ge 18 ] || skip 'node is older than 18'
grep -qa 'src="/assets/main-' "$bin/fairwayd" || skip 'this fairwayd was built without its page'
chromium=$(command -v chromium || command -v chromium-browser) || skip 'there is no chromium (Debian: chromium)'
"$chromium" --headless --no-sandbox --dump-dom about:blank >/dev/null 2>&1 || skip 'chromium does not start'

mkdir -p "$work"
cd "$work"
cp "$source"/{package.json,package-lock.json,browser.mjs,page.test.mjs,bench.mjs} .
if ! cmp -s package-lock.json installed.json; then
  rm -f installed.json
  timeout 180 npm ci --ignore-scripts --no-audit --no-fund >npm.log 2>&1 ||
    { cat npm.log; skip 'npm cannot install the packages'; }
  cp package-lock.json installed.json
fi
export FAIRWAY_BIN=$bin CHROMIUM=$chromium
[ -z "$program" ] || exec node "$program"
rm -rf screenshots && mkdir screenshots
exec node --test --test-reporter=spec page.test.mjs
