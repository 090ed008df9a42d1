#!/bin/bash
# Two mirrors that face each other: no path leaves, all are cut at a limit. A frame that loses too much light fails
# in one attempt and names the limit to raise; existing files must keep the job's max_cut, too.
. "$(dirname "$0")/farm.sh"

# hall NAME FRAMES REFLECTANCE QUALITY: prints a job document; a camera ray is black after max_depth reflections.
hall()
{
    jq -nc --arg name "$1" --arg frames "$2" --argjson reflectance "$3" --argjson quality "$4" '
        { kind: "mirror", reflectance: $reflectance } as $mirror |
        { version: 1, name: $name, frames: $frames, fps: 1, resolution: [40, 30],
          camera: { position: [0, 0, 0], target: [0.1, 0.2, 1], fov: 40 }, background: 1,
          scene: { media: [], objects: [
            { kind: "plane", point: [0, 0, -1], normal: [0, 0, 1], material: $mirror },
            { kind: "plane", point: [0, 0, 1], normal: [0, 0, -1], material: $mirror } ] },
          quality: ({ method: "midpoint", step: 1 } + $quality), output: { path: ($name + "/h.####.exr") } }'
}

# number FILE ATTRIBUTE: the double in the file's header.
number()
{
    LC_ALL=C grep -aPo "marchd:$2\0double\0\x08\0\0\0(?s:.{8})" "$1" | head -c "$((27 + ${#2}))" | tail -c 8 | od -An -tf8 | tr -d ' '
}

# frames_of ID STATE: [[frame, tries]...]
frames_of()
{
    ask job.frames "{\"id\":$1,\"state\":[\"$2\"]}" | jq -c '[.result.frames[] | [.frame, .attempts]]'
}

start_daemon --backend software --max-attempts 3

# The throughput is (1/2)^4 when a path would be reflected for the fourth time.
id=$(submit "$(hall few 0 0.5 '{"max_depth":3}')")
wait_state "$id" failed
expect "its frame" "$(frames_of "$id" failed)" "[[0,1]]"
reason=$(ask job.frames "{\"id\":$id}" | jq -r '.result.frames[0].error')
[[ $reason == *"cut rays may have taken 6.25 % of the light, max_cut allows 1 %; max_depth 3 cut 6.25 %, min_throughput 0.001 cut 0 %"*"expected a larger max_depth, or"* ]] ||
    fail "the reason: $reason"
expect_files few 0
id=$(submit "$(hall dim 0 0.5 '{"max_depth":8,"min_throughput":0.2}')")
wait_state "$id" failed
reason=$(ask job.frames "{\"id\":$id}" | jq -r '.result.frames[0].error')
[[ $reason == *"taken 12.5 % of"*"expected a smaller min_throughput, or"* ]] || fail "the reason: $reason"

# The reason is known when the event of the failed job arrives.
for _ in {1..20}; do
    id=$(submit "$(hall few 0 0.5 '{"max_depth":3}')")
    MARCHD_SOCKET=$socket "$bin/march" wait "$id" >/dev/null 2>&1 && fail "the job did not fail"
    expect "reasons" "$(ask job.frames "{\"id\":$id}" | jq '[.result.frames[] | select(.error)] | length')" 1
done

# When the cut is allowed or small enough, the frame is published; its header holds the cut.
id=$(submit "$(hall few 0 0.5 '{"max_depth":3,"max_cut":1}')")
wait_state "$id" succeeded
expect "rays" "$(number "$scratch/out/few/h.0000.exr" raysPerPixel)" 4
expect "cut rays" "$(number "$scratch/out/few/h.0000.exr" cutRays)" 1
expect "cut share" "$(number "$scratch/out/few/h.0000.exr" cutShare)" 0.0625
expect "tolerance" "$(number "$scratch/out/few/h.0000.exr" cutTolerance)" 1
id=$(submit "$(hall deep 0 0.5 '{"max_depth":6}')")
wait_state "$id" succeeded
expect "rays of the deep one" "$(number "$scratch/out/deep/h.0000.exr" raysPerPixel)" 7
expect "its share" "$(number "$scratch/out/deep/h.0000.exr" cutShare)" 0.0078125

# max_cut changes no pixel: a file within it is kept, a file beyond it is rendered again.
id=$(submit "$(hall few 0 0.5 '{"max_depth":3,"max_cut":0.0625}')")
wait_state "$id" succeeded
expect "frames kept" "$(field "$id" .skipped)" 1
id=$(submit "$(hall few 0 0.5 '{"max_depth":3,"max_cut":0.0624}')")
wait_state "$id" failed
expect "the frame that was there" "$(frames_of "$id" failed)" "[[0,1]]"
ask job.log "{\"id\":$id}" | jq -r '.result.attempts[].log' |
    grep -q "h.0000.exr is rendered again: marchd:cutShare: expected at most 0.0624" || fail "why it was rendered again"

# Only frames that lose too much fail; copies of a frame that passes do not.
id=$(submit "$(hall some 0-5 '{"keys":[[0,0.25],[2,0.5],[4,0.25]],"interpolation":"hold"}' '{"max_depth":3}')")
wait_state "$id" failed
expect "frames that failed" "$(frames_of "$id" failed)" "[[2,1],[3,1]]"
expect "frames that were made" "$(field "$id" .succeeded)" 4
expect "why the job failed" "$(field "$id" .reason)" "2 of its frames failed"
for frame in 0 1 4 5; do
    expect "share of frame $frame" "$(number "$scratch/out/some/h.000$frame.exr" cutShare)" 0.00390625
done

# When all frames fail, the job is failed.
id=$(submit "$(hall all 0-199 0.5 '{"max_depth":3}')")
wait_state "$id" failed
field "$id" .reason | grep -qF "expected a larger max_depth" || fail "the job's reason: $(field "$id" .reason)"
ask job.log "{\"id\":$id}" | jq -r '.result.attempts[].log' | grep "is rendered again" && fail "what another job's attempt said"
tries=$(ask job.frames "{\"id\":$id}" | jq '[.result.frames[].attempts] | add')
[ "$tries" -lt 20 ] || fail "too many frames were tried: $tries"
expect "leftovers" "$(find "$scratch/out" -name '*.part' | wc -l)" 0
stop_daemon

# march render, without a daemon.
cd "$scratch" || exit 1
hall here 0-1 0.5 '{"max_depth":3}' >here.json
status=0
"$bin/march" render here.json --backend software >said 2>complaints || status=$?
expect "the exit status" "$status" 1
grep -qF "frame 1 failed: quality: cut rays may have taken 6.25 % of the light" complaints || fail "its words: $(cat complaints)"
"$bin/march" render here.json --backend software --set quality.max_cut=1 >said 2>complaints || fail "$(cat complaints)"
grep -q '^here/h.0001.exr  rendered .* s  encoded .* s  cut 6.25 %$' said || fail "what it says: $(cat said)"
"$bin/march" render here.json --backend software --set quality.max_cut=1 --set 'output.path="again/h.####.exr"' --json >said || fail "again"
expect "in JSON" "$(jq -c '[.frames[].cut_share]' said)" "[0.0625,0.0625]"
