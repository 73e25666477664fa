#!/usr/bin/env bash
# Runs the curl examples of the README against a real service, and its examples of the tool.
# Usage: readme.sh README BIN_DIR
set -euo pipefail
readme=$(realpath "$1") bin=$2
place=$(mktemp -d)
service=
trap '[ -z "$service" ] || kill "$service"; rm -rf "$place"' EXIT
cd "$place"
PATH=$bin:$PATH
fairway sample ring noisy.glb
# A scene whose buffer stands in a file beside it.
fairway curvature noisy.glb whole.gltf --quiet
jq -r '.buffers[0].uri | sub("^[^,]*,"; "")' whole.gltf | base64 -d >scene.bin
jq '.buffers[0].uri = "scene.bin"' whole.gltf >scene.gltf
: >service.log  # there before anybody looks for it
fairwayd --listen 127.0.0.1:0 --data data >service.log 2>&1 &
service=$!
for _ in $(seq 100); do
  url=$(sed -n 's/^fairwayd: listening on //p' service.log)
  [ -n "$url" ] && break
  sleep 0.1
done
[ -n "$url" ] || { cat service.log; exit 1; }

id= runs=0
while IFS= read -r line; do
  line=${line//http:\/\/127.0.0.1:8080/$url}
  line=${line//jobs\/ID/jobs\/$id}
  rm -f clean.glb clean.gltf
  echo "+ $line"
  answer=$(eval "$line --fail-with-body" </dev/null) || { echo "$answer"; exit 1; }
  new=$(jq -r '.id // empty' <<<"$answer" 2>/dev/null || true)
  if [ -n "$new" ]; then
    id=$new
    for _ in $(seq 100); do
      state=$(curl -sS "$url/v1/jobs/$id" | jq -r .state)
      case $state in queued | running) sleep 0.1 ;; *) break ;; esac
    done
    [ "$state" = succeeded ] || { echo "the job ended $state"; exit 1; }
  fi
  case $line in *clean.glb*) [ "$(head -c 4 clean.glb)" = glTF ] || { echo "no mesh came"; exit 1; } ;; esac
  case $line in
    *clean.gltf*)
      jq -e '[.buffers[].uri | startswith("data:")] | all' clean.gltf >/dev/null ||
        { echo "no self-contained scene came"; exit 1; } ;;
  esac
  runs=$((runs + 1))
done < <(grep '^curl ' "$readme")
[ "$runs" -ge 5 ] || { echo "only $runs curl examples were found"; exit 1; }

while IFS= read -r line; do
  line=${line//http:\/\/127.0.0.1:8080/$url}
  echo "+ $line"
  eval "$line" </dev/null
done < <(grep -E '^fairway (sample|inspect|methods|denoise|curvature|compare|submit)( |$)' "$readme" | sort -r)
