#!/bin/bash
# Changes to a job: pause, resume, cancel, retry, priority; and the reason of a waiting job.
. "$(dirname "$0")/farm.sh"

# 50 s of frames: they are not over before the test is done with them.
start_daemon --workers 1 --worker-program "$(stub write:50)"
first=$(submit "$(job 1-1000 '.name = "first"')")
second=$(submit "$(job 1-3 '.name = "second" | .output.path = "second/s.####.exr"')")

wait_until "the first runs" has_state "$first" running
expect "the second's state" "$(field "$second" .state)" queued
expect "why it waits" "$(field "$second" .reason)" "waits behind job $first (priority 50)"
expect "its new priority" "$(ask job.priority "{\"id\":$second,\"priority\":70}" | jq .result.priority)" 70
wait_state "$second" succeeded
expect "the first goes on" "$(field "$first" .state)" running

# A job whose output is looked at is told of while others are before it.
listen "$scratch/events"
third=$(submit "$(job 1-3 '.name = "third" | .priority = 20 | .output.path = "third/t.####.exr"')" true)
expect "resumed behind the first" "$(ask job.resume "{\"id\":$third}" | jq -r .result.state)" queued
grep -q "\"id\":$third.*its output is looked at" "$scratch/events" || fail "no event says why it waits: $(tail -n 1 "$scratch/events")"
expect "canceled" "$(ask job.cancel "{\"id\":$third}" | jq -r .result.state)" canceled
ask job.delete "{\"id\":$third}" >/dev/null

expect "paused" "$(ask job.pause "{\"id\":$first}" | jq -r '.result | .state + ": " + .reason')" "paused: paused by $(id -un)"
wait_until "nothing of it is in hand" eval '[ "$(field "$first" .running)" = 0 ]'
before=$(field "$first" .succeeded)
# A job that would have to wait for it is rendered.
ask job.priority "{\"id\":$second,\"priority\":0}" >/dev/null
ask job.retry "{\"id\":$second,\"state\":\"succeeded\"}" >/dev/null
wait_state "$second" succeeded
expect "frames done while paused" "$(field "$first" .succeeded)" "$before"
expect "resumed" "$(ask job.resume "{\"id\":$first}" | jq -r .result.state)" running

# In a farm that is drained no frame is begun: what runs is over when --wait ends.
drain=$("$bin/march" drain --wait --socket "$socket" 2>/dev/null) || fail "march drain --wait: status $?"
expect "the drain" "$drain" "drained: no frame runs, and none is begun until \`march undrain\` or a restart"
expect "frames of a drained farm" "$(ask daemon.status | jq -c '.result | [.drain.user, .frames.running, .frames.queued > 0]')" "[\"$(id -un)\",0,true]"
expect "why it waits" "$(field "$first" .reason)" "drained by $(id -un): no frame is begun until \`march undrain\` or a restart"
"$bin/march" undrain --socket "$socket" >/dev/null || fail "march undrain: status $?"
expect "not drained" "$(ask daemon.status | jq -c .result.drain)" null

expect "canceled" "$(ask job.cancel "{\"id\":$first}" | jq -r .result.state)" canceled
expect_error "$(ask job.pause "{\"id\":$first}")" 3 "was canceled"
wait_until "nothing of it is in hand" eval '[ "$(ask worker.list | jq ".result.workers[0].frames")" = 0 ]'
files=$(find "$scratch/out/cloud" -name '*.exr' | wc -l)
expect "frames" "$(field "$first" '.succeeded + .canceled')" 1000
expect "files" "$(field "$first" .succeeded)" "$files"

# A retry of some frames makes the job live; the others stay canceled, also after a restart.
expect "retried" "$(ask job.retry "{\"id\":$first,\"state\":\"canceled\",\"range\":\"995-1000\"}" | jq .result.retried)" 6
wait_until "they are done" eval '[ "$(field "$first" .queued)" = 0 ]'
kill_daemon
start_daemon --workers 1 --worker-program "$(stub write:0)"
wait_until "the retried frames are done" eval '[ "$(field "$first" ".queued + .running")" = 0 ]'
expect "its state" "$(field "$first" .state)" canceled
expect "its frames" "$(field "$first" '.succeeded + .canceled')" 1000
expect "frame 997" "$(ask job.frames "{\"id\":$first,\"range\":\"997\"}" | jq -r '.result.frames[0].state')" succeeded
expect "retried" "$(ask job.retry "{\"id\":$first,\"state\":[\"canceled\",\"succeeded\"]}" | jq .result.retried)" 1000
wait_state "$first" succeeded
expect_files cloud 1000

# A job that is over may be retried only while no other job writes its files.
expect "the same output again" "$(submit "$(job 1-1000)" true)" $((third + 1))
expect_error "$(ask job.retry "{\"id\":$first,\"state\":\"succeeded\"}")" 3 "writes its frame"
expect_error "$(ask job.retry "{\"id\":$first,\"state\":\"queued\"}")" -32602 "params.state"

# A restart changes nothing.
list=$(ask job.list | jq -c '[.result.jobs[] | {id, name, state, priority, owner, submitted, succeeded, finished, seconds_per_frame}]')
[[ $list == *'"seconds_per_frame":0.'* ]] || fail "no job has seconds a frame: $list"
stop_daemon
start_daemon --workers 1 --worker-program "$(stub write:0)"
expect "the list after a restart" \
    "$(ask job.list | jq -c '[.result.jobs[] | {id, name, state, priority, owner, submitted, succeeded, finished, seconds_per_frame}]')" "$list"
expect "succeeded jobs" "$(ask job.list '{"state":"succeeded"}' | jq -c '[.result.jobs[].id]')" "[$first,$second]"
expect "frames of the farm" "$(ask daemon.status | jq -c '.result | [.frames.succeeded, .frames.queued, .jobs.paused]')" '[1003,1000,1]'
stop_daemon

# A job whose frames were all queued again has not begun, also after a restart.
start_daemon --workers 1 --worker-program "$(stub nocontext)"
ask job.retry "{\"id\":$second,\"state\":\"succeeded\"}" >/dev/null
expect "retried in full" "$(field "$second" '[.state, .queued, .started] | map(tostring) | join(" ")')" "queued 3 null"
kill_daemon
start_daemon --workers 1 --worker-program "$(stub nocontext)"
expect "retried in full, after a restart" "$(field "$second" '[.state, .queued, .started] | map(tostring) | join(" ")')" "queued 3 null"

# A job that was paused when it ended is not paused after a retry, also after a restart.
third=$(submit "$(job 1-3 '.name = "third" | .output.path = "third/s.####.exr"')" true)
expect "canceled while paused" "$(ask job.cancel "{\"id\":$third}" | jq -r .result.state)" canceled
expect "retried" "$(ask job.retry "{\"id\":$third,\"state\":\"canceled\"}" | jq .result.retried)" 3
expect "retried after a pause" "$(field "$third" .state)" queued
kill_daemon
start_daemon --workers 1 --worker-program "$(stub write:0)"
wait_state "$third" succeeded
stop_daemon

# Frames that are rendered although their files are good are that after a crash, too.
start_daemon --workers 1 --worker-program "$(stub nocontext)"
expect "retried by force" "$(ask job.retry "{\"id\":$third,\"state\":\"succeeded\",\"range\":\"2\",\"force\":true}" | jq .result.retried)" 1
expect "retried as usual" "$(ask job.retry "{\"id\":$third,\"state\":\"succeeded\"}" | jq .result.retried)" 2
kill_daemon
start_daemon --workers 1 --worker-program "$(stub forced)"
wait_state "$third" succeeded
expect "rendered again, and skipped" "$(field "$third" '[.succeeded, .skipped] | @csv')" 1,2
# One whose job is canceled meanwhile is canceled, after a further retry of others and a restart, too.
stop_daemon
start_daemon --workers 1 --worker-program "$(stub nocontext)"
ask job.retry "{\"id\":$third,\"state\":[\"succeeded\",\"skipped\"],\"force\":true}" >/dev/null
ask job.cancel "{\"id\":$third}" >/dev/null
expect "retried after a cancel" "$(ask job.retry "{\"id\":$third,\"state\":\"canceled\",\"range\":\"1\"}" | jq .result.retried)" 1
kill_daemon
start_daemon --workers 1 --worker-program "$(stub forced)"
wait_state "$third" canceled
expect "skipped, and canceled" "$(field "$third" '[.succeeded, .skipped, .canceled] | @csv')" 0,1,2
stop_daemon

# A submission of a canceled job's files waits until a worker has left its last frame.
start_daemon --workers 1 --worker-program "$(stub hang)"
ask job.pause "{\"id\":$second}" >/dev/null
first=$(submit "$(job 1-3 '.output.path = "same/s.####.exr"')")
wait_until "it runs" has_state "$first" running
pid=$(ask worker.list | jq '.result.workers[0].pid')
kill -STOP "$pid"
ask job.cancel "{\"id\":$first}" >/dev/null
for n in 1 2; do
    printf '{"jsonrpc":"2.0","id":%d,"method":"job.submit","params":{"document":%s}}\n' $n "$(job 1-3 '.output.path = "same/s.####.exr"')"
done | "$bin/socket-client" --keep "$socket" >"$scratch/submitted" &
wait_until "the second of them is refused" grep -q "a job just submitted" "$scratch/submitted"
! grep -q '"id":1' "$scratch/submitted" || fail "the first did not wait: $(cat "$scratch/submitted")"
kill -CONT "$pid"
wait_until "the first is accepted" grep -q "\"id\":1,\"result\":{\"id\":$((first + 1))}" "$scratch/submitted"
stop_daemon

# A drain takes back what workers have in hand and have not begun; a restart ends it. Frames were short until now.
start_daemon --workers 1 --worker-program "$(stub write:0)"
first=$(submit "$(job 1-40 '.output.path = "drained/s.####.exr"')")
wait_state "$first" succeeded
stop_daemon
start_daemon --workers 1 --worker-program "$(stub write:3600000)"
expect "retried" "$(ask job.retry "{\"id\":$first,\"state\":\"succeeded\",\"range\":\"1-30\"}" | jq .result.retried)" 30
has_in_hand() { [ "$(field "$first" .running)" "$1" 1 ]; }
wait_until "frames are in hand beside the one that runs" has_in_hand -gt
wait_until "one of them is begun" eval '[ "$(field "$first" .phase)" = render ]' # or all of them would come back
ask daemon.drain >/dev/null
wait_until "those that were not begun are back" has_in_hand -eq
ask daemon.undrain >/dev/null
wait_until "they are in hand again" has_in_hand -gt
ask daemon.drain >/dev/null
kill_daemon
start_daemon --workers 1 --worker-program "$(stub write:0)"
expect "a drain after a restart" "$(ask daemon.status | jq -c .result.drain)" null
wait_state "$first" succeeded
stop_daemon
