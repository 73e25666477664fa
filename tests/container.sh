#!/usr/bin/env bash
# What the files for containers and for systemd say of fairwayd is so: the settings exist, the paths too.
# `./dev image-test` tries the image itself. Usage: container.sh SOURCE_DIR BIN_DIR
set -euo pipefail
source=$1 bin=$2
fail() { echo "$*"; exit 1; }
files=("$source"/docker/{Dockerfile,compose.yaml,image-test.sh} "$source/server/fairwayd/fairwayd.service")

help=$("$bin/fairwayd" --help)
count=0
while read -r variable; do
  flag=--$(tr 'A-Z_' 'a-z-' <<<"${variable#FAIRWAY_}")
  grep -q -e "^ *$flag[ =]" <<<"$help" || fail "$variable is no setting of fairwayd"
  count=$((count + 1))
done < <(grep -ohE 'FAIRWAY_[A-Z_]+' "${files[@]}" | grep -vx 'FAIRWAY_SHARED' | sort -u)
[ "$count" -ge 6 ] || fail "only $count settings were found"

# A stop may take as long as running jobs are given, and a little.
drain=$(sed -n 's/.*FAIRWAY_DRAIN: "\([0-9]*\)"/\1/p' "$source/docker/compose.yaml")
grace=$(sed -n 's/.*stop_grace_period: \([0-9]*\)s/\1/p' "$source/docker/compose.yaml")
[ "$grace" -gt "$drain" ] || fail "compose kills after $grace s what may take $drain s"
usual=$(sed -n 's/.*--drain SECONDS=\([0-9]*\).*/\1/p' <<<"$help")
[ "$(sed -n 's/^TimeoutStopSec=//p' "$source/server/fairwayd/fairwayd.service")" -gt "$usual" ] ||
  fail "systemd kills before --drain is over"

# nginx lets through what the service is to refuse by itself.
most=$(sed -n 's/.*--max-body BYTES=\([0-9]*\).*/\1/p' <<<"$help")
through=$(sed -n 's/.*client_max_body_size \([0-9]*\)m;/\1/p' "$source/docker/nginx.conf")
[ $((through * 1048576)) -gt "$most" ] || fail "nginx refuses bodies that the service takes"

# The image gets what the programs load and nothing that they do not.
root=$(mktemp -d)
trap 'rm -rf "$root"' EXIT
if [ "$(id -u)" -eq 0 ]; then
  "$source/docker/rootfs.sh" "$bin" "$root/image"
  for program in fairwayd fairway fairway-submit; do
    chroot "$root/image" "/usr/local/bin/$program" --version >/dev/null || fail "$program does not run in the image"
  done
  [ ! -e "$root/image/bin" ] || fail "there are other programs in the image"
fi
echo "$count settings, three programs"
