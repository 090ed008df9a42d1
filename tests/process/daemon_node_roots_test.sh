#!/bin/bash
# Nodes that see another folder than the daemon does where an output root is: they get no frames, and say why.
[ "$(id -u)" = 0 ] || { echo "skip: only root mounts"; exit 77; }
unshare -m true 2>/dev/null || { echo "skip: no mount namespace here"; exit 77; }
. "$(dirname "$0")/farm.sh"

mkdir "$scratch/out" "$scratch/elsewhere"
echo "root 0123456789abcdef0123456789abcdef" >"$scratch/elsewhere/.marchd-root"
: >"$scratch/mount-blind"
# Each node has its own mounts, as machines have. A file mount-NODE gives it another disk at the root's place.
cat >"$scratch/launch" <<END
#!/bin/sh
exec unshare -m --propagation private sh -c '
    echo \$\$ >"$scratch/pid-\$1"
    [ ! -e "$scratch/mount-\$1" ] || mount --bind "$scratch/elsewhere" "$scratch/out"
    exec "$bin/march-worker" --node --worker "\$2"' sh "\$@"
END
chmod +x "$scratch/launch"
worker=$(stub write:20)

workers() { ask worker.list | jq -c "[.result.workers[] | $1]"; }
states() { workers 'select(.node == "'"$1"'").state'; }
reason() { ask worker.list | jq -r "[.result.workers[] | select(.node == \"$1\").reason][0] // \"\""; }
other="output root $scratch/out is another one: its .marchd-root says 01234567, expected "

start_daemon --workers none --pool "far launcher=command nodes=anna=2,blind heartbeat=60 command='$scratch/launch {node} $worker'"
job=$(submit "$(job 1-60)")
wait_state "$job" succeeded
wait_until "what is wrong is said" eval '[[ "$(reason blind)" == "node blind: $other"* ]]'
expect "states" "$(states anna) $(states blind)" '["idle","idle"] ["waiting"]'
expect "leftovers" "$(find "$scratch" -name '.marchd-probe-*')" ""

# The disk is replaced under a node that works: what its workers have open stays right, what comes next is refused there.
rm "$scratch/mount-blind"
wait_until "the other node takes frames" eval '[ "$(states blind)" = "[\"idle\"]" ]'
job=$(submit "$(job 1-60 '.output.path = "first/f.####.exr"')")
wait_until "frames are done" eval '[ "$(field "$job" .succeeded)" -ge 10 ]'
: >"$scratch/mount-anna"
nsenter -m -t "$(cat "$scratch/pid-anna")" mount --bind "$scratch/elsewhere" "$scratch/out"
next=$(submit "$(job 1-60 '.output.path = "next/n.####.exr"')")
wait_until "what is wrong is said" eval '[[ "$(reason anna)" == "node anna: $other"* ]]'
wait_state "$job" succeeded
wait_state "$next" succeeded
expect "files" "$(find "$scratch/out" -name '*.exr' | wc -l) $(find "$scratch/elsewhere" -name '*.exr' | wc -l)" "180 0"
expect "frames that failed" "$(field "$job" .failed) $(field "$next" .failed)" "0 0"
rm "$scratch/mount-anna"
wait_until "the node takes frames again" eval '[ "$(states anna)" = "[\"idle\",\"idle\"]" ]'
stop_daemon
