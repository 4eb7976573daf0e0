# Completion of the command rabiline: source tools/completion.bash
_rabiline() {
  local word=${COMP_WORDS[COMP_CWORD]} verbs options
  if ((COMP_CWORD == 1)); then
    verbs=$(rabiline --help 2>/dev/null | awk '/^  [a-z]/ {print $1}')
    mapfile -t COMPREPLY < <(compgen -W "$verbs" -- "$word")
  elif [[ $word == -* ]]; then
    options=$(rabiline "${COMP_WORDS[1]}" --help 2>/dev/null | grep -oE -- '--[a-z-]+' | sort -u)
    mapfile -t COMPREPLY < <(compgen -W "$options" -- "$word")
  elif [[ ${COMP_WORDS[1]} == new ]]; then
    mapfile -t COMPREPLY < <(compgen -W "$(rabiline new --help 2>/dev/null | awk '/^  [a-z-]+  / {print $1}')" -- "$word")
  else
    mapfile -t COMPREPLY < <(compgen -f -- "$word")
    compopt -o filenames
  fi
}
complete -F _rabiline rabiline
