#!/bin/bash
# The real worker: every frame is rendered once, also when workers and the daemon are killed.
. "$(dirname "$0")/farm.sh"

start_daemon
wait_until "a worker is ready" eval '[ "$(ask worker.list | jq "any(.result.workers[]; .state == \"idle\")")" = true ]'
expect "idle workers that do not say what they render with" "$(ask worker.list |
    jq '[.result.workers[] | select(.state == "idle" and (.renderer | length) == 0)] | length')" 0
id=$(submit "$(job 0-239x40)")
wait_state "$id" succeeded
expect_files cloud 6
expect "frames" "$(ask job.frames "{\"id\":$id}" |
    jq -c '[.result.frames[] | select(.state == "succeeded" and .render_s > 0 and .size_bytes > 0) | .frame]')" '[0,40,80,120,160,200]'
file=$(ask job.frames "{\"id\":$id}" | jq -r '.result.frames[1].path')
expect "its first bytes" "$(head -c 4 "$file" | od -An -tx1 | xargs)" "76 2f 31 01"

# The same job again finds its files and renders nothing.
again=$(submit "$(job 0-239x40)")
wait_state "$again" succeeded
expect "frames found" "$(field "$again" .skipped)" 6

# Killed workers and a killed daemon.
id=$(submit "$(job 0-59 '.output.path = "killed/k.####.exr"')")
wait_until "frames are done" eval '[ "$(field "$id" .succeeded)" -ge 3 ]'
kill -KILL "$(ask worker.list | jq '[.result.workers[].pid | values][0]')"
wait_until "more frames are done" eval '[ "$(field "$id" .succeeded)" -ge 10 ]'
kill_daemon
start_daemon
wait_state "$id" succeeded
wait_until "leftovers are gone" eval '[ -z "$(find "$scratch/out/killed" -name "*.part")" ]'
expect_files killed 60
stop_daemon
