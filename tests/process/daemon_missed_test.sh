#!/bin/bash
# Frames that no setting keeps within the tolerance: they fail, or are published and marked where the job asks for it.
. "$(dirname "$0")/farm.sh"

# shell NAME MORE: a job whose code promises too low a lipschitz, so that no steps find its shell; MORE is added to its quality.
shell()
{
    jq -c --arg name "$1" --argjson more "$2" '
        .name = $name | .frames = "0-1" | .resolution = [48, 32] | .output.path = $name + "/s.####.exr" |
        .camera = { position: [0, 0, 4], target: [0, 0, 0], fov: 40 } |
        .lights = [{ kind: "point", intensity: 10, position: [2, 3, 2] }] |
        .scene.media = [{ sigma_s: 1, density: { kind: "glsl", lipschitz: 2, bounds: { kind: "sphere", radius: 1 }, source:
            "float density(vec3 p, float t) { return 20.0 * (0.12 - abs(length(p) - 0.7)); }" } }] |
        .quality = { tolerance: 0.05 } + $more' "$PROJECT_ROOT/jobs/cloud.json"
}

told='"on_miss":"publish"'
start_daemon --backend software --workers 1
cd "$scratch" || exit 1
id=$(submit "$(shell fails '{}')")
wait_state "$id" failed
reason=$(ask job.frames "{\"id\":$id}" | jq -r '.result.frames[0].error')
[[ $reason == *"expected an error of at most 0.05, got "*" at best, by "*"renderings had"*"lipschitz too low"*'"on_miss": "publish"'* ]] ||
    fail "the reason: $reason"
[ ! -e "$scratch/out/fails/s.0000.exr" ] || fail "a frame over its tolerance is there"

status=0
shell kept "{$told}" >kept.json
"$bin/march" submit kept.json --watch --socket "$socket" >said 2>&1 || status=$?
expect "the status of submit --watch" "$status" 1
id=2
counts_of()
{
    ask job.show "{\"id\":$id}" | jq -c '.result | [.succeeded, .failed, .missed, .reason]'
}
expect "the job" "$(counts_of)" '[2,0,2,"2 of its frames missed the tolerance"]'
expect "its tolerance" "$(field "$id" .tolerance)" 0.05
expect "its frames" "$(ask job.frames "{\"id\":$id}" | jq -c '[.result.frames[] | [.missed, .measured_error > 0.05]]')" '[[true,true],[true,true]]'
expect "the map of its frames" "$(ask job.frame_map "{\"id\":$id}" | jq -c '.result | [.states, (.errors[] > 0.05), (.seconds[] > 0)]')" \
    '["mm",true,true,true,true]'
"$bin/march" list --socket "$socket" | grep -q "MISSED" || fail "the titles of march list"
"$bin/march" show "$id" --socket "$socket" | grep -q "2 succeeded, 2 over the tolerance" || fail "march show"
stop_daemon

# The next daemon counts them from the store, and a job that finds the files counts them too.
start_daemon --backend software --workers 1
expect "after a restart" "$(counts_of)" '[2,0,2,"2 of its frames missed the tolerance"]'
id=$(submit "$(shell kept "{$told}")")
wait_state "$id" succeeded
expect "found" "$(ask job.show "{\"id\":$id}" | jq -c '.result | [.skipped, .missed]')" '[2,2]'
# A job that fails such frames does not keep their files.
id=$(submit "$(shell kept '{}')")
wait_state "$id" failed
stop_daemon

# Here and now: the exit status is 1, and verify names the frames.
status=0
shell here "{$told}" >here.json
"$bin/march" render here.json --backend software --json >said 2>complaints || status=$?
expect "the exit status" "$status" 1
expect "what render says" "$(jq -c '[.succeeded, .failed, .missed, .frames[1].missed]' said)" '[2,0,2,true]'
status=0
"$bin/march" verify here.json --out 'here/s.####.exr' >said || status=$?
expect "the status of verify" "$status" 1
grep -q 's.0001.exr .*marchd:missed: expected an error of at most 0.05 (tolerance), got ' said || fail "verify: $(cat said)"
grep -q '2 published over the tolerance; 2 wrong, 0 missing' said || fail "its summary: $(cat said)"
