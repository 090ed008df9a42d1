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
all="frames restart walled controller asked again power step cut none_free no_srun half_look operator too_long runs_out chaos"
workers=2 # on each machine
max=3
minutes=${MINUTES:-5} # of chaos
seed=${SEED:-$RANDOM} # of what it hits, and when
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
pool() { echo "far launcher=slurm workers=$workers gres=gpu:$workers max=$max heartbeat=5 idle=2 keep=10 program=$scratch/node $*"; }

workers() { ask worker.list | jq -c "[.result.workers[] | $1]"; }
idle_count() { workers 'select(.state == "idle" or .state == "busy")' | jq length; }
has_idle() { [ "$(idle_count)" -eq "$1" ]; }
has_done() { [ "$(field "$1" .succeeded)" -ge "$2" ]; }
says() { [[ "$(workers .reason)" == *"$1"* ]]; }
jobs_of_slurm() { squeue -h -o '%i %j' "$@" | sed -n 's/ march-.*//p'; }
# The controller writes jobs down a few seconds late: what it took before, it knows when it is back.
settle() { sleep 8; }
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
    # What more were allowed is given back by a daemon that may have one.
    if [ "$max" -gt 1 ]; then
        max=1 start_farm
        wait_until "two machines are given back" has_jobs 1
        stop_daemon
    fi
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
    local as_daemon=("${as_daemon[@]}" unshare --net)
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

# What the workers of a machine do.
on() { workers "select(.node == \"$1\") | .state" | jq -c unique; }
is_back() { [[ "$(on "$1")" =~ ^\[\"(idle|busy)\" ]]; }
begin_work() # FOLDER FRAMES: a job, and three machines at work on it
{
    id=$(submit "$(job "1-$2" ".output.path = \"$1/f.####.exr\"")")
    wait_until "three machines" has_idle 6
    wait_until "frames are done" has_done "$id" 10
}
end_work() # FOLDER FRAMES: each frame is there once
{
    wait_state "$id" succeeded
    expect_files "$1" "$2"
    never_failed "$id"
}
end_farm()
{
    wait_until "the machines are given back" has_jobs 0
    wait_until "their workers are gone" none_left
    stop_daemon
}

# What runs goes on without Slurm's controller; nothing is asked for and nothing is given up until it is back.
controller()
{
    start_farm
    begin_work controller 500
    settle
    kill_controller
    end_work controller 500
    wait_until "its silence is told" grep -q "Slurm does not answer" "$scratch/daemon.log"
    expect "machines at work" "$(workers .state | jq -c unique)" '["idle"]'
    sleep 4 # longer than machines may be idle: nobody can be asked to take them back
    expect "machines at work" "$(workers .state | jq -c unique)" '["idle"]'
    id=$(submit "$(job 1-100 '.output.path = "alone/f.####.exr"')")
    end_work alone 100
    start_controller || fail "no controller"
    end_farm
}

# sbatch ends without an answer: what it has asked for is found by its name, and not asked for again.
asked()
{
    local count

    printf '#!/bin/sh\necho x >>%s/asked\n%s "$@" >/dev/null\n' "$scratch" "$(command -v sbatch)" >"$scratch/commands/sbatch"
    chmod +x "$scratch/commands/sbatch"
    max=1
    start_farm
    id=$(submit "$(job 1-40 '.output.path = "asked/f.####.exr"')")
    end_work asked 40
    expect "times that sbatch was called" "$(wc -l <"$scratch/asked")" 1
    # The controller dies while it is asked.
    end_farm
    printf '#!/bin/sh\necho x >>%s/asked\n%s "$@" >/dev/null\nwhile [ -e %s/wait ]; do sleep 0.1; done\n' "$scratch" \
        "$(command -v sbatch)" "$scratch" >"$scratch/commands/sbatch"
    touch "$scratch/wait"
    start_farm
    id=$(submit "$(job 1-40 '.output.path = "dies/f.####.exr"')")
    wait_until "it is asked" eval '[ "$(wc -l <"$scratch/asked")" -eq 2 ]'
    wait_until "it is in the queue" has_jobs 1
    settle
    kill_controller
    rm "$scratch/wait" "$scratch/commands/sbatch"
    start_controller || fail "no controller"
    end_work dies 40
    count=$(grep -c "Slurm took job" "$scratch/daemon.log" || true)
    [ "$count" -le 1 ] || fail "Slurm was asked again"
    end_farm
    max=3
}

# The controller dies before it has written down a job, and gives its id to another: that one is nobody's business.
again()
{
    local lost other=

    max=1
    start_farm
    scontrol update partitionname=render state=down
    id=$(submit "$(job 1-40 '.output.path = "again2/f.####.exr"')")
    wait_until "Slurm took it" grep -q "Slurm took job" "$scratch/daemon.log"
    printf '#!/bin/sh\necho "sbatch: not now" >&2\nexit 1\n' >"$scratch/commands/sbatch"
    chmod +x "$scratch/commands/sbatch"
    lost=$(sed -n 's/.*Slurm took job \([0-9]*\)$/\1/p' "$scratch/daemon.log" | tail -n 1)
    kill_controller
    start_controller || fail "no controller"
    if [ -n "$(jobs_of_slurm)" ]; then
        echo "again: the controller had written the job down, its id is not used again"
        scontrol update partitionname=render state=up
    else
        scontrol update partitionname=render state=up
        wait_until "another job has its id" eval 'other=$(sbatch --parsable -N1 -J other -o /dev/null --wrap "sleep 1000"); [ "$other" -ge "$lost" ]'
        expect "the id" "$other" "$lost"
    fi
    rm "$scratch/commands/sbatch"
    end_work again2 40
    wait_until "the machine is given back" has_jobs 0
    if [ -n "$other" ]; then
        expect "the other job" "$(squeue -h -j "$other" -o %T)" RUNNING
        scancel "$other"
    fi
    end_farm
    max=3
}

# A machine loses its power: its frames are rendered elsewhere, and Slurm says what became of it.
power()
{
    start_farm min=3
    begin_work power 300
    power_off n2
    wait_until "the loss is noticed" eval '! is_back n2'
    end_work power 300
    wait_until "Slurm says what happened" grep -q "on n2 ended: NODE_FAIL" "$scratch/daemon.log"
    wait_until "and that no machine is free" says "waits: "
    power_on n2
    wait_until "it answers" all_answer
    begin_work power2 100
    end_work power2 100
    stop_daemon
    start_farm
    end_farm
}

# A step is canceled: it is started again in the same allocation.
step()
{
    local before

    start_farm
    begin_work step 200
    before=$(jobs_of_slurm | sort)
    scancel "$(squeue -h -s -w n1 -o %i | grep -E '\.[0-9]+$' | head -n 1)"
    wait_until "its end is noticed" grep -q "node n1: .* ended" "$scratch/daemon.log"
    wait_until "it is back" is_back n1
    expect "jobs of Slurm" "$(jobs_of_slurm | sort)" "$before"
    end_work step 200
    end_farm
}

# A machine that nobody reaches sends no end of its stream. Its frames run elsewhere; its node ends by itself.
cut()
{
    local init

    start_farm
    begin_work cut 300
    init=$(cat "$cluster/run/n3")
    cut_off n3
    wait_until "its silence is told" grep -q "node n3: nothing was heard of it for 5 s" "$scratch/daemon.log"
    wait_until "its node ended" eval '! nsenter --target "$init" --pid --mount pgrep -f "march-worker --node" >/dev/null'
    end_work cut 300
    join n3
    wait_until "it answers" all_answer
    end_farm
}

none_free()
{
    local others

    others=$(sbatch --parsable --array=1-3 -N1 --exclusive -o /dev/null --wrap "sleep 1000")
    wait_until "all machines are taken" eval '[ "$(sinfo -h -N -t alloc -o %N | wc -l)" -eq 3 ]'
    start_farm
    id=$(submit "$(job 1-40 '.output.path = "free/f.####.exr"')")
    wait_until "Slurm's reason stands with the workers" says "waits: Resources"
    wait_until "and with the job" eval '[[ "$(field "$id" .reason)" == *"waits: "* ]]'
    scancel "$others"
    end_work free 40
    end_farm
}

# Slurm's commands are there, but srun is not.
no_srun()
{
    local command before=("${as_daemon[@]}")

    mkdir "$scratch/some"
    for command in sbatch squeue scancel; do ln -s "$(command -v $command)" "$scratch/some"; done
    as_daemon=(env "PATH=$scratch/some")
    start_farm
    id=$(submit "$(job 1-4 '.output.path = "srun/f.####.exr"')")
    wait_until "it is told" says "srun: no such file"
    stop_daemon
    as_daemon=("${before[@]}")
    start_daemon --workers none --pool "far launcher=slurm max=1 heartbeat=5 idle=2 keep=10 program=/nowhere/march-worker"
    wait_until "what lacks there is told" says "/nowhere/march-worker: No such file or directory"
    stop_daemon
    start_farm
    end_work srun 4
    end_farm
}

# A squeue that is killed while it prints says nothing of the machines that it has not come to.
half_look()
{
    start_farm
    begin_work half 600
    cat >"$scratch/commands/squeue" <<'END'
#!/bin/bash
/usr/bin/squeue "$@" | head -n 2
kill -KILL $$
END
    chmod +x "$scratch/commands/squeue"
    wait_until "its silence is told" grep -q "Slurm does not answer" "$scratch/daemon.log"
    end_work half 600
    expect "machines at work" "$(workers .node | jq -c unique)" '["n1","n2","n3"]'
    grep "knows no job" "$scratch/daemon.log" && fail "a machine was given up"
    rm "$scratch/commands/squeue"
    end_farm
}

# An operator cancels an allocation: that is told, and another is asked for.
operator()
{
    start_farm
    begin_work operator 200
    scancel "$(jobs_of_slurm -w n1)"
    wait_until "it is told" grep -q "on n1 ended: CANCELLED\|on n1 ended: COMPLETING" "$scratch/daemon.log"
    wait_until "it is back" is_back n1
    end_work operator 200
    end_farm
}

# A job whose frames take longer than any allocation asks for none, and says so.
too_long()
{
    sed "s|--worker .*|--worker \"$(stub write:2000)\"|" "$scratch/node" >"$scratch/two" && chmod +x "$scratch/two"
    printf '#!/bin/sh\n%s "$@" | sed "s/|UNLIMITED|/|0:01|/"\n' "$(command -v squeue)" >"$scratch/commands/squeue"
    chmod +x "$scratch/commands/squeue"
    max=1
    start_farm "program=$scratch/two"
    id=$(submit "$(job 1-40 '.output.path = "long/f.####.exr"')")
    wait_until "the job says so" eval '[[ "$(field "$id" .reason)" == *"takes 2 s, Slurm'"'"'s machines stay for 1 s: pool far needs a longer time"* ]]'
    wait_until "the machine is given back" has_jobs 0
    ask job.cancel "{\"id\":$id}" >/dev/null
    rm "$scratch/commands/squeue"
    end_farm
    max=3
}

# The time of allocations runs out. No frame is begun that would not be done; of one whose time is unknown Slurm ends the
# worker, and it costs no attempt.
runs_out()
{
    local slow

    start_farm time=1
    begin_work out 2400
    end_work out 2400
    grep -q "the rest of its time is too short" "$scratch/daemon.log" || fail "the frames were done in a minute"
    ! grep -q "now queued" "$scratch/daemon.log" || fail "a frame was lost: $(grep "now queued" "$scratch/daemon.log" | head -n 1)"
    end_farm
    slow=$(stub write:300000)
    sed "s|--worker .*|--worker \"$slow\"|" "$scratch/node" >"$scratch/slow" && chmod +x "$scratch/slow"
    max=1
    start_farm time=1 "program=$scratch/slow"
    id=$(submit "$(job 1 '.output.path = "slow/f.####.exr"')")
    wait_until "it is told" grep -q "on n1 ended: \(TIMEOUT\|COMPLETING\)" "$scratch/daemon.log"
    wait_until "the frame waits again" grep -q "job $id frame 1 attempt 1: .* now queued" "$scratch/daemon.log"
    never_failed "$id"
    ask job.cancel "{\"id\":$id}" >/dev/null
    end_farm
    max=3
}

# once_and_whole FOLDER COUNT NAMES: so many frames, each of which got its name once, and is the file that got it, whole. A
# line of NAMES is "INODE PATH", by the library that the daemon was started with.
once_and_whole()
{
    local folder=$scratch/out/$1 frame name

    expect_files "$1" "$2"
    expect "names given twice" "$(sed 's/^[0-9]* //' "$3" | sort | uniq -d)" ""
    expect "files that are not those named" \
        "$(find "$folder" -name '*.exr' -printf '%i %p\n' | sort | diff - <(grep -F " $folder/" "$3" | sort))" ""
    for ((frame = 1; frame <= $2; frame++)); do
        name=$(printf '%s/f.%04d.exr' "$folder" $frame)
        [ "$(cat "$name")" = "frame $frame" ] || fail "$name: $(cat "$name")"
    done
}

# Something breaks every second.
chaos()
{
    local ends victim frames=$((minutes * 60 * 20)) round=0 slow

    [ "$minutes" -gt 0 ] || return 0
    echo "chaos: SEED=$seed"
    RANDOM=$seed
    as_daemon+=("LD_PRELOAD=$bin/libmachine_shim.so" "LD_MACHINE_NAMES=$scratch/names")
    slow=$(stub write:500)
    sed "s|--worker .*|--worker \"$slow\"|" "$scratch/node" >"$scratch/half" && chmod +x "$scratch/half"
    start_farm workers=4 gres=gpu:2 "program=$scratch/half"
    id=$(submit "$(job "1-$frames" '.output.path = "chaos/f.####.exr"')")
    ends=$((SECONDS + minutes * 60))
    while [ $SECONDS -lt $ends ]; do
        sleep 1
        round=$((round + 1))
        victim=n$((RANDOM % 3 + 1))
        case $((RANDOM % 8)) in
        0 | 1 | 2) kill -KILL "$(pgrep -o -f "$bin/stub-worker")" ;;
        3) kill -KILL "$(pgrep -n -f "$bin/march-worker --node")" ;;
        4) scancel "$(squeue -h -s -w $victim -o %i 2>/dev/null | grep -E '\.[0-9]+$' | head -n 1)" ;;
        5) kill -KILL "$(pgrep -n -x srun)" ;;
        6)
            [ $((round % 10)) -ne 0 ] || { power_off $victim; power_on $victim; }
            ;;
        7)
            [ $((round % 7)) -ne 0 ] || { kill_daemon; start_farm workers=4 gres=gpu:2 "program=$scratch/half"; }
            ;;
        esac 2>/dev/null
    done
    wait_until "the machines answer" all_answer
    wait_state "$id" succeeded
    once_and_whole chaos "$frames" "$scratch/names"
    echo "chaos: $frames frames, each named once and whole, $round blows"
    end_farm
}

# took BEGIN: milliseconds since EPOCHREALTIME was that.
took() { echo "$(((${EPOCHREALTIME/./} - ${1/./}) / 1000)) ms"; }

# Prints how fast it is: nothing fails.
figures()
{
    local begin round

    sed "s|--worker .*|--worker \"$(stub write:1)\"|" "$scratch/node" >"$scratch/fast" && chmod +x "$scratch/fast"
    for round in 1 2 3; do
        sleep 5 # an idle cluster
        rm -f "$scratch/begun"
        begin=$EPOCHREALTIME
        sbatch -Q -N1 -o /dev/null --wrap "touch $scratch/begun"
        while [ ! -e "$scratch/begun" ]; do sleep 0.01; done
        echo "sbatch to its script: $(took "$begin")"
        sleep 5
        start_farm "program=$scratch/fast"
        begin=$EPOCHREALTIME
        id=$(submit "$(job 1 ".output.path = \"first$round/f.####.exr\"")")
        wait_state "$id" succeeded
        echo "submit to the first frame: $(took "$begin")"
        end_farm
    done
    start_farm min=3
    wait_until "three machines" has_idle 6
    id=$(submit "$(job 1-12 '.output.path = "figure/first.####.exr"')")
    wait_state "$id" succeeded
    for round in 1 2 3; do
        begin=$EPOCHREALTIME
        id=$(submit "$(job 1-200 ".output.path = \"figure/f$round.####.exr\"")")
        wait_state "$id" succeeded
        echo "200 frames of 0.2 s on 6 workers: $(took "$begin"), ideal 6667 ms"
    done
    stop_daemon
}

for part in ${*:-$all}; do
    begin=$SECONDS
    : >"$scratch/daemon.log"
    "$part"
    echo "$part: ok, $((SECONDS - begin)) s"
done
