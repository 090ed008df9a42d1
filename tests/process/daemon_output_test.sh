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

# A store on a full disk: a submit is refused with the cause, and accepted when there is room.
mount -t tmpfs -o size=600k tmpfs "$scratch/disk"
start_daemon --worker-program "$(stub skip)" --state "$scratch/disk/state"
dd if=/dev/zero of="$scratch/disk/filler" bs=1k 2>/dev/null
big=$(job 1 '.name = ("x" * 100) | .lights = [range(12) as $i | .lights[0]]')
for _ in $(seq 60); do
    answer=$(ask job.submit "{\"paused\":true,\"document\":$(jq -c --arg n "$RANDOM$RANDOM" '.output.path = "f" + $n + "/x.####.exr"' <<<"$big")}")
    [ "$(jq 'has("error")' <<<"$answer")" = true ] && break
done
expect_error "$answer" 4 ""
rm "$scratch/disk/filler"
wait_until "it takes jobs again" eval 'ask job.submit "{\"paused\":true,\"document\":$big}" | grep -q result'
stop_daemon

# Jobs canceled while their only frame is being published: a restart does not change their state.
fill_store()
{
    dd if=/dev/zero of="$scratch/disk/filler" bs=1k 2>/dev/null
    for n in $(seq 60); do
        ask job.submit "{\"paused\":true,\"document\":$(jq -c ".output.path = \"fill$n/x.####.exr\"" <<<"$big")}" | grep -q '"code":4' && return
    done
    fail "the store is not full"
}
start_daemon --worker-program "$(stub write:0)" --state "$scratch/disk/state"
named=$(submit "$(job 1 '.output.path = "named/n.####.exr"')" true)
lost=$(submit "$(job 1 '.output.path = "lost/l.####.exr"')" true)
fill_store
for id in "$named" "$lost"; do
    expect_error "$(ask job.resume "{\"id\":$id}")" 4 ""
done
wait_until "both files are written" eval '[ "$(find "$scratch/out" -name "*.part" | wc -l)" = 2 ]'
for id in "$named" "$lost"; do
    expect_error "$(ask job.cancel "{\"id\":$id}")" 4 ""
done
rm "$scratch/out/lost/"*.part "$scratch/disk/filler"
wait_until "both are done with" eval '[ "$(field "$named" .running)$(field "$lost" .running)" = 00 ]'
expect "a canceled job whose frame got its name" "$(field "$named" '[.state, .succeeded] | join(" ")')" "canceled 1"
expect "a canceled job whose frame was lost" "$(field "$lost" '[.state, .canceled] | join(" ")')" "canceled 1"
stop_daemon
start_daemon --worker-program "$(stub write:0)" --state "$scratch/disk/state"
expect "the first after a restart" "$(field "$named" '[.state, .succeeded] | join(" ")')" "canceled 1"
expect "the second after a restart" "$(field "$lost" '[.state, .canceled] | join(" ")')" "canceled 1"
expect_files named 1
expect_files lost 0
stop_daemon
