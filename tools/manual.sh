#!/usr/bin/env bash
# manual.sh STICKSLIP: prints the manual page, which help2man makes of docs/manual.txt and of what `--help` prints.
# help2man asks this script for the help of the program and of its commands in turn.
set -euo pipefail
here=$(dirname "${BASH_SOURCE[0]}")

help_of() { "$STICKSLIP" "$@" --help | sed -E "s|$STICKSLIP|stickslip|; s/^(  -.),--/\1, --/"; }

case ${1:-} in
  --version) "$STICKSLIP" --version | sed -n '1s/ (.*//p' ;;
  --help)
    help_of | sed 's/^Subcommands:$/\n*Commands*/'
    for command in $(help_of | sed -n '/^Subcommands:/,$s/^  \([a-z]*\) .*/\1/p'); do
      printf '\n*stickslip %s*\n' "$command"
      help_of "$command" | sed -E '/^(Positionals|Options):$|^  -h, --help/d; s/^Usage: /\n/'
    done ;;
  "") echo "usage: $0 STICKSLIP" >&2; exit 2 ;;
  *) STICKSLIP=$1 help2man --no-info --include="$here/../docs/manual.txt" "${BASH_SOURCE[0]}" | sed 's/^\.TH MANUAL.SH /.TH STICKSLIP /' ;;
esac
