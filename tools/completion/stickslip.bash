# Completion of stickslip in bash: made by tools/completions.py from what --help prints.

_stickslip() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} command=${COMP_WORDS[1]:-} options=
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W "run study merge compare explain gradcheck verify report methods schema --help --version" -- "$word")
    return
  fi
  case $command in
    run) options="--help --method --set --json --output --report --trace --export" ;;
    study) options="--help --output --resume --restart --shard --jobs" ;;
    merge) options="--help --output" ;;
    compare) options="--help --relative --rounding --json" ;;
    explain) options="--help --method --set --json" ;;
    gradcheck) options="--help --method --set --json" ;;
    verify) options="--help --solution --json" ;;
    report) options="--help" ;;
    methods) options="--help --json" ;;
    schema) options="--help" ;;
  esac
  case $before in
    -m | --method)
      mapfile -t COMPREPLY < <(compgen -W "monolithic_al penalty uzawa_al" -- "$word")
      return ;;
    --set | --shard | -j | --jobs | --relative | --rounding)
      return ;;
    -o | --output | --export)
      mapfile -t COMPREPLY < <(compgen -d -- "$word")
      return ;;
    --solution)
      mapfile -t COMPREPLY < <(compgen -d -- "$word"; compgen -f -X '!*.json' -- "$word")
      return ;;
  esac
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
    return
  fi
  case $command in
    run | study | explain | gradcheck)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -d -- "$word"; compgen -f -X '!*.json' -- "$word") ;;
    merge | compare | verify | report)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -d -- "$word") ;;
    schema)
      mapfile -t COMPREPLY < <(compgen -W "scene study" -- "$word") ;;
  esac
}
complete -F _stickslip stickslip
