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

# A start takes the part files that an earlier one left for their frames, if they are whole, of this job and not of a farm
# beside it. Here they are copies of job 1's files, which a job with the same picture has under other names.
start_daemon
id=$(submit "$(job 0-239x40 '.output.path = "taken/t.####.exr" | .output.existing = "overwrite"')" true)
kill_daemon
part() { echo "$scratch/out/taken/t.$1.exr.$2.$id.1.1.part"; }
farm=$(sed -n 's/^farm \(.\{8\}\).*/\1/p' "$scratch/out/.marchd-root")
cp "$scratch/out/cloud/cloud.0000.exr" "$(part 0000 "$farm")"
head -c -100 "$scratch/out/cloud/cloud.0040.exr" >"$(part 0040 "$farm")"
cp "$scratch/out/cloud/cloud.0040.exr" "$(part 0080 "$farm")"
cp "$scratch/out/cloud/cloud.0120.exr" "$(part 0120 00000000)"
stat -c %i "$scratch/out/taken"/t.* >"$scratch/parts"
first=$(stat -c %i "$(part 0000 "$farm")")
start_daemon
ask job.resume "{\"id\":$id}" >/dev/null
wait_state "$id" succeeded
wait_until "its own part files are gone" eval '[ "$(find "$scratch/out/taken" -name "*.part")" = "$(part 0120 00000000)" ]'
expect "frames rendered" "$(field "$id" '[.succeeded, .skipped] | join(" ")')" "6 0"
expect "the file of frame 0" "$(stat -c %i "$scratch/out/taken/t.0000.exr")" "$first"
expect "part files that became pictures" "$(stat -c %i "$scratch/out/taken"/*.exr | grep -cxFf "$scratch/parts")" 1
"$bin/march" verify "$scratch/out/taken" >/dev/null || fail "march verify: $("$bin/march" verify "$scratch/out/taken")"
stop_daemon
