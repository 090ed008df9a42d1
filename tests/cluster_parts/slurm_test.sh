#!/bin/bash
# Machines that a real Slurm lends: frames, restarts of the daemon, and what Slurm does when something breaks.
#   tests/cluster_parts/slurm_test.sh [PART...]     with the programs of PROGRAM_FOLDER (build/clang/bin)
# Exit status 77, with the reason, where there can be no cluster.
here=$(cd "$(dirname "$0")/../.." && pwd)
export PROGRAM_FOLDER=${PROGRAM_FOLDER:-$here/build/clang/bin} PROJECT_ROOT=$here
. "$here/tests/cluster_parts/slurm_cluster.sh"
if [ -z "${IN_CLUSTER-}" ]; then
    lack=$(cluster_lack)
    [ -z "$lack" ] || { echo "skipped: no cluster can be made: $lack"; exit 77; }
    IN_CLUSTER=yes exec unshare --pid --fork --kill-child --mount-proc --mount --net --uts "$0" "$@"
fi
. "$here/tests/process/farm.sh"
chmod 711 "$scratch"
cluster=$scratch/cluster
parts=" ${*:-frames restart walled} "
workers=2 # on each machine
worker=$(stub write:200)
as_daemon=(env "PATH=$scratch/commands:$PATH")
mkdir "$scratch/commands" # what stands before Slurm's own

# The stub stands behind the real program of a node.
cat >"$scratch/node" <<END
#!/bin/sh
exec "$bin/march-worker" --node --worker "$worker"
END
chmod +x "$scratch/node"

# start_farm KEY=VALUE...: a daemon whose only workers are Slurm's.
start_farm()
{
    start_daemon --workers none --pool "$(pool "$@")"
}
pool() { echo "far launcher=slurm workers=$workers gres=gpu:$workers max=3 heartbeat=5 idle=2 keep=10 program=$scratch/node $*"; }

workers() { ask worker.list | jq -c "[.result.workers[] | $1]"; }
idle_count() { workers 'select(.state == "idle" or .state == "busy")' | jq length; }
has_idle() { [ "$(idle_count)" -eq "$1" ]; }
has_done() { [ "$(field "$1" .succeeded)" -ge "$2" ]; }
says() { [[ "$(workers .reason)" == *"$1"* ]]; }
jobs_of_slurm() { squeue -h -o %i "$@"; }
has_jobs() { [ "$(jobs_of_slurm | wc -l)" -eq "$1" ]; }
processes() { pgrep -f "$bin/(march-worker|stub-worker)" || true; }
none_left() { [ -z "$(processes)" ]; }
# never_failed ID: no attempt at a frame of the job counts.
never_failed()
{
    expect "attempts that failed" "$(ask job.log "{\"id\":$1}" | jq '[.result.attempts[] | select(.outcome == "failed")] | length')" 0
}

echo "the cluster starts"
start_cluster || fail "no cluster"

# As many machines as the queue needs, and none for nothing.
frames()
{
    local id

    start_farm
    expect "before a job" "$(workers .reason | jq -c unique)" '["no frame waits for it"]'
    id=$(submit "$(job 1-2)")
    wait_state "$id" succeeded
    expect_files cloud 2
    id=$(submit "$(job 1-60 '.output.path = "many/m.####.exr"')")
    wait_until "three machines" has_idle 6
    expect "machines" "$(workers .node | jq -c unique)" '["n1","n2","n3"]'
    wait_state "$id" succeeded
    expect_files many 60
    never_failed "$id"
    wait_until "the machines are given back" has_jobs 0
    wait_until "their workers are gone" none_left
    stop_daemon
}

# Another daemon of the farm goes on with the machines of the one before.
restart()
{
    local id before

    start_farm
    id=$(submit "$(job 1-400 '.output.path = "again/a.####.exr"')")
    wait_until "frames are done" has_done "$id" 10
    wait_until "three machines" has_idle 6
    before=$(jobs_of_slurm | sort)
    kill_daemon
    wait_until "their workers are gone" none_left
    start_farm
    wait_until "three machines" has_idle 6
    expect "jobs of Slurm" "$(jobs_of_slurm | sort)" "$before"
    stop_daemon
    expect "jobs of Slurm" "$(jobs_of_slurm | sort)" "$before"
    # Without a daemon the lease runs out.
    wait_until "nothing is left behind" has_jobs 0
    start_farm
    wait_state "$id" succeeded
    expect_files again 400
    never_failed "$id"
    stop_daemon
    wait_until "nothing is left behind" has_jobs 0
}

# A daemon without a network asks march-launch, which has one, for every command of Slurm's.
walled()
{
    local id conf=$scratch/marchd.conf launch=$scratch/launch.sock launch_pid

    echo "pool = $(pool)" >"$conf"
    env "PATH=$scratch/commands:$PATH" "$bin/march-launch" --config "$conf" --socket "$launch" &
    launch_pid=$!
    wait_until "march-launch listens" test -S "$launch"
    as_daemon+=(unshare --net)
    start_daemon --workers none --config "$conf" --launch-socket "$launch"
    [ "$(readlink "/proc/$daemon_pid/ns/net")" != "$(readlink /proc/$$/ns/net)" ] || fail "the daemon has a network"
    id=$(submit "$(job 1-60 '.output.path = "walled/w.####.exr"')")
    wait_state "$id" succeeded
    expect_files walled 60
    never_failed "$id"
    [ -z "$(pgrep -P "$daemon_pid")" ] || fail "the daemon starts commands itself"
    [ -n "$(pgrep -P "$launch_pid")" ] || fail "march-launch starts no commands"
    wait_until "the machines are given back" has_jobs 0
    stop_daemon
    kill "$launch_pid"
}

for part in $parts; do
    begin=$SECONDS
    "$part"
    echo "$part: ok, $((SECONDS - begin)) s"
done
