#!/bin/bash
# Jobs that are over leave the queue by count, bytes and age; their files stay, and so do jobs that are not over.
. "$(dirname "$0")/farm.sh"

known() { ask job.list | jq -c '[.result.jobs[].id]'; }
knows() { [ "$(known)" = "$1" ]; }
rules() { printf '%s\n' "$@" >"$scratch/conf"; }
reload() { expect "settings that hold now" "$(ask daemon.reload | jq -c .result.changed)" "$1"; }
# one N: a job of three frames that succeeds.
one()
{
    local id

    id=$(submit "$(job 1-3 ".output.path = \"a$1/a.####.exr\"")")
    wait_state "$id" succeeded
}

rules "log-level = info"
start_daemon --config "$scratch/conf" --worker-program "$(stub write:1)"
for n in 1 2 3; do one $n; done
live=$(submit "$(job 1 '.output.path = "live/l.####.exr"')" true)
for n in 5 6; do one $n; done
expect "all jobs without a rule" "$(known)" "[1,2,3,4,5,6]"
listen "$scratch/events"

# By their number: those that ended first leave, one that is not over does not count.
rules "keep-jobs = 3"
reload '["keep-jobs"]'
wait_until "two leave" knows "[3,4,5,6]"
expect "what the log says" "$(grep -c 'deleted by marchd (keep-jobs); 0 files removed' "$scratch/daemon.log")" 2
expect_files a1 3
expect_files a2 3
wait_until "their ends are told" eval '[ "$(grep -c "\"type\":\"deleted\"" "$scratch/events")" = 2 ]'
expect_error "$(ask job.show '{"id":1}')" 1 "there is no such job"

# A job that is retried is not over any more, and the one that ends next leaves in its turn.
ask job.retry '{"id":3,"state":"succeeded","force":true}' >/dev/null
wait_state 3 succeeded
rules "keep-jobs = 2"
reload '["keep-jobs"]'
wait_until "one leaves" knows "[3,4,6]"

# By the bytes of their files: the newest stay whose files fit.
size=$(stat -c %s "$scratch/out/a6/a.0001.exr")
rules "keep-bytes = $((size * 4))"
reload '["keep-jobs","keep-bytes"]'
wait_until "the files of one job fit" knows "[3,4]"
expect "what the log says of bytes" "$(grep -c 'deleted by marchd (keep-bytes)' "$scratch/daemon.log")" 1

# By age, over a SIGKILL: the end of a job is known after it.
one 7
rules "keep-days = 0.00001"
kill_daemon
start_daemon --config "$scratch/conf" --worker-program "$(stub write:1)"
wait_until "all that are over leave" knows "[4]"
expect "what the log says of days" "$(grep -c 'deleted by marchd (keep-days)' "$scratch/daemon.log")" 2
expect_files a7 3
kill_daemon
start_daemon --config "$scratch/conf" --worker-program "$(stub write:1)"
expect "after another SIGKILL" "$(known)" "[4]"
ask job.resume "{\"id\":$live}" >/dev/null
wait_until "it leaves when it is over" knows "[]"

# A job that is over while its root is away stays until its part files are swept, and deletions of users come between.
rules "log-level = info"
reload '["keep-days"]'
for n in 8 9; do one $n; done
rules "keep-jobs = 1"
reload '["keep-jobs"]'
ask job.delete '{"id":8}' >/dev/null
wait_until "one is left" knows "[9]"
stop_daemon

expect_error_of() { [[ $("$bin/marchd" --config /dev/null --output-root "$scratch/out" --check-config "$@" 2>&1) == *"$wanted"* ]] || fail "$*"; }
wanted='--keep-days: expected "none" or a number of days, at most 100000, got "30d"'
expect_error_of --keep-days 30d
