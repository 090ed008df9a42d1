#!/bin/bash
# The time that is left of a job has the jobs in front of it.
. "$(dirname "$0")/farm.sh"

has_done() { [ "$(field "$1" .succeeded)" -ge "$2" ]; }
rests() { [ "$(field "$1" .running)" = 0 ]; }
# both A B: the seconds that are said of both jobs at one moment.
both() { ask job.list | jq -c --argjson a "$1" --argjson b "$2" '[.result.jobs as $jobs | $a, $b | . as $id | $jobs[] | select(.id == $id) | .eta_s]'; }
# check WHAT SECONDS JQ-FILTER
check() { jq -e --argjson alone "$alone" "$3" <<<"$2" >/dev/null || fail "$1: $alone alone, both $2"; }

start_daemon --worker-program "$(stub write:40)"
behind=$(submit "$(job 0-999 '.output.path = "a/a.####.exr"')")
wait_until "frames are done" has_done "$behind" 8
ask job.pause "{\"id\":$behind}" >/dev/null
wait_until "no frame runs" rests "$behind"
alone=$(field "$behind" .eta_s)
# So many frames that no scatter of the others' pace is like what they take.
front=$(submit "$(job 0-9999 '.output.path = "b/b.####.exr" | .priority = 90')")
wait_until "frames are done" has_done "$front" 8
check "a paused job waits for none" "$(both "$behind" "$front")" '.[0] == $alone and .[1] > 0'
ask job.resume "{\"id\":$behind}" >/dev/null
check "a job waits for the one in front" "$(both "$behind" "$front")" '.[1] > 0 and (.[0] - $alone - .[1] | fabs) < 1e-3'
ask job.pause "{\"id\":$front}" >/dev/null
# Its frames go on meanwhile, so what it takes alone is not quite what it was.
check "no job waits for a paused one" "$(both "$behind" "$front")" '.[0] < .[1]'
ask job.resume "{\"id\":$front}" >/dev/null
# Of jobs of one owner and priority the first comes first, and a later one waits for all of them.
for priority in 90 50; do
    ask job.priority "{\"id\":$front,\"priority\":50}" >/dev/null
    ask job.priority "{\"id\":$behind,\"priority\":$priority}" >/dev/null
    check "the order at priority $priority" "$(both "$behind" "$front")" '.[1] > .[0]'
done
ask job.priority "{\"id\":$front,\"priority\":90}" >/dev/null
third=$(submit "$(job 0-999 '.output.path = "c/c.####.exr" | .priority = 99')")
wait_until "frames are done" has_done "$third" 8
ask job.pause "{\"id\":$front}" >/dev/null
check "nor for a paused one between" "$(both "$behind" "$front")" '.[0] < .[1]'
ask job.cancel "{\"id\":$third}" >/dev/null
ask job.cancel "{\"id\":$front}" >/dev/null
ask job.cancel "{\"id\":$behind}" >/dev/null
stop_daemon
