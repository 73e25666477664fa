#!/usr/bin/env bash
# run.sh FOLDER [SECONDS [TARGET...]]: runs fuzz targets (all of them without a name) of the build in
# FOLDER for SECONDS each (600), two at a time (or $FAIRWAY_FUZZ_AT_ONCE). Seeds are made new; corpora in FOLDER/corpus grow from
# run to run; what is found is kept in FOLDER/findings. One line per target; fails with any finding.
set -euo pipefail
folder=$1 seconds=${2:-600}
shift $(($# < 2 ? $# : 2))

# TARGET: what libFuzzer is told besides. Each input has ten seconds, but Draco's: the Draco library
# may spin for many seconds on input that is not Draco. That is not found here, and is not meant to
# be: a limit on the CPU time of a job's process bounds it.
options_of() {
  case $1 in
    drc | draco_glb) echo "-max_len=4096 -timeout=120" ;;
    glb | meshopt_glb) echo "-max_len=8192 -timeout=10" ;;
    gltf) echo "-max_len=12288 -timeout=10" ;;
    *) echo "-max_len=4096 -timeout=10" ;;
  esac
}

run_target() {
  local folder=$1 seconds=$2 target=$3
  local corpus=$folder/corpus/$target findings=$folder/findings/$target log=$folder/logs/$target.log
  mkdir -p "$corpus" "$findings" "$folder/logs"
  # A Draco stream that claims more than it holds may ask for much at once; the job's limit on
  # address space is what answers that. Here it must stay below rss_limit_mb.
  local status=0
  # shellcheck disable=SC2046
  ASAN_OPTIONS=allocator_may_return_null=1:detect_stack_use_after_return=0 \
  UBSAN_OPTIONS=print_stacktrace=1 FAIRWAY_FUZZ_TARGET=$target \
    nice -n 19 "$folder/fuzz/fuzz_target" $(options_of "$target") -max_total_time="$seconds" \
    -rss_limit_mb=2048 -print_final_stats=1 -artifact_prefix="$findings/" \
    "$corpus" "$folder/seeds/$target" >"$log" 2>&1 || status=$?
  local runs coverage found time
  runs=$(sed -n 's/^stat::number_of_executed_units: *//p' "$log")
  coverage=$(grep -o 'cov: [0-9]*' "$log" | tail -n 1 | cut -d ' ' -f 2 || true)
  time=$(sed -n 's/^Done [0-9]* runs in \([0-9]*\) second.*/\1/p' "$log")
  found=$(find "$findings" -type f -newer "$folder/started" | wc -l)
  [ "$status" -eq 0 ] || [ "$found" -gt 0 ] || found=1
  printf '%-14s %10s runs %6s s  coverage %6s  findings %d\n' \
    "$target" "${runs:-?}" "${time:--}" "${coverage:-?}" "$found"
  [ "$found" -eq 0 ] || { sed 's/^/    /' "$log" | grep -E 'ERROR|broken promise|SUMMARY|Test unit' |
    head -n 4; return 1; }
}

if [ "${1:-}" = --one ]; then
  run_target "$folder" "$seconds" "$2"
  exit
fi

mkdir -p "$folder"
touch "$folder/started"
"$folder/fuzz/fuzz_seeds" "$folder/seeds" >"$folder/seeds.log" || { cat "$folder/seeds.log"; exit 1; }
targets=("$@")
[ ${#targets[@]} -gt 0 ] || mapfile -t targets < <(ls "$folder/seeds")
printf '%s\n' "${targets[@]}" |
  xargs -P "${FAIRWAY_FUZZ_AT_ONCE:-2}" -I '{}' "$0" "$folder" "$seconds" --one '{}' ||
  { echo "findings are in $folder/findings, logs in $folder/logs"; exit 1; }
