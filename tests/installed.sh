#!/usr/bin/env bash
# Installs the build and tries what came: programs, manual pages, completions.
# Usage: installed.sh SOURCE_DIR BUILD_DIR
set -euo pipefail
source=$1 build=$2
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT
die() { echo "installed: $*"; exit 1; }

cmake --install "$build" --prefix "$place" >/dev/null
version=$(sed -n 's/^project(fairway VERSION \([0-9.]*\).*/\1/p' "$source/CMakeLists.txt")
for program in fairway fairwayd fairway-submit; do
  [ "$("$place/bin/$program" --version)" = "$program $version" ] || die "$program --version"
done

# The three find each other.
cd "$place"
bin/fairway sample ring noisy.glb
bin/fairway denoise noisy.glb clean.glb --quiet
# Into a variable first: grep -q ends early, and who writes to it would fail.
help=$(bin/fairway submit --help)
grep -q 'fairway-submit' <<<"$help" || die "fairway does not find fairway-submit"
settings=$(bin/fairwayd --data data --print-config)
grep -q '^listen = ' <<<"$settings" || die "fairwayd --print-config"

# What --help offers is on the page and offered by the completion.
options_of() { "$@" --help | grep -oE '^ +(-[a-z],)?--[a-z-]+' | grep -oE -- '--[a-z-]+'; }
offered() { # WORD...: what bash offers for the last one
  COMP_WORDS=("$@") COMP_CWORD=$(($# - 1)) COMPREPLY=()
  "_${1//-/_}"
  printf '%s\n' "${COMPREPLY[@]}"
}
check() { # PROGRAM PAGE [SUBCOMMAND...]
  local program=$1 page=$2 option
  shift 2
  for option in $(options_of "bin/$program" "$@"); do
    grep -qE -- "$option( |$)" <<<"$page" || die "the page of $program lacks $* $option"
    grep -qxF -- "$option" <<<"$(offered "$program" "$@" "${option:0:4}")" ||
      die "the completion of $program lacks $* $option"
  done
}
for program in fairway fairwayd fairway-submit; do
  # shellcheck disable=SC1090
  source "share/bash-completion/completions/$program"
  file=$(echo share/man/man?/"$program".[18])
  [ -f "$file" ] || die "$program has no manual page"
  if ! command -v man >/dev/null || ! command -v groff >/dev/null; then
    echo "SKIPPED: there is no man, or no groff, to read the pages with"
    exit 0
  fi
  page=$(MANWIDTH=200 LC_ALL=C.UTF-8 MANOPT= man -l "$file" | col -b)
  # man keeps the formatter's warnings to itself.
  groff -man -ww -z -K utf8 -T utf8 "$file" 2>warnings
  [ ! -s warnings ] || { cat warnings; die "$file does not render cleanly"; }
  for part in NAME SYNOPSIS OPTIONS EXAMPLES 'SEE ALSO'; do
    grep -qx "$part" <<<"$page" || die "$file has no $part"
  done
  check "$program" "$page"
  case $program in
    fairway) for verb in denoise curvature inspect methods sample compare; do check fairway "$page" $verb; done ;;
    fairwayd) for verb in "keys add" "keys list" "keys revoke" "tenants list" "tenants set" "webhooks secret show"; do
      # shellcheck disable=SC2086
      check fairwayd "$page" $verb
    done ;;
  esac
done
[ "$(offered fairway den)" = denoise ] || die "fairway den is not completed"
[ "$(offered fairwayd keys re)" = revoke ] || die "fairwayd keys re is not completed"
[ "$(offered fairwayd --auth k)" = keys ] || die "the values of --auth are not offered"
echo "programs, pages and completions of $version are good"
