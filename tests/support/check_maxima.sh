#!/usr/bin/env bash
# check_maxima.sh SOURCE_DIR: fails and names each maximum or minimum of doubles in tests/ that NaN passes.
# check_maxima.sh --self-test: fails where one would go unseen.
#
# std::max(error, NaN) is `error`, `if (NaN > error)` is false, and Eigen's maxCoeff() keeps NaN or drops it as the
# order of comparisons has it: a test that folds its errors so passes on a solution that is no number. larger() of
# core/algebra/scalar.hpp, smaller() and largest_entry() of tests/support/largest.hpp keep NaN. Folds of integers say
# so: std::max<int>(most, own).
set -euo pipefail

check() {
  cd "$1"
  local found
  found=$(find tests -name '*.[hc]pp' -print0 | sort -z | xargs -0 perl -0777 -ne '
    our $text = $_; $text =~ s{//[^\n]*}{}g;
    sub report { my ($at, $what) = @_; my $line = 1 + (substr($text, 0, $at) =~ tr/\n//);
                 $what =~ s/\s+/ /g; print "$ARGV:$line: $what\n"; }
    my $name = qr/[\w.\[\]]+(?:->\w+)*/;
    # worst = std::max(worst, ...), worst = std::max({worst, ...}), worst = fmax(..., worst)
    report($-[0], $&) while $text =~ /(?<![\w.>])($name)\s*=\s*(?:std::)?f?(?:max|min)\(\s*\{?\s*\1\s*,[^;]*;/g;
    report($-[0], $&) while $text =~ /(?<![\w.>])($name)\s*=\s*(?:std::)?f?(?:max|min)\([^;]*,\s*\1\s*\}?\s*\);/g;
    # if (error > worst) worst = error;
    report($-[0], $&) while $text =~ /if\s*\([^;{]*[<>]=?\s*($name)\)\s*\{?\s*\1\s*=[^=][^;]*;/g;
    report($-[0], $&) while $text =~ /\b(?:max|min)Coeff\([^)]*\)/g;
    report($-[0], $&) while $text =~ /\blpNorm<Eigen::Infinity>/g;')
  if [ -n "$found" ]; then
    printf 'NaN passes (see %s):\n%s\n' "tests/support/check_maxima.sh" "$found" >&2
    return 1
  fi
}

self_test() {
  local line
  tree=$(mktemp -d)
  trap 'rm -rf "$tree"' EXIT
  mkdir -p "$tree/tests/core"
  cat >"$tree/tests/core/good.cpp" <<'GOOD'
worst = larger(worst, error);
most = std::max<int>(most, own);
const double allowed = std::max(1e-11, 50 * unit_roundoff * condition);
step = std::min(1.15 * step, 0.15);
EXPECT_GE(share.minCoeff<Eigen::PropagateNaN>(), 0);
if (error > allowed) failed = true;
GOOD
  (check "$tree") || { echo "a good file is refused" >&2; return 1; }
  while read -r line; do
    printf '%b\n' "$line" >"$tree/tests/core/wrong.cpp"
    if (check "$tree") 2>/dev/null; then
      echo "unseen: $line" >&2
      return 1
    fi
    rm "$tree/tests/core/wrong.cpp"
  done <<'CASES'
worst = std::max(worst, error);
out.error = std::max(out.error, error / scale);
largest[i] =\n    std::max(largest[i], x);
scale = std::max({scale, std::abs(a), std::abs(b)});
worst = std::max(error, worst);
worst = fmax(worst, error);
least = std::min(least, margin);
if (error > worst) worst = error;
if (std::abs(a - b) > worst) {\n  worst = std::abs(a - b);\n}
EXPECT_LE(K.cwiseAbs().maxCoeff(), 1e-12);
EXPECT_LE((a - b).lpNorm<Eigen::Infinity>(), 1e-12);
CASES
}

case "${1:---self-test}" in
  --self-test) self_test ;;
  *) check "$1" ;;
esac
