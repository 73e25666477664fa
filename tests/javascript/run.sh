#!/usr/bin/env bash
# Lets JavaScript packages read what fairway writes, and upload to fairwayd. Says SKIPPED where node
# or npm cannot be used.
# Usage: run.sh SOURCE_DIR BIN_DIR WORK_DIR
set -euo pipefail
source=$1 bin=$2 work=$3
skip() { echo "SKIPPED: $*"; exit 0; }

command -v node >/dev/null || skip 'there is no node'
command -v npm >/dev/null || skip 'there is no npm'
major=$(node -p 'process.versions.node.split(".")[0]')
[ "$major" -ge 18 ] || skip "node $major is older than 18"

# The packages are installed once for each lock file.
mkdir -p "$work/files"
cd "$work"
cp "$source"/package.json "$source"/package-lock.json "$source"/{read,upload}.mjs .
if ! cmp -s package-lock.json installed.json; then
  rm -f installed.json
  timeout 180 npm ci --ignore-scripts --no-audit --no-fund >npm.log 2>&1 ||
    { cat npm.log; skip 'npm cannot install the packages'; }
  cp package-lock.json installed.json
fi

# A scene that comes as glTF, and the same mesh without one: a fresh glTF is made around it.
cd files
"$bin/fairway" sample ring scene-in.glb --noise 0.2
"$bin/fairway" denoise scene-in.glb fresh-in.ply --params '{"steps":0,"curvature":[]}' --quiet
parameters() { echo "{\"steps\":4,\"compression\":\"$1\"}"; }
for way in scene fresh; do
  input=$(echo "$way"-in.*)
  "$bin/fairway" denoise "$input" $way.glb --params "$(parameters none)" >$way.glb.log 2>&1
  for compression in draco meshopt; do
    output=$way-$compression.glb
    "$bin/fairway" denoise "$input" "$output" --params "$(parameters $compression)" >"$output.log" 2>&1
  done
  "$bin/fairway" denoise "$input" $way.drc --params "$(parameters none)" >$way.drc.log 2>&1
done
cd ..
node read.mjs files

# The service on a free port; it says which on its first line.
rm -rf service service.log
"$bin/fairwayd" --data service --listen 127.0.0.1:0 --min-free 0 >service.log 2>&1 &
daemon=$!
trap 'kill $daemon; wait $daemon || true' EXIT
server=
for _ in $(seq 600); do
  server=$(sed -n 's/^fairwayd: listening on //p' service.log)
  [ -z "$server" ] || break
  sleep 0.1
done
[ -n "$server" ] || { cat service.log; exit 1; }
node upload.mjs "$server" files/scene-in.glb
