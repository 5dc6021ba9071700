#!/usr/bin/env bash
# install_dependencies.sh [test|python|web]: installs what is missing of the Debian (12 or later) packages that the build
# needs, with `test` those of the tests, with `python` those of the Python module and its notebook, with `web` those of
# the page for learners alone. STICKSLIP_NO_APT=1 installs nothing.
set -euo pipefail

# libopenblas0-serial is named because SuiteSparse would else bring the reference BLAS, which is 3 to 6 times slower;
# libmumps-seq-5.5 with libmumps-headers-dev, because libmumps-seq-dev would bring an MPI development tree.
packages=(g++ cmake ninja-build libeigen3-dev libsuitesparse-dev libopenblas0-serial libmumps-seq-5.5
  libmumps-headers-dev nlohmann-json3-dev libcli11-dev libfmt-dev help2man)
case "${1:-}" in
  "") ;;
  test) packages+=(clang libgtest-dev libgmock-dev libbenchmark-dev librapidcheck-dev python3-jsonschema dpkg-dev
    file librsvg2-bin fonts-liberation poppler-utils chromium python3-numpy python3-scipy pybind11-dev python3-dev
    python3-nlopt) ;;
  python) packages+=(pybind11-dev python3-dev python3-pip python3-setuptools python3-wheel python3-venv python3-numpy
    python3-pandas python3-matplotlib python3-nlopt jupyter-nbconvert python3-ipykernel) ;;
  web) packages=(cmake ninja-build libeigen3-dev nlohmann-json3-dev libfmt-dev emscripten) ;;
  *) echo "usage: $0 [test|python|web]" >&2; exit 2 ;;
esac

if [ "${STICKSLIP_NO_APT:-0}" = 1 ]; then
  exit 0
fi
if ! command -v apt-get >/dev/null; then
  echo "no apt-get here: install the equivalents of: ${packages[*]}" >&2
  exit 0
fi

missing=()
for package in "${packages[@]}"; do
  [ "$(dpkg-query -W -f='${db:Status-Status}' "$package" 2>/dev/null)" = installed ] || missing+=("$package")
done
[ ${#missing[@]} -gt 0 ] || exit 0

as_root=()
if [ "$(id -u)" != 0 ]; then
  command -v sudo >/dev/null || { echo "not root and no sudo; as root: apt-get install ${missing[*]}" >&2; exit 1; }
  as_root=(sudo)
fi
echo "installing: ${missing[*]}"
"${as_root[@]}" apt-get update -qq
"${as_root[@]}" env DEBIAN_FRONTEND=noninteractive apt-get install -y -qq --no-install-recommends "${missing[@]}"
