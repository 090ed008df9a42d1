#!/bin/bash
# SIGHUP: settings are read again, invalid ones change nothing, and the service manager is notified.
. "$(dirname "$0")/farm.sh"

conf=$scratch/marchd.conf
notes=$scratch/notes

# reload TEXT...: the file's lines; returns once the daemon has said something about them.
reload()
{
    local said

    said=$(grep -c ' settings: ' "$scratch/daemon.log")
    printf '%s\n' "$@" >"$conf"
    kill -HUP "$daemon_pid"
    wait_until "the daemon speaks of its settings" eval '[ "$(grep -c " settings: " "$scratch/daemon.log")" -gt '"$said"' ]'
}

said()
{
    wait_until "the line \"$1\"" grep -qF -- "$1" "$scratch/daemon.log"
}

# A service manager that records its notifications.
"$bin/notify-listener" "$scratch/notify" >"$notes" &
wait_until "the manager listens" test -S "$scratch/notify"
export NOTIFY_SOCKET=$scratch/notify

printf '%s\n' "user-jobs = 5" >"$conf"
start_daemon --config "$conf" --worker-program "$(stub write:700)" --max-attempts 2
wait_until "ready is told" grep -q '^READY=1 STATUS=jobs: 0; frames: 0 queued, 0 running' "$notes"

# A limit and a log level that are applied at once; the command line still overrides the file.
reload "log-level = debug" "stop-timeout = 9" "progress-limit = 33" "max-attempts = 50"
said "settings: changed: stop-timeout, progress-limit, user-jobs, log-level"
wait_until "reloading is told" grep -q '^RELOADING=1 MONOTONIC_USEC=[0-9]' "$notes"
wait_until "ready is told again" eval '[ "$(grep -c "^READY=1" "$notes")" = 2 ]'
id=$(submit "$(job 1-2)")
wait_state "$id" succeeded
grep -q 'debug: job [0-9]* frame [12] attempt 1: published' "$scratch/daemon.log" || fail "log-level = debug shows no such line"

# Settings that need a restart are named.
reload "workers = 1" "threads = 4" "log-level = info"
said "warning: settings: changed, but need a restart: threads"
expect "workers" "$(ask worker.list | jq '.result.workers | length')" 2

# Invalid settings: the error names file and line, and nothing changes.
reload "stop-timeout = 1" "log-level = loud"
said "error: settings: not changed: $conf:2: --log-level: expected debug, info, warning or error, got \"loud\""
reload "no-such = 1"
said "$conf:1: no-such: there is no such setting"
# Who asks for a reload is told what holds now, or what is wrong, as systemctl is.
printf '%s\n' "user-jobs = 6" "threads = 4" "log-level = info" >"$conf"
expect "a reload that is asked for" "$(ask daemon.reload | jq -c .result)" '{"changed":["user-jobs"],"restart":["threads"]}'
printf '%s\n' "stop-timeout = soon" "user-jobs = 9" "woks = 1" >"$conf"
"$bin/march" reload --socket "$socket" >/dev/null 2>"$scratch/said"
expect "march reload of wrong settings: its status" $? 1
grep -qF "settings: not changed: $conf:1: --stop-timeout: expected seconds from 0 to 86400, got \"soon\" (and 1 more: marchd --check-config)" "$scratch/said" ||
    fail "march reload says $(cat "$scratch/said")"
said "a reload of the settings is asked for by $(id -un)"
# The same without a daemon: all mistakes, and nothing is made.
"$bin/marchd" --check-config --config "$conf" --state "$scratch/none" 2>"$scratch/said" >/dev/null
expect "a check of wrong settings: its status" $? 2
expect "mistakes" "$(cut -d: -f1-3 "$scratch/said")" "marchd: $conf:1
marchd: $conf:3"
printf '%s\n' "input-root = /no/such" >"$conf"
"$bin/marchd" --check-config --config "$conf" --state "$scratch/none" --output-root "$scratch/none" 2>"$scratch/said" >/dev/null
expect "a check of right settings: its status" $? 0
grep -q "warning: input root /no/such: No such file" "$scratch/said" || fail "the check says $(cat "$scratch/said")"
[ ! -e "$scratch/none" ] || fail "a check made a folder"
rm "$conf"
kill -HUP "$daemon_pid"
wait_until "a file that is gone is told of" grep -q "settings: not changed: $conf" "$scratch/daemon.log"
expect "its state" "$(ask daemon.status | jq -r .result.pid)" "$daemon_pid"

# The stop uses the timeout that was read last; the service manager is asked for it, and for some time to commit.
reload "stop-timeout = 2"
id=$(submit "$(job 1-40)")
wait_until "it runs" has_state "$id" running
wait_until "the line tells of it" grep -qE '^STATUS=jobs: 1; frames: [0-9]+ queued, [1-9] running$' "$notes"
stop_daemon
wait_until "stopping is told" grep -qE '^STOPPING=1 STATUS=stopping; jobs: 1; .* EXTEND_TIMEOUT_USEC=22000000$' "$notes"
expect "all that is told" "$(grep -cvE '^(READY=1 |RELOADING=1 |STOPPING=1 |STATUS=)' "$notes")" 0
