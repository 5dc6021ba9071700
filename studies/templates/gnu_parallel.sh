#!/bin/bash
# A study by GNU parallel, on one machine or several.
#
#   studies/templates/gnu_parallel.sh STUDY.json OUTPUT [SHARDS]
#
# STICKSLIP names the program (stickslip on the PATH if it is not set); PARALLEL_FLAGS is passed on to parallel
# ("--jobs 16", "--sshloginfile nodes": the directory must then be one that all machines see). Run again after a
# failure, it runs only what is missing. On one machine `stickslip study --jobs N` does the same without shards.
set -euo pipefail

if (($# < 2 || $# > 3)); then
  echo "usage: $0 STUDY.json OUTPUT [SHARDS]" >&2
  exit 2
fi
study=$(realpath "$1")
output=$(realpath -m "$2")
shards=${3:-8}
program=$(realpath "$(command -v "${STICKSLIP:-stickslip}")")
read -ra flags <<< "${PARALLEL_FLAGS:-}"
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1

parts=()
for ((i = 1; i <= shards; ++i)); do parts+=("$output/shards/$i"); done
# A share that fails does not stop the others; the merge then says what is missing, and its exit code is 3.
parallel "${flags[@]}" --env OPENBLAS_NUM_THREADS --env OMP_NUM_THREADS --quote \
  "$program" study "$study" --shard "{}/$shards" --resume -o "$output/shards/{}" ::: $(seq "$shards") || true
exec "$program" merge "${parts[@]}" -o "$output"
