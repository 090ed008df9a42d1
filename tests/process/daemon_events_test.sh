#!/bin/bash
# Events of subscribers, and the end of a subscriber that does not read.
. "$(dirname "$0")/farm.sh"

start_daemon --worker-program "$(stub write:20)"
listen "$scratch/all"
begun_ms=$(date +%s%3N)
id=$(submit "$(job 1-50)")
listen "$scratch/one" "{\"id\":$id,\"frames\":false}"
other=$(submit "$(job 1-5 '.output.path = "other/o.####.exr"')")
wait_state "$id" succeeded
wait_state "$other" succeeded
last_word() { jq -r "select(.params.type == \"job\" and .params.job.id == $2) | .params.job.state" "$1" | tail -n 1; }
wait_until "the ends are told" eval '[ "$(last_word "$scratch/all" "$id")$(last_word "$scratch/all" "$other")$(last_word "$scratch/one" "$id")" = succeededsucceededsucceeded ]'
lasted_ms=$(($(date +%s%3N) - begun_ms))
all="jq -c .params $scratch/all"

expect "states told" "$($all | jq -r --argjson id "$id" 'select(.type == "job" and .job.id == $id) | .job.state' | uniq | xargs)" \
    "queued running succeeded"
expect "frames told done" "$($all | jq --argjson id "$id" 'select(.type == "frame" and .id == $id and .state == "succeeded") |
    .frame' | sort -n | uniq | wc -l)" 50
expect "frames told begun" "$($all | jq --argjson id "$id" 'select(.type == "frame" and .id == $id and .state == "running") |
    .frame' | sort -n | uniq | wc -l)" 50
expect "jobs told to who asked for one" "$(jq -c 'select(.params) | .params | [.type, .job.id]' "$scratch/one" | grep -c job)" \
    "$(jq -c 'select(.params) | .params | [.type, .job.id]' "$scratch/one" | grep -c "\"job\",$id")"
expect "frames told to who asked for none" "$(jq -c 'select(.params.type == "frame")' "$scratch/one")" ""
expect "workers without a process or a reason" "$($all | jq 'select(.worker.state == "backing_off" and .worker.reason == null)')" ""
told=$($all | jq --argjson id "$id" 'select(.type == "job" and .job.id == $id) | .type' | wc -l)
# Its three states are told at once, its counts at most every 250 ms.
[ "$told" -le $((4 + lasted_ms / 250)) ] || fail "a job of at most $lasted_ms ms was told $told times"
stop_daemon

# Who unsubscribes from one job hears no more of it, and goes on to hear of others.
start_daemon --worker-program "$(stub write:20)"
first=$(submit "$(job 1-5 '.output.path = "first/f.####.exr"')" true)
second=$(submit "$(job 1-5 '.output.path = "second/s.####.exr"')" true)
mkfifo "$scratch/asks"
"$bin/socket-client" --keep "$socket" <"$scratch/asks" >"$scratch/heard" &
exec 7>"$scratch/asks"
asked=0
say() # METHOD PARAMS: on that connection; returns when it is answered
{
    asked=$((asked + 1))
    printf '{"jsonrpc":"2.0","id":%d,"method":"%s","params":%s}\n' "$asked" "$1" "$2" >&7
    wait_until "$1 is answered" grep -q "\"id\":$asked,\"result\"" "$scratch/heard"
}
say events.subscribe "{\"id\":$first}"
say events.subscribe "{\"id\":$second}"
say events.unsubscribe "{\"id\":$first}"
say events.unsubscribe "{\"id\":999}" # none is there to end
ask job.resume "{\"id\":$first}" >/dev/null
wait_state "$first" succeeded
ask job.resume "{\"id\":$second}" >/dev/null
wait_state "$second" succeeded
wait_until "the other job's end is told" grep -q '"state":"succeeded","draft"' "$scratch/heard"
expect "jobs told after one was left" "$(jq -r '.params | select(.type == "frame") | .id' "$scratch/heard" | sort -u | xargs)" "$second"
say events.subscribe '{}'
say events.unsubscribe '{}'
say events.unsubscribe "{\"id\":$second}"
before=$(wc -l <"$scratch/heard")
third=$(submit "$(job 1-5 '.output.path = "third/t.####.exr"')")
wait_state "$third" succeeded
say daemon.status '{}'
expect "lines told after all were left" "$(($(wc -l <"$scratch/heard") - before))" 1
exec 7>&-
expect_error "$(ask events.unsubscribe '{"id":0}')" -32602 "params.id: expected an integer from 1"
stop_daemon

# A subscriber that stops reading is disconnected after 16 MiB; others are not affected.
start_daemon --worker-program "$(stub skip)"
# Each event is sent once for each subscription.
yes '{"jsonrpc":"2.0","id":1,"method":"events.subscribe","params":{}}' | head -n 60 >"$scratch/subscriptions"
"$bin/socket-client" --keep "$socket" <"$scratch/subscriptions" >"$scratch/stopped" &
wait_until "the subscriptions are answered" eval '[ "$(grep -c result "$scratch/stopped")" = 60 ]'
kill -STOP $!
id=$(submit "$(job 0-4999 '.output.path = "many/m.####.exr"')")
wait_state "$id" succeeded
expect "times it was cut off" "$(grep -c "does not read its events" "$scratch/daemon.log")" 1
stop_daemon
