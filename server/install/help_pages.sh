#!/bin/sh
# Prints what --help says of a program and of its subcommands, each behind a line "@@ WORDS".
# Usage: help_pages.sh PROGRAM [GROUP...]
# A GROUP is a subcommand that the program's own --help does not list. Left out is `worker`, which is not
# for people.
set -eu
program=$1
shift

page() { # WORDS...
  echo "@@ $*"
  text=$("$program" "$@" --help)
  printf '%s\n' "$text"
  for verb in $(printf '%s\n' "$text" | sed -n '/^Subcommands:/,/^$/s/^  \([a-z-]*\).*/\1/p'); do
    [ "$verb" = worker ] || page "$@" "$verb"
  done
}

page
for group in "$@"; do page "$group"; done
