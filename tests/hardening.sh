#!/usr/bin/env bash
# hardening.sh PROGRAM...: each program is position independent, binds at once and makes its tables
# read-only, has no executable stack, watches its stack, and checks the bounds of what it copies.
set -euo pipefail
failed=0
for program in "$@"; do
  headers=$(readelf --wide --file-header --program-headers --dynamic "$program")
  symbols=$(readelf --wide --dyn-syms "$program")
  require() {
    grep -Eq "$3" <<<"$2" || { echo "$program: $1"; failed=1; }
  }
  require 'is not position independent' "$headers" 'Type: +DYN'
  require 'does not bind at once' "$headers" 'FLAGS_1.* NOW'
  require 'leaves its tables writable' "$headers" 'GNU_RELRO'
  require 'has an executable stack' "$headers" 'GNU_STACK.* RW +0x'
  require 'does not watch its stack' "$symbols" '__stack_chk_fail'
  require 'does not check bounds' "$symbols" '__(memcpy|memmove|memset|read|recv|snprintf|vsnprintf|strncpy|pread|readlink|poll)[a-z0-9]*_chk'
done
exit $failed
