#!/usr/bin/env bash
# docker/nginx.conf in front of a real fairwayd: what a client gets through it. Says SKIPPED without nginx (it is
# not installed by the tests, because Debian would start it on port 80).
# Usage: proxy.sh SOURCE_DIR BIN_DIR
set -euo pipefail
source=$1 bin=$2
PATH=$PATH:/usr/sbin
command -v nginx >/dev/null || { echo 'SKIPPED: there is no nginx'; exit 0; }
die() { echo "$*" >&2; cat "$work"/nginx.log >&2; exit 1; }
work=$(mktemp -d)
chmod 711 "$work"
daemon='' proxy=''
tidy() {
  [ -z "$proxy" ] || kill "$proxy" 2>/dev/null || true
  [ -z "$daemon" ] || { kill "$daemon" && wait "$daemon"; } 2>/dev/null || true
  rm -rf "$work"
}
trap tidy EXIT

"$bin/fairwayd" --data "$work/data" --listen 127.0.0.1:0 --min-free 0 --max-body 2000000 >"$work/log" 2>&1 &
daemon=$!
address=
for _ in $(seq 300); do
  address=$(sed -n 's#^fairwayd: listening on http://##p' "$work/log")
  [ -z "$address" ] || break
  sleep 0.1
done
[ -n "$address" ] || die "fairwayd does not start"

# The file as it is shipped, but for addresses and folders of this test.
port=$((20000 + RANDOM % 20000))
sed -e "s#server fairway:8080#server $address#" -e "s#listen 80;#listen 127.0.0.1:$port;#" \
  -e "s#/run/nginx.pid#$work/nginx.pid#" -e "s#/dev/stdout#$work/access.log#" -e "s#/dev/stderr#$work/nginx.log#" \
  -e "s#^http {#http {\n  client_body_temp_path $work/body;\n  proxy_temp_path $work/proxy;\n  fastcgi_temp_path $work/f;\n  uwsgi_temp_path $work/u;\n  scgi_temp_path $work/s;#" \
  "$source/docker/nginx.conf" >"$work/nginx.conf"
: >"$work/nginx.log"
nginx -e "$work/nginx.log" -t -c "$work/nginx.conf" 2>"$work/nginx.log" || die "nginx refuses the file"
nginx -e "$work/nginx.log" -c "$work/nginx.conf" -g 'daemon off;' &
proxy=$!
url=http://127.0.0.1:$port
for _ in $(seq 100); do
  ! curl -sf -o /dev/null "$url/livez" || break
  sleep 0.1
done

"$bin/fairway" sample ring "$work/ring.glb" --noise 0.2
curl -sSf -F "mesh=@$work/ring.glb" -F 'params={"steps":5}' "$url/v1/denoise" -o "$work/through.glb"
"$bin/fairway" denoise "$work/ring.glb" "$work/direct.glb" --params '{"steps":5}' --quiet
cmp "$work/through.glb" "$work/direct.glb" || die "the result is another one than without the proxy"

id=$(curl -sS -F "mesh=@$work/ring.glb" -F 'params={"steps":9}' "$url/v1/jobs" | sed -n 's/.*"id":"\([^"]*\)".*/\1/p')
events=$(curl -sSN --max-time 60 "$url/v1/jobs/$id/events")
grep -q '"state":"succeeded"' <<<"$events" || die "events do not come through: $events"
# The first bytes of events come while the job is still at work.
id=$(curl -sS -F "mesh=@$work/ring.glb" -F 'params={"steps":10000,"integration":"semi_implicit"}' "$url/v1/jobs" | sed -n 's/.*"id":"\([^"]*\)".*/\1/p')
seen=$( (curl -sN --max-time 60 "$url/v1/jobs/$id/events" || true) | grep -m 1 '^event: progress' || true)
state=$(curl -sS "$url/v1/jobs/$id" | sed -n 's/.*"state":"\([^"]*\)".*/\1/p')
[ "$seen,$state" = 'event: progress,running' ] || die "progress is held back: $seen, $state"
curl -sS -X POST -o /dev/null "$url/v1/jobs/$id/cancel"

# A page of the proxy's own address, port and all, is no strange page.
status=$(curl -s -o /dev/null -w '%{http_code}' -H "Origin: $url" -F "mesh=@$work/ring.glb" "$url/v1/jobs")
[ "$status" = 202 ] || die "the page behind the proxy is answered $status"

head -c 3000000 /dev/zero >"$work/large.glb"
answer=$(curl -sS -F "mesh=@$work/large.glb" "$url/v1/denoise" || true)
grep -q '"code":"too_large"' <<<"$answer" || die "too large is not told by the service: $answer"
[ "$(curl -s -o /dev/null -w '%{http_code}' "$url/metrics")" = 404 ] || die "metrics are open to all"
[ "$(curl -s -o /dev/null -w '%{http_code}' -H 'Range: bytes=0-3' "$url/samples/ring.glb")" = 200 ] || die "samples do not come"
curl -sf "$url/" | grep -q '<title>fairway' || die "the page does not come"
kill "$daemon" && wait "$daemon" || true
daemon=
curl -s "$url/livez" | grep -q '"code":"unavailable"' || die "a service that is away is not told as a problem"
echo "the proxy holds"
