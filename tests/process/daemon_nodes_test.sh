#!/bin/bash
# Workers of nodes: their frames, and what happens when a node, its launcher, its daemon or the way between them ends.
. "$(dirname "$0")/farm.sh"

# A launcher that prints what shells print, and leaves the pid of its node.
cat >"$scratch/launch" <<END
#!/bin/sh
echo "Welcome to \$1."
printf 'You have mail. '
echo \$\$ >"$scratch/pid-\$1"
exec "$bin/march-worker" --node --worker "\$2"
END
chmod +x "$scratch/launch"

# start_nodes NODES STUB-MODE OPTION...: a daemon without workers of its own.
start_nodes()
{
    local nodes=$1 worker

    worker=$(stub "$2")
    shift 2
    start_daemon --workers none --pool "far launcher=command nodes=$nodes heartbeat=2 command='$scratch/launch {node} $worker'" "$@"
}

workers() { ask worker.list | jq -c "[.result.workers[] | $1]"; }
all_idle() { [ "$(workers .state | jq -c unique)" = '["idle"]' ]; }
node_pid() { cat "$scratch/pid-$1"; }
# Orphans may be left as zombies by whom they get as their parent.
is_gone() { ! grep -q '^State:.[^Z]' "/proc/$1/status" 2>/dev/null; }
# Its workers say so, too, until it is started again, which may be soon.
silences() { [ "$(grep -c "warning: node anna: nothing was heard of it for 2 s" "$scratch/daemon.log")" -ge "$1" ]; }
workers_of() { pgrep -P "$1" | tr '\n' ' '; }
all_gone() { local pid; for pid in $1; do is_gone "$pid" || return 1; done; }

refused()
{
    local said

    said=$("$bin/marchd" --state "$scratch/x" --socket "$scratch/y" --pool "$1" 2>&1) && fail "accepted: $1"
    [[ $said == *"$2"* ]] || fail "$1: expected \"$2\", got \"$said\""
}
refused "" "expected the pool's name"
refused "far" "expected nodes="
refused "far nodes=a" 'expected command='
refused "far nodes=a,a launcher=ssh" "a stands there twice"
refused "far nodes=-a launcher=ssh" "expected a machine's name"
refused "far nodes=a launcher=rsh" "expected command, ssh or slurm"
refused "far nodes=a launcher=ssh program='x y'" "expected a path of letters"
refused "far nodes=a launcher=command command='x \"y'" "expected another \""
refused "far nodes=a launcher=ssh colour=red" "colour: expected launcher"
refused "local nodes=a" "local: expected tags=... or users=..."

start_nodes anna=2,ben write:20
wait_until "all workers are idle" all_idle
expect "workers" "$(workers '[.id, .pool, .node]')" '[[1,"far","anna"],[2,"far","anna"],[3,"far","ben"]]'
# The workers of a machine share its GPUs in turn, also when one of them is replaced.
turns() { pgrep -a -P "$(node_pid anna)" | grep -o 'turn:[0-9]*' | sort | tr '\n' ' '; }
expect "turns" "$(turns)" "turn:0 turn:1 "
kill -KILL "$(pgrep -f -P "$(node_pid anna)" 'turn:0')"
wait_until "it is replaced" eval '[ "$(turns)" = "turn:0 turn:1 " ]'
wait_until "all workers are idle" all_idle
id=$(submit "$(job 1-60)")
wait_state "$id" succeeded
expect_files "cloud" 60

# The node is gone, and its workers with it. What they had in hand is rendered elsewhere, and costs no attempt.
id=$(submit "$(job 1-200 '.output.path = "kill/k.####.exr"')")
wait_until "frames are done" eval '[ "$(field "$id" .succeeded)" -ge 10 ]'
pid=$(node_pid anna)
children=$(workers_of "$pid")
[ -n "$children" ] || fail "the node has no workers"
kill -KILL "$pid"
wait_until "its workers are gone" all_gone "$children"
wait_state "$id" succeeded
expect_files "kill" 200
wait_until "the node is started again" all_idle
expect "attempts that failed" "$(ask job.log "{\"id\":$id}" | jq '[.result.attempts[] | select(.outcome == "failed")] | length')" 0

# A node that is not heard any more: others render its frames, and it ends by itself when it wakes.
id=$(submit "$(job 1-200 '.output.path = "still/s.####.exr"')")
wait_until "frames are done" eval '[ "$(field "$id" .succeeded)" -ge 10 ]'
pid=$(node_pid anna)
children=$(workers_of "$pid")
kill -STOP "$pid"
wait_until "its silence is noticed" silences 1
wait_until "it is started again" all_idle
wait_state "$id" succeeded
kill -CONT "$pid" 2>/dev/null
wait_until "the old node is gone" is_gone "$pid"
wait_until "its workers are gone" all_gone "$children"
wait_until "what it wrote on is removed" eval '[ -z "$(find "$scratch/out/still" -name "*.part")" ]'
expect_files "still" 200

# What a node that is not heard goes on to write is removed, though its job is over by then.
stop_daemon
start_nodes anna write:4000
wait_until "the worker is idle" all_idle
id=$(submit "$(job 1 '.output.path = "late/l.####.exr"')")
wait_until "the frame runs" eval '[ "$(field "$id" .running)" = 1 ]'
pid=$(node_pid anna)
kill -STOP "$pid"
wait_until "its silence is noticed" silences 2
ask job.cancel "{\"id\":$id}" >/dev/null
wait_until "the late file is there" eval '[ -n "$(ls "$scratch/out/late")" ]'
wait_until "the late file is removed" eval '[ -z "$(ls "$scratch/out/late")" ]'
kill -CONT "$pid" 2>/dev/null
wait_until "the old node is gone" is_gone "$pid"
stop_daemon
start_nodes anna=2,ben write:20
wait_until "all workers are idle" all_idle

# A daemon that is silent, or killed: nothing of it stays on the nodes.
pid=$(node_pid ben)
children=$(workers_of "$pid")
kill -STOP "$daemon_pid"
wait_until "the node ends" is_gone "$pid"
wait_until "its workers are gone" all_gone "$children"
kill -CONT "$daemon_pid"
wait_until "the nodes are back" all_idle
pid=$(node_pid ben)
children=$(workers_of "$pid")
kill_daemon
wait_until "the node ends" is_gone "$pid"
wait_until "its workers are gone" all_gone "$children"

# Nodes that cannot be used: what is wrong stands with their workers.
cat >"$scratch/other" <<'END'
#!/bin/sh
case $1 in
old) echo 'marchd-node {"protocol":1,"version":"0.0.1","host":"old","landlock":7}' ;;
weak) sleep 1 | "$2" --node | sed 's/"landlock":[0-9]*,"lack":null/"landlock":0,"lack":"no landlock in this kernel"/' ;;
wall) echo "permission denied" >&2; exit 255 ;;
loud) yes noise >&2 & yes nonsense ;;
thief)
    : | "$2" --node | sed -n '/^marchd-node/s/"landlock":[0-9]*/"landlock":7/p'
    read -r order
    token=$(echo "$order" | sed 's/.*"token":"\([0-9a-f]*\)".*/\1/')
    echo "probed {\"token\":\"$token\",\"fault\":null,\"seen_ms\":0,\"roots\":[{\"path\":\"/etc/shadow\",\"id\":\"\",\"inode\":\"1\",\"uid\":0}]}"
    ;;
odd) echo 'marchd-node {"protocol":' ;;
evil) printf '%s\n' 'marchd-node {"protocol":1,"version":"1\n<2>forged: \u001b[31m","host":"x","landlock":7}' ;;
esac
sleep 1
END
chmod +x "$scratch/other"
start_daemon --workers none --pool "far launcher=command nodes=old,weak,wall,odd,evil,loud,thief command='$scratch/other {node} $bin/march-worker'" \
    --pool "none launcher=command nodes=a command='$scratch/no-such-program'"
# A node that is tried again says so meanwhile.
for reason in "node old: it has march-worker 0.0.1 (protocol 1), this is marchd" \
    "node weak: no landlock in this kernel: expected landlock, or landlock=optional in pool far" \
    "permission denied" "node loud: it says much" "expected a root of the probe" "node odd: line 1" "node evil: it has march-worker 1 <2>forged: ?[31m (protocol 1)" "no-such-program: no such file"; do
    wait_until "told: $reason" eval '[[ "$(workers .reason)" == *"$reason"* ]]'
done
! grep -q '^<2>forged' "$scratch/daemon.log" || fail "a node writes lines of the log"
expect "states" "$(workers .state | jq -c unique)" '["waiting"]'
id=$(submit "$(job 1-3 '.output.path = "never/n.####.exr"')")
[[ $(field "$id" .reason) == "no worker is ready: node old: "* ]] || fail "reason: $(field "$id" .reason)"
stop_daemon

