#!/usr/bin/env bash
# Installs what is missing, builds with warnings as errors and runs the tests; arguments go to ctest in place of
# "-LE slow", which leaves the slow ones out. STICKSLIP_NO_APT=1 installs nothing; STICKSLIP_JOBS=n: n compilers;
# CXX=g++: another compiler than clang++, which is the faster one.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")"

bash tools/install_dependencies.sh test
bash tools/check_format.sh
# shellcheck source=tools/environment.sh
. tools/environment.sh

echo "test.sh: builds everything; from nothing this takes about twice as long as demo.sh, 18 to 26 minutes on two cores"
cmake --preset ci -DCMAKE_CXX_COMPILER="${CXX:-clang++}"
cmake --build --preset ci -j "$jobs"

[ $# -gt 0 ] || set -- -LE slow
ctest --test-dir build/ci -j 2 --output-on-failure "$@"
