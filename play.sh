#!/usr/bin/env bash
# Installs what is missing, builds the page for learners, and says where it is. Safe to run again. STICKSLIP_NO_APT=1
# installs nothing; STICKSLIP_JOBS=n starts n compilers.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

bash tools/install_dependencies.sh web
# shellcheck source=tools/environment.sh
. tools/environment.sh

echo "play.sh: builds the page; from nothing this takes about 7 minutes on two cores"
cmake --preset wasm
cmake --build --preset wasm -j "$jobs"
echo "The page: $PWD/build/wasm/stickslip.html"
