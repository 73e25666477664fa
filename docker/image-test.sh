#!/usr/bin/env bash
# Tries the image localhost/fairway:latest as it is meant to be run: read-only, without capabilities, as a user
# of its own, on this machine's loopback. Every line "ok" is a promise that held.
# Usage: image-test.sh [SHARED]; SHARED (or FAIRWAY_SHARED, ../shared) has hostile files, if there are any.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
image=localhost/fairway:latest
shared=${1:-${FAIRWAY_SHARED:-../shared}}
port=$((20000 + RANDOM % 20000))
url=http://127.0.0.1:$port
name=fairway-test-$$
volume=fairway-test-$$
work=$(mktemp -d)
passed=0

# Without systemd podman complains of timers for health checks, which nobody wants here.
podman() { command podman "$@" 2> >(grep -v healthcheck >&2); }
ok() { passed=$((passed + 1)); printf 'ok    %s\n' "$*"; }
die() { printf 'FAILED %s\n' "$*" >&2; podman logs "$name" 2>&1 | tail -n 20 >&2; exit 1; }
tidy() {
  podman rm -f -t 1 "$name" >/dev/null 2>&1 || true
  podman volume rm -f "$volume" >/dev/null 2>&1 || true
  rm -rf "$work"
}
trap tidy EXIT

confined=(--runtime runc --network host --ulimit nofile=1024:1024 --ulimit nproc=1024:1024
  --read-only --read-only-tmpfs=false --cap-drop all --security-opt no-new-privileges)
start() {
  podman run -d --replace --name "$name" "${confined[@]}" --volume "$volume:/data:U" \
    --env "FAIRWAY_LISTEN=127.0.0.1:$port" --env "FAIRWAY_AUTH=${1:-none}" --env FAIRWAY_MIN_FREE=0 \
    --env FAIRWAY_DRAIN=20 "$image" >/dev/null
  local i
  for i in $(seq 100); do
    curl -sf -o /dev/null "$url/readyz" && return
    sleep 0.1
  done
  die "the service does not get ready"
}
inside() { podman exec "$name" "$@"; }
state_of() { curl -s "$url/v1/jobs/$1" | jq -r .state; }
wait_for() { # ID STATE
  local i
  for i in $(seq 600); do
    [ "$(state_of "$1")" = "$2" ] && return
    sleep 0.1
  done
  die "job $1 is $(state_of "$1"), not $2"
}
submit() { # FILE [PARAMETERS]
  curl -sS -F "mesh=@$1" -F "params=${2:-{\}}" "$url/v1/jobs" | jq -re .id
}

size=$(podman image inspect "$image" --format '{{.Size}}')
printf 'size  %d bytes, %d MB\n' "$size" $((size / 1000000))
[ "$size" -le 100000000 ] || die "the image is larger than 100 MB"
ok "the image has at most 100 MB"
[ "$(podman image inspect "$image" --format '{{.Config.User}}')" = 10001:10001 ] || die "it runs as root"
podman image inspect "$image" | jq -e '.[0].Labels."org.opencontainers.image.version"' >/dev/null ||
  die "it has no labels"
podman image inspect "$image" | jq -e '.[0].Healthcheck.Test | index("--health")' >/dev/null ||
  die "it has no health check"
ok "it has labels, a health check and a user that is not root"

podman volume create "$volume" >/dev/null
# Samples come from the tool in the image: the machine needs no build.
sample() { podman run --rm "${confined[@]}" --volume "$work:/out:U" --entrypoint fairway "$image" sample "$@"; }
chmod 777 "$work"
sample ring /out/ring.glb --noise 0.2
sample torus /out/large.glb --size 250 --noise 0.2
for shell in sh bash busybox; do
  podman run --rm "${confined[@]}" --entrypoint "$shell" "$image" -c true 2>/dev/null && die "there is a $shell"
done
ok "there is no shell in it"

start
pid=$(podman inspect "$name" --format '{{.State.Pid}}')
[ "$(awk '/^Uid:/ {print $2}' "/proc/$pid/status")" -ne 0 ] || die "the process is root"
[ "$(awk '/^CapEff:/ {print $2}' "/proc/$pid/status")" = 0000000000000000 ] || die "it has capabilities"
[ "$(awk '/^NoNewPrivs:/ {print $2}' "/proc/$pid/status")" = 1 ] || die "it may gain privileges"
ok "the process is no root, has no capability and can gain none"
[ "$(inside fairwayd --health)" = ready ] || die "--health says it is not ready"
podman healthcheck run "$name" >/dev/null || die "the health check fails"
ok "the health check passes"
podman logs "$name" 2>&1 | grep -q '"event":"sandbox' || die "nothing was said of the sandbox"
note=$(podman logs "$name" 2>&1 | sed -n 's/.*"event":"sandbox[^"]*".*"note":"\([^"]*\)".*/\1/p' | head -n 1)
inside fairway worker --self-test-sandbox >"$work/sandbox.txt" || { cat "$work/sandbox.txt" >&2; die "the sandbox does not hold"; }
grep -q 'FAILED' "$work/sandbox.txt" && die "a wall of the sandbox does not hold"
ok "the walls around a worker hold: $(grep -c '^ok' "$work/sandbox.txt") of them; ${note:-no note}"

id=$(submit "$work/ring.glb")
wait_for "$id" succeeded
curl -sf -o "$work/clean.glb" "$url/v1/jobs/$id/result"
[ "$(head -c 4 "$work/clean.glb")" = glTF ] || die "the result is no GLB"
digest=$(sha256sum <"$work/clean.glb")
curl -sf "$url/" | grep -q 'src="/assets/main-' || die "the page is missing"
ok "a job runs to its result, and the page is there"

# SIGTERM: what runs may end.
long='{"steps": 3000}'
id2=$(submit "$work/large.glb" "$long")
wait_for "$id2" running
podman stop -t 30 "$name" >/dev/null
[ "$(podman inspect "$name" --format '{{.State.ExitCode}}')" = 0 ] || die "it does not end well on SIGTERM"
start
[ "$(state_of "$id2")" = succeeded ] || die "the running job did not end before the stop: $(state_of "$id2")"
[ "$(curl -sf "$url/v1/jobs/$id/result" | sha256sum)" = "$digest" ] || die "a result did not survive"
ok "SIGTERM lets a running job end, and a new container with the volume has all jobs and results"

# kill -9 in the middle of work.
ids=()
for i in 1 2 3 4 5 6; do ids+=("$(submit "$work/large.glb" "{\"steps\": $((200 + i))}")"); done
wait_for "${ids[0]}" running
podman kill -s KILL "$name" >/dev/null
start
for one in "${ids[@]}"; do wait_for "$one" succeeded; done
ok "after kill -9 in the middle of work all ${#ids[@]} jobs are done"

# Hostile bytes: each is refused or fails alone.
hostile=0
status_of() { curl -s -o "$work/answer" -w '%{http_code}' --max-time 60 -F "mesh=@$1" "$url/v1/denoise"; }
head -c 100000 /dev/urandom >"$work/random.glb"
head -c 1000 "$work/ring.glb" >"$work/cut.glb"
: >"$work/empty.glb"
printf 'ply\nformat ascii 1.0\nelement vertex 4000000000\nproperty float x\nend_header\n' >"$work/huge.ply"
printf '{"asset":{"version":"2.0"},"buffers":[{"byteLength":1,"uri":"../../etc/passwd"}]}' >"$work/path.gltf"
files=("$work"/{random,cut,empty}.glb "$work/huge.ply" "$work/path.gltf")
if [ -d "$shared/bad" ]; then
  mapfile -t more < <(find "$shared/bad" -type f \( -name '*.glb' -o -name '*.gltf' -o -name '*.drc' -o -name '*.ply' \) -size -4000k | sort)
  files+=("${more[@]}")
else
  echo "SKIPPED: no collection of hostile files at $shared/bad"
fi
for file in "${files[@]}"; do
  status=$(status_of "$file")
  case $status in
    2?? | 4??) ;;
    *) die "$file is answered $status: $(head -c 300 "$work/answer")" ;;
  esac
  curl -sf -o /dev/null "$url/livez" || die "the service died of $file"
  hostile=$((hostile + 1))
done
[ "$(status_of "$work/random.glb")" = 415 ] || die "random bytes are not refused"
id=$(submit "$work/ring.glb" '{"steps": 3}')
wait_for "$id" succeeded
ok "$hostile hostile files are answered, and the service works on"

# As the image comes it asks for keys, which are made beside the service.
podman stop -t 30 "$name" >/dev/null
start keys
[ "$(curl -s -o /dev/null -w '%{http_code}' "$url/v1/jobs")" = 401 ] || die "no key is asked for"
key=$(inside fairwayd keys add --label test | grep -o 'fw_[A-Za-z0-9_-]*' | head -n 1)
[ "$(curl -s -o /dev/null -w '%{http_code}' -H "Authorization: Bearer $key" "$url/v1/jobs")" = 200 ] ||
  die "a key that was made in the container opens nothing"
ok "a key made in the container opens the service"

podman stop -t 30 "$name" >/dev/null
echo "$passed passed, 0 failed"
