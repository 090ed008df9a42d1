# The service through reloads, crashes, hangs and stops. Sourced by tests/service.

reload_holds()
{
    local id

    reload "log-level = debug" "user-jobs = 1" "worker-memory = 1G"
    expect "a reload's status" "$reload_status" 0
    grep -q '^settings: changed: .*user-jobs, .*worker-memory, log-level$' "$work/settings" || { cat "$work/settings"; fail "what changed"; }
    id=$(submit ann "$(cloud_job 1-400 480 270 limited)")
    cloud_job 1 64 36 more >"$root/home/ann/job.json"
    ends 4 "jobs: ann may have 1" as ann march submit job.json
    until_true "a published frame is told, now that the level is debug" eval \
        '[ -n "$(journal MARCHD_JOB='"$id"' PRIORITY=7 | jq -r "select(.MESSAGE | endswith(\"published\")) | .MARCHD_FRAME")" ]'
    reload "user-jobs = 1000" "log-level = debug" "stop-timeout = soon"
    expect "the status of a reload that fails" "$reload_status" 1
    grep -q 'settings: not changed: /etc/marchd/marchd.conf:3: .*stop-timeout' "$work/settings" || { cat "$work/settings"; fail "file and line"; }
    ends 4 "jobs: ann may have 1" as ann march submit job.json
    expect "service" "$(inside systemctl is-active marchd.service)" active
    reload "user-jobs = 3" "log-level = debug" "worker-memory = 1G"
    as ann march submit job.json
    as ann march cancel "$id"
}

render_workers()
{
    inside pgrep -u marchd -f march-worker || true
}

worker_is_killed()
{
    local id pid entry

    id=$(submit ann "$(cloud_job 1-6 480 270 wounded)")
    until_true "a frame is done" has_done ann "$id" 1
    pid=$(main_pid)
    # The worker that is killed has frames in flight.
    inside kill -KILL "$(as ann march workers --json | jq '[.. | objects | select((.frames? // 0) > 0) | .pid][0]')"
    as ann march wait "$id"
    landed_once wounded 6
    expect "the daemon" "$(main_pid)" "$pid"
    entry=$(journal MARCHD_JOB="$id" _SYSTEMD_UNIT=marchd.service |
        jq -c 'select(.MESSAGE | contains("signal 9")) | select(.MARCHD_FRAME)' | tail -n 1)
    # jq -e succeeds on empty input.
    [ -n "$entry" ] && echo "$entry" | jq -e '(.MARCHD_FRAME | tonumber) >= 1 and .MARCHD_ATTEMPT == "1" and (.MARCHD_WORKER | tonumber) >= 1 and .MARCHD_OWNER == "ann"' ||
        fail "no entry with job, frame and attempt of the killed worker: $entry"
    expect "attempts that the job's log tells of" "$(as ann march log "$id" | grep -c 'signal 9')" 1
}

memory_bomb_is_survived()
{
    local id other pid

    # The memory limit acts before the progress limit: the job takes half a gigabyte a second.
    reload "user-jobs = 3" "log-level = debug" "worker-memory = 1G" "progress-limit = 300"
    pid=$(main_pid)
    id=$(submit ann "$(bomb_job bomb)")
    other=$(submit bob "$(cloud_job 1-4 160 90 beside)")
    ends 1 "" as ann march wait "$id"
    as ann march log "$id" >"$work/out"
    grep -q 'out of memory: a worker may have 1 GiB' "$work/out" || fail "its log: $(cat "$work/out")"
    as bob march wait "$other"
    landed_once beside 4
    reload "user-jobs = 3" "log-level = debug"
    expect "the daemon" "$(main_pid)" "$pid"
    expect "pictures of the bomb" "$(find "$root/srv/marchd" -path '*bomb*' -type f | wc -l)" 0
}

daemon_is_killed()
{
    local id pid round

    id=$(submit ann "$(cloud_job 1-10 480 270 killed)")
    for round in 2 5; do
        until_true "$round frames are done" has_done ann "$id" "$round"
        pid=$(main_pid)
        list_files killed >"$work/list"
        inside kill -KILL "$pid"
        until_true "systemd brings it back" has_new_pid "$pid"
    done
    as ann march wait "$id"
    landed_once killed 10 "$work/list"
    expect "restarts" "$(inside systemctl show -P NRestarts marchd.service)" 2
    expect "pictures that are the same file" "$(find "$root/srv/marchd/killed" -name '*.exr' -links +1)" ""
    expect "workers of dead daemons" "$(render_workers | wc -l)" "$(as ann march workers --json | jq '[.. | .pid? // empty] | length')"
}

# drop_in SETTING: changes a setting of the service's unit until remove_drop_in.
drop_in()
{
    mkdir -p "$root/etc/systemd/system/marchd.service.d"
    printf '[Service]\n%s\n' "$1" >"$root/etc/systemd/system/marchd.service.d/test.conf"
    inside systemctl daemon-reload
}

remove_drop_in()
{
    rm -r "$root/etc/systemd/system/marchd.service.d"
    inside systemctl daemon-reload
}

watchdog_acts()
{
    local id pid limit begin

    limit=$(inside systemctl show -P WatchdogUSec marchd.service)
    [[ $limit != 0 && $limit != infinity ]] || fail "WatchdogSec is $limit"
    # The shipped limit allows for slow machines; a shorter one saves time here.
    drop_in "WatchdogSec=8"
    inside systemctl restart marchd.service
    id=$(submit ann "$(cloud_job 1-7 480 270 hung)")
    until_true "two frames are done" has_done ann "$id" 2
    pid=$(main_pid)
    list_files hung >"$work/list"
    begin=$SECONDS
    inside kill -STOP "$pid"
    until_true "systemd ends it and brings it back" has_new_pid "$pid"
    echo "after $((SECONDS - begin)) s"
    inside journalctl -q --no-pager -o cat -u marchd.service -g 'Watchdog timeout' | grep -q . || fail "it was not the watchdog"
    as ann march wait "$id"
    landed_once hung 7 "$work/list"
    # The watchdog leaves a daemon alone whose event loop runs, for longer than the limit.
    pid=$(main_pid)
    sleep 9
    expect "the daemon after a quiet time" "$(main_pid)" "$pid"
    remove_drop_in
    inside systemctl restart marchd.service
}

stop_is_graceful()
{
    local id running number begin

    # The unit's timeout does not count: the daemon asks systemd for as long as stop-timeout.
    drop_in "TimeoutStopSec=1"
    id=$(submit ann "$(cloud_job 1-7 800 450 stopped)")
    until_true "a frame is done" has_done ann "$id" 1
    running=$(as ann march frames --json "$id" | jq -r '.. | objects | select(.state? == "running") | .frame')
    [ -n "$running" ] || fail "no frame is running"
    begin=$SECONDS
    inside systemctl stop marchd.service
    echo "stopped within $((SECONDS - begin)) s"
    expect "how it ended" "$(inside systemctl show -P Result marchd.service)" success
    for number in $running; do
        [ -f "$root/srv/marchd/stopped/$(printf 'c.%04d.exr' "$number")" ] || fail "frame $number was running, and is not there"
    done
    expect "part files" "$(find "$root/srv/marchd/stopped" -type f ! -name '*.exr')" ""
    [ "$(find "$root/srv/marchd/stopped" -name '*.exr' | wc -l)" -lt 7 ] || fail "it was over before it was stopped"
    list_files stopped >"$work/list"
    remove_drop_in
    inside systemctl start marchd.service
    as ann march wait "$id"
    landed_once stopped 7 "$work/list"
    expect "attempts" "$(as ann march frames --json "$id" | jq -c '[.. | .attempts? // empty] | unique')" "[1]"
}
