#!/usr/bin/env bash
# security.sh SOURCE: every test and attack that .github/SECURITY.md names is there.
set -euo pipefail
cd "$1"
# One line, with literals that were broken put together.
sources=$(find tests \( -name '*.cpp' -o -name CMakeLists.txt \) -exec cat {} + | tr '\n' ' ' |
  sed 's/" *"//g; s/TEST_CASE( */TEST_CASE(/g')
missing=0 names=0
while IFS= read -r name; do
  names=$((names + 1))
  case $sources in
    *"TEST_CASE(\"$name\""* | *"Attack{\"$name\""* | *"add_test(NAME $name "*) ;;
    *) echo "SECURITY.md names what is not there: $name" >&2; missing=1 ;;
  esac
done < <(grep '^|\|^\*\*The build' .github/SECURITY.md | grep -o '`[^`]*`' | tr -d '`' |
  grep -v '^/\|^\./dev\|^-D\|_test$')
[ "$names" -gt 40 ] || { echo "only $names names were found in SECURITY.md" >&2; missing=1; }
exit "$missing"
