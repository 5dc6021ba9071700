#!/usr/bin/env bash
# coverage.sh [CTEST ARGUMENTS]: builds with counters, runs the tests (without the slow ones, unless arguments are given),
# prints the lines and branches reached by folder and writes build/coverage/html/index.html. Needs Debian's gcovr.
# STICKSLIP_JOBS=n: n compilers and tests at once.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."
# shellcheck source=tools/environment.sh
. tools/environment.sh
command -v gcovr >/dev/null || { echo "gcovr is not here: apt-get install gcovr" >&2; exit 1; }

cmake --preset coverage
cmake --build --preset coverage -j "$jobs"
find build/coverage -name '*.gcda' -delete # of an earlier run
[ $# -gt 0 ] || set -- -LE slow
ctest --test-dir build/coverage -j "$jobs" --output-on-failure "$@"

mkdir -p build/coverage/html
# Branches that only an exception takes are left out: the compiler adds them to every call.
gcovr --root . --object-directory build/coverage --filter 'core/' --filter 'methods/' --filter 'sensitivity/' \
  --filter 'studies/' --exclude-throw-branches --exclude-unreachable-branches \
  -j "$jobs" --html-details build/coverage/html/index.html --json-summary build/coverage/summary.json
python3 - build/coverage/summary.json <<'PYTHON'
import collections, json, sys

kinds = ("line", "branch")
sums = collections.defaultdict(lambda: dict.fromkeys((f"{k}_{w}" for k in kinds for w in ("covered", "total")), 0))
for file in json.load(open(sys.argv[1]))["files"]:
    parts = file["filename"].split("/")
    folder = "/".join(parts[: 2 if len(parts) > 2 else 1])
    for name in (folder, "all"):
        for key in sums[name]:
            sums[name][key] += file[key]
print(f"{'folder':<22}{'lines':>8}{'reached':>9}{'branches':>10}{'reached':>9}")
for name in sorted(sums, key=lambda n: (n == "all", n)):
    s = sums[name]
    shares = [100 * s[f"{k}_covered"] / max(1, s[f"{k}_total"]) for k in kinds]
    print(f"{name:<22}{s['line_total']:>8}{shares[0]:>8.1f}%{s['branch_total']:>10}{shares[1]:>8.1f}%")
PYTHON
