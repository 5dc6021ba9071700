# Completion of stickslip in bash: commands, options, methods, scene and study files, directories.

_stickslip() {
  local word=${COMP_WORDS[COMP_CWORD]} before=${COMP_WORDS[COMP_CWORD-1]} command=${COMP_WORDS[1]:-}
  COMPREPLY=()
  if [ "$COMP_CWORD" -eq 1 ]; then
    mapfile -t COMPREPLY < <(compgen -W "run study merge compare explain gradcheck report methods schema
      --help --version" -- "$word")
    return
  fi
  local options=--help
  case $command in
    run) options+=" --method --set --json --output --report --trace --export" ;;
    explain | gradcheck) options+=" --method --set --json" ;;
    study) options+=" --output --resume --restart --shard --jobs" ;;
    merge) options+=" --output" ;;
    compare) options+=" --relative --rounding --json" ;;
    methods) options+=" --json" ;;
  esac
  case $before in
    -m | --method)
      mapfile -t COMPREPLY < <(compgen -W "penalty uzawa_al monolithic_al" -- "$word")
      return ;;
    -o | --output | --export)
      mapfile -t COMPREPLY < <(compgen -d -- "$word")
      return ;;
    --set | --shard | -j | --jobs | --relative | --rounding) return ;;
  esac
  if [[ $word == -* ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
    return
  fi
  case $command in
    run | explain | gradcheck | study)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -d -- "$word"; compgen -f -X '!*.json' -- "$word") ;;
    merge | compare | report)
      compopt -o filenames 2>/dev/null
      mapfile -t COMPREPLY < <(compgen -d -- "$word") ;;
    schema) mapfile -t COMPREPLY < <(compgen -W "scene study" -- "$word") ;;
  esac
}
complete -F _stickslip stickslip
