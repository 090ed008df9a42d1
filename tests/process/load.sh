# Shared by what attacks a daemon of farm.sh: many connections, large jobs, and what the daemon takes.
attacker=

# subscribe_lines COUNT: so many subscriptions to all events.
subscribe_lines()
{
    local n

    for ((n = 1; n <= $1; n++)); do
        printf '{"jsonrpc":"2.0","id":%s,"method":"events.subscribe","params":{}}\n' "$n"
    done
}

# large_job_line [KEYS]: the submit of a job with 24 timelines of so many keys, about 3.6 MB with 10,000.
large_job_line()
{
    job 1 | jq -c --argjson keys "${1:-10000}" '
        def timeline: {keys: [range($keys) | [., 1 + . / 1000000]]};
        .scene.media = [range(8) | {density: {kind: "homogeneous", bounds: {kind: "sphere", center: [0, 0, 0], radius: timeline}},
            sigma_a: timeline, sigma_s: timeline}]
        | .output.path = "large/x.####.exr" | .quality = {method: "midpoint", step: 0.1, light_step: 0.1}
        | {jsonrpc: "2.0", id: 1, method: "job.submit", params: {paused: true, document: .}}'
}

# attack CONNECTIONS LINES: sends the file's lines on each, prints how they were answered.
attack()
{
    "$bin/load-client" "$socket" "$1" "$2"
}

# attack_unread CONNECTIONS LINES: the same, reads nothing, goes on until end_attack.
attack_unread()
{
    "$bin/load-client" --unread "$socket" "$1" "$2" >"$scratch/attack" &
    attacker=$!
    wait_until "the attack is begun" grep -q ready "$scratch/attack"
}

end_attack()
{
    kill -KILL "$attacker" 2>/dev/null
    wait "$attacker" 2>/dev/null
    attacker=
}

# resident_mib: memory of the daemon.
resident_mib()
{
    awk '/^VmRSS/ { print int($2 / 1024) }' "/proc/$daemon_pid/status"
}

# loop_percent: sets `share`, the loop's of the daemon's processor time since the last call; 0 where that was below 0.1 s.
loop_percent()
{
    local all_s loop_s

    all_s=$(awk -v ticks="$(getconf CLK_TCK)" '{ print ($14 + $15) / ticks }' "/proc/$daemon_pid/stat")
    loop_s=$(turns .sum_s)
    share=$(jq -n "($all_s - ${last_all_s:-0}) as \$all | if \$all < 0.1 then 0 else 100 * ($loop_s - ${last_loop_s:-0}) / \$all | floor end")
    last_all_s=$all_s
    last_loop_s=$loop_s
}

# watch_memory SECONDS, watch_memory_until PID: the most of it, as `peak`.
watch_memory()
{
    local ends=$((SECONDS + $1)) now

    peak=0
    while [ $SECONDS -lt $ends ]; do
        now=$(resident_mib)
        [ "$now" -le "$peak" ] || peak=$now
        sleep 0.2
    done
}

watch_memory_until()
{
    local now

    peak=0
    while kill -0 "$1" 2>/dev/null; do
        now=$(resident_mib)
        [ "$now" -le "$peak" ] || peak=$now
        sleep 0.2
    done
    wait "$1"
}

# turns JQ-FILTER: of what the daemon says about its loop.
turns()
{
    ask daemon.status | jq ".result.loop | $1"
}
