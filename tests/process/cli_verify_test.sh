#!/bin/sh
# march verify: defects of a sequence are named, file by file, and give exit code 1.
. "$(dirname "$0")/march.sh"
PATH=$PROGRAM_FOLDER:$PATH
scratch=$(mktemp -d)
trap 'rm -rf "$scratch"' EXIT
cd "$scratch" || exit 1

# sequence FOLDER LAST: makes frames 0 to LAST without defects.
sequence() {
    rm -rf "$1"
    mkdir "$1"
    for frame in $(seq 0 "$2"); do
        exr-make "$1/a.000$frame.exr" "frame=$frame" "error=0.00$frame"
    done
}
# says TEXT...: checks that each text was printed.
says() {
    for text; do
        grep -qF -- "$text" out || fail "expected \"$text\""
    done
}

sequence good 5
expect 0 march verify good
[ "$(cat out)" = "a.####.exr: 6 files, frames 0-5; worst error 0.5 % (95 %: below 0.75 %) of 1 % in a.0005.exr; all well" ] || fail "the summary"
expect 0 march verify good --json
grep -q '^{"folder":".*/good","good":true,"being_written":0,"sequences":\[{"pattern":"a.####.exr","good":true,"files":6,"frames":"0-5","wrong":0,"missed":0,"missing":0,"missing_frames":"","drafts":0,"unmeasured":0,"worst_error":0.005,"worst_error95":0.0075,"worst_file":"a.0005.exr"}\],"files":\[{"file":"a.0000.exr","frame":0,"wrong":null,"tolerance":0.01,"audit":"reference","measured_error":0,' out || fail "--json"
expect 0 march verify good --tolerance 0.005
expect 1 march verify good --tolerance 0.0049
says "a.0005.exr  marchd:error: expected at most 0.0049 (tolerance), got 0.005" "1 wrong, 0 missing"
[ "$(wc -l <out)" -eq 3 ] || fail "one file alone is over the given tolerance"

# What the modelled orders of scattering leave out is no defect: the largest of the sequence is told.
exr-make good/a.0002.exr frame=2 error=0.002 beyond=0.6
exr-make good/a.0003.exr frame=3 error=0.003 beyond=0.8
expect 0 march verify good
[ "$(cat out)" = "a.####.exr: 6 files, frames 0-5; worst error 0.5 % (95 %: below 0.75 %) of 1 % in a.0005.exr; the modelled orders of scattering leave out 80 % (95 %: below 100 %); all well" ] || fail "the summary with what is left out"
expect 0 march verify good --json
jq -e '.sequences[0].beyond == {"error": 0.8, "error95": 1} and .files[2].beyond == {"error": 0.6, "error95": 0.75} and (.files[1] | has("beyond") | not)' out >/dev/null ||
    fail "--json with what is left out"
sequence good 5

expect 2 march verify good/a.0000.exr
grep -q "good/a.0000.exr: expected a folder of EXR files or a job file, got an EXR file" err || fail "a picture is no folder"

# Part files are left out and counted.
: >good/a.0006.exr.7.1.1.part
expect 0 march verify good
says "1 file being written (.part) left out"
expect 0 march verify good --json
says '"being_written":1'

sequence bad 9
exr-make bad/a.0000.exr frame=0 tolerance=0
exr-make bad/a.0001.exr frame=1 error=0.0101
exr-make bad/a.0002.exr frame=2 value=nan
exr-make bad/a.0003.exr frame=3 value=inf
truncate -s -40 bad/a.0004.exr
exr-make bad/a.0005.exr frame=5 hash=
exr-make bad/a.0006.exr frame=6 hash=0000000000000000000000000000000f
exr-make bad/a.0007.exr frame=7 width=17
exr-make bad/a.0008.exr frame=9
echo "no image" >bad/a.0009.exr
mkdir bad/a.0010.exr
expect 1 march verify bad
says "a.0000.exr  it has no measured error, other files of the sequence have one" \
    "a.0001.exr  marchd:error: expected at most 0.01 (tolerance), got 0.0101" \
    "a.0002.exr  channel G at pixel (3, 2) is NaN: expected a finite number; of the frame's values 1 are NaN, 0 infinite" \
    "a.0003.exr  channel G at pixel (3, 2) is infinite" \
    "a.0004.exr  line 8: " \
    "a.0005.exr  marchd:jobHash: expected the hash of a picture, got nothing" \
    "a.0006.exr  it is of another job, or of another version of it: 0000000000000000000000000000000f, most files of the sequence have 00000000000000000000000000000001" \
    "a.0007.exr  its size is 17 x 9, most files of the sequence have 16 x 9" \
    "a.0008.exr  its name says frame 8, its header 9" \
    "a.0009.exr  " \
    "a.0010.exr  it is no regular file" \
    "a.####.exr: 11 files, frames 0-10; worst error 1 % (95 %: below 1.5 %) of 1 % in a.0001.exr; 11 wrong, 0 missing"
expect 1 march verify bad --json
[ "$(grep -o '"wrong":"' out | wc -l)" -eq 11 ] || fail "each wrong file has its reason in JSON"

# Frames that read files of their own have different picture hashes; the sequence shares that of the job.
sequence volumes 2
exr-make volumes/a.0001.exr frame=1 picture=0000000000000000000000000000000f
expect 0 march verify volumes

sequence gaps 9
rm gaps/a.0003.exr gaps/a.0005.exr gaps/a.0006.exr
expect 1 march verify gaps
says "a.####.exr  missing: frames 3,5-6" "frames 0-2,4,7-9" "0 wrong, 3 missing"
expect 1 march verify gaps --frames 0-12x2
says "missing: frames 6,10,12"
expect 0 march verify gaps --frames 0-2,9
rm gaps/a.0000.exr gaps/a.0002.exr gaps/a.0004.exr gaps/a.0008.exr
expect 1 march verify gaps
says "frames 1,7,9" "missing: frames 3,5"
expect 1 march verify gaps --json
says '"missing":2,"missing_frames":"3,5"'
rm gaps/a.0007.exr
expect 0 march verify gaps # every eighth

# Several sequences in a folder are separated, even if their names have other numbers too.
sequence many 3
for frame in 0 1 2; do
    exr-make "many/s2_v$frame.0007.exr" frame=7 hash=0000000000000000000000000000000a
    exr-make "many/b$frame.left.exr" "frame=$frame" width=8 hash=0000000000000000000000000000000b
done
rm many/b1.left.exr
exr-make many/b3.left.exr frame=3 width=8 hash=0000000000000000000000000000000b
exr-make many/still.exr hash=0000000000000000000000000000000c
expect 1 march verify many
says "a.####.exr: 4 files, frames 0-3" "b#.left.exr  missing: frame 1" "b#.left.exr: 3 files, frames 0,2-3" \
    "s2_v0.####.exr: 1 file, frames 7" "s2_v2.####.exr: 1 file" "still.exr: 1 file; worst"
[ "$(grep -c 'all well$' out)" -eq 5 ] || fail "five of six are well"
exr-make many/a.3.exr frame=3
expect 1 march verify many
says "frame 3 is there twice"

expect 2 march verify nowhere
expect 2 march verify good --tolerance 0
expect 2 march verify good --frames 3-
expect 2 march verify good --out elsewhere
expect 2 march verify
mkdir empty
expect 1 march verify empty
grep -q "there is no EXR file" err || fail "an empty folder"

# A job determines frames, size, hash and channels; without a tolerance no audit is needed.
cat >job.json <<'JOB'
{ "version": 1, "name": "fog", "frames": "0-3", "fps": 24, "resolution": [16, 9],
  "camera": { "position": [0, 0, -3], "target": [0, 0, 0], "up": [0, 1, 0], "fov": 50, "clip": [1, 6] },
  "lights": [ { "kind": "point", "intensity": 60, "position": { "keys": [[0, [0, 2, 0]], [1, [1, 2, 0]]] } } ],
  "scene": { "media": [ { "density": { "kind": "homogeneous", "bounds": { "kind": "sphere", "center": [0, 0, 0], "radius": 1 } },
    "sigma_s": 1, "sigma_a": 0 } ] },
  "quality": { "method": "midpoint", "step": 0.1, "light_step": 0.1 }, "output": { "path": "fog/fog.####.exr" } }
JOB
expect 1 march verify job.json
says "missing: frames 0-3" "fog.####.exr: 0 files; 0 wrong, 4 missing"
march render job.json --backend software >/dev/null 2>err || fail "render"
expect 0 march verify job.json
says "fog.####.exr: 4 files, frames 0-3; the modelled orders" "; 4 whose error was not measured, for their job states its method; all well"
expect 0 march verify fog
says "fog.####.exr: 4 files, frames 0-3; the modelled orders" "; 4 whose error was not measured, for their job states its method; all well"
march verify - <job.json >out 2>err || fail "a job from standard input"
expect 0 march verify job.json --frames 1-2
says "2 files, frames 1-2"
expect 1 march verify job.json --frames 0-5
says "missing: frames 4-5"
expect 1 march verify job.json --tolerance 0.01
says "fog.0000.exr  marchd:error: expected the frame's measured error, at most 0.01 (tolerance), got nothing" "4 wrong"
expect 1 march verify job.json --set fps=25
says "fog.0000.exr  rendered from an older version of this job (marchd:jobHash: expected"
cp fog/fog.0001.exr fog/fog.0002.exr
expect 1 march verify job.json
says "fog.0002.exr  marchd:frame: expected 2, got 1" "1 wrong, 0 missing"
mv fog moved
expect 1 march verify job.json --out "$PWD/moved/fog.####.exr"
says "1 wrong, 0 missing"
[ ! -e fog ] || fail "verifying makes no folder"
expect 2 march verify job.json --set quality.stp=1

# An existing file is kept, and reports its error, when that is within its tolerance; else it is rendered again.
hash=$(march validate job.json --json | sed 's/.*"hash":"\([0-9a-f]*\)".*/\1/')
exr-make moved/fog.0003.exr frame=3 "hash=$hash" error=0.005
expect 0 march render job.json --backend software --frames 3 --out "$PWD/moved/fog.####.exr"
says "fog.0003.exr  was there already  error 0.5 % (95 %: below 0.75 %)  cached"
expect 0 march render job.json --backend software --frames 3 --out "$PWD/moved/fog.####.exr" --json
says '"audit":"reference","measured_error":0.005,"error95":0.0075,"audit_rays":64,"method":"cached"}'
exr-make moved/fog.0003.exr frame=3 "hash=$hash" error=0.0101
expect 0 march render job.json --backend software --frames 3 --out "$PWD/moved/fog.####.exr"
says "fog.0003.exr  rendered"

# A job with a tolerance is audited: its folder verifies without the job, and with it.
audited() { march "$@" --set 'quality={"tolerance":0.05}'; }
expect 0 audited render job.json --backend software --out "$PWD/kept/fog.####.exr"
[ "$(grep -c 'error .* % (95 %: below ' out)" -eq 4 ] || fail "four frames say how exact they are"
expect 0 march verify kept
says "fog.####.exr: 4 files, frames 0-3; worst error" " of 5 % in fog.000" "; all well"
expect 0 audited verify job.json --out "$PWD/kept/fog.####.exr"
expect 1 march verify kept --tolerance 1e-9
expect 1 march verify job.json --set 'quality={"tolerance":0.04}' --out "$PWD/kept/fog.####.exr"
says "4 wrong" "marchd:jobHash: expected"
expect 0 audited render job.json --backend software --out "$PWD/kept/fog.####.exr" --json
[ "$(grep -o '"state":"skipped".[^}]*"error95"' out | wc -l)" -eq 4 ] || fail "frames that are there tell of their error"

[ "$failures" -eq 0 ]
