# Shared by the daemon's process tests: a private daemon in a scratch folder, requests to it, and what to expect.
# The test sets nothing; it calls start_daemon with marchd's options, and ends with `finish`.
set -u
bin=${PROGRAM_FOLDER:?}
scratch=$(mktemp -d)
socket=$scratch/sock
daemon_pid=
as_daemon=() # what marchd is started with
rest=$'[^\n]*' # of a line, in a regular expression
patience_s=600 # a guard against what never happens, not a measure: machines are slow and busy
export XDG_CONFIG_HOME=$scratch/config # a daemon reads no settings of whoever runs the test

fail()
{
    echo "FAIL: $*" >&2
    [ -f "$scratch/daemon.log" ] && tail -n 40 "$scratch/daemon.log" >&2
    exit 1
}

clean_up()
{
    # shellcheck disable=SC2046 # a list of numbers
    kill -KILL $(jobs -p) 2>/dev/null
    wait 2>/dev/null
    mountpoint -q "$scratch/disk" 2>/dev/null && umount "$scratch/disk"
    rm -rf "$scratch"
}
trap clean_up EXIT

for program in marchd march march-worker stub-worker socket-client; do
    [ -x "$bin/$program" ] || fail "there is no $bin/$program: build all targets, not only the programs"
done

# run_for_others: what other users run and read lies in the scratch folder from here on. Who cloned into a home of mode 0700
# keeps them from the programs below it.
run_for_others()
{
    chmod 711 "$scratch"
    mkdir "$scratch/bin"
    cp "$bin"/{marchd,march,march-worker,stub-worker,socket-client} "$PROJECT_ROOT/tests/support/leaks.supp" "$scratch/bin"
    chmod -R a+rX "$scratch/bin"
    bin=$scratch/bin
    [ -z "${LSAN_OPTIONS-}" ] || export LSAN_OPTIONS=${LSAN_OPTIONS//$PROJECT_ROOT\/tests\/support/$bin}
    cd "$scratch" || fail "no scratch folder"
}

# stub MODE: makes the worker program that does it.
stub()
{
    local program=$scratch/worker-${1//:/-}

    printf '#!/bin/sh\nexec "%s/stub-worker" --mode %s "$@"\n' "$bin" "$1" >"$program"
    chmod +x "$program"
    echo "$program"
}

# start_daemon OPTION...: returns once it answers. It writes below $scratch/out unless told otherwise, and root's reads no
# settings of the machine.
start_daemon()
{
    [[ " $* " == *" --output-root "* ]] || set -- --output-root "$scratch/out" "$@"
    [[ " $* " == *" --input-root "* ]] || set -- --input-root / "$@"
    [[ " $* " == *" --config "* ]] || set -- --config /dev/null "$@"
    "${as_daemon[@]}" "$bin/marchd" --state "$scratch/state" --socket "$socket" --workers 2 "$@" \
        2>>"$scratch/daemon.log" &
    daemon_pid=$!
    wait_until "the daemon answers" answers_or_ended
    kill -0 "$daemon_pid" 2>/dev/null || fail "the daemon did not start"
}

answers_or_ended()
{
    [ -n "$(ask daemon.status 2>/dev/null)" ] || ! kill -0 "$daemon_pid" 2>/dev/null
}

# stop_daemon: SIGTERM, and the exit status must be 0 (which also says that no memory leaked).
stop_daemon()
{
    local status=0

    kill -TERM "$daemon_pid"
    wait "$daemon_pid" || status=$?
    daemon_pid=
    [ "$status" = 0 ] || fail "the daemon ended with status $status"
}

kill_daemon()
{
    kill -KILL "$daemon_pid" || fail "the daemon was gone already"
    wait "$daemon_pid" 2>/dev/null
    daemon_pid=
}

# ask METHOD [PARAMS]: prints the answer's line.
ask()
{
    printf '{"jsonrpc":"2.0","id":1,"method":"%s","params":%s}\n' "$1" "${2:-{\}}" | "$bin/socket-client" "$socket"
}

# as UID GIDS COMMAND...: the command as another user, whose groups (comma-separated) are these, the first the primary one.
as()
{
    local uid=$1 gids=$2

    shift 2
    setpriv --reuid="$uid" --regid="${gids%%,*}" --groups="$gids" "$@"
}

# ask_as UID GIDS METHOD [PARAMS]: as ask, by another user.
ask_as()
{
    printf '{"jsonrpc":"2.0","id":1,"method":"%s","params":%s}\n' "$3" "${4:-{\}}" | as "$1" "$2" "$bin/socket-client" "$socket"
}

# ask_raw: standard input is sent as it is.
ask_raw()
{
    "$bin/socket-client" "$socket"
}

# listen FILE [PARAMS]: events into the file, from now on.
listen()
{
    "$bin/socket-client" --keep "$socket" >"$1" \
        <<<"{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"events.subscribe\",\"params\":${2:-{\}}}" &
    wait_until "the subscription is answered" test -s "$1"
}

# job RANGE [JQ-FILTER]: prints a small job document, with a stated method. Without a filter, one of a range is made once.
job()
{
    local made=/dev/null

    [ $# -gt 1 ] || [[ $1 == *[!0-9-]* ]] || made=$scratch/job-$1
    [ ! -s "$made" ] || { cat "$made"; return; }
    jq -c --arg range "$1" --slurpfile stated "$PROJECT_ROOT/tests/support/stated_quality.json" \
        '.frames = $range | .resolution = [32, 18] | .quality = $stated[0].cloud | '"${2:-.}" "$PROJECT_ROOT/jobs/cloud.json" |
        tee "$made"
}

# submit DOCUMENT [PAUSED]: prints the new job's id.
submit()
{
    local answer

    answer=$(ask job.submit "{\"document\":$1,\"paused\":${2:-false}}")
    [[ $answer =~ ^\{\"jsonrpc\":\"2\.0\",\"id\":1,\"result\":\{\"id\":([0-9]+)$rest\}\}$ ]] || fail "submit: $answer"
    echo "${BASH_REMATCH[1]}"
}

# field ID JQ-FILTER: of the job. What waits asks often, and jq starts slowly: a plain member is found without it.
field()
{
    local answer value

    answer=$(ask job.show "{\"id\":$1}")
    if [[ $2 =~ ^\.[a-z_]+$ && ${answer#*'"result":'} =~ \"${2#.}\":(\"([^\"\\]*)\"|[a-z0-9]+)[,\}] ]]; then
        value=${BASH_REMATCH[1]}
        value=${value#\"}
        echo "${value%\"}"
    else
        jq -r ".result | $2" <<<"$answer"
    fi
}

# wait_until WHAT COMMAND...: until the command succeeds. What takes long is looked at less often: a look starts programs.
wait_until()
{
    local what=$1 ends=$((SECONDS + patience_s)) pause_cs=5 pause

    shift
    until "$@"; do
        [ $SECONDS -lt $ends ] || fail "not within $patience_s s: $what"
        printf -v pause '0.%02d' $pause_cs
        sleep "$pause"
        [ $pause_cs -ge 40 ] || pause_cs=$((pause_cs + 1 + pause_cs / 10))
    done
}

# has_state ID STATE: fails the test where the job is over and that is not its state.
has_state()
{
    local state

    state=$(field "$1" .state)
    [ "$state" = "$2" ] && return
    case $state in succeeded | failed | canceled) fail "job $1: expected $2, got $(field "$1" '{state, reason}')" ;; esac
    return 1
}

# wait_state ID STATE
wait_state()
{
    wait_until "job $1 is $2" has_state "$1" "$2"
}

# expect WHAT ACTUAL WANTED
expect()
{
    [ "$2" = "$3" ] || fail "$1: expected \"$3\", got \"$2\""
}

# expect_error ANSWER CODE TEXT: the answer is an error with that code, whose message holds the text.
expect_error()
{
    local code message

    if [[ $1 =~ ^\{\"jsonrpc\":\"2\.0\",\"id\":[^,{]*,\"error\":\{\"code\":(-?[0-9]+),\"message\":\"([^\"\\]*)\"$rest\}\}$ ]]; then
        code=${BASH_REMATCH[1]} message=${BASH_REMATCH[2]}
    else
        code=$(jq '.error.code' <<<"$1") message=$(jq -r '.error.message' <<<"$1")
    fi
    expect "error code of $1" "$code" "$2"
    [[ $message == *"$3"* ]] || fail "expected an error with \"$3\", got $1"
}

# expect_files FOLDER COUNT: so many EXR files and nothing else.
expect_files()
{
    expect "files in $1" "$(find "$scratch/out/$1" -name '*.exr' | wc -l)" "$2"
    expect "leftovers in $1" "$(find "$scratch/out/$1" -type f ! -name '*.exr')" ""
}
