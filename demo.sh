#!/usr/bin/env bash
# Installs what is missing, builds, runs the headline study and says where its report is. Safe to run again: it builds
# and computes only what is missing. STICKSLIP_NO_APT=1 installs nothing; STICKSLIP_JOBS=n starts n compilers.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

bash tools/install_dependencies.sh
# shellcheck source=tools/environment.sh
. tools/environment.sh

echo "demo.sh: builds the program; from nothing this takes 8 to 13 minutes on two cores"
cmake --preset release -DSTICKSLIP_BUILD_TESTS=OFF -DSTICKSLIP_BUILD_BENCH=OFF
cmake --build --preset release -j "$jobs"  # (all that `cmake --install` installs)

echo "demo.sh: runs the study; its stiffest penalty, 1e10, is meant to fail"
build/release/stickslip study studies/scenes/cattaneo_mindlin.study.json -o "$PWD/results/cattaneo_mindlin.study" \
  --resume
