#!/usr/bin/env bash
# Fails where clang-format 14 (Debian 12's; others break lines elsewhere) would change a source, and where a line has
# more than 120 characters, which it does not see in comments. Texts of a source ("...") may be longer. `--fix` changes
# the format; comments are broken by hand.
set -euo pipefail
cd "$(dirname "${BASH_SOURCE[0]}")/.."

failed=0
sources() { find core methods sensitivity studies tests bench -name '*.[hc]pp' -print0; }
sources | xargs -0 perl -CSD -ne '
  chomp;
  print(STDERR "$ARGV:$.: ", length, " characters, at most 120\n"), $failed = 1
    if length > 120 && (!/"/ || m{^\s*//|//[^"]*$});
  close ARGV if eof; END { exit $failed // 0 }' || failed=1

for clang_format in clang-format-14 clang-format ""; do
  [ -n "$clang_format" ] || { echo "clang-format 14 is not here: the format is not checked"; exit "$failed"; }
  if command -v "$clang_format" >/dev/null && "$clang_format" --version | grep -q 'version 14\.'; then
    break
  fi
done
mode=(--dry-run -Werror)
[ "${1:-}" != --fix ] || mode=(-i)
sources | xargs -0 -r "$clang_format" --style=file "${mode[@]}" || failed=1
exit "$failed"
