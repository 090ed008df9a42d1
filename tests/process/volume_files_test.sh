#!/bin/sh
# Bad volume files: `march render` names the file and the member of the job, and leaves no files behind.
set -u
PATH=$PROGRAM_FOLDER:$PATH
scratch=$(mktemp -d "${TMPDIR:-/tmp}/volume_files_test.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
unset MARCH_WORKER
. "$PROJECT_ROOT/tests/process/march.sh"
seeds=$PROJECT_ROOT/tests/fuzz/seeds

last=1
# job FILE [KEYS]: writes job.json, which shows that volume.
job() {
    cat >job.json <<JSON
{ "version": 1, "name": "scan", "frames": "0-$last", "fps": 24, "resolution": [16, 9],
  "camera": { "position": { "orbit": { "center": [0, 0, 0], "axis": [0, 0, 1], "radius": 4, "period": 5 } },
              "target": [0, 0, 0], "up": [0, 0, 1], "fov": 30 },
  "scene": { "media": [ { "density": { "kind": "grid", "file": "$1"${2+, $2} }, "emission": 1 } ] },
  "quality": { "method": "midpoint", "step": 0.1 },
  "output": { "path": "pictures/scan.####.exr", "pixel": "half" } }
JSON
}

# refuse CODE FILE WORDS [KEYS]: CODE is 2 where the job itself is refused, 1 where its frames fail.
refuse() {
    wanted=$1
    file=$2
    words=$3
    shift 3
    job "$file" "$@"
    expect "$wanted" march render job.json
    grep -F "$file" err | grep -F 'scene.media[0].density.file: ' | grep -qF "$words" || fail "$file: expected its place and \"$words\""
    [ -z "$(ls pictures 2>/dev/null)" ] || fail "$file: left behind: $(ls pictures)"
    rm -rf pictures
}

# Good files render, so that the refusals below have their own reasons.
cp "$seeds/volume_nifti/version_1" good.nii
cp "$seeds/volume_nifti/gzip" good.nii.gz
cp "$seeds/volume_nrrd/raw" good.nrrd
head -c 60 /dev/zero >good_5x4x3xuint8.raw
for file in good.nii good.nii.gz good.nrrd good_5x4x3xuint8.raw; do
    job "$file"
    expect 0 march render job.json
    [ "$(ls pictures | wc -l)" -eq 2 ] || fail "$file: expected two frames"
    rm -rf pictures
done

# NanoVDB's own converter quantises a grid and packs it with Blosc: the picture hardly changes.
nanovdb_convert -f "$PROJECT_ROOT/jobs/smoke/smoke.0010.nvdb" smoke.vdb >/dev/null || fail "nanovdb_convert"
for options in '' '-b --fp8' '--fpN'; do
    # shellcheck disable=SC2086 # several options
    nanovdb_convert -f $options smoke.vdb packed.nvdb >/dev/null || fail "nanovdb_convert $options"
    job packed.nvdb '"grid": "density"'
    expect 0 march render job.json --frames 0
    [ -e first.exr ] || mv pictures/scan.0000.exr first.exr
    [ ! -e pictures/scan.0000.exr ] || exr-compare first.exr pictures/scan.0000.exr | awk '{ exit !($1 < 0.01 && $1 > 0) }' ||
        fail "nanovdb_convert $options: expected nearly the same picture"
    rm -rf pictures
done

refuse 2 gone.nii 'No such file or directory'
head -c 400 good.nii >short.nii
refuse 1 short.nii 'expected 5 x 4 x 3 voxels of uint8, 60 bytes, got 48 bytes'
head -c 100 good.nii >header.nii
refuse 1 header.nii 'ends after 100 bytes'
: >empty.nii
refuse 1 empty.nii 'ends after 0 bytes'
{ cat good.nii && echo; } >long.nii
refuse 1 long.nii '60 bytes, got 61 bytes'
head -c 120 good.nii.gz >cut.nii.gz
refuse 1 cut.nii.gz 'its gzip data end before they are complete'
# Each frame has a file of its own, and there are more frames than a worker gets at once: each fails by itself, and the
# command ends.
last=5
for frame in 0 1 2 3 4 5; do cp cut.nii.gz "cut.$frame.nii.gz"; done
job cut.#.nii.gz
expect 1 march render job.json
[ "$(grep -c 'frame [0-5] failed: .*/cut.[0-5].nii.gz: its gzip data end' err)" -eq 6 ] || fail "each frame's own file"
rm -rf pictures
# One cut file for all frames, which nobody has written to for a while, stays cut: the other frames are not tried.
sleep 2.5
refuse 1 cut.nii.gz 'frame 0 failed: '
! grep -q 'frame 1 failed' err || fail "a cut file fails the job at once"
last=1
{ head -c 137 good.nii.gz && printf 'wrong' && tail -c 3 good.nii.gz; } >damaged.nii.gz
refuse 1 damaged.nii.gz 'damaged'
{ cat good.nii.gz && echo more; } >followed.nii.gz
refuse 1 followed.nii.gz 'got something else'
cp good.nii named.nii.gz
refuse 1 named.nii.gz 'no gzip data'
mkdir folder.nrrd
refuse 2 folder.nrrd 'expected a file, got a folder or a device'
mkfifo pipe.nrrd
refuse 2 pipe.nrrd 'expected a file, got a folder or a device'
sed 's/sizes: 5 4 3/sizes: 5 0 3/' good.nrrd >zero.nrrd
refuse 1 zero.nrrd 'sizes: expected at least 1 voxel along j, got 0'
sed 's/spacings: 1 2 3/spacings: 1 -2 3/' good.nrrd >negative.nrrd
refuse 1 negative.nrrd 'spacings: expected 3 numbers above 0, got "1 -2 3"'
sed 's/sizes: 5 4 3/sizes: 4096 1024 512/' good.nrrd >huge.nrrd
refuse 1 huge.nrrd 'sizes: expected fewer than 2^31 voxels'
head -c 61 /dev/zero >wrong_5x4x3xuint8.raw
refuse 1 wrong_5x4x3xuint8.raw '60 bytes, got 61 bytes, skip_bytes 1 would fit'
refuse 1 good_5x4x3xuint8.raw 'expected 5 x 4 x 3 voxels of uint16, 120 bytes, got 60 bytes' '"type": "uint16"'
{ head -c 28 /dev/zero && printf '\000\000\300\177'; } >nan_2x2x2xfloat32.raw
refuse 1 nan_2x2x2xfloat32.raw 'voxel (1, 1, 1) is no finite number'

if [ "$(id -u)" -ne 0 ]; then
    cp good.nii secret.nii
    chmod 000 secret.nii
    refuse 2 secret.nii 'Permission denied'
fi

[ "$failures" -eq 0 ] || { echo "$failures failed"; exit 1; }
