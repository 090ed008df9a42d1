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

# An edited job does not replace what an older version of it has published, unless it says so.
edited='.name = "edited" | .camera.fov = 47'
expect_error "$(ask job.submit "{\"document\":$(job 7-50 "$edited")}")" 3 "cloud.0007.exr and 33 more would be replaced, which job $id (\"cloud\")"
submit "$(job 41-50 "$edited")" >/dev/null
expect_error "$(ask job.submit "{\"document\":$(job 40)}" | jq -c 'if .result then {"error":{"code":0,"message":"taken"}} else . end')" 0 taken
wait_until "all is over" eval '[ "$(ask daemon.status | jq .result.jobs.succeeded)" = 3 ]'
wait_state "$(submit "$(job 7 "$edited | .output.existing = \"overwrite\"")")" succeeded
rm "$scratch/out/cloud/"*.exr
wait_state "$(submit "$(job 8-9 "$edited")")" succeeded

# Of two idle workers, the one whose fence opens the folder takes the frame, whichever is asked first.
for folder in 1 2; do
    ids[folder]=$(submit "$(job 1-3 ".output.path = \"fence$folder/s.####.exr\"")")
done
wait_state "${ids[1]}" succeeded
wait_state "${ids[2]}" succeeded
for frame in 11 12; do
    for folder in 1 2; do
        wait_state "$(submit "$(job $frame ".output.path = \"fence$folder/s.####.exr\"")")" succeeded
    done
done
stop_daemon
