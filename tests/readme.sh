#!/usr/bin/env bash
# Runs the examples of the README (for shell also those of the documentation's first page) in one
# language against a real service.
# Usage: readme.sh README BIN_DIR shell|python|javascript
set -euo pipefail
readme=$(realpath "$1") bin=$2 language=$3
first_page=${readme%/*}/server/web/docs/index.html
place=$(mktemp -d)
service=
trap '[ -z "$service" ] || kill "$service"; rm -rf "$place"' EXIT
cd "$place"
PATH=$bin:$PATH

start_service() {
  : >service.log  # there before anybody looks for it
  fairwayd --listen 127.0.0.1:0 --data data >service.log 2>&1 &
  service=$!
  for _ in $(seq 300); do
    url=$(sed -n 's/^fairwayd: listening on //p' service.log)
    [ -n "$url" ] && return
    sleep 0.1
  done
  cat service.log
  exit 1
}

# A scene whose buffer stands in a file beside it.
make_scene() {
  fairway curvature noisy.glb whole.gltf --quiet
  jq -r '.buffers[0].uri | sub("^[^,]*,"; "")' whole.gltf | base64 -d >scene.bin
  jq '.buffers[0].uri = "scene.bin"' whole.gltf >scene.gltf
}

# Follows the job that an answer tells of, if it does, and keeps its id.
follow_job() { # ANSWER
  local new state
  new=$(jq -r '.id // empty' <<<"$1" 2>/dev/null || true)
  [ -n "$new" ] || return 0
  id=$new
  for _ in $(seq 600); do
    state=$(curl -sS "$url/v1/jobs/$id" | jq -r .state)
    case $state in queued | running) sleep 0.1 ;; *) break ;; esac
  done
  [ "$state" = succeeded ] || { echo "the job ended $state"; exit 1; }
}

is_glb() { [ "$(head -c 4 "$1")" = glTF ] || { echo "$1 is no mesh"; exit 1; }; }

run_curl() {
  local line answer runs=0
  id=
  while IFS= read -r line; do
    line=${line//http:\/\/127.0.0.1:8080/$url}
    line=${line//jobs\/ID/jobs\/$id}
    rm -f clean.glb clean.gltf
    echo "+ $line"
    answer=$(eval "$line --fail-with-body" </dev/null) || { echo "$answer"; exit 1; }
    follow_job "$answer"
    case $line in *clean.glb*) is_glb clean.glb ;; esac
    case $line in
      *clean.gltf*)
        jq -e '[.buffers[].uri | startswith("data:")] | all' clean.gltf >/dev/null ||
          { echo "no self-contained scene came"; exit 1; } ;;
    esac
    runs=$((runs + 1))
  done < <(grep '^curl ' "$readme"; sed 's/^<pre><code>//; s|</code></pre>$||' "$first_page" | grep '^curl ')
  [ "$runs" -ge 9 ] || { echo "only $runs curl examples were found"; exit 1; }
}

run_tool() {
  local line
  while IFS= read -r line; do
    line=${line//http:\/\/127.0.0.1:8080/$url}
    echo "+ $line"
    eval "$line" </dev/null
  done < <(grep -E '^fairway (sample|inspect|methods|denoise|curvature|compare|submit)( |$)' "$readme" | sort -r)
}

# The README's block of a language, which makes clean.glb of noisy.glb.
run_block() { # FENCE FILE INTERPRETER
  sed -n "/^\`\`\`$1\$/,/^\`\`\`\$/p" "$readme" | sed "/^\`\`\`/d; s|http://127.0.0.1:8080|$url|" >"$2"
  [ -s "$2" ] || { echo "the README has no $1"; exit 1; }
  cat "$2"
  "$3" "$2"
  is_glb clean.glb
  fairway compare ring.glb noisy.glb
  fairway compare ring.glb clean.glb
}

# One that is not there is told, not passed over.
need() {
  command -v "$1" >/dev/null && return
  echo "SKIPPED: there is no $1"
  exit 0
}

fairway sample ring noisy.glb --clean ring.glb
case $language in
  shell) make_scene; start_service; run_curl; run_tool ;;
  python) need python3; start_service; run_block python snippet.py python3 ;;
  javascript) need node; start_service; run_block js snippet.mjs node ;;
  *) echo "there are no examples in $language"; exit 1 ;;
esac
