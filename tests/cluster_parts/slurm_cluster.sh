# A Slurm cluster of three machines on this one, for tests. Each machine is a namespace of processes, mounts, host name and
# network; a bridge joins them. Whoever sources this is run again in namespaces of its own, so nothing is left behind.
# Wants `cluster`, a folder of at most 60 characters, to be set.
cluster_nodes="n1 n2 n3"

# cluster_lack: says what this machine lacks; nothing where a cluster can be.
cluster_lack()
{
    local program missing=

    PATH=$PATH:/usr/sbin:/sbin
    for program in slurmctld:slurmctld slurmd:slurmd sbatch:slurm-client munged:munge ip:iproute2 unshare:util-linux jq:jq; do
        command -v "${program%:*}" >/dev/null || missing="$missing ${program#*:}"
    done
    if [ -n "$missing" ]; then
        echo "apt-get install$missing"
    elif [ "$(id -u)" -ne 0 ]; then
        echo "machines of its own need root"
    elif ! unshare --pid --fork --mount --net --uts sh -c 'mount -t tmpfs x /mnt && ip link add br0 type bridge' 2>/dev/null; then
        echo "this machine makes no namespaces with a network"
    fi
}

# machine NODE COMMAND...: runs it there.
machine() { nsenter --target "$(cat "$cluster/run/$1")" --mount --uts --pid --net -- "${@:2}"; }

make_machine() # NODE
{
    local number=${1#n} init parent

    # The first process of the machine: all others there end with it.
    unshare --pid --mount-proc --uts --net --fork --kill-child bash -c 'hostname "$1"; ip link set lo up; trap : TERM INT HUP
        touch "$2/run/$1.is-up"; while :; do sleep 1000 & wait; done' - "$1" "$cluster" </dev/null >>"$cluster/log/$1" 2>&1 &
    parent=$!
    until [ -e "$cluster/run/$1.is-up" ]; do sleep 0.02; done
    rm "$cluster/run/$1.is-up"
    init=$(ps -o pid= --ppid "$parent" | tr -d ' ')
    echo "$init" >"$cluster/run/$1"
    ip link add "v$1" type veth peer name eth0 netns "$init" && ip link set "v$1" master br0 up
    machine "$1" sh -c "ip addr add 198.18.0.$((10 + number))/24 dev eth0 && ip link set eth0 up"
}

start_slurmd() # NODE
{
    mkdir -p "$cluster/spool/$1"
    machine "$1" slurmd -D -N "$1" </dev/null >>"$cluster/log/slurmd-$1" 2>&1 &
}

start_controller()
{
    slurmctld -D </dev/null >>"$cluster/log/slurmctld" 2>&1 &
    controller=$!
    until scontrol ping 2>/dev/null | grep -q 'is UP'; do
        kill -0 "$controller" || { tail -n 20 "$cluster/log/slurmctld" >&2; return 1; }
        sleep 0.05
    done
}

kill_controller()
{
    kill -KILL "$controller"
    wait "$controller" 2>/dev/null
    return 0
}

power_off()
{
    kill -KILL "$(cat "$cluster/run/$1")"
    ip link delete "v$1" 2>/dev/null
    return 0
}

power_on()
{
    rm -rf "$cluster/spool/$1"
    make_machine "$1"
    start_slurmd "$1"
}

cut_off() { ip link set "v$1" down; }
join() { ip link set "v$1" up; }
munge_answers() { munge -S "$cluster/munge/socket" -n 2>/dev/null | unmunge -S "$cluster/munge/socket" >/dev/null 2>&1; }
all_answer() { [ "$(sinfo -h -N -o '%N %t' | sort -u | grep -cE ' (idle|mix|alloc)$')" -eq 3 ]; }
steps_run() { timeout 20 srun -Q --mpi=none --immediate=10 -N3 true 2>/dev/null; }

write_settings()
{
    local node

    mkdir -p "$cluster"/{etc,log,run,munge,state,spool,dev}
    printf '127.0.0.1 localhost\n198.18.0.1 ctl\n198.18.0.11 n1\n198.18.0.12 n2\n198.18.0.13 n3\n' >"$cluster/etc/hosts"
    head -c 1024 /dev/urandom >"$cluster/munge/key"
    chmod 400 "$cluster/munge/key"
    chmod 755 "$cluster" "$cluster/munge"
    for node in 0 1; do mknod "$cluster/dev/gpu$node" c 1 3; done
    echo "NodeName=n[1-3] Name=gpu File=$cluster/dev/gpu[0-1]" >"$cluster/etc/gres.conf"
    cat >"$cluster/etc/slurm.conf" <<END
ClusterName=tests
SlurmctldHost=ctl(198.18.0.1)
SlurmUser=root
SlurmdUser=root
AuthType=auth/munge
CredType=cred/munge
AuthInfo=socket=$cluster/munge/socket,cred_expire=5
StateSaveLocation=$cluster/state
SlurmdSpoolDir=$cluster/spool/%n
SlurmctldPidFile=$cluster/run/slurmctld.pid
SlurmdPidFile=$cluster/run/slurmd.%n.pid
MailProg=/bin/true
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
JobAcctGatherType=jobacct_gather/none
AccountingStorageType=accounting_storage/none
JobCompType=jobcomp/none
MpiDefault=none
SwitchType=switch/none
SchedulerType=sched/backfill
SchedulerParameters=batch_sched_delay=0,sched_interval=5,bf_interval=5
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
ReturnToService=2
SlurmctldTimeout=15
SlurmdTimeout=5
BatchStartTimeout=10
MessageTimeout=5
KillWait=5
MinJobAge=300
GresTypes=gpu
END
    for node in 1 2 3; do
        echo "NodeName=n$node NodeAddr=198.18.0.1$node CPUs=4 RealMemory=2000 Gres=gpu:2 State=UNKNOWN"
    done >>"$cluster/etc/slurm.conf"
    echo "PartitionName=render Nodes=ALL Default=YES MaxTime=INFINITE DefaultTime=INFINITE State=UP" >>"$cluster/etc/slurm.conf"
}

start_cluster()
{
    local node

    export SLURM_CONF=$cluster/etc/slurm.conf PATH=$PATH:/usr/sbin:/sbin
    write_settings
    mount --bind "$cluster/etc/hosts" /etc/hosts && hostname ctl || return 1
    ip link set lo up && ip link add br0 type bridge && ip addr add 198.18.0.1/24 dev br0 && ip link set br0 up || return 1
    munged -F --key-file="$cluster/munge/key" --socket="$cluster/munge/socket" --pid-file="$cluster/munge/pid" \
        --seed-file="$cluster/munge/seed" --log-file="$cluster/log/munged" </dev/null >>"$cluster/log/munged" 2>&1 &
    munged=$!
    wait_until "munged answers or ends" eval 'munge_answers || ! kill -0 "$munged" 2>/dev/null'
    munge_answers || { tail -n 3 "$cluster/log/munged" >&2; return 1; }
    for node in $cluster_nodes; do make_machine "$node" || return 1; done
    start_controller || return 1
    for node in $cluster_nodes; do start_slurmd "$node"; done
    wait_until "the machines answer" all_answer
    wait_until "steps run" steps_run
}
