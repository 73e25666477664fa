#!/bin/sh
# Lays out what the runtime image has: the programs, the libraries that they load, names and certificates.
# Usage: rootfs.sh BIN_DIR ROOT
set -eu
bin=$1 root=$2
rm -rf "$root"
mkdir -p "$root/usr/local/bin" "$root/etc/ssl/certs" "$root/data" "$root/tmp"

for program in fairwayd fairway fairway-submit; do
  strip -o "$root/usr/local/bin/$program" "$bin/$program"
  # "libx.so.1 => /lib/libx.so.1 (0x…)" and the loader, "/lib64/ld-linux-x86-64.so.2 (0x…)".
  ldd "$bin/$program" | sed -n 's/.*=> \(\/[^ ]*\) .*/\1/p; s/^[[:space:]]*\(\/[^ ]*\) .*/\1/p'
done | sort -u | while read -r library; do
  mkdir -p "$root$(dirname "$library")"
  cp -L "$library" "$root$library"
done

echo 'fairway:x:10001:10001:fairway:/data:/nonexistent' >"$root/etc/passwd"
echo 'fairway:x:10001:' >"$root/etc/group"
echo 'hosts: files dns' >"$root/etc/nsswitch.conf"
# Debian's authorities only, not those that the machine that builds trusts beside them.
cat /usr/share/ca-certificates/mozilla/*.crt >"$root/etc/ssl/certs/ca-certificates.crt"
chown 10001:10001 "$root/data"
chmod 0700 "$root/data"
chmod 1777 "$root/tmp"
