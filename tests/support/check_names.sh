#!/usr/bin/env bash
# check_names.sh SOURCE_DIR: fails and names each case that is cited (A4, C12, ...) and not in the table of
# tests/README.md, and each in the table that no test cites.
# check_names.sh --self-test: fails where one would go unseen.
set -euo pipefail

# A case is a letter and a number in a comment, or the instance of a test suite; letters of other things that look so
# (elements T3 and T6, moduli E1, radii R2) are not among A, B, C.
check() {
  cd "$1"
  local cited explained
  cited=$(find tests core methods sensitivity studies -name '*.[hc]pp' -o -path core/README.md | sort | xargs perl -ne '
      my $text = /^\s*INSTANTIATE_TEST_SUITE_P\((\w+)/ ? $1 : $ARGV =~ /\.md$/ ? $_ : m{(//.*)} ? $1 : "";
      $text =~ s/"[^"]*"//g;
      print "$1\n" while $text =~ /(?<![\w.\[\/-])([ABC][1-9][0-9]?)(?![\w])/g' | sort -u)
  explained=$(sed -n 's/^| \([ABC][1-9][0-9]*\) |.*/\1/p' tests/README.md | sort -u)
  local unexplained unused
  unexplained=$(comm -23 <(echo "$cited") <(echo "$explained"))
  unused=$(comm -13 <(echo "$cited") <(echo "$explained"))
  [ -z "$unexplained" ] || echo "cited, and not in the table of tests/README.md:" $unexplained >&2
  [ -z "$unused" ] || echo "in the table of tests/README.md, and cited nowhere:" $unused >&2
  [ -z "$unexplained$unused" ]
}

self_test() {
  tree=$(mktemp -d)
  trap 'rm -rf "$tree"' EXIT
  mkdir -p "$tree"/{tests/methods,core,methods,sensitivity,studies}
  printf '| A4 | a bar | here |\n| C12 | a touch | here |\n' >"$tree/tests/README.md"
  printf '// C12: just touching; E1, T3 and "B7" are no cases\nconst double A9 = 1;\n' >"$tree/methods/good.hpp"
  printf 'INSTANTIATE_TEST_SUITE_P(A4, PullOut, testing::Values(10));\n' >"$tree/tests/methods/good.cpp"
  check "$tree" || { echo "a good tree is refused" >&2; return 1; }
  local line
  while read -r line; do
    echo "$line" >"$tree/tests/methods/wrong.cpp"
    if (check "$tree") 2>/dev/null; then
      echo "unseen: $line" >&2
      return 1
    fi
    rm "$tree/tests/methods/wrong.cpp"
  done <<'CASES'
TEST(HardCases, Lands) {  // (C33, by its load)
/// B2: the plate
INSTANTIATE_TEST_SUITE_P(A1, Stop, testing::Values(1));
CASES
  rm "$tree/methods/good.hpp"
  if (check "$tree") 2>/dev/null; then
    echo "unseen: a name that is cited nowhere" >&2
    return 1
  fi
}

case "${1:---self-test}" in
  --self-test) self_test ;;
  *) check "$1" ;;
esac
