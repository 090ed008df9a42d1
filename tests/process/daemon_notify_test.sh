#!/bin/bash
# Notices: what a job's rules and the settings ask for is kept until somebody delivers it, over kills and restarts.
. "$(dirname "$0")/farm.sh"

pending() { ask notify.pending "${1:-{\}}"; }
# The notices that wait, as "JOB EVENT TARGET" lines.
waiting() { pending | jq -r '.result.notices[] | "\(.job) \(.event) \(.to // .webhook)"'; }
has_waiting() { waiting | grep -qx "$1"; }
to() { echo "[{\"on\":$1,\"to\":\"chat\"}]"; }
rules() { echo ".output.path = \"$1/f.####.exr\" | .notify = $2"; }

start_daemon --worker-program "$(stub write:0)" --notify mail:failed
# A job that ends well tells those who asked for it, once each.
good=$(submit "$(job 1-3 "$(rules good '[{"on":["done","failed"],"to":"chat"},{"on":["done"],"to":"chat"},{"on":["done"],"webhook":"https://example.org/x"}]')")")
wait_until "the end is told" has_waiting "$good done chat"
expect "notices" "$(waiting)" "$good done chat"$'\n'"$good done https://example.org/x"
body=$(pending | jq -r '.result.notices[0].body')
expect "the body" "$(jq -c '[.version, .event, .job.id, .job.state, .job.succeeded, .job.frames, .job.reason]' <<<"$body")" \
    "[1,\"done\",$good,\"succeeded\",3,3,null]"
expect "its id" "$(jq .id <<<"$body")" "$(pending | jq '.result.notices[0].id')"

# Pages, and what is delivered.
first=$(pending '{"limit":1}' | jq '.result.notices[0].id')
expect "one a page" "$(pending '{"limit":1}' | jq '.result.notices | length')" 1
expect "after the first" "$(pending "{\"after\":$first}" | jq -r '.result.notices[].webhook')" "https://example.org/x"
expect "done" "$(ask notify.done "{\"id\":$first}" | jq -c .result)" '{}'
expect "what is left" "$(waiting)" "$good done https://example.org/x"
expect "done again" "$(ask notify.done "{\"id\":$first}" | jq -c .result)" '{}'
kill_daemon
start_daemon --worker-program "$(stub write:0)" --notify mail:failed
expect "after a kill" "$(waiting)" "$good done https://example.org/x"
second=$(pending | jq '.result.notices[0].id')
ask notify.done "{\"id\":$second,\"error\":\"nobody \\u0007 is there\"}" >/dev/null
grep -q "notice $second is given up: nobody" "$scratch/daemon.log" || fail "no line about the notice that was given up"
expect "nothing is left" "$(waiting)" ""

# A retry tells again, and later ids are greater than all before.
ask job.retry "{\"id\":$good,\"state\":[\"succeeded\"],\"force\":true}" >/dev/null
wait_until "the end is told again" has_waiting "$good done chat"
third=$(pending | jq '.result.notices[0].id')
[ "$third" -gt "$second" ] || fail "the id $third after $second"
stop_daemon

# A job that fails tells the target of the settings too; a canceled one tells nobody.
start_daemon --worker-program "$(stub fail:frame)" --max-attempts 1 --notify mail:failed
bad=$(submit "$(job 1-2 "$(rules bad "$(to '["failed"]')")")")
wait_until "the failure is told" has_waiting "$bad failed mail"
has_waiting "$bad failed chat" || fail "the job's own target is not told: $(waiting)"
silent=$(submit "$(job 1-2 "$(rules silent '[]')")" true)
ask job.cancel "{\"id\":$silent}" >/dev/null
wait_state "$silent" canceled
ask job.delete "{\"id\":$bad}" >/dev/null
expect "notices of a job that is deleted" "$(waiting | grep -c "^$bad ")" 2
stop_daemon

# A fault that pauses a job is told once, over a restart too; a pause by its user is not.
start_daemon --workers 1 --worker-program "$(stub fail:output)"
paused=$(submit "$(job 1-2 "$(rules paused "$(to '["waiting"]')")")" true)
held=$(submit "$(job 1-2 "$(rules held "$(to '["waiting"]')")")")
wait_until "the hold is told" has_waiting "$held waiting chat"
[[ $(pending | jq -r ".result.notices[] | select(.job == $held) | .body" | jq -r .job.reason) == "paused: "* ]] ||
    fail "the reason: $(pending)"
kill_daemon
start_daemon --workers 1 --worker-program "$(stub fail:output)"
sleep 3 # two looks at the job
expect "told once" "$(waiting | grep "$held")" "$held waiting chat"
expect "a pause by its user" "$(waiting | grep -c "^$paused ")" 0
stop_daemon

# Whom jobs may name is known once march-web has said so.
start_daemon --worker-program "$(stub write:0)"
answer=$(ask job.submit "{\"document\":$(job 1 "$(rules new "$(to '["done"]')")"),\"paused\":true}")
[[ $(jq -r '.result.warnings[0]' <<<"$answer") == "notify: whether the farm has these targets"* ]] || fail "no warning: $answer"
pending '{"targets":["mail","chats"]}' >/dev/null
expect_error "$(ask job.submit "{\"document\":$(job 1 "$(rules other "$(to '["done"]')")")}")" 3 \
    'notify[0].to: there is no target "chat", did you mean "chats"?'
expect_error "$(ask job.submit "{\"document\":$(job 1 "$(rules other '[{"on":["done"],"webhook":"http://a/"}]')")}")" 3 \
    'notify[0].webhook: jobs of this farm may not name addresses'
pending '{"targets":["chat"],"webhooks":true}' >/dev/null
answer=$(ask job.submit "{\"document\":$(job 1 "$(rules other '[{"on":["done"],"webhook":"http://a/"}]')"),\"paused\":true}")
expect "no warning" "$(jq -c '.result | keys' <<<"$answer")" '["id"]'
# march submit adds a rule.
job 1 "$(rules cli '[]')" >"$scratch/cli.json"
id=$("$bin/march" submit --socket "$socket" --notify chat:done "$scratch/cli.json" 2>/dev/null) || fail "march submit --notify"
wait_until "the rule of the command line" has_waiting "$id done chat"
"$bin/march" submit --socket "$socket" --notify chat:ready "$scratch/cli.json" 2>"$scratch/said" && fail "a wrong event is taken"
grep -q -- '--notify: expected NAME:EVENT,EVENT' "$scratch/said" || fail "march says $(cat "$scratch/said")"
expect_error "$(pending '{"targets":["a b"]}')" -32602 "params.targets[0]: expected a target's name"
expect_error "$(ask notify.done '{}')" -32602 "params.id"
stop_daemon

# Kills at any moment: each job tells its end, once.
start_daemon --worker-program "$(stub write:5)"
pending '{"targets":["chat"]}' | jq -r '.result.notices[].id' | while read -r id; do ask notify.done "{\"id\":$id}" >/dev/null; done
ids=()
for n in $(seq 40); do ids+=("$(submit "$(job 1-2 "$(rules "kill$n" "$(to '["done"]')")")")"); done
for n in $(seq 8); do
    sleep "0.$((RANDOM % 4))$((RANDOM % 10))"
    kill_daemon
    start_daemon --worker-program "$(stub write:5)"
done
for id in "${ids[@]}"; do
    wait_state "$id" succeeded
    wait_until "job $id tells its end" has_waiting "$id done chat"
done
expect "notices of 40 jobs" "$(waiting | sort -u | wc -l) $(waiting | wc -l)" "40 40"
stop_daemon

[ "$(id -u)" = 0 ] || exit 0
# Others may neither see nor end notices.
run_for_others
start_daemon --worker-program "$(stub write:0)"
chmod 666 "$socket"
expect_error "$(ask_as 5 60 notify.pending)" 2 "no token gives the right to it"
expect_error "$(ask_as 5 60 notify.done '{"id":1}')" 2 "no token gives the right to it"
stop_daemon
