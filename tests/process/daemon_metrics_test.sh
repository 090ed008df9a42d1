#!/bin/bash
# What the daemon counts: frames, faults, workers and waits, as `march metrics` prints them.
. "$(dirname "$0")/farm.sh"

# value SERIES: of a line of the text, by its name and labels as they stand there.
value()
{
    "$bin/march" metrics --socket "$socket" | awk -v series="$1" 'index($0, series " ") == 1 { print substr($0, length(series) + 2) }'
}
is_value() { [ "$(value "$1")" = "$2" ]; }
expect_value() { expect "$1" "$(value "$1")" "$2"; }
exceeds() { awk -v a="$(value "$1")" -v b="$2" 'BEGIN { exit !(a > b) }'; }
toleranced='.quality = { tolerance: 0.05 }'

start_daemon --worker-program "$(stub audited:20)"
expect_value 'marchd_jobs{state="succeeded"}' 0
expect_value marchd_frames_published_total 0
id=$(submit "$(job 1-8 "$toleranced | .name = \"own words\"")")
wait_state "$id" succeeded
rendered='pool="local",backend="other",method="cached"'
expect_value 'marchd_jobs{state="succeeded"}' 1
expect_value 'marchd_frames{state="succeeded"}' 8
expect_value marchd_frames_published_total 8
expect_value marchd_frames_skipped_total 0
expect_value marchd_frames_missed_total 0
expect_value "marchd_frame_seconds_count{$rendered}" 8
expect_value "marchd_frame_seconds_sum{$rendered}" 0.16
expect_value "marchd_frame_seconds_bucket{$rendered,le=\"0.01\"}" 0
expect_value "marchd_frame_seconds_bucket{$rendered,le=\"0.03\"}" 8
expect_value "marchd_frame_error_ratio_bucket{$rendered,le=\"0.1\"}" 0
expect_value "marchd_frame_error_ratio_bucket{$rendered,le=\"0.2\"}" 8
expect_value 'marchd_work_seconds_total{part="render"}' 0.16
expect_value marchd_published_bytes_total "$(find "$scratch/out/cloud" -name '*.exr' -printf '%s\n' | awk '{ sum += $1 } END { print sum }')"
expect_value marchd_publish_seconds_count 8
expect_value marchd_job_start_wait_seconds_count 1
exceeds marchd_publish_seconds_sum 0 || fail "no time to publish"
exceeds marchd_commit_seconds_count 1 || fail "no commit is counted"
exceeds marchd_loop_turn_seconds_count 10 || fail "no turns are counted"
exceeds marchd_cpu_seconds_total 0 || fail "no processor time"
expect_value 'marchd_output_roots{state="there"}' 1
expect_value marchd_store_ok 1
"$bin/march" metrics --socket "$socket" | grep -q words && fail "a user's word is in the text"

# A job that misses its tolerance, and one that states none: the same stub, other labels.
id=$(submit "$(job 1-3 '.quality = { tolerance: 0.005, on_miss: "publish" } | .output.path = "missed/m.####.exr"')")
wait_state "$id" succeeded
expect_value marchd_frames_missed_total 3
expect_value "marchd_frame_error_ratio_bucket{$rendered,le=\"1\"}" 8
expect_value "marchd_frame_error_ratio_bucket{$rendered,le=\"1.5\"}" 11

# Why frames wait.
id=$(submit "$(job 1-5 '.output.path = "paused/p.####.exr"')" true)
expect_value 'marchd_queue_jobs{reason="paused"}' 1
expect_value 'marchd_queue_frames{reason="paused"}' 5
wait_until "it waits" exceeds 'marchd_queue_longest_wait_seconds{reason="paused"}' 0.2
ask daemon.drain >/dev/null
expect_value marchd_drained 1
ask job.resume "{\"id\":$id}" >/dev/null
expect_value 'marchd_queue_jobs{reason="paused"}' 0
wait_until "its output was looked at" is_value 'marchd_queue_frames{reason="drained"}' 5
ask daemon.undrain >/dev/null
wait_state "$id" succeeded
expect_value 'marchd_queue_frames{reason="drained"}' 0
stop_daemon

# Two jobs for two workers that take long: one is served, the other waits for its turn.
start_daemon --worker-program "$(stub write:3000)"
expect_value marchd_frames_published_total 0
expect_value 'marchd_jobs{state="succeeded"}' 3
first=$(submit "$(job 1-200 '.output.path = "first/f.####.exr"')")
wait_until "both workers are busy" is_value 'marchd_workers{pool="local",state="busy"}' 2
second=$(submit "$(job 1-7 '.output.path = "second/s.####.exr" | .priority = 10')")
expect_value 'marchd_queue_jobs{reason="served"}' 1
wait_until "the second waits" is_value 'marchd_queue_frames{reason="turn"}' 7
ask job.cancel "{\"id\":$first}" >/dev/null
ask job.cancel "{\"id\":$second}" >/dev/null
kill_daemon

# A job's root that is away, and a pool that the settings have no more.
nowhere='far launcher=command nodes=anna command=/bin/false'
start_daemon --pool "$nowhere"
id=$(submit "$(job 1-4 '.output.path = "far/f.####.exr" | .pool = "far"')")
wait_until "it waits for its pool" is_value 'marchd_queue_frames{reason="worker"}' 4
expect_value 'marchd_workers{pool="far",state="waiting"}' 1
mv "$scratch/out" "$scratch/away"
wait_until "it waits for its root" is_value 'marchd_queue_frames{reason="root"}' 4
expect_value 'marchd_output_roots{state="away"}' 1
mv "$scratch/away" "$scratch/out"
wait_until "its root is back" is_value 'marchd_queue_frames{reason="worker"}' 4
stop_daemon
start_daemon --worker-program "$(stub write:0)"
wait_until "no pool may render it" is_value 'marchd_queue_frames{reason="pool"}' 4
ask job.cancel "{\"id\":$id}" >/dev/null
stop_daemon

start_daemon --worker-program "$(stub fail:frame)"
id=$(submit "$(job 1 '.output.path = "fails/f.####.exr"')")
wait_until "the job failed" has_state "$id" failed
expect_value 'marchd_frame_faults_total{pool="local",fault="frame"}' 3
expect_value 'marchd_frame_faults_total{pool="local",fault="lost"}' 0
stop_daemon

start_daemon --worker-program "$(stub crash)" --max-attempts 2
id=$(submit "$(job 1 '.output.path = "crashes/c.####.exr"')")
wait_until "the job failed" has_state "$id" failed
expect_value 'marchd_frame_faults_total{pool="local",fault="lost"}' 2
wait_until "the ends are counted" is_value 'marchd_worker_ends_total{pool="local",cause="died"}' 2
stop_daemon

start_daemon --worker-program "$(stub plan:10)"
id=$(submit "$(job 1-4 '.output.path = "plans/p.####.exr"')")
wait_state "$id" succeeded
expect_value 'marchd_plan_seconds_count{pool="local"}' 4
stop_daemon

start_daemon --worker-program "$(stub nocontext)"
wait_until "a worker did not start" exceeds 'marchd_worker_ends_total{pool="local",cause="not_started"}' 0
id=$(submit "$(job 1-2 '.output.path = "none/n.####.exr"')")
wait_until "no worker is ready" is_value 'marchd_queue_frames{reason="worker"}' 2
stop_daemon
