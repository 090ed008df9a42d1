#!/bin/bash
# Jobs that come after others: they wait, go on, are held when another did not succeed, and all of this over a SIGKILL.
. "$(dirname "$0")/farm.sh"

# next NAME AFTER [PAUSED]: a job after others; AFTER is JSON.
next() { submit "$(job 1-2 ".output.path = \"$1/$1.####.exr\" | .name = \"$1\" | .after = $2")" "${3:-false}"; }
told() { ask job.show "{\"id\":$1}" | jq -c '.result | [.state, .after, .reason]'; }
is_told() { [ "$(told "$1")" = "$2" ]; }
refused() { ask job.submit "{\"document\":$(job 1 ".output.path = \"no/n.####.exr\" | .after = $1")}"; }

start_daemon --worker-program "$(stub write:1)"
first=$(submit "$(job 1-4)" true)

expect_error "$(refused '[99]')" 1 "after[0]: job 99 is not known"
expect_error "$(refused '[1,2]')" 1 "after[1]: job 2 is not known" # its own id would be 2
expect_error "$(refused '[1,1]')" -32602 "params.document.after[1]: job 1 is there twice"
expect_error "$(refused '1')" -32602 "after: expected an array of jobs' ids"
expect_error "$(refused '{"jobs":[1],"when":"soon"}')" -32602 "after.when: expected one of"
expect_error "$(refused '[0]')" -32602 "after[0]: expected an integer"
expect_error "$(refused "$(jq -nc '[range(1; 66)]')")" -32602 "after: expected"

# A chain: each waits for the one before, says so, and none begins too early.
second=$(next second "[$first]")
third=$(next third "[$first,$second]")
expect "what the second waits for" "$(told "$second")" "[\"queued\",[$first],\"waits for job $first (\\\"cloud\\\"): 0 of its 4 frames are done\"]"
expect "what the third waits for" "$(told "$third")" \
    "[\"queued\",[$first,$second],\"waits for job $first (\\\"cloud\\\"): 0 of its 4 frames are done, and for 1 more\"]"
expect "no time left is told" "$(field "$second" .eta_s)" null
other=$(submit "$(job 1 '.output.path = "other/o.####.exr"')")
wait_state "$other" succeeded
kill_daemon
start_daemon --worker-program "$(stub write:1)"
expect "what the third waits for after a SIGKILL" "$(told "$third" | jq -c '.[:2]')" "[\"queued\",[$first,$second]]"
other=$(submit "$(job 1 '.output.path = "other2/o.####.exr"')")
wait_state "$other" succeeded
expect "frames that were begun too early" "$(field "$second" .started) $(field "$third" .started)" "null null"
ask job.resume "{\"id\":$first}" >/dev/null
wait_state "$third" succeeded
expect "each began when the one before had ended" "$(ask job.list "{\"ids\":[$first,$second,$third]}" |
    jq '.result.jobs | .[0].finished <= .[1].started and .[1].finished <= .[2].started')" true
expect "what they wait for then" "$(told "$third")" '["succeeded",[],null]'

# One that fails, is canceled or is deleted holds the job; a retry that succeeds lets it go on, and so does resume.
bad=$(submit "$(job 1 '.output.path = "bad/b.####.exr"')" true)
held=$(next held "[$bad]")
either=$(next either "{\"jobs\":[$bad],\"when\":\"over\"}")
by_hand=$(next by_hand "[$bad]" true)
ask job.cancel "{\"id\":$bad}" >/dev/null
why="paused: job $bad (\\\"cloud\\\"), which it comes after, was canceled: march retry $bad, or march resume $held to render it all the same"
wait_until "it is held" is_told "$held" "[\"paused\",[$bad],\"$why\"]"
wait_state "$either" succeeded
kill_daemon
start_daemon --worker-program "$(stub write:1)"
wait_until "it is held after a SIGKILL" is_told "$held" "[\"paused\",[$bad],\"$why\"]"
expect "who was paused by hand" "$(field "$by_hand" .reason)" "paused by $(id -un)"
ask job.resume "{\"id\":$by_hand}" >/dev/null
expect "why it is held then" "$(told "$by_hand" | jq -r '.[2]' | cut -d : -f 1-2)" "paused: job $bad (\"cloud\"), which it comes after, was canceled"
expect "an override" "$(ask job.resume "{\"id\":$by_hand}" | jq -c '.result.after')" "[]"
wait_state "$by_hand" succeeded
expect "the other is held still" "$(field "$held" .state)" paused
ask job.retry "{\"id\":$bad,\"state\":\"canceled\"}" >/dev/null
wait_state "$held" succeeded

# Who resumes a job that waits does not wait for others; a SIGKILL changes nothing of it.
first=$(submit "$(job 1 '.output.path = "again/a.####.exr"')" true)
second=$(next eager "[$first]")
stop_daemon
start_daemon --worker-program "$(stub nocontext)"
expect "an override" "$(ask job.resume "{\"id\":$second}" | jq -c '.result.after')" "[]"
kill_daemon
start_daemon --worker-program "$(stub write:1)"
wait_state "$second" succeeded
expect "the first is paused still" "$(field "$first" .state)" paused

# A job that has gone on does not wait again when the other is retried, not even over a SIGKILL before its first frame.
stop_daemon
start_daemon --worker-program "$(stub nocontext)"
before=$(submit "$(job 1 '.output.path = "before/b.####.exr"')" true)
behind=$(next behind "{\"jobs\":[$before],\"when\":\"over\"}")
ask job.cancel "{\"id\":$before}" >/dev/null
wait_until "it goes on" eval '[ "$(told "$behind" | jq -c ".[1]")" = "[]" ]'
expect "retried" "$(ask job.retry "{\"id\":$before,\"state\":\"canceled\"}" | jq .result.retried)" 1
kill_daemon
start_daemon --worker-program "$(stub nocontext)"
expect "what it waits for" "$(told "$behind" | jq -c '.[1]')" "[]"
ask job.cancel "{\"id\":$before}" >/dev/null
stop_daemon
start_daemon --worker-program "$(stub write:1)"
wait_state "$behind" succeeded

# A job that was deleted cannot be waited for, and one that a live job waits for does not age out.
third=$(next last "[$first]")
fourth=$(next after_all "{\"jobs\":[$first],\"when\":\"over\"}" true)
ask job.cancel "{\"id\":$first}" >/dev/null
wait_until "it is held" eval '[ "$(field "$third" .state)" = paused ]'
stop_daemon
start_daemon --worker-program "$(stub write:1)" --keep-days 0.00001
wait_until "all others leave" eval '[ "$(ask job.list | jq -c "[.result.jobs[].id]")" = "[$first,$third,$fourth]" ]'
ask job.delete "{\"id\":$first}" >/dev/null
wait_until "that it is gone is told" eval '[[ $(field "$third" .reason) == "paused: job $first, which it comes after, was deleted: march resume $third renders it all the same" ]]'
expect_error "$(refused "[$first]")" 1 "after[0]: job $first is not known"
ask job.resume "{\"id\":$fourth}" >/dev/null
ask job.resume "{\"id\":$third}" >/dev/null
wait_until "all are over and leave" eval '[ "$(ask job.list | jq -c .result.total)" = 0 ]'
expect_files last 2
expect_files after_all 2
stop_daemon
