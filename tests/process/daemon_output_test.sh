#!/bin/bash
# An output that cannot be written: the job is paused with the reason, no frame loses an attempt, and resume works.
. "$(dirname "$0")/farm.sh"

[ "$(id -u)" = 0 ] || { echo "skip: a small file system can be mounted by root only"; exit 77; }
mkdir -p "$scratch/disk"
mount -t tmpfs -o size=64k tmpfs "$scratch/disk" 2>/dev/null || { echo "skip: no file system can be mounted here"; exit 77; }

start_daemon --worker-program "$(stub write:10)" --output-root "$scratch/disk"
id=$(submit "$(job 1-40)")
wait_state "$id" paused
[[ $(field "$id" .reason) == "paused: output: "*"No space left on device"* ]] || fail "reason: $(field "$id" .reason)"
expect "frames that failed" "$(field "$id" .failed)" 0
mount -o remount,size=4m "$scratch/disk"
ask job.resume "{\"id\":$id}" >/dev/null
wait_state "$id" succeeded
wait_until "leftovers are gone" eval '[ -z "$(find "$scratch/disk" -name "*.part")" ]'
expect "files" "$(find "$scratch/disk" -name '*.exr' | wc -l)" 40

# A folder that became read-only.
id=$(submit "$(job 41-60)" true)
mount -o remount,ro "$scratch/disk"
ask job.resume "{\"id\":$id}" >/dev/null
wait_state "$id" paused
[[ $(field "$id" .reason) == "paused: output: "*"ead-only"* ]] || fail "reason: $(field "$id" .reason)"
expect_error "$(ask job.submit "{\"document\":$(job 1 '.output.path = "new/n.####.exr"')}")" -32602 "output.path"
mount -o remount,rw "$scratch/disk"
ask job.resume "{\"id\":$id}" >/dev/null
wait_state "$id" succeeded
stop_daemon
umount "$scratch/disk"

# A store on a full disk: a submit is refused with the cause, nothing is handed out, and all goes on when there is room.
store_is()
{
    [ "$(ask daemon.status | jq -r .result.store.state)" = "$1" ]
}
fill_disk()
{
    dd if=/dev/zero of="$scratch/disk/filler" bs=1k oflag=append conv=notrunc 2>/dev/null
}
# fill_store: until the reserve is given up.
fill_store()
{
    fill_disk
    for n in $(seq 60); do
        store_is short && return
        ask job.submit "{\"paused\":true,\"document\":$(jq -c --arg n "$RANDOM$n" '.output.path = "f" + $n + "/x.####.exr"' <<<"$big")}" >/dev/null
    done
    fail "the store is not full"
}
mount -t tmpfs -o size=600k tmpfs "$scratch/disk"
start_daemon --worker-program "$(stub write:0)" --state "$scratch/disk/state"
big=$(job 1 '.name = ("x" * 100) | .lights = [range(12) as $i | .lights[0]]')
waiting=$(submit "$(job 1-9 '.output.path = "waiting/w.####.exr"')" true)
fill_store
expect_error "$(ask job.submit "{\"document\":$big}")" 4 "the disk of $scratch/disk/state is full"
ask job.resume "{\"id\":$waiting}" >/dev/null
expect "a job that waits for room" "$(field "$waiting" '[.state, .running, .reason] | join(" ")')" \
    "queued 0 store: the disk of $scratch/disk/state is full: what is in flight is stored, nothing new is begun until there is room"
expect "files while the disk is full" "$(find "$scratch/out/waiting" -type f)" ""
# Killed in the middle, with the reserve given up and the disk full.
fill_disk
kill_daemon
"$bin/notify-listener" "$scratch/notify" >"$scratch/notes" &
wait_until "the manager listens" test -S "$scratch/notify"
NOTIFY_SOCKET=$scratch/notify "$bin/marchd" --state "$scratch/disk/state" --socket "$socket" --workers 2 \
    --output-root "$scratch/out" --input-root / --worker-program "$(stub write:0)" 2>>"$scratch/daemon.log" &
daemon_pid=$!
wait_until "the start waits for room or has begun nothing" eval \
    'grep -q "EXTEND_TIMEOUT_USEC=" "$scratch/notes" || store_is short || store_is failing'
rm "$scratch/disk/filler"
wait_state "$waiting" succeeded
expect_files waiting 9
wait_until "it takes jobs again" eval 'ask job.submit "{\"paused\":true,\"document\":$big}" | grep -q result'
stop_daemon

# Frames that were in hand before the disk was full are rendered after, and wait as part files. Whether the daemon is killed
# then or stopped, and even where a part file is lost, they are published once when there is room. The stub takes no part
# files over: its frames are rendered again.
for signal in KILL TERM; do
    start_daemon --worker-program "$(stub write:200000)" --state "$scratch/disk/state"
    ids=()
    for name in kept lost; do
        ids+=("$(submit "$(job 1 ".output.path = \"$signal/$name.####.exr\" | .output.existing = \"fail\"")")")
        wait_until "its frame is in hand" eval '[ "$(field "${ids[-1]}" .running)" = 1 ]'
    done
    fill_store
    fill_disk
    mapfile -t workers < <(ask worker.list | jq '.result.workers[].pid')
    kill -USR1 "${workers[@]}"
    wait_until "both files are written" eval '[ "$(find "$scratch/out/$signal" -name "*.part" | wc -l)" = 2 ]'
    wait_until "nothing is stored" store_is failing
    for id in "${ids[@]}"; do
        expect_error "$(ask job.cancel "{\"id\":$id}")" 3 "succeeds in a moment"
    done
    status=0
    kill "-$signal" "$daemon_pid"
    wait "$daemon_pid" 2>/dev/null || status=$?
    [ "$signal" = KILL ] || expect "the status of a daemon that leaves changes behind" "$status" 1
    rm "$scratch/out/$signal"/lost*.part
    expect "part files that stay, and pictures" "$(find "$scratch/out/$signal" -type f | sed 's/.*\.//' | xargs)" part
    rm "$scratch/disk/filler"
    start_daemon --worker-program "$(stub write:0)" --state "$scratch/disk/state"
    for id in "${ids[@]}"; do
        wait_state "$id" succeeded
    done
    wait_until "no part file stays" eval '[ -z "$(find "$scratch/out/$signal" -name "*.part")" ]'
    expect_files "$signal" 2
    stop_daemon
done
