#!/usr/bin/env bash
# Fails where clang-format 14 (Debian 12's; others break lines elsewhere) would change a source. `--fix` changes it.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

for clang_format in clang-format-14 clang-format ""; do
  [ -n "$clang_format" ] || { echo "clang-format 14 is not here: the format is not checked"; exit 0; }
  if command -v "$clang_format" >/dev/null && "$clang_format" --version | grep -q 'version 14\.'; then
    break
  fi
done
mode=(--dry-run -Werror)
[ "${1:-}" != --fix ] || mode=(-i)
find core methods sensitivity studies tests bench -name '*.[hc]pp' -print0 |
  xargs -0 -r "$clang_format" --style=file "${mode[@]}"
