#!/bin/bash
# A worker can read the files of its job and no others: a hostile job's file is refused with a reason, and other jobs
# render.
. "$(dirname "$0")/farm.sh"
mkdir -p "$scratch/in/ann" "$scratch/in/bob" "$scratch/out"
head -c 60 /dev/zero >"$scratch/in/ann/good_5x4x3xuint8.raw"
cp "$scratch/in/ann/good_5x4x3xuint8.raw" "$scratch/in/bob/secret.raw"
cp "$scratch/in/ann/good_5x4x3xuint8.raw" "$scratch/in/bob/secret_5x4x3xuint8.raw"
ln -s "$scratch/state" "$scratch/in/ann/store"
printf "NRRD0004\ntype: uint8\ndimension: 3\nsizes: 5 4 3\nencoding: raw\nendian: little\ndata file: %s\n" \
    "$scratch/in/bob/secret.raw" >"$scratch/in/ann/spy.nhdr"

# scan FILE NAME: prints a job that shows that volume.
scan()
{
    jq -nc --arg file "$1" --arg name "$2" '
        { version: 1, name: $name, frames: "0-1", fps: 24, resolution: [16, 9],
          camera: { position: [0, 0, 4], target: [0, 0, 0], fov: 30 },
          scene: { media: [ { density: { kind: "grid", file: $file }, sigma_a: 0, emission: 1 } ] },
          quality: { method: "midpoint", step: 0.1 }, output: { path: ($name + "/f.####.exr"), pixel: "half" } }'
}

# served FIELD: the field's values of all workers that have rendered.
served()
{
    ask worker.list | jq -r "[.result.workers[] | select(.done > 0) | .$1 | tostring] | unique | join(\" \")"
}

start_daemon --backend software --input-root "$scratch/in" --workers 1
id=$(submit "$(scan "$scratch/in/ann/good_5x4x3xuint8.raw" good)")
wait_state "$id" succeeded
expect_files good 2
held=$(served sandbox) first=$(served pid)
[[ $held == "landlock "*", seccomp" || $held == "seccomp, "*landlock* ]] || fail "a worker with a job's files is held by \"$held\""

# Another job of the same owner is served by the same process if it reads and writes in folders of the fence, and by another
# one if it does not.
id=$(submit "$(scan "$scratch/in/ann/good_5x4x3xuint8.raw" good | jq -c '.output.path = "good/g.####.exr"')")
wait_state "$id" succeeded
expect_files good 4
expect "the process of a job within the fence" "$(served pid)" "$first"
id=$(submit "$(scan "$scratch/in/bob/secret_5x4x3xuint8.raw" good | jq -c '.output.path = "good/h.####.exr"')")
wait_state "$id" succeeded
expect_files good 6
[ "$(served pid)" != "$first" ] || fail "the worker of the first job has read what its fence does not open"
stop_daemon

# A job that exceeds the memory limit fails and names the limit.
if grep -q __asan_init "$bin/march-worker"; then
    echo "sanitizers need more memory than there would be: not tried"
else
    start_daemon --backend software --workers 1 --worker-memory 512M --max-attempts 1
    bomb=$(submit "$(job 1 '.scene.media[0].density = { kind: "glsl", file: "/bomb.glsl", lipschitz: 1, bounds: { kind: "sphere", radius: 1 },
        source: "#define A(x) x + x + x + x + x + x + x + x\n#define B(x) A(A(A(x)))\nfloat density(vec3 p, float t) { return B(B(B(p.x))); }\n" } |
        del(.camera.clip) | .output.path = "bomb/b.####.exr"')")
    wait_state "$bomb" failed
    said=$(ask job.log "{\"id\":$bomb}" | jq -r '.result.attempts[].log')
    [[ $said == *"out of memory: a worker may have 0.5 GiB (worker-memory)"* ]] || fail "the reason: $said"
    stop_daemon
    rm "$scratch/daemon.log" # the limit is worth a warning
fi

if [[ $held != landlock* ]]; then
    echo "this kernel has no Landlock: what a worker reads is not tried"
    exit 77
fi
start_daemon --backend software --input-root "$scratch/in"

# The header is a file of the job; the file that the header names is not.
spy=$(submit "$(scan "$scratch/in/ann/spy.nhdr" spy)")
wait_state "$spy" failed
ask job.frames "{\"id\":$spy}" | jq -r '.result.frames[].error' | grep -q 'Permission denied' ||
    fail "the reason: $(field "$spy" .reason) $(ask job.frames "{\"id\":$spy}")"
expect_files spy 0

# The slot of the refused job's worker serves the next job without trouble.
other=$(submit "$(scan "$scratch/in/ann/good_5x4x3xuint8.raw" after)")
wait_state "$other" succeeded
expect "workers in trouble" "$(ask worker.list | jq '[.result.workers[] | select(.reason != null)] | length')" 0
grep -q 'warning: worker' "$scratch/daemon.log" && fail "a change of jobs is no warning"
stop_daemon
# The same job renders without the sandbox: no other check refused it.
start_daemon --backend software --input-root "$scratch/in" --sandbox no
open=$(submit "$(scan "$scratch/in/ann/spy.nhdr" open)")
wait_state "$open" succeeded
stop_daemon
