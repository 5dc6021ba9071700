# complete.zsh FOLDER LINE: prints what zsh offers after LINE, a word a line, by the completion `_stickslip` in FOLDER.
# A second zsh runs on a pseudo-terminal, since completion is part of its line editor alone.
zmodload zsh/zpty
zpty shell zsh -f -i
send() { zpty -w shell "$1" }
send "PROMPT= RPROMPT= fpath=(${(q)1} \$fpath); autoload -Uz compinit; compinit -D -u; stty -echo 2>/dev/null"
send "bindkey '^I' complete-word; zstyle ':completion:*' insert-tab false"
# Each word is asked of the built-in as an array, in place of being shown.
send 'compadd() {
  if [[ ${@[1,(i)(-|--)]} == *-(O|A|D)\ * ]]; then builtin compadd "$@"; return; fi
  local -a offered; builtin compadd -A offered "$@"
  builtin compadd "$@"
  local word; for word in $offered; do print -r -- "offered:$word" >>$OFFERED; done
}'
send 'finish() { : >$OFFERED.end }; comppostfuncs=(finish)'
export OFFERED=$(mktemp)
send "OFFERED=$OFFERED; print ready >\$OFFERED.ready"
wait_for() { local n; for n in {1..200}; do [[ -e $1 ]] && return; sleep 0.05; done; print -u2 "zsh: no answer"; exit 1 }
wait_for $OFFERED.ready
zpty -w -n shell "$2"$'\t'
wait_for $OFFERED.end
sed 's/^offered://' $OFFERED
rm -f $OFFERED $OFFERED.ready $OFFERED.end
zpty -d shell
