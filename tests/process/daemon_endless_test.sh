#!/bin/bash
# GLSL of the user that does not end: the attempt ends at a time limit and fails its frame, not the job's other
# frames, other jobs or workers.
. "$(dirname "$0")/farm.sh"

cat >"$scratch/endless.glsl" <<'GLSL'
#define SIN_16(x) sin(sin(sin(sin(sin(sin(sin(sin(sin(sin(sin(sin(sin(sin(sin(sin(x))))))))))))))))

float density(vec3 p, float t)
{
    float sum = 0.0;
    if (t > FROM) // as good as endless: minutes a picture, whatever the driver does about long loops
        for (int i = 0; i < 60000; ++i) sum += SIN_16(SIN_16(sum + p.x));
    return 0.8 + 1e-9 * sum - length(p);
}
GLSL

# endless NAME FRAMES FROM: prints a job document whose frames (a second each) do not end after FROM.
endless()
{
    jq -c --arg name "$1" --arg frames "$2" --rawfile text "$scratch/endless.glsl" --arg from "$3" '
        .name = $name | .frames = $frames | .fps = 1 | .resolution = [640, 180] | .output.path = $name + ".####.exr" |
        .scene.media[0].density = { kind: "glsl", file: "/farm/endless.glsl", source: ($text | sub("FROM"; $from)),
            lipschitz: 1, bounds: { kind: "sphere", center: [0, 0, 0], radius: 1 } } | del(.camera.clip) |
        .quality = { method: "midpoint", step: 0.1, light_step: 0.2 }' "$PROJECT_ROOT/jobs/cloud.json"
}

# Only what does not end may reach the limit: eight times what a frame takes here and now, the worker's start with it.
endless short 0 9 | jq 'del(.scene.media[0].density.file)' >"$scratch/short.json"
begun_ms=$(date +%s%3N)
"$bin/march" render "$scratch/short.json" --backend software --out "$scratch/short.####.exr" >"$scratch/said" 2>&1 || fail "a frame that ends: $(cat "$scratch/said")"
limit_s=$((($(date +%s%3N) - begun_ms) * 8 / 1000))
[ $limit_s -ge 4 ] || limit_s=4
echo "limit: $limit_s s"
start_daemon --backend software --progress-limit $limit_s --max-attempts 3
started=$SECONDS
one=$(submit "$(endless one 0-3 2.5)")
other=$(submit "$(job 0-11)")
wait_state "$one" failed
wait_state "$other" succeeded
expect "frames that were made" "$(field "$one" .succeeded)" 3
expect "frames that failed" "$(field "$one" .failed)" 1
frames=$(ask job.frames "{\"id\":$one,\"state\":[\"failed\"]}")
expect "the frame" "$(jq -c '[.result.frames[] | select(.state == "failed") | .frame]' <<<"$frames")" "[3]"
expect "tries it had" "$(jq -c '[.result.frames[] | select(.state == "failed") | .attempts]' <<<"$frames")" "[1]"
jq -r '.result.frames[] | select(.state == "failed") | .error' <<<"$frames" |
    grep -qF "no progress for $limit_s s: does density in endless.glsl end?" || fail "the reason: $frames"

# Both slots have workers again, which render.
again=$(submit "$(job 20-31)")
wait_state "$again" succeeded
wait_until "two workers are ready" eval '[ "$(ask worker.list | jq "[.result.workers[] | select(.state == \"idle\")] | length")" = 2 ]'

# No frame waits behind a frame of another job whose duration is unknown.
alone=$(submit "$(endless alone 0 -1)")
wait_until "it is begun" eval '[ "$(field "$alone" .state)" = running ]'
other=$(submit "$(job 40-41)")
wait_state "$other" succeeded
expect "the endless one, after the other job" "$(field "$alone" .state)" running
wait_state "$alone" failed

# A loop without an end fails its frame in one attempt: Mesa 22 cuts it itself, at once, Mesa 25 leaves it to the time limit.
cut=$(submit "$(endless cut 0-3 9 | jq -c '.scene.media[0].density.source = "float density(vec3 p, float t)\n{\n    float sum = 0.0;\n    if (t > 1.5 && t < 2.5) while (sum >= 0.0) sum += 1.0;\n    return 0.8 + 1e-9 * min(sum, 1.0) - length(p);\n}\n"')")
wait_state "$cut" failed
expect "frames beside the cut one" "$(field "$cut" .succeeded)" 3
expect "why the job failed" "$(field "$cut" .reason)" "1 of its frames failed"
frames=$(ask job.frames "{\"id\":$cut,\"state\":[\"failed\"]}")
expect "the cut frame" "$(jq -c '[.result.frames[] | select(.state == "failed") | [.frame, .attempts]]' <<<"$frames")" "[[2,1]]"
grep -qE "more iterations of its loops|no progress for $limit_s s" <<<"$frames" || fail "the reason: $frames"

# When no frame ends, the job is failed after three.
all=$(submit "$(endless all 0-99 -1)")
wait_state "$all" failed
field "$all" .reason | grep -qF "does density in endless.glsl end?" || fail "the job's reason: $(field "$all" .reason)"
[ "$(ask job.frames "{\"id\":$all}" | jq '[.result.frames[].attempts] | add')" -le 5 ] || fail "too many frames were tried"
expect "leftovers" "$(find "$scratch/out" -name '*.part' | wc -l)" 0
echo "took $((SECONDS - started)) s"
stop_daemon

# march render, without a daemon.
endless here 0-2 1.5 | jq 'del(.scene.media[0].density.file)' >"$scratch/here.json"
cd "$scratch" || exit 1
status=0
"$bin/march" render here.json --backend software --progress-limit $limit_s >said 2>complaints || status=$?
expect "the exit status" "$status" 1
expect "its files" "$(echo here.*.exr)" "here.0000.exr here.0001.exr"
grep -qF "frame 2 failed: no progress for $limit_s s: does density in density.source end?" complaints || fail "its words: $(cat complaints)"
