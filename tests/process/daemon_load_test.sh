#!/bin/bash
# Clients that are many, greedy or slow take neither the daemon's memory nor its time, and connections wait for descriptors.
. "$(dirname "$0")/farm.sh"
. "$(dirname "$0")/load.sh"

# Subscribers that never read: the text of an event is there once, and a user's connections share one limit.
start_daemon --worker-program "$(stub skip)" --user-frames none
id=$(submit "$(job 0-39999)" true)
subscribe_lines 64 >"$scratch/lines"
attack_unread 20 "$scratch/lines"
before=$(resident_mib)
ask job.resume "{\"id\":$id}" >/dev/null
wait_until "a client is cut off" grep -q "does not read its events" "$scratch/daemon.log"
wait_state "$id" succeeded
expect "frames of a retry in parts" "$(ask job.retry "{\"id\":$id,\"state\":\"skipped\"}" | jq .result.retried)" 40000
wait_state "$id" succeeded
# Sanitizers keep what is freed.
if ! [[ -n ${ASAN_OPTIONS-} && $(nm -D "$bin/marchd" 2>/dev/null) == *asan* ]]; then
    [ "$(resident_mib)" -lt $((before + 100)) ] || fail "memory: $before MiB, then $(resident_mib)"
fi
end_attack

# Large jobs of one user are read in threads: another's request is answered before they are, and all are answered. The loop
# takes a twentieth of the processor time, and most of it if it reads them itself.
large_job_line 2000 >"$scratch/lines"
loop_percent
attack 12 "$scratch/lines" >"$scratch/answers" &
attacker=$!
wait_until "a status is told" eval '[ -n "$(turns .longest_ms)" ]'
wait "$attacker" || fail "the attack: $(cat "$scratch/answers")"
attacker=
expect "answers to twelve equal jobs" "$(cat "$scratch/answers")" "12 answers, 11 errors"
loop_percent
[ "$share" -lt 25 ] || fail "the loop takes $share % of the daemon's processor time: $(turns .)"
expect "turns that are counted" "$(turns '(.counts | length) == (.up_to_ms | length) + 1 and (.counts | add) > 0')" true
"$bin/march" status --socket "$socket" | grep -q "^turns  *longest .* ms of processor time: .* up to 1 ms" ||
    fail "march status: $("$bin/march" status --socket "$socket")"

# A list that is written in steps has all jobs, in order.
expect "the list" "$(ask job.list | jq -c '[.result.jobs[].id]')" "$(jq -nc "[range(1; 3)]")"
expect "frames of a walk in steps" "$(ask job.frames "{\"id\":$id,\"range\":\"0-39999x10000\",\"offset\":1,\"limit\":2}" |
    jq -c '[[.result.frames[].frame], .result.total]')" "[[10000,20000],4]"
expect "frames of a long range" "$(ask job.frames "{\"id\":$id,\"range\":\"$(printf '1,%.0s' {1..33000})1\"}" | jq .error.code)" -32602
stop_daemon

# A deletion of many frames that a SIGKILL cuts off leaves a canceled job, of which nothing is rendered again.
start_daemon --worker-program "$(stub nocontext)"
ask job.delete '{"id":1}' >/dev/null &
deleter=$!
while [[ $(ask job.show '{"id":1}') == *'"state":"succeeded"'* ]]; do :; done
kill_daemon
wait "$deleter"
start_daemon --worker-program "$(stub nocontext)"
if [[ $(ask job.show '{"id":1}') != *'"error"'* ]]; then
    expect "a deletion that was cut off" "$(field 1 '[.state, .queued, .reason] | join(" ")')" \
        "canceled 0 its deletion by $(id -un) has begun: march delete 1 ends it"
    ask job.delete '{"id":1}' >/dev/null
fi
expect_error "$(ask job.show '{"id":1}')" 1 "there is no such job"
stop_daemon

# A retry of one frame among a million writes what changes, and what it leaves stays canceled over a SIGKILL.
start_daemon --worker-program "$(stub nocontext)" --user-frames none
id=$(submit "$(job 0-999999 '.output.path = "million/x.####.exr"')" true)
ask job.cancel "{\"id\":$id}" >/dev/null
wait_until "the job is swept" eval '[ "$(ask job.show "{\"id\":$id}" | jq .result.finished)" != null ]'
before=$(stat -c %s "$scratch/state/queue.db-wal")
expect "frames that are retried" "$(ask job.retry "{\"id\":$id,\"state\":\"canceled\",\"range\":\"7,999999\"}" | jq .result.retried)" 2
[ $(($(stat -c %s "$scratch/state/queue.db-wal") - before)) -lt 1000000 ] || fail "the retry wrote $(($(stat -c %s "$scratch/state/queue.db-wal") - before)) bytes"
kill_daemon
start_daemon --worker-program "$(stub nocontext)" --user-frames none
expect "frames after the restart" "$(ask job.show "{\"id\":$id}" | jq -c '[.result.queued, .result.canceled]')" "[2,999998]"
expect "frames that are retried then" "$(ask job.retry "{\"id\":$id,\"state\":\"canceled\"}" | jq .result.retried)" 999998
expect_error "$(ask job.retry "{\"id\":$id,\"range\":\"1..9\"}")" -32602 'params.range: expected "1-100x2", got "1..9"'
stop_daemon

# Names that people read as others.
start_daemon --worker-program "$(stub nocontext)"
expect_error "$(ask job.submit "{\"document\":$(job 1 '.name = "a\u202egpj"')}")" -32602 "name: U+202E is not allowed"
stop_daemon

# A lack of descriptors is the farm's, not the job's.
start_daemon --worker-program "$(stub nocontext)"
mkfifo "$scratch/requests"
"$bin/socket-client" "$socket" <"$scratch/requests" >"$scratch/answers" &
exec 9>"$scratch/requests"
answer() { wait_until "answer $1" eval '[ "$(wc -l <"$scratch/answers")" = '"$1"' ]'; sed -n "$1p" "$scratch/answers"; }
say() { jq -nc --argjson document "$(job 1)" --argjson id "$1" '{jsonrpc: "2.0", id: $id, method: "job.submit", params: {document: $document}}' >&9; }
echo '{"jsonrpc":"2.0","id":1,"method":"daemon.status"}' >&9
answer 1 >/dev/null
# The limit lies below what stays open: whatever ends meanwhile frees nothing.
for used in 0 1 2 3; do [ -e "/proc/$daemon_pid/fd/$used" ] || fail "the daemon has no descriptor $used"; done
prlimit --pid "$daemon_pid" --nofile=4:1024
sleep 2 # the daemon looks after its roots every second
say 2
expect "who is to blame" "$(answer 2 | jq -r '[.error.code, .error.message] | join(" ")')" \
    "-32603 output root $scratch/out cannot be opened: this program may open no more than 4 files (LimitNOFILE= of its service)"
prlimit --pid "$daemon_pid" --nofile=1024:1024
say 3
expect "the job then" "$(answer 3 | jq 'has("result")')" true
exec 9>&-
stop_daemon

# No descriptors: connections wait, which is said once, and are served when there are some again.
as_daemon=(prlimit --nofile=40:40)
start_daemon --worker-program "$(stub nocontext)"
subscribe_lines 1 >"$scratch/lines"
attack_unread 60 "$scratch/lines"
wait_until "the lack is told" grep -q "connections have to wait, tried again every second: this program may open no more than 40 files" "$scratch/daemon.log"
end_attack
expect "who asks then" "$(ask daemon.status | jq .result.pid)" "$daemon_pid"
expect "times the lack is told" "$(grep -c "connections have to wait" "$scratch/daemon.log")" 1
stop_daemon
