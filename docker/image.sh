#!/usr/bin/env bash
# Builds the image localhost/fairway with buildah. Usage: image.sh [TARGET]
# The base is $BASE (default: debian:bookworm-slim). Where that cannot be pulled, debootstrap makes one of the
# packages that this machine uses.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
target=${1:-runtime}
base=${BASE:-debian:bookworm-slim}
own_base=localhost/fairway-base:bookworm
say() { printf '%s\n' "image: $*" >&2; }
mkdir -p build

# Packages come from where this machine has them; so do certificates, where a network has its own.
make_base() {
  local folder mirror container mounted
  folder=$(mktemp -d)
  mirror=$(cat /etc/apt/sources.list /etc/apt/sources.list.d/* 2>/dev/null |
    sed -n 's/^URIs: *\([^ ]*\).*/\1/p; s/^deb \(\[[^]]*\] \)\?\([^ ]*\) bookworm main.*/\2/p' | head -n 1 || true)
  say "making a base of Debian 12 with debootstrap"
  # shellcheck disable=SC2086
  debootstrap --variant=minbase --include=ca-certificates bookworm "$folder" $mirror >build/debootstrap.log
  cp /usr/local/share/ca-certificates/*.crt "$folder/usr/local/share/ca-certificates/" 2>/dev/null || true
  chroot "$folder" update-ca-certificates >/dev/null 2>&1
  container=$(buildah from scratch)
  mounted=$(buildah mount "$container")
  cp -a "$folder/." "$mounted/"
  buildah umount "$container" >/dev/null
  buildah config --env NODE_EXTRA_CA_CERTS=/etc/ssl/certs/ca-certificates.crt "$container"
  buildah commit --format docker --rm "$container" "$own_base" >/dev/null
  rm -rf "$folder"
}

if [ -z "${BASE:-}" ]; then
  if buildah inspect --type image "$own_base" >/dev/null 2>&1; then
    base=$own_base
  elif ! timeout 60 buildah pull "$base" >build/pull.log 2>&1; then
    say "$base cannot be pulled ($(tail -n 1 build/pull.log | cut -c1-120))"
    make_base
    base=$own_base
  fi
fi

# What the compiler made before may be used again, also between images.
cache=${CCACHE_DIR:-$HOME/.cache/ccache}
mkdir -p "$cache"
version=$(sed -n 's/^project(fairway VERSION \([^ ]*\).*/\1/p' CMakeLists.txt)
revision=$(git rev-parse HEAD 2>/dev/null || echo unknown)
say "building stage $target on $base"
buildah bud --isolation chroot --format docker --layers -f docker/Dockerfile --target "$target" \
  --build-arg BASE="$base" --build-arg VERSION="$version" --build-arg REVISION="$revision" \
  --volume "$cache:/ccache" -t "localhost/fairway:$target" . >build/image.log 2>&1 ||
  { tail -n 40 build/image.log >&2; say "the image was not built; see build/image.log"; exit 1; }
[ "$target" = runtime ] || exit 0
buildah tag localhost/fairway:runtime "localhost/fairway:$version" localhost/fairway:latest
size=$(buildah inspect --type image --format '{{.FromImageID}}' localhost/fairway:latest |
  xargs -I{} buildah images --json | jq -r '.[] | select(.names // [] | index("localhost/fairway:latest")) | .size')
say "localhost/fairway:latest is built, $size"
