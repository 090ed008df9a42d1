#!/bin/bash
# Plans are made once, numbered and kept by the daemon, and their frames repeat bit by bit.
. "$(dirname "$0")/farm.sh"

tolerant='.quality = {"tolerance": 0.05}'
made() { grep -c ': plan [0-9]* is made$' "$scratch/daemon.log"; }
told() { grep -c ' makes the plan$' "$scratch/daemon.log"; }
kept() { sqlite3 "$scratch/state/queue.db" 'SELECT count(*), max(number) FROM plan'; }

# maker: the worker that was told last to make a plan.
maker()
{
    sed -n 's/.*: worker \([0-9]*\) makes the plan$/\1/p' "$scratch/daemon.log" | tail -n 1
}
is_told() { [ "$(told)" = "$1" ]; }
stub_method() { sqlite3 "$scratch/state/queue.db" 'SELECT text FROM plan LIMIT 1' | jq -r .quality.method; }
both_begin() { [ "$(field "$1" .running)" = 2 ]; }

# Of two workers one makes the plan, and the other waits; when the first is killed, the other makes it.
start_daemon --worker-program "$(stub share:3000)" --log-level debug
id=$(submit "$(job 0-5 ".output.path = \"a/a.####.exr\" | $tolerant")")
wait_until "one plans" is_told 1
wait_until "the other waits" both_begin "$id"
first=$(maker)
expect "plans at a time" "$(told)" 1
kill -KILL "$(ask worker.list | jq ".result.workers[] | select(.id == $first) | .pid")"
wait_until "another one plans" is_told 2
[ "$(maker)" != "$first" ] || fail "the dead worker is to plan again"
expect "no plan yet" "$(made)" 0
wait_state "$id" succeeded
expect "plans" "$(made) $(told) $(kept)" "1 2 1|1"

# The next job of the same scene has the plan of the same segment; after a restart, too. These workers give every segment
# one name, whatever its frames are.
id=$(submit "$(job 2-9 ".output.path = \"b/b.####.exr\" | $tolerant")")
wait_state "$id" succeeded
expect "plans for the next job" "$(made) $(told) $(kept)" "1 2 1|1"
stop_daemon
start_daemon --worker-program "$(stub share:0)" --log-level debug
id=$(submit "$(job 0-5 ".output.path = \"c/c.####.exr\" | $tolerant")")
wait_state "$id" succeeded
expect "plans after a restart" "$(made) $(told) $(kept)" "1 2 1|1"
# Another scene has another plan, with the next number.
id=$(submit "$(job 0-5 ".output.path = \"d/d.####.exr\" | .camera.fov = 51 | $tolerant")")
wait_state "$id" succeeded
expect "plans of two scenes" "$(made) $(told) $(kept)" "2 3 2|2"
told_plans() { ask job.plans "$1" | jq -c '[.result.plans[] | [.number, .quality.method, (.why | type), (.scouts | type)]]'; }
expect "plans that clients are told" "$(told_plans "{\"id\":$id}") $(told_plans '{"id":1}')" \
    "[[2,\"$(stub_method)\",\"string\",\"array\"]] [[1,\"$(stub_method)\",\"string\",\"array\"]]"
expect_error "$(ask job.plans "{\"id\":$id,\"limit\":1001}")" -32602 "params.limit: expected an integer from 1 to 1000, got 1001"
expect_error "$(ask job.plans '{"id":9999}')" 1 "there is no such job"
stop_daemon

# A plan is checked as the job's quality would be, and nobody sends one that was not asked for.
start_daemon --worker-program "$(stub misplan:0)"
id=$(submit "$(job 0 ".output.path = \"e/e.####.exr\" | .camera.fov = 52 | $tolerant")")
wait_state "$id" failed
reason=$(ask job.frames "{\"id\":$id}" | jq -r '.result.frames[0].error')
[[ $reason == "a plan is refused: params.plan.quality.step: expected "* ]] || fail "the reason: $reason"
stop_daemon
start_daemon --worker-program "$(stub intrude:0)"
id=$(submit "$(job 0 ".output.path = \"f/f.####.exr\" | .camera.fov = 52 | $tolerant")")
wait_state "$id" failed
reason=$(ask job.frames "{\"id\":$id}" | jq -r '.result.frames[0].error')
[[ $reason == "plan: expected one that the worker was told to make"* ]] || fail "the reason: $reason"
expect "plans that were refused" "$(kept)" "2|2"
stop_daemon

# Real workers: a later job with the same frames shares the plan, one with others has its own, because the name of a segment
# follows from each frame's number. Each frame is repeated alone from its header.
start_daemon --backend software
cd "$scratch" || exit 1
before=$(made)
id=$(submit "$(job 40-55 ".output.path = \"real/r.####.exr\" | $tolerant")")
wait_state "$id" succeeded
expect "frames that tell their plan" "$(ask job.frames "{\"id\":$id}" | jq '[.result.frames[] | select(.plan > 2)] | length')" 16
again=$(submit "$(job 40-55 ".output.path = \"again/r.####.exr\" | $tolerant")")
wait_state "$again" succeeded
expect "plans of a segment" "$(($(made) - before))" 1
id=$(submit "$(job 40-54 ".output.path = \"others/r.####.exr\" | $tolerant")")
wait_state "$id" succeeded
expect "plans of two segments" "$(($(made) - before))" 2
stop_daemon
job 40-55 ".output.path = \"alone/r.####.exr\" | $tolerant" >alone.json
for frame in 55 40 47; do
    file=r.00$frame.exr
    "$bin/march" render alone.json --frames $frame --plan-of "out/real/$file" --backend software >said 2>&1 || fail "$(cat said)"
    expect "frame $frame alone" "$("$bin/exr-compare" "out/real/$file" "alone/$file")" "0 0"
    for key in planNumber quality jobHash; do
        header() { strings -n 4 "$1" | grep -A 2 "marchd:$key\$" | tail -n 1; }
        [ -n "$(header "alone/$file")" ] || fail "alone/$file has no marchd:$key"
        expect "marchd:$key" "$(header "alone/$file")" "$(header "out/real/$file")"
    done
done
# A file of another job says what is wrong.
job 40-55 ".output.path = \"other/r.####.exr\" | .camera.fov = 53 | $tolerant" >other.json
status=0
"$bin/march" render other.json --frames 40 --plan-of out/real/r.0040.exr --backend software >said 2>&1 || status=$?
expect "the status for another job" "$status" 1
grep -q 'r.0040.exr: marchd:sequenceHash: expected [0-9a-f]*, a frame of this job' said || fail "$(cat said)"
