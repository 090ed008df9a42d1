#!/bin/sh
# A sequence of sparse grids: a bad file fails only its own frame, and OpenVDB files give the same picture.
set -u
PATH=$PROGRAM_FOLDER:$PATH
scratch=$(mktemp -d "${TMPDIR:-/tmp}/smoke_test.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1
unset MARCH_WORKER
. "$PROJECT_ROOT/tests/process/march.sh"

cp "$PROJECT_ROOT/jobs/smoke.json" .
mkdir smoke
cp "$PROJECT_ROOT"/jobs/smoke/smoke.000[3-7].nvdb smoke

# render CODE FOLDER FRAMES [OPTION...]: renders the job's frames and expects that exit code.
render() {
    code=$1
    folder=$2
    frames=$3
    shift 3
    expect "$code" march render smoke.json --set 'resolution=[32,18]' --set output.pixel=float \
        --set 'quality={"method":"midpoint","step_voxels":1,"light_step_voxels":2}' --frames "$frames" \
        --out "$folder/####.exr" "$@"
}

# same A B: the pictures are equal bit for bit.
same() { [ "$(exr-compare "$1" "$2")" = "$(exr-compare "$1" "$1")" ] || fail "$1 and $2 differ: $(exr-compare "$1" "$2")"; }

render 0 whole 3-7
[ "$(ls whole | wc -l)" -eq 5 ] || fail "expected five frames"
! exr-compare whole/0003.exr whole/0004.exr | grep -q '^0 0' || fail "frames 3 and 4 show the same"

# The frames are in another order, and one file, which is read ahead while the frame before it is rendered, is cut
# short.
head -c 20000 smoke/smoke.0005.nvdb >cut
mv cut smoke/smoke.0005.nvdb
render 1 holed 7,4,5,6,3
[ "$(ls holed | tr '\n' ' ')" = "0003.exr 0004.exr 0006.exr 0007.exr " ] || fail "expected all but frame 5, got $(ls holed)"
grep -F smoke.0005.nvdb err | grep -qF 'cut short' || fail "expected the name of the file that is cut short"
! grep -qF smoke.0004.nvdb err || fail "frame 4 is blamed for another's file"
for frame in 3 4 6 7; do same "whole/000$frame.exr" "holed/000$frame.exr"; done
cp "$PROJECT_ROOT/jobs/smoke/smoke.0005.nvdb" smoke

render 2 gone 3-8
grep -qF smoke.0008.nvdb err || fail "expected the name of the file that is not there"
render 1 cold 4 --set 'scene.media[0].blackbody.grid="heat"'
grep -qF 'no grid is named "heat"; there are "density" (float), "temperature" (float)' err || fail "expected what grids there are"

if command -v nanovdb_convert >/dev/null; then
    nanovdb_convert smoke/smoke.0004.nvdb smoke/smoke.0004.vdb >/dev/null 2>&1
    render 0 openvdb 4 --set 'scene.media[0].density.file="smoke/smoke.####.vdb"'
    same whole/0004.exr openvdb/0004.exr
    mkdir programs
    with_converter=$PATH
    for program in timeout ls grep cat; do ln -s "$(command -v $program)" programs; done
    PATH=$PROGRAM_FOLDER:$scratch/programs
    render 1 hint 4 --set 'scene.media[0].density.file="smoke/smoke.####.vdb"'
    grep -qF 'install libnanovdb-tools' err || fail "expected a hint what to install"
    PATH=$with_converter
else
    echo "nanovdb_convert is not installed: OpenVDB files are not tried"
fi
exit $((failures > 0))
