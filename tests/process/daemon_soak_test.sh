#!/bin/bash
# Many jobs, while workers, clients and the daemon die at random and clients send random changes. In the end every frame of
# every job has one complete file, its row describes that file, no other file is left, and a restart changes nothing.
#   SOAK_ACTS=5000 SOAK_SEED=7 tests/process/daemon_soak_test.sh   longer, with other choices
. "$(dirname "$0")/farm.sh"
RANDOM=${SOAK_SEED:-1}
acts=${SOAK_ACTS:-100} # not seconds: as much happens on a busy machine
submitted=0

# Kinds of workers: most work, some die, stop sending, break the protocol or fail their frames.
mixed=$scratch/worker-mixed
cat >"$mixed" <<END
#!/bin/bash
printf x >>"$scratch/turns"
turn=\$(stat -c %s "$scratch/turns")
modes=(write:5 write:20 write:0 crash write:5 fail:frame write:50 garbage write:5 hang)
exec "$bin/stub-worker" --mode "\${modes[turn % 10]}" "\$@"
END
chmod +x "$mixed"

# Checks the final names repeatedly: one file per name, and never an incomplete one.
watch_files()
{
    while :; do
        find "$scratch/out" -name '*.exr' -printf '%p %i\n' 2>/dev/null
        find "$scratch/out" -name '*.exr' -size -8c -printf 'short %p\n' 2>/dev/null
        sleep 0.1
    done >>"$scratch/seen"
}

submit_one()
{
    local document

    submitted=$((submitted + 1))
    document=$(job "1-$((RANDOM % 60 + 1))" ".output.path = \"$submitted/s.####.exr\" | .priority = $((RANDOM % 100))")
    ask job.submit "{\"document\":$document}" >/dev/null
}

# A client that goes away: in the middle of a line, or with a subscription.
vanish()
{
    if [ $((RANDOM % 2)) = 0 ]; then
        printf '{"jsonrpc":"2.0","id":1,"method":"job.cancel","par' | ask_raw >/dev/null
    else
        listen "$scratch/vanished"
        kill -KILL $!
        wait $! 2>/dev/null
    fi
}

kill_worker()
{
    local pids

    mapfile -t pids < <(ask worker.list | jq '.result.workers[].pid | values')
    [ ${#pids[@]} = 0 ] || kill -KILL "${pids[RANDOM % ${#pids[@]}]}" 2>/dev/null
}

# change METHOD [MORE-PARAMS]: for a random job; it may be refused.
change()
{
    [ "$submitted" = 0 ] || ask "$1" "{\"id\":$((RANDOM % submitted + 1))${2-}}" >/dev/null
}

restart()
{
    "$1"
    start_daemon --stop-timeout 1 --workers 3 --worker-program "$mixed"
}

act()
{
    case $((RANDOM % 16)) in
    0 | 1 | 2 | 3) submit_one ;;
    4 | 5 | 6) kill_worker ;;
    7) restart kill_daemon ;;
    8) [ $((RANDOM % 4)) != 0 ] || restart stop_daemon ;;
    9) change job.pause ;;
    10 | 11) change job.resume ;;
    12) [ $((RANDOM % 3)) != 0 ] || change job.cancel ;;
    13) change job.retry ',"state":["failed","canceled"]' ;;
    14) change job.priority ",\"priority\":$((RANDOM % 101))" ;;
    15) vanish ;;
    esac
}

# All members of jobs and frames but those that a restart resets.
tell_all()
{
    local id

    ask job.list | jq -c '.result.jobs[] | del(.seconds_per_frame, .eta_s)'
    for id in $(ask job.list | jq '.result.jobs[].id'); do
        ask job.frames "{\"id\":$id}" | jq -c --argjson id "$id" '.result.frames[] | [$id, .frame, .state, .hash, .path, .error]'
    done
}

mkdir -p "$scratch/out"
watch_files &
start_daemon --stop-timeout 1 --workers 3 --worker-program "$mixed"
for _ in $(seq "$acts"); do
    act
done

# With workers that work, all jobs that are not canceled or failed succeed.
kill_daemon
start_daemon --worker-program "$(stub write:0)"
for id in $(ask job.list '{"state":["queued","running","paused"]}' | jq '.result.jobs[].id'); do
    ask job.resume "{\"id\":$id}" >/dev/null
done
for id in $(ask job.list | jq '.result.jobs[].id'); do
    ask job.retry "{\"id\":$id}" >/dev/null
done
frames_left()
{
    ask daemon.status | jq '.result.frames | .queued + .running'
}
tell_unfinished()
{
    ask daemon.status
    ask worker.list
    ask job.list '{"state":["queued","running","paused"]}'
}
for ((left = $(frames_left); left > 0; left = $(frames_left))); do
    (wait_until "fewer than $left frames are left" eval '[ "$(frames_left)" -lt "$left" ]') || {
        tell_unfinished >&2
        exit 1
    }
done
wait_until "leftovers are gone" eval '[ -z "$(find "$scratch/out" -name "*.part")" ]'

expect "jobs that neither succeeded nor were canceled" \
    "$(ask job.list | jq -c '.result.jobs[] | select(.state != "succeeded" and .state != "canceled")')" ""
expect "jobs whose states do not add up" "$(ask job.list | jq -c '.result.jobs[] | select(.queued + .running + .succeeded +
    .failed + .canceled + .skipped != .frames)')" ""
expect "succeeded jobs with other frames" \
    "$(ask job.list | jq -c '.result.jobs[] | select(.state == "succeeded" and .succeeded != .frames)')" ""
before=$(tell_all)
stop_daemon

# Compares rows with files. State 2 is "succeeded"; each file holds its own number.
jq -r 'arrays | select(.[2] == "succeeded") | .[4]' <<<"$before" | sort >"$scratch/told"
find "$scratch/out" -type f ! -name .marchd-root | sort >"$scratch/there"
diff "$scratch/told" "$scratch/there" || fail "the files told and the files there differ"
sqlite3 "$scratch/state/queue.db" 'SELECT inode FROM frame WHERE state = 2' | sort >"$scratch/inodes_told"
find "$scratch/out" -type f ! -name .marchd-root -printf '%i\n' | sort >"$scratch/inodes_there"
diff "$scratch/inodes_told" "$scratch/inodes_there" || fail "the files that the rows tell of are others"
while read -r path; do
    number=${path%.exr}
    [ "$(<"$path")" = "frame $((10#${number##*.}))" ] || fail "$path holds \"$(<"$path")\""
done <"$scratch/there"
expect "rows of publishing cut short" "$(sqlite3 "$scratch/state/queue.db" 'SELECT count(*) FROM frame WHERE state = 1')" 0
expect "names that held two files" "$(sort -u "$scratch/seen" | cut -d' ' -f1 | grep -v '^short' | sort | uniq -d)" ""
expect "unfinished files" "$(grep '^short' "$scratch/seen")" ""

start_daemon --worker-program "$(stub write:0)"
diff <(echo "$before") <(tell_all) || fail "a restart changed something"
kill_daemon
expect "what the sanitizers said" "$(grep -E 'Sanitizer:|runtime error' "$scratch/daemon.log")" ""
echo "$submitted jobs, $(wc -l <"$scratch/there") files, $(stat -c %s "$scratch/turns") workers"
