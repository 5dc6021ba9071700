# shellcheck shell=bash
# Sourced by demo.sh and test.sh: the BLAS to run with, and how many compilers to start.

# OpenBLAS without threads, whatever the system's alternative is: repeatable, and no hidden cores in a timing.
for folder in /usr/lib/*/openblas-serial; do
  if [ -e "$folder/libblas.so.3" ]; then
    export LD_LIBRARY_PATH="$folder${LD_LIBRARY_PATH:+:$LD_LIBRARY_PATH}"
  fi
done
export OPENBLAS_NUM_THREADS=1

# Sixteen sources with Eigen in them take up to 2 GB to compile.
memory_kib=$(awk '/^MemAvailable:/ {print $2}' /proc/meminfo 2>/dev/null || echo 0)
jobs=$((${memory_kib:-0} / 2097152))
cores=$(nproc)
[ "$jobs" -le "$cores" ] || jobs=$cores
[ "$jobs" -ge 1 ] || jobs=1
jobs=${STICKSLIP_JOBS:-$jobs}
