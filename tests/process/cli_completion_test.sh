#!/bin/bash
# Completion of `march` and `marchd` in bash, zsh and fish themselves, with a daemon and without.
. "$PROJECT_ROOT/tests/process/farm.sh"
PATH=$bin:$PATH
cd "$scratch" || exit 1
export HOME=$scratch XDG_RUNTIME_DIR=$scratch
export MARCHD_SOCKET=$socket
mkdir jobs.d
touch a.json b.txt

# typed_bash WORD...: bash's completions of the last word.
typed_bash()
{
    # shellcheck disable=SC2016 # expanded by the other shell
    bash -c 'eval "$(march completion bash)"; COMP_WORDS=("$@"); COMP_CWORD=$(($# - 1)); _"$1" 2>/dev/null; echo "${COMPREPLY[*]}"' - "$@"
}

bash -n <(march completion bash) || fail "bash reads it"
expect "verbs" "$(typed_bash march pa)" pause
expect "options" "$(typed_bash march frames 7 --r)" --range
expect "job files and folders" "$(typed_bash march submit '')" "jobs.d a.json"
expect "values behind =" "$(typed_bash march list --state = queued,ru)" queued,running
expect "the daemon's options" "$(typed_bash marchd --stop)" --stop-timeout
expect "no ids without a daemon" "$(typed_bash march show '')" ""
bash -c 'eval "$(march completion bash)"; complete -p march marchd' >registered || fail "bash registers both"

start_daemon --worker-program "$(stub write:50)" --workers 1
live=$(submit "$(job 0-3)" true)
over=$(submit "$(job 0-3 '.output.path = "over/over.####.exr"')" true)
ask job.cancel "{\"id\":$over}" >/dev/null
wait_state "$over" canceled
expect "ids of jobs, the newest first" "$(typed_bash march show '')" "$over $live"
expect "ids of jobs that are not over" "$(typed_bash march pause '')" "$live"

if command -v zsh >/dev/null; then
    march completion zsh >_march
    zsh -n _march || fail "zsh reads it"
    # Stands in for what zsh gives to a completion function, and prints what it gets back.
    # shellcheck disable=SC2016
    typed_zsh()
    {
        zsh -fc 'compdef() { :; }; _describe() { print -r -- ${(P)2}; }; _files() { print files "$@"; }; compset() { :; }
                 compadd() { shift; print -r -- "$@"; }; source ./_march; service=$1; words=("$@"); CURRENT=$#; PREFIX=$words[-1]; _march' - "$@"
    }
    [[ $(typed_zsh march pa) == "pause:Starts no more"* ]] || fail "zsh offers verbs: $(typed_zsh march pa)"
    expect "zsh: ids" "$(typed_zsh march wait '')" "$live:cloud, paused"
    expect "zsh: job files" "$(typed_zsh march submit '')" "files -g *.json"
    expect "zsh: the daemon's options" "$(typed_zsh marchd --h | tr ' ' '\n' | grep stop)" --stop-timeout
else
    echo "no zsh here: not tried"
fi

if command -v fish >/dev/null; then
    march completion fish >march.fish
    fish --no-execute march.fish || fail "fish reads it"
    typed_fish() { fish -c 'source march.fish; complete -C "$argv[1]"' "$1"; }
    expect "fish: verbs" "$(typed_fish 'march pa' | cut -f 1)" pause
    expect "fish: ids" "$(typed_fish 'march wait ')" "$live	cloud, paused"
    expect "fish: job files" "$(typed_fish 'march submit a' | cut -f 1)" a.json
    expect "fish: values" "$(typed_fish 'march list --state pa' | cut -f 1)" paused
    expect "fish: the daemon's options" "$(typed_fish 'marchd --stop' | cut -f 1)" --stop-timeout
else
    echo "no fish here: not tried"
fi

# A daemon that hangs blocks completion for a second at most.
kill -STOP "$daemon_pid"
typed_bash march show '' >/dev/null # it would not end
kill -CONT "$daemon_pid"
stop_daemon
