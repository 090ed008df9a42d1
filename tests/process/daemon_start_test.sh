#!/bin/bash
# Faults at the start of the daemon or its workers, and their messages.
. "$(dirname "$0")/farm.sh"

# refuse TEXT OPTION...: marchd ends at once, with an error that holds the text.
refuse()
{
    local text=$1 said status=0

    shift
    said=$(timeout "$patience_s" "$bin/marchd" "$@" 2>&1) || status=$?
    [ "$status" != 0 ] && [ "$status" != 124 ] || fail "marchd $*: status $status"
    [[ $said == *"$text"* ]] || fail "marchd $*: expected \"$text\", got \"$said\""
}

refuse "--workers: expected" --workers many
refuse "there is no such option" --nothing
"$bin/marchd" --version | grep -q '^marchd ' || fail "--version"
"$bin/marchd" --help | grep -q -- --output-root || fail "--help"

start_daemon --worker-program "$(stub skip)"
refuse "another marchd" --state "$scratch/state" --socket "$scratch/other" --output-root "$scratch/out"
refuse "another daemon answers" --state "$scratch/state2" --socket "$socket" --output-root "$scratch/out"
expect "the first daemon's pid" "$(ask daemon.status | jq .result.pid)" "$daemon_pid"

# A killed daemon leaves its socket; the next one replaces it.
kill_daemon
[ -S "$socket" ] || fail "the socket of a killed daemon should be there"
# A worker that the killed daemon was starting has its lock until it is a program of its own.
flock "$scratch/state/lock" sh -c 'touch "$1/held" && while [ -e "$1/held" ] && [ ! -e "$1/released" ]; do sleep 0.1; done' sh "$scratch" &
wait_until "the lock is taken" [ -e "$scratch/held" ]
# SIGHUP does not end a start that waits.
hang_up()
{
    local line words

    for line in /proc/[0-9]*/cmdline; do # no program is started for any: a start waits for seconds only
        { mapfile -d '' -t words <"$line"; } 2>/dev/null
        [[ "${words[*]}" == *"marchd --state $scratch/state"* ]] || continue
        kill -HUP "$(basename "${line%/cmdline}")"
        touch "$scratch/hung"
    done
}
{ sleep 1; hang_up; sleep 0.1; touch "$scratch/released"; } &
start_daemon --worker-program "$(stub nocontext)"
[ -e "$scratch/hung" ] || fail "no start was there to be hung up"
id=$(submit "$(job 1-3)")
wait_until "the reason is known" eval '[[ $(field "$id" .reason) == "no worker is ready: there is no GL context"* ]]'
# A worker that is started again has no reason before it has failed again, too.
reasons() { ask worker.list | jq -c '[.result.workers[] | .reason] | unique'; }
wait_until "both workers have said why" eval '[ "$(reasons)" = '"'[\"there is no GL context to be had here\"]'"' ]'
expect "attempts spent" "$(ask job.frames "{\"id\":$id}" | jq '[.result.frames[].attempts] | add')" 0
stop_daemon
[ ! -e "$socket" ] || fail "an orderly stop leaves the socket"
tail -n 1 "$scratch/daemon.log" | grep -q "stopping: no frame is running$" || fail "what the stop waits for"

start_daemon --worker-program "$scratch/no-such-program"
wait_until "the reason is known" eval '[[ $(field "$id" .reason) == *"no such file"* ]]'
stop_daemon

# A socket of systemd, which the daemon does not remove.
systemd-socket-activate -l "$scratch/activated" "$bin/marchd" --state "$scratch/state" --socket "$socket" \
    --output-root "$scratch/out" --worker-program "$(stub nocontext)" 2>>"$scratch/daemon.log" &
daemon_pid=$!
own_socket=$socket
socket=$scratch/activated
wait_until "the activated daemon answers" eval '[ -n "$(ask daemon.status 2>/dev/null)" ]'
[ ! -e "$own_socket" ] || fail "it made a socket of its own"
stop_daemon
[ -S "$socket" ] || fail "it removed a socket that is not its own"
socket=$own_socket

# Workers that break the protocol are killed, and their attempts end.
start_daemon --worker-program "$(stub garbage)"
wait_state "$id" failed
[[ $(ask job.log "{\"id\":$id}" | jq -r '.result.attempts[0].log') == *"it sent an invalid message"* ]] || fail "log: $(ask job.log "{\"id\":$id}")"
stop_daemon

# Workers that report a wrong file, or frames that are not theirs: such a file is not published.
start_daemon --worker-program "$(stub lie:0)"
id=$(submit "$(job 1-3 '.output.path = "lies/l.####.exr"')")
wait_state "$id" failed
[[ $(ask job.log "{\"id\":$id}" | jq -r '[.result.attempts[].log] | join(" ")') == *"expected inode"*"got inode"* ]] || fail "log: $(ask job.log "{\"id\":$id}")"
wait_until "leftovers are gone" eval '[ -z "$(find "$scratch/out/lies" -type f)" ]'
expect_files lies 0
stop_daemon

# The faults that a worker can report.
for fault in job frame; do
    start_daemon --worker-program "$(stub fail:$fault)"
    id=$(submit "$(job 1-4 ".output.path = \"$fault/f.####.exr\"")")
    wait_state "$id" failed
    attempts=$(ask job.log "{\"id\":$id}" | jq '.result.attempts | length')
    if [ $fault = job ]; then
        [ "$attempts" -le 2 ] || fail "$attempts attempts at a job that cannot work, by two workers"
    else
        expect "attempts at four frames" "$attempts" 12
    fi
    stop_daemon
done

# A job whose workers do not start is paused while workers for other jobs start. When none start, no job is paused.
cat >"$scratch/no-start" <<EOF
#!/bin/bash
[ ! -e "$scratch/outage" ] || exit 1
if [[ " \$* " == *" --fenced "* ]]; then
    read -r -u 3 fence
    [[ \$fence != *'"folder":"bad"'* ]] || exit 1
fi
exec "$bin/stub-worker" --mode skip "\$@"
EOF
chmod +x "$scratch/no-start"
touch "$scratch/outage"
start_daemon --worker-program "$scratch/no-start"
bad=$(submit "$(job 1-3 '.output.path = "bad/f.####.exr" | .priority = 99')")
good=$(submit "$(job 1-3 '.output.path = "good/f.####.exr"')")
wait_until "workers do not start" eval '[ "$(grep -c "ended: exit status 1" "$scratch/daemon.log")" -ge 7 ]'
expect "a job when no worker starts" "$(field "$bad" .state)" queued
rm "$scratch/outage"
wait_state "$good" succeeded
wait_state "$bad" paused
[[ $(field "$bad" '"\(.state): \(.reason)"') == "paused: paused: workers start for other jobs, but not for this one: exit status 1" ]] ||
    fail "a job whose workers do not start: $(field "$bad" '{state, reason}')"
stop_daemon

# A store of a newer version is not changed.
sqlite3 "$scratch/state/queue.db" 'PRAGMA user_version = 1000'
refuse "newer" --state "$scratch/state" --socket "$socket" --output-root "$scratch/out"
