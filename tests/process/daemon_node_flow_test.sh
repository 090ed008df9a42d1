#!/bin/bash
# Nodes that do not read what they are told, and workers of nodes that say too much at once.
. "$(dirname "$0")/farm.sh"
. "$(dirname "$0")/load.sh"

workers() { ask worker.list | jq -c "[.result.workers[] | $1]"; }
are_idle() { [ "$(workers 'select(.state == "idle")' | jq length)" -eq "$1" ]; }
memory_kib() { awk '/^VmHWM/ { print $2 }' "/proc/$daemon_pid/status"; }

# What the daemon says goes through a process that passes on beats alone while there is a file "deaf".
cat >"$scratch/reader" <<END
import os, select, sys
lines, beat = sys.stdin.buffer, b""
while line := lines.readline():
    if line.startswith(b"beat"):
        beat = line
    sys.stdout.buffer.write(line)
    sys.stdout.buffer.flush()
    while os.path.exists("$scratch/deaf"):
        select.select([], [], [], 0.5)
        os.write(1, beat)
END
cat >"$scratch/launch" <<END
#!/bin/bash
exec 3<&0
exec "$bin/march-worker" --node --worker "$(stub write:20)" < <(exec python3 "$scratch/reader" <&3)
END
chmod +x "$scratch/launch"
start_daemon --workers none --pool "far launcher=command nodes=anna=20 heartbeat=20 command=$scratch/launch"
wait_until "all workers are idle" are_idle 20

# A large job for each of many workers is no fault of their node, which reads as fast as it can.
large_job_line 10000 | sed 's/"frames":"1"/"frames":"1-40"/; s/"paused":true/"paused":false/' >"$scratch/line"
[ $((20 * $(wc -c <"$scratch/line"))) -gt $((64 << 20)) ] || fail "the job is small" # what may wait for a node
id=$("$bin/socket-client" "$socket" <"$scratch/line" | jq .result.id)
wait_state "$id" succeeded
expect "nodes that ended" "$(grep -c "does not read" "$scratch/daemon.log")" 0

# A node that does not read gets no more, and is ended.
touch "$scratch/deaf"
id=$(sed 's/x\.####/y.####/' "$scratch/line" | "$bin/socket-client" "$socket" | jq .result.id)
wait_until "it is ended" grep -qF "node anna: it does not read what it is told" "$scratch/daemon.log"
rm "$scratch/deaf"
[ "$(memory_kib)" -lt $((300 << 10)) ] || fail "memory: $(memory_kib) KiB"
wait_state "$id" succeeded
expect "frames" "$(field "$id" .succeeded)" 40
stop_daemon

# A worker of the node says a line that is longer than any message: it is ended, its neighbour and the node are not.
cat >"$scratch/loud" <<END
#!/bin/bash
mkdir "$scratch/once" 2>/dev/null || exec "$(stub write:20)" "\$@"
[[ " \$* " =~ " --fd "([0-9]+) ]]
head -c 300000 /dev/zero | tr '\0' x >&"\${BASH_REMATCH[1]}"
sleep 600
END
chmod +x "$scratch/loud"
start_daemon --workers none \
    --pool "far launcher=command nodes=ben=2 command='$bin/march-worker --node --worker $scratch/loud'"
wait_until "it is told" grep -q "worker [12]: a line is longer than 262144 bytes" "$scratch/daemon.log"
wait_until "another is there" are_idle 2
id=$(submit "$(job 1-20 '.output.path = "loud/l.####.exr"')")
wait_state "$id" succeeded
expect_files loud 20
expect "nodes that ended" "$(grep -c "its stream ended" "$scratch/daemon.log")" 0
stop_daemon
