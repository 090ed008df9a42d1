#!/bin/bash
# Workers and daemons that die: no frame is lost, none is published twice, no part file is left.
. "$(dirname "$0")/farm.sh"

published_once()
{
    expect "frames published twice" "$(jq -r 'select(.params.type == "frame" and .params.state == "succeeded") |
        .params.frame' "$1" | sort -n | uniq -d)" ""
}

worker_in_hand()
{
    ask worker.list | jq -r '[.result.workers[] | select(.frames > 0) | .pid][0] // empty'
}

frames_done()
{
    [ "$(field "$1" .succeeded)" -ge "$2" ]
}

# A worker killed while it renders: its frame is tried again by a new worker.
start_daemon --worker-program "$(stub write:100)"
listen "$scratch/events"
id=$(submit "$(job 1-120)")
wait_until "some frames are done" frames_done "$id" 4
kill -KILL "$(worker_in_hand)"
wait_state "$id" succeeded
expect_files cloud 120
published_once "$scratch/events"
expect "lost attempts" "$(ask job.log "{\"id\":$id}" | jq -r '[.result.attempts[].outcome] | unique | join(" ")')" lost
[[ $(ask job.log "{\"id\":$id}" | jq -r '.result.attempts[0].log') == *"signal 9"* ]] || fail "the log lacks the signal"
stop_daemon

# A worker that dies on every frame: three attempts for each, then it is failed, with the output of the worker as its log.
start_daemon --worker-program "$(stub crash)"
id=$(submit "$(job 5 '.output.path = "crash/c.####.exr"')")
wait_state "$id" failed
expect "attempts" "$(ask job.frames "{\"id\":$id}" | jq -c '.result.frames[0] | [.frame, .state, .attempts]')" '[5,"failed",3]'
expect "logged" "$(ask job.log "{\"id\":$id,\"frame\":5}" | jq '.result.attempts | length')" 3
[[ $(ask job.log "{\"id\":$id}" | jq -r '.result.attempts[0].log') == *"crashing on frame 5"* ]] ||
    fail "the log lacks what the worker wrote: $(ask job.log "{\"id\":$id}")"
stop_daemon

# When no frame can be rendered, the job is failed as a whole, so that its frames do not kill the workers one by one.
start_daemon --worker-program "$(stub crash)" --max-attempts 1
id=$(submit "$(job 1-200 '.output.path = "hopeless/h.####.exr"')")
wait_state "$id" failed
[[ $(field "$id" .reason) == *"exit status"* || $(field "$id" .reason) == *signal* ]] || fail "the reason: $(field "$id" .reason)"
[ "$(ask job.frames "{\"id\":$id}" | jq '[.result.frames[].attempts] | add')" -le 5 ] || fail "too many frames were tried"
stop_daemon

# A daemon killed during a job, three times: the job continues.
worker=$(stub write:20)
start_daemon --worker-program "$worker"
id=$(submit "$(job 1-120 '.output.path = "killed/k.####.exr"')")
for done in 10 40 70; do
    wait_until "$done frames are done" frames_done "$id" "$done"
    kill_daemon
    before=$(find "$scratch/out/killed" -name '*.exr' | wc -l)
    start_daemon --worker-program "$worker"
    [ "$(field "$id" .succeeded)" -ge "$before" ] || fail "$before files, yet $(field "$id" .succeeded) frames known"
done
wait_state "$id" succeeded
expect "frames" "$(field "$id" '[.frames, .succeeded] | join(" ")')" "120 120"
wait_until "leftovers are removed" eval '[ -z "$(find "$scratch/out/killed" -name "*.part")" ]'
expect_files killed 120
expect "whole files" "$(cat "$scratch"/out/killed/*.exr | sort -u | wc -l)" 120

# SIGTERM during a job: begun frames are finished, the others stay queued in the store.
id=$(submit "$(job 1-200 '.output.path = "stopped/s.####.exr"')")
wait_until "some frames are done" frames_done "$id" 20
stop_daemon
expect "parts after an orderly stop" "$(find "$scratch/out/stopped" -name '*.part')" ""
files=$(find "$scratch/out/stopped" -name '*.exr' | wc -l)
start_daemon --worker-program "$worker"
[ "$(field "$id" .succeeded)" -ge "$files" ] || fail "frames were forgotten by an orderly stop"
wait_state "$id" succeeded
expect_files stopped 200
stop_daemon

# A worker that does not stop is killed after the stop timeout.
start_daemon --worker-program "$(stub sleep:$((patience_s * 2000)))" --stop-timeout 1
id=$(submit "$(job 1-9 '.output.path = "slow/s.####.exr"')")
wait_until "a worker is busy" eval '[ -n "$(worker_in_hand)" ]'
stopping_at=$SECONDS
stop_daemon
[ $((SECONDS - stopping_at)) -lt $patience_s ] || fail "it was waited for"

# A worker that sends no heartbeat is killed, which the log of the frame says.
start_daemon --worker-program "$(stub hang)" --workers 1 --max-attempts 1
ask job.cancel "{\"id\":$id}" >/dev/null
id=$(submit "$(job 3 '.output.path = "hung/h.####.exr"')")
wait_state "$id" failed
[[ $(ask job.log "{\"id\":$id}" | jq -r '.result.attempts[0].log') == "killed: no message for "* ]] ||
    fail "log: $(ask job.log "{\"id\":$id}")"
stop_daemon

# A client that sends requests without end does not keep the daemon from stopping.
start_daemon --worker-program "$(stub skip)"
id=$(submit "$(job 1 '.output.path = "asked/a.####.exr"')" true)
yes "{\"jsonrpc\":\"2.0\",\"id\":1,\"method\":\"job.priority\",\"params\":{\"id\":$id,\"priority\":3}}" | ask_raw >"$scratch/asked" &
wait_until "it asks" test -s "$scratch/asked"
stop_daemon # it would not end

# Files that a worker of a dead daemon still writes do no harm, and are removed when the job is swept.
start_daemon --worker-program "$(stub write:10)"
id=$(submit "$(job 1-3 '.output.path = "late/l.####.exr"')" true)
epoch=$(sqlite3 "$scratch/state/queue.db" 'SELECT epoch FROM daemon')
kill_daemon
start_daemon --worker-program "$(stub write:10)"
expect "the epoch" "$(sqlite3 "$scratch/state/queue.db" 'SELECT epoch FROM daemon')" $((epoch + 1))
for frame in 1 2 3; do
    echo late >"$scratch/out/late/l.000$frame.exr.$id.$epoch.1.part"
done
ask job.resume "{\"id\":$id}" >/dev/null
wait_state "$id" succeeded
expect "attempts of each frame" "$(ask job.frames "{\"id\":$id}" | jq -c '[.result.frames[].attempts]')" "[1,1,1]"
wait_until "leftovers are gone" eval '[ -z "$(find "$scratch/out/late" -name "*.part")" ]'
expect_files late 3
! grep -q late "$scratch"/out/late/*.exr || fail "a late worker's bytes were published"
stop_daemon
