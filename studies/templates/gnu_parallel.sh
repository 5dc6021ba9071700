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
if [[ ! $shards =~ ^[1-9][0-9]{0,4}$ ]]; then
  echo "$0: SHARDS is '$shards'; must be a whole number from 1 to 99999" >&2
  exit 2
fi
program=$(realpath "$(command -v "${STICKSLIP:-stickslip}")")
read -ra flags <<< "${PARALLEL_FLAGS:-}"
export OPENBLAS_NUM_THREADS=1 OMP_NUM_THREADS=1

parts=()
for ((i = 1; i <= shards; ++i)); do parts+=("$output/shards/$i"); done
# Paths go by the environment: parallel would replace {} and its like in a command.
export SHARE_PROGRAM=$program SHARE_STUDY=$study SHARE_OUTPUT=$output SHARE_COUNT=$shards
names=()
for name in OPENBLAS_NUM_THREADS OMP_NUM_THREADS SHARE_PROGRAM SHARE_STUDY SHARE_OUTPUT SHARE_COUNT; do
  names+=(--env "$name")
done
# A share that fails does not stop the others; the merge then says what is missing, and its exit code is 3.
parallel "${flags[@]}" "${names[@]}" \
  '"$SHARE_PROGRAM" study "$SHARE_STUDY" --shard {}/"$SHARE_COUNT" --resume -o "$SHARE_OUTPUT"/shards/{}' \
  ::: $(seq "$shards") || true
exec "$program" merge "${parts[@]}" -o "$output"
