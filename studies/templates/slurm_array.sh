#!/bin/bash
# A study as an array job of Slurm: every task runs its share of the cells, a last job joins the shares.
#
#   studies/templates/slurm_array.sh STUDY.json OUTPUT [SHARDS]      submits both, prints where the whole will be
#
# STICKSLIP names the program (stickslip on the PATH if it is not set); SBATCH_FLAGS is passed on to sbatch
# ("--partition=short --time=1:00:00"). The directory must be one that all nodes see. Run again after a failure, it
# submits all tasks again, and each runs only what is missing in its share.
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
read -ra flags <<< "${SBATCH_FLAGS:-}"
mkdir -p "$output/shards"
parts=()
for ((i = 1; i <= shards; ++i)); do parts+=("$output/shards/$i"); done
quoted() {  # words as bash reads them again
  local words
  printf -v words '%q ' "$@"
  printf '%s' "${words% }"
}

# One thread a task: the cells are what runs in parallel.
array=$(sbatch --parsable "${flags[@]}" --job-name=stickslip --array="1-$shards" --ntasks=1 --cpus-per-task=1 \
  --output="$output/shards/%a.log" --export=ALL,OPENBLAS_NUM_THREADS=1,OMP_NUM_THREADS=1 <<EOF
#!/bin/bash
exec $(quoted "$program" study "$study") --shard "\$SLURM_ARRAY_TASK_ID/$shards" --resume -o $(quoted "$output/shards/")"\$SLURM_ARRAY_TASK_ID"
EOF
)
# afterany: where a task has failed, the merge says which cells are missing, and its exit code is 3.
joined=$(sbatch --parsable "${flags[@]}" --job-name=stickslip-merge --dependency="afterany:${array%%;*}" --ntasks=1 \
  --output="$output/merge.log" <<EOF
#!/bin/bash
exec $(quoted "$program" merge "${parts[@]}" -o "$output")
EOF
)
echo "tasks: job ${array%%;*}, merge: job ${joined%%;*}; the whole will be in $output"
