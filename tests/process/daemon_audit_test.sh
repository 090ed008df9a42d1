#!/bin/bash
# Errors of frames that workers report: clients get them, the store keeps them, and a frame over its tolerance has one attempt.
. "$(dirname "$0")/farm.sh"

accuracy_of()
{
    ask job.frames "{\"id\":$1}" | jq -c '[.result.frames[] | [.audit, .measured_error, .error95, .audit_rays, .method, .cut_share, .traced]]'
}

# told_end EVENTS ID: the subscriber has all events of the job's frames.
told_end()
{
    jq -e --argjson id "$2" 'select(.params.type == "job" and .params.job.id == $id and .params.job.state == "succeeded")' \
        "$1" >/dev/null
}

start_daemon --worker-program "$(stub audited:0)"
id=$(submit "$(job 0-1 '.output.path = "a/a.####.exr"')")
wait_state "$id" succeeded
whole='["reference",0.00625,0.0075,64,"cached",0.125,0.0625]'
expect "accuracy" "$(accuracy_of "$id")" "[$whole,$whole]"
latest='[.method, .measured_error, .error95, .tolerance]'
expect "what the job says of its latest frame" "$(field "$id" "$latest | tojson")" '["cached",0.00625,0.0075,null]'
expect "the map's errors and bounds" "$(ask job.frame_map "{\"id\":$id}" | jq -c '.result | [.errors, .errors95]')" '[[0.00625,0.00625],[0.0075,0.0075]]'
row=$("$bin/march" frames "$id" --socket "$socket" | tr -s ' ' | sed -n 2p)
[[ $row == *" cached 0.62 / 0.75 12.5 6.25 $scratch/out/a/a.0000.exr"* ]] || fail "the row of march frames: $row"
"$bin/march" frames "$id" --socket "$socket" | head -n 1 | grep -q 'METHOD  *AUDIT % / 95 %     CUT %  TRACED %  FILE' || fail "the titles"
stop_daemon

# The next daemon reads them from the store; frames of a worker that audits nothing have none.
start_daemon --worker-program "$(stub write:0)"
expect "accuracy after a restart" "$(accuracy_of "$id")" "[$whole,$whole]"
expect "what the job says after a restart" "$(field "$id" "$latest | tojson")" '["cached",0.00625,0.0075,null]'
plain=$(submit "$(job 0 '.output.path = "b/b.####.exr"')")
wait_state "$plain" succeeded
expect "what a job without audits says" "$(field "$plain" "$latest | tojson")" '["midpoint",null,null,null]'
expect "no audit" "$(ask job.frames "{\"id\":$plain}" | jq -c '.result.frames[0] | [has("audit"), has("measured_error"), has("cut_share"), has("traced")]')" \
    "[false,false,false,false]"
row=$("$bin/march" frames "$plain" --socket "$socket" | tr -s ' ' | sed -n 2p)
[[ $row == *" - - - - $scratch/out/b/b.0000.exr"* ]] || fail "the row of a frame without audit: $row"
stop_daemon

start_daemon --worker-program "$(stub fail:missed)" --max-attempts 3
id=$(submit "$(job 0-1 '.output.path = "c/c.####.exr"')")
wait_state "$id" failed
expect "one try each" "$(ask job.frames "{\"id\":$id}" | jq -c '[.result.frames[] | [.state, .attempts]]')" '[["failed",1],["failed",1]]'
id=$(submit "$(job 0-99 '.output.path = "d/d.####.exr"')")
wait_state "$id" failed
tries=$(ask job.frames "{\"id\":$id}" | jq '[.result.frames[].attempts] | add')
[ "$tries" -lt 20 ] || fail "too many frames were tried: $tries"
stop_daemon

# A plan is made once, between the start and the end of a frame, within its attempt.
start_daemon --worker-program "$(stub plan:10)"
listen "$scratch/events"
id=$(submit "$(job 0-1 '.output.path = "e/e.####.exr"')")
wait_state "$id" succeeded
expect "attempts of planned frames" "$(ask job.frames "{\"id\":$id}" | jq -c '[.result.frames[] | [.state, .attempts]]')" \
    '[["succeeded",1],["succeeded",1]]'
wait_until "the end is told" told_end "$scratch/events" "$id"
expect "beginnings" "$(grep -c '"frame":[01],"state":"running"' "$scratch/events")" 2
stop_daemon

# A frame that plans is running, and everybody can see what it is at.
start_daemon --worker-program "$(stub plan:60000)"
listen "$scratch/phases"
id=$(submit "$(job 0 '.output.path = "p/p.####.exr"')")
told_phase() { grep -q '"type":"phase".*"phase":"'"$1"'","phase_progress":'"$2" "$scratch/phases"; }
wait_until "the phase is told" told_phase render 0.25
expect "phases" "$(jq -c 'select(.params.type == "phase") | .params | [.id, .frame, .attempt, .phase, .phase_progress]' \
    "$scratch/phases" | head -n 3 | xargs)" "[$id,0,1,plan,0] [$id,0,1,render,0] [$id,0,1,render,0.25]"
expect "the job's phase" "$(ask job.show "{\"id\":$id}" | jq -c '.result | [.state, .phase, .phase_progress]')" '["running","render",0.25]'
expect "the frame's phase" "$(ask job.frames "{\"id\":$id}" | jq -c '.result.frames[0] | [.state, .phase, .phase_progress]')" \
    '["running","render",0.25]'
"$bin/march" frames "$id" --socket "$socket" | grep -q '  render 25 %$' || fail "march frames tells the phase"
"$bin/march" list --socket "$socket" | grep -q '  running  *render 25 %  ' || fail "march list tells the phase"
"$bin/march" show "$id" --socket "$socket" | grep -q '^phase      render, 25 % of it$' || fail "march show tells the phase"
ask job.cancel "{\"id\":$id}" >/dev/null
kill_daemon
start_daemon --worker-program "$(stub phase:60000)"
id=$(submit "$(job 0 '.output.path = "q/q.####.exr"')")
plans() { [ "$(ask job.show "{\"id\":$id}" | jq -c '.result | [.state, .phase, .phase_progress]')" = '["running","plan",0]' ]; }
wait_until "the job plans" plans
"$bin/march" list --socket "$socket" | grep -q '  running  *plan  ' || fail "march list tells that the job plans"
ask job.cancel "{\"id\":$id}" >/dev/null
kill_daemon

# The real worker: its report on each frame matches the file, and every frame is within the tolerance.
start_daemon --backend software --workers 1
cd "$scratch" || exit 1
listen "$scratch/real"
id=$(submit "$(job 48-50 '.output.path = "real/r.####.exr" | .quality = {"tolerance": 0.05}')")
wait_state "$id" succeeded
"$bin/march" verify "$scratch/out/real" --json >verified || fail "$(cat verified)"
expect "errors" "$(ask job.frames "{\"id\":$id}" | jq -c '[.result.frames[] | [.audit, .measured_error, .error95, .method]]')" \
    "$(jq -c '[.files[] | [.audit, .measured_error, .error95, .method]]' verified)"
expect "within" "$(jq '[.files[] | select(.audit and .measured_error <= 0.05 and .tolerance == 0.05)] | length' verified)" 3
wait_until "the end is told" told_end "$scratch/real" "$id"
expect "beginnings" "$(grep -c '"state":"running"' <(grep '"type":"frame"' "$scratch/real"))" 3
stop_daemon
