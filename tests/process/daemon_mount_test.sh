#!/bin/bash
# The disk of an output root is taken away under frames that run, and mounted again: nothing lands on the folder below it, a
# frame counts only if it is in the root, and fenced workers go on in the new mount.
[ "$(id -u)" = 0 ] || { echo "skip: only root mounts"; exit 77; }
[ "${1-}" = inside ] || { unshare -m true 2>/dev/null || { echo "skip: no mount namespace here"; exit 77; }; exec unshare -m --propagation private "$0" inside; }
. "$(dirname "$0")/farm.sh"

disk=$scratch/disk out=$scratch/out
mkdir "$disk" "$out"
mount -t tmpfs -o size=64m tmpfs "$disk" 2>/dev/null || { echo "skip: no file system can be mounted here"; exit 77; }
mount --bind "$disk" "$out"

start_daemon --worker-program "$(stub write:5)" --output-root "$out"
job=$(submit "$(job 1-800)")
for round in 1 2; do
    wait_until "frames are published" eval '[ "$(field "$job" .succeeded)" -gt $((round * 50)) ]'
    umount -l "$out"
    wait_until "the job waits" eval '[ "$(field "$job" .state)" = paused ]'
    wait_until "no frame runs" eval '[ "$(field "$job" .running)" = 0 ]'
    [[ $(field "$job" .reason) == "paused: output root $out is not the folder that it was, it has no .marchd-root (is its disk mounted?)"* ]] || fail "reason: $(field "$job" .reason)"
    expect "what is below the mount point" "$(ls -A "$out")" ""
    there=$(find "$disk" -name '*.exr' | wc -l)
    [ "$(field "$job" .succeeded)" -le "$there" ] || fail "$(field "$job" .succeeded) frames count, and $there are there"
    mount --bind "$disk" "$out"
done
wait_state "$job" succeeded
expect "files" "$(find "$out" -name '*.exr' | wc -l)" 800
expect "leftovers" "$(find "$out" -name '*.part')" ""
expect "frames that failed" "$(field "$job" .failed)" 0
stop_daemon

# Without its disk the root is not made: the start says so, and the job waits for the disk.
umount "$out"
start_daemon --worker-program "$(stub write:5)" --output-root "$out"
held=$(field "$job" .succeeded)
ask job.retry "{\"id\":$job,\"state\":\"succeeded\",\"range\":\"1-20\"}" >/dev/null
wait_until "the job waits" eval '[ "$(field "$job" .state)" = paused ]'
expect "what is below the mount point" "$(ls -A "$out")" ""
mount --bind "$disk" "$out"
wait_state "$job" succeeded
expect "frames" "$(field "$job" .succeeded)" "$held"

# The real worker, inside its fence: what the kernel opened for it was in the former mount.
stop_daemon
start_daemon --output-root "$out" --backend software
job=$(submit "$(job 1-3 '.output.path = "real/r.####.exr"')")
wait_until "a frame is published" eval '[ "$(field "$job" .succeeded)" -ge 1 ]'
umount -l "$out"
wait_until "the job waits or is over" eval '[[ $(field "$job" .state) =~ paused|succeeded ]]'
mount --bind "$disk" "$out"
wait_state "$job" succeeded
expect "files" "$(find "$out/real" -name '*.exr' | wc -l)" 3
stop_daemon
umount "$out" "$disk"
