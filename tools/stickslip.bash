# Completion of stickslip in bash, from what the program's own help says at the time: options and commands, choices in
# braces, and of values a file where the description ends in "(JSON)", a directory where it begins with that word.

_stickslip() {
  local program=$1 word=$2 before=$3 command=${COMP_WORDS[1]:-} help words kind=
  compopt -o filenames 2>/dev/null
  COMPREPLY=()
  [ "$COMP_CWORD" -gt 1 ] || command=
  help=$("$program" $command --help 2>/dev/null) || return
  words=$(sed -nE 's/^  (-.,)?(--[a-z-]+).*/\2/p' <<<"$help")
  if [ -z "$command" ]; then
    words+=$'\n'$(sed -n '/^Subcommands:/,$s/^  \([a-z]*\) .*/\1/p' <<<"$help")
  elif [[ $before == -* ]]; then
    kind=$(sed -nE "s/^  (-.,)?$before(,--[a-z-]+)? ([A-Z=]+ .*)/\3/p" <<<"$help")
  fi
  if [ -z "$kind" ] && [ -n "$command" ] && [[ $word != -* ]]; then
    kind=$(sed -n '/^Positionals:/,/^$/p' <<<"$help")
  fi
  case $before/$kind in
    -m/?* | --method/?*) words=$("$program" methods | sed -n '/^[a-z_]*$/p') ;;
    */*"(JSON)"*) mapfile -t COMPREPLY < <(compgen -d -- "$word"; compgen -f -X '!*.json' -- "$word"); return ;;
    */*{*}*) words=$(sed -n 's/,/ /g; s/.*{\(.*\)}.*/\1/p' <<<"$kind") ;;
    */*" director"*) mapfile -t COMPREPLY < <(compgen -d -- "$word"); return ;;
    */?*) return ;;
  esac
  mapfile -t COMPREPLY < <(compgen -W "$words" -- "$word")
}
complete -F _stickslip stickslip
