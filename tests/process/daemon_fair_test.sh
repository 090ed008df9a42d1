#!/bin/bash
# What waits for what: frames in hand and a higher priority, skipped frames, the order of frames, the limit of a frame's
# time; and, played by root, two users.
. "$(dirname "$0")/farm.sh"

# A job whose first frames are there: a hundred frames or so are in hand when one of them has to be rendered. They are given
# back, and a job of a higher priority waits for that one alone.
start_daemon --workers 1 --worker-program "$(stub some:3600000)" # until SIGUSR1
long=$(submit "$(job 1-400)")
wait_until "frames are skipped" eval '[ "$(field "$long" ".skipped")" = 99 ]'
high=$(submit "$(job 1-3 '.priority = 90 | .output.path = "high/h.####.exr"')")
expect "why it waits" "$(field "$high" .reason)" "waits for a free worker"
wait_until "frames are given back" eval '[ "$(field "$long" .running)" = 1 ]'
kill -USR1 "$(ask worker.list | jq '.result.workers[].pid')"
wait_state "$high" succeeded
expect "frames rendered before a higher priority" "$(field "$long" .succeeded)" 1
expect "skips say nothing about seconds a frame" "$(field "$high" .seconds_per_frame)" null
ask job.cancel "{\"id\":$long}" >/dev/null
stop_daemon

# What a worker says that it found is looked at.
start_daemon --workers 1 --worker-program "$(stub claim)" --max-attempts 2
claimed=$(submit "$(job 1-3 '.output.path = "claim/c.####.exr"')")
wait_state "$claimed" failed
frames=$(ask job.frames "{\"id\":$claimed}")
expect "skipped" "$(field "$claimed" .skipped)" 0
jq -r '.result.frames[0].error' <<<"$frames" | grep -q 'c.0001.exr: No such file' || fail "the reason: $frames"
stop_daemon

# First, last, middle, every third, the rest.
start_daemon --workers 1 --worker-program "$(stub write:0)"
ordered=$(submit "$(job 1-10 '.order = ["first", "last", "middle", 3] | .output.path = "order/o.####.exr"')" true)
listen "$scratch/events" "{\"id\":$ordered}"
ask job.resume "{\"id\":$ordered}" >/dev/null
wait_until "its end is told" grep -q '"type":"job","job":{[^}]*"state":"succeeded"' "$scratch/events"
expect "the order" "$(jq -r 'select(.params.type == "frame" and .params.state == "running") | .params.frame' "$scratch/events" | xargs)" \
    "1 10 6 4 7 2 3 5 8 9"
grep -q "resumed by $(id -un)" "$scratch/daemon.log" || fail "the log does not say who resumed"
stop_daemon

# Progress without end ends: the frame fails at once.
start_daemon --workers 1 --worker-program "$(stub write:3600000)" # which says after an hour that it is done
endless=$(submit "$(job 1 '.frame_limit = 1 | .output.path = "endless/e.####.exr"')")
wait_state "$endless" failed
frames=$(ask job.frames "{\"id\":$endless}")
expect "the frame" "$(jq -c '.result.frames[0] | [.attempts, .error]' <<<"$frames")" \
    '[1,"killed: frame takes more than 1 s (the job'\''s frame_limit)"]'
kill_daemon

[ "$(id -u)" = 0 ] || { echo "skip: other users can be played by root only"; exit 77; }

# One worker, and a quarter of an hour of another user's frames in hundreds of jobs: a single job is over before nearly all of
# them.
run_for_others
rm -rf "$scratch/state" "$scratch/out"
start_daemon --workers 1 --worker-program "$(stub write:1000)"
chmod 666 "$socket"
job 1-3 | jq -c 'range(300) as $n | .output.path = "flood/\($n)/f.####.exr" |
    {jsonrpc: "2.0", id: $n, method: "job.submit", params: {document: .}}' >"$scratch/flood"
as 1 1 "$bin/socket-client" "$socket" <"$scratch/flood" >"$scratch/answers"
expect "jobs of the flood" "$(jq -s '[.[] | select(.result.id)] | length' "$scratch/answers")" 300
first=$(jq -s '[.[].result.id] | min' "$scratch/answers")
wait_until "a frame of the flood succeeded" eval '[ "$(field "$first" .succeeded)" -gt 0 ]'
single=$(ask_as 2 2 job.submit "{\"document\":$(job 1 '.output.path = "single/s.####.exr"')}" | jq .result.id)
wait_state "$single" succeeded
last=$(jq -s '[.[].result.id] | max' "$scratch/answers")
expect "the flood's last job" "$(field "$last" .state)" queued
field "$last" .reason | grep -qE "^waits behind job [0-9]+ \(priority 50\)$" || fail "why it waits: $(field "$last" .reason)"

# What was used is known after a crash: the first frame is of who used less. That is who has the newest job, unless a slow
# machine has rendered much of it by then.
next=$(ask_as 2 2 job.submit "{\"document\":$(job 1-1000 '.output.path = "next/n.####.exr"')}" | jq .result.id)
kill_daemon
expect "owners whose use is stored" "$(sqlite3 "$scratch/state/queue.db" "SELECT count(*) FROM usage WHERE used_s > 0.1")" 2
least=$(sqlite3 "$scratch/state/queue.db" "SELECT owner_uid FROM usage ORDER BY used_s LIMIT 1")
start_daemon --workers 1 --worker-program "$(stub write:3600000)"
wait_until "a frame runs" eval '[ "$(ask daemon.status | jq .result.frames.running)" -gt 0 ]'
expect "whose frame it is" "$(field "$next" '.running > 0')" "$(jq -n "$least == 2")"
kill_daemon
