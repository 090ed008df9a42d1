#!/bin/bash
# The life of a job with workers that write small files: each frame once, states, events, stop of the daemon.
. "$(dirname "$0")/farm.sh"

start_daemon --worker-program "$(stub write:5)"
id=$(submit "$(job 1-40)")
wait_state "$id" succeeded
expect "frames that succeeded" "$(field "$id" .succeeded)" 40
wait_until "the leftovers are gone" eval '[ -z "$(find "$scratch/out/cloud" -name "*.part")" ]'
expect_files cloud 40
expect "frame 7" "$(ask job.frames "{\"id\":$id,\"range\":\"7\"}" |
    jq -c '.result | [.total, .frames[0].frame, .frames[0].state, .frames[0].size_bytes]')" '[1,7,"succeeded",8]'
stop_daemon
