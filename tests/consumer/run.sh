#!/usr/bin/env bash
# Installs the build, moves what was installed, and lets a project of a stranger use its core.
# Usage: run.sh SOURCE_DIR BUILD_DIR CXX
set -euo pipefail
source=$1 build=$2 cxx=$3
here=$source/tests/consumer
place=$(mktemp -d)
trap 'rm -rf "$place"' EXIT

cmake --install "$build" --prefix "$place/first" >/dev/null
mv "$place/first" "$place/prefix"
if grep -rlF -e "$source" -e "$place/first" "$place/prefix/lib" --include='*.cmake' --include='*.pc'; then
  echo "the files above name paths of the machine that built them"
  exit 1
fi

sed -n '/^```cpp$/,/^```$/p' "$source/README.md" | sed '/^```/d' >"$place/readme.cpp"
[ -s "$place/readme.cpp" ] || { echo "the README has no C++"; exit 1; }
cmake -S "$here" -B "$place/build" -G Ninja -DCMAKE_BUILD_TYPE=Release -DCMAKE_CXX_COMPILER="$cxx" \
  -DCMAKE_PREFIX_PATH="$place/prefix" -DREADME_SNIPPET="$place/readme.cpp" >"$place/configure.log" ||
  { cat "$place/configure.log"; exit 1; }
cmake --build "$place/build" -j 2
"$place/build/tour"
"$place/build/readme"

# The same core by pkg-config.
export PKG_CONFIG_PATH=$place/prefix/lib/pkgconfig
read -ra flags < <(pkg-config --cflags --libs fairway)
"$cxx" -std=c++20 "$here/tour.cpp" "${flags[@]}" -o "$place/tour"
"$place/tour"
echo "core $(pkg-config --modversion fairway) is good to be used"
