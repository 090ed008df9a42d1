#!/bin/bash
# A truncated scan is a fault of the job: it fails at once and names the file. With the complete scan it renders.
. "$(dirname "$0")/farm.sh"

good=$PROJECT_ROOT/tests/fuzz/seeds/volume_nifti/gzip
scan=$scratch/head.nii.gz
grid=$(jq -n --arg file "$scan" '{density: {kind: "grid", file: $file}, sigma_a: 0, emission: 1}')

head -c 120 "$good" >"$scan"
sleep 2.5 # a file just written may still grow, and is tried again
start_daemon --backend software
id=$(submit "$(job 0-239 | jq -c --argjson medium "$grid" '.scene.media = [$medium] | .lights = []')")
wait_state "$id" failed
field "$id" .reason | grep -qF "$scan: its gzip data end before they are complete, after 120 bytes" ||
    fail "expected the file and what is wrong as the reason, got: $(field "$id" .reason)"
expect "frames that failed" "$(field "$id" .failed)" 240
[ "$(ask job.frames "{\"id\":$id}" | jq '[.result.frames[].attempts] | add')" -le 4 ] || fail "a frame was tried again in vain"
expect "files" "$(find "$scratch/out" -name "*.exr" | wc -l)" 0

cp "$good" "$scan"
ask job.retry "{\"id\":$id,\"range\":\"48-50\"}" >/dev/null
wait_until "three frames are done" eval '[ "$(field "$id" .succeeded)" = 3 ]'
expect "workers that were lost" "$(ask worker.list | jq '[.result.workers[] | select(.reason != null)] | length')" 0
stop_daemon
