#!/bin/bash
# marchd --openrpc describes the methods: what a daemon takes and answers in all states of jobs is what it says, and all of it.
. "$(dirname "$0")/farm.sh"
described=$scratch/openrpc.json
"$bin/marchd" --openrpc >"$described" || fail "marchd --openrpc: status $?"
check() { python3 "$PROJECT_ROOT/tests/process/openrpc.py" "$1" "$described" "${@:2}" || fail "$1: see above"; }
check protocol "$PROJECT_ROOT/docs/protocol.md"
check sources "$PROJECT_ROOT"/daemon/requests/*.c

# Each answer is kept with the name of its method.
ask()
{
    local answer

    answer=$(printf '{"jsonrpc":"2.0","id":1,"method":"%s","params":%s}\n' "$1" "${2:-{\}}" | "$bin/socket-client" "$socket")
    [ -z "$answer" ] || printf '%s\t%s\n' "$1" "$answer" >>"$scratch/answers"
    echo "$answer"
}
# look ID: asks everything about a job.
look()
{
    ask job.list "{\"ids\":[$1]}" >/dev/null
    ask job.list '{"limit":1}' >/dev/null
    ask job.frame_map "{\"id\":$1}" >/dev/null
    ask job.frames "{\"id\":$1,\"limit\":1}" >/dev/null
    ask job.show "{\"id\":$1}" >/dev/null
    ask job.frames "{\"id\":$1}" >/dev/null
    ask job.log "{\"id\":$1}" >/dev/null
    ask job.plans "{\"id\":$1}" >/dev/null
    ask worker.list >/dev/null
    ask daemon.status >/dev/null
    ask daemon.metrics >/dev/null
}

# Frames that are planned and take long: running, paused, drained, canceled.
start_daemon --workers 1 --stop-timeout 1 --worker-program "$(stub plan:50000)"
expect "a subscription" "$(ask events.subscribe '{}' | jq -c .result)" '{}'
expect "its end" "$(ask events.unsubscribe '{}' | jq -c .result)" '{}'
listen "$scratch/slow"
id=$(submit "$(job 1-3 '.comment = "slow" | .tags = ["a"] | .output.path = "slow/s.####.exr"')")
wait_until "its frame is rendered" eval '[ "$(field "$id" .phase)" = render ]'
look "$id"
behind=$(submit "$(job 1-3 '.output.path = "behind/b.####.exr"')")
look "$behind"
expect "a higher priority" "$(ask job.priority "{\"id\":$behind,\"priority\":7}" | jq .result.priority)" 7
ask daemon.drain >/dev/null
look "$behind"
ask daemon.undrain >/dev/null
ask job.pause "{\"id\":$behind}" >/dev/null
look "$behind"
ask job.resume "{\"id\":$behind}" >/dev/null
ask job.cancel "{\"id\":$behind}" >/dev/null
look "$behind"
expect_error "$(ask job.pause "{\"id\":$behind}")" 3 "was canceled"
# Tokens in all states.
for params in '{"scope":"read"}' '{"scope":"submit","name":"a","expires_s":1000,"once":false}' '{"scope":"admin","once":true}'; do
    token=$(ask token.create "$params" | jq -r .result.token)
    ask token.list >/dev/null
    ask auth.token "{\"token\":\"$token\"}" >/dev/null
done
ask token.list >/dev/null
ask auth.drop >/dev/null
ask auth.token '{"token":"wrong"}' >/dev/null
ask token.revoke "{\"id\":$(ask token.list | jq '.result.tokens[0].id')}" >/dev/null
check params "$socket" "$id"
stop_daemon

# Accuracy, an error over the tolerance, frames that are found, retried and deleted.
start_daemon --workers 1 --worker-program "$(stub audited:0)"
listen "$scratch/quick"
id=$(submit "$(job 1-3 '.quality = {"tolerance": 0.001, "on_miss": "publish"} | .output.path = "missed/m.####.exr"')")
wait_state "$id" succeeded
look "$id"
ask job.retry "{\"id\":$id,\"state\":[\"succeeded\"],\"range\":\"2\",\"force\":true}" >/dev/null
wait_state "$id" succeeded
ask daemon.reload >/dev/null
noted=$(ask job.submit "{\"document\":$(job 1 '.notify = [{"on":["done"],"to":"chat"},{"on":["done"],"webhook":"http://a/"}] | .output.path = "noted/n.####.exr"')}" |
    jq .result.id)
wait_until "its end is noted" eval '[ "$(ask notify.pending | jq ".result.notices | length")" = 2 ]'
ask notify.done "{\"id\":$(ask notify.pending '{"targets":["chat"],"webhooks":true}' | jq '.result.notices[0].id')}" >/dev/null
wait_state "$noted" succeeded
ask job.delete "{\"id\":$id,\"files\":true}" >/dev/null
wait_until "its end is told" grep -q '"type":"deleted"' "$scratch/quick"
stop_daemon
start_daemon --workers 1 --worker-program "$(stub fail:frame)"
id=$(submit "$(job 1-2 '.output.path = "failed/f.####.exr"')")
wait_state "$id" failed
look "$id"
stop_daemon

# No worker can begin: its reason.
start_daemon --workers 1 --worker-program "$(stub nocontext)"
wait_until "its reason is told" eval '[ "$(ask worker.list | jq -r ".result.workers[0].reason // empty")" ]'
stop_daemon

# A real frame, planned and audited.
start_daemon --workers 1 --backend software
id=$(submit "$(job 1 '.quality = {"tolerance": 0.1} | .output.path = "real/r.####.exr"')")
wait_state "$id" succeeded
look "$id"
stop_daemon
cat "$scratch/slow" "$scratch/quick" >"$scratch/events"
check answers "$scratch/answers" "$scratch/events"
