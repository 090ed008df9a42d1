#!/bin/bash
# A queue that is backed up, restored, lost or damaged, with the real commands.
. "$(dirname "$0")/farm.sh"
state=$scratch/state
paused() { submit "$(job 1-3 ".name = \"$1\" | .output.path = \"$1/f.####.exr\"")" true; }
starts_with() { "$bin/marchd" --state "$state" --socket "$socket" --output-root "$scratch/out" "$@" 2>>"$scratch/daemon.log"; }

start_daemon --worker-program "$(stub write:5)"
expect "the first job" "$(paused castle)" 1
"$bin/march" backup "$scratch/copy.db" --socket "$socket" >"$scratch/said" || fail "backup beside a running daemon"
expect "what was copied" "$(cat "$scratch/said")" "copied the queue in $state to $scratch/copy.db"
expect "mode of the copy" "$(stat -c %a "$scratch/copy.db")" 600
expect "the job after it" "$(paused river)" 2
MARCHD_SOCKET=$socket "$bin/march" restore "$scratch/copy.db" 2>"$scratch/refusal" && fail "restored below a running daemon"
grep -q "another marchd (pid $daemon_pid) uses $state" "$scratch/refusal" || fail "$(cat "$scratch/refusal")"
stop_daemon
MARCHD_SOCKET=$socket "$bin/march" backup "$scratch/none.db" 2>"$scratch/refusal"
expect "a backup by the socket of a stopped daemon" $? 3
grep -q "no daemon at $socket says where its queue is: name its state folder" "$scratch/refusal" || fail "$(cat "$scratch/refusal")"

# Ids do not begin again, and what is restored is what was copied.
"$bin/march" restore "$scratch/copy.db" "$state" >/dev/null || fail "restore"
start_daemon --worker-program "$(stub write:5)"
expect "jobs" "$(ask job.list | jq -c '[.result.jobs[].name]')" '["castle"]'
expect "an id after the restore" "$(paused meadow)" 3
stop_daemon

# One flipped bit in each of two jobs. The daemon has kept no backup: it was stopped before its first look.
LC_ALL=C sed -i 's/meadow\/f/meadow\/g/; s/castle\/f/castle\/g/' "$state/queue.db"
start_daemon --worker-program "$(stub write:5)"
for id in 1 3; do
    expect "a job whose document is damaged" "$(field $id .state)" failed
    [[ $(field $id .reason) == "store: its document was damaged on the disk, and no backup has it"* ]] || fail "$(field $id .reason)"
    expect_error "$(ask job.retry "{\"id\":$id,\"state\":\"failed\"}")" 3 "its document was damaged"
done
expect "its deletion" "$(ask job.delete '{"id":1}' | jq -c .result.files_removed)" 0
stop_daemon
grep -q "a damaged row of queue.db (document 3): no backup has it" "$scratch/daemon.log" || fail "the log says nothing"
cp "$scratch/copy.db" "$state/backup.db"
LC_ALL=C sed -i 's/castle\/f/castle\/g/' "$state/queue.db"

# A store that is gone is a question.
rm "$state"/queue.db*
starts_with && fail "a new farm was begun unasked"
expect "the exit status, which keeps systemd from trying again" "$(starts_with; echo $?)" 2
grep -q "there is no $state/queue.db, but $state/backup.db says that a farm was here: mount its disk, put a backup back (march restore $state/backup.db $state), or begin" "$scratch/daemon.log" || fail "no question"
start_daemon --new-store --worker-program "$(stub write:5)"
expect "an id of the new store" "$(paused lake)" 4
stop_daemon
