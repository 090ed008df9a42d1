# What other machines are to the service: march-launch's unit, and nodes by ssh and Slurm, which are this machine itself.
# Sourced by tests/service.

# worker_package_installs: the node's package alone.
worker_package_installs()
{
    apt install /root/marchd-worker.deb
    inside march-worker --version | grep -q "^march-worker " || fail "march-worker does not run"
    inside sh -c '! ldd /usr/bin/march-worker | grep "not found"' || fail "libraries are missing"
    expect "units" "$(find "$root/lib/systemd/system" "$root/usr/lib/systemd" -name 'march*')" ""
    expect "users" "$(grep -c '^marchd' "$root/etc/passwd")" 0
    expect "other programs" "$(ls "$root/usr/bin/march" "$root/usr/bin/marchd" 2>/dev/null)" ""
    # A node without a daemon ends when its stream does.
    inside sh -c ': | march-worker --node | cat' >"$work/hello"
    grep -q '^marchd-node {' "$work/hello" || fail "it is no node: $(cat "$work/hello")"
    apt purge marchd-worker
    expect "what is left" "$(ls "$root/usr/bin/march-worker" 2>/dev/null)" ""
}

# start_sshd: on a port of 127.0.0.1, which is in $port. Keys are made and put there as docs/operations.md says.
start_sshd()
{
    local line ssh=$root/etc/marchd/ssh

    cat >"$root/root/make_keys" <<'END'
cd /etc/marchd/ssh
ssh-keygen -q -t ed25519 -N '' -f id && chgrp marchd id && chmod 640 id && echo "restrict,command=\"/usr/bin/march-worker --node\" $(cat id.pub)" >node_key
install -D -o marchd -m 600 node_key ~marchd/.ssh/authorized_keys
END
    while IFS= read -r line; do
        grep -qxF -- "$line" "$here/../docs/operations.md" || [ "$line" = "cd /etc/marchd/ssh" ] || fail "docs/operations.md says otherwise: $line"
    done <"$root/root/make_keys"
    inside sh -e /root/make_keys
    inside mkdir -p /run/sshd
    inside usermod -s /bin/sh marchd
    until
        port=$((20000 + RANDOM % 12000))
        inside systemd-run -q --unit="test-sshd-$port" /usr/sbin/sshd -D -p "$port" -o ListenAddress=127.0.0.1 -o PidFile=none
        comes_true eval '! inside systemctl is-active -q "test-sshd-$port" || inside journalctl -q -u "test-sshd-$port" -g "Server listening"'
        inside systemctl is-active -q "test-sshd-$port"
    do :; done
    inside ssh-keyscan -t ed25519 -p "$port" 127.0.0.1 >"$ssh/known_hosts"
    printf '%s\n' 'Host node1' "    Port $port" '    HostName 127.0.0.1' >>"$ssh/config"
}

node_says() { inside journalctl -q -u marchd.service -o cat -g "$1" >/dev/null; }

# as_daemon COMMAND...: what a daemon that was taken over can do.
as_daemon() { inside nsenter -t "$(main_pid)" -m -n -i -- setpriv --reuid marchd --regid marchd --init-groups --no-new-privs "$@"; }

# keys_are_out_of_reach PID...: of march-launch and of what it has started, which are of the daemon's user.
keys_are_out_of_reach()
{
    local pid

    ! as_daemon cat /etc/marchd/ssh/id || fail "the daemon reads ssh's key"
    as_daemon cat "/proc/$(main_pid)/root/etc/marchd/marchd.conf" >/dev/null || fail "the daemon does not reach its own files by /proc: that says nothing of others"
    for pid; do
        inside test -d "/proc/$pid" || fail "there is no process $pid"
        ! as_daemon cat "/proc/$pid/root/etc/marchd/ssh/id" || fail "the daemon reads ssh's key by /proc"
        ! as_daemon sh -c ": >>/proc/$pid/mem" || fail "the daemon writes the memory of a process of march-launch"
        ! as_daemon readlink "/proc/$pid/ns/net" || fail "the daemon opens the network of march-launch"
    done
}

node_renders()
{
    local id launch port

    start_sshd
    # The key starts a node, whatever it is used for.
    inside setpriv --reuid marchd --regid marchd --clear-groups sh -c \
        'sleep 1 | ssh -T -o BatchMode=yes -F /etc/marchd/ssh/config node1 id' >"$work/hello"
    grep -q '^marchd-node {' "$work/hello" && ! grep -q uid= "$work/hello" || fail "the key is for anything: $(cat "$work/hello")"
    # A launcher that tries what a march-launch that was taken over could try.
    cat >"$root/usr/local/bin/probe" <<'END'
#!/bin/sh
reach() { "$@" >/dev/null 2>&1 && echo "reaches: $*" >&2; }
reach ls /var/lib/marchd
reach ls /var/cache/marchd
reach ls /srv/marchd
reach ls /srv/marchd-input
reach ls /run/marchd
reach ls /proc/1
reach grep -qx marchd /proc/[0-9]*/comm
reach ls /home/ann
reach ls /dev/dri
reach touch /etc/marchd/probe
reach touch /usr/bin/probe
reach cat /etc/shadow
reach unshare -U true
cat /etc/marchd/ssh/id >/dev/null && echo "reads its key" >&2
echo "probe ends" >&2
END
    chmod +x "$root/usr/local/bin/probe"
    cp "$root/etc/marchd/marchd.conf" "$work/conf"
    set_conf "workers = none" "pool = far launcher=ssh nodes=node1 ssh-config=/etc/marchd/ssh/config" \
        "pool = probe launcher=command nodes=probe command='/usr/local/bin/probe {node}'"
    inside systemctl restart marchd.service
    id=$(submit ann "$(cloud_job 1-3 64 36 faraway)")
    as ann march wait "$id"
    landed_once faraway 3
    expect "who rendered" "$(inside march workers --json | jq -c '[.. | objects | select(.node? == "node1") | .pool]')" '["far"]'
    # ssh belongs to march-launch's unit, which has a network; the daemon has none, and no keys.
    launch=$(inside systemctl show -P MainPID march-launch.service)
    expect "who runs march-launch" "$(inside ps -o user= -p "$launch")" marchd
    expect "ssh's unit" "$(inside sh -c 'ps -o unit= -p "$(pgrep -x ssh)"')" march-launch.service
    [ "$(inside readlink "/proc/$(main_pid)/ns/net")" != "$(inside readlink "/proc/$launch/ns/net")" ] || fail "the daemon has a network"
    keys_are_out_of_reach "$launch" "$(inside pgrep -x ssh)"
    expect "the rights of a picture from a node" "$(stat -c %a "$root/srv/marchd/faraway/c.0001.exr")" 644
    until_true "the probe has run" node_says "node probe: probe ends"
    node_says "node probe: reads its key" || fail "march-launch cannot read ssh's key"
    node_says "node probe: reaches" && fail "$(inside journalctl -q -u marchd.service -o cat -g 'node probe: reaches')"
    # A stop lets a frame finish on the node, too. The end of the daemon is the end of the node.
    id=$(submit ann "$(cloud_job 1 480 270 lastfar)")
    until_true "its frame is being rendered" eval '[ "$(job_field ann '"$id"' .running)" = 1 ]'
    inside systemctl stop marchd.socket marchd.service
    landed_once lastfar 1
    until_true "nothing is left of the node" eval '[ -z "$(inside pgrep -f "march-worker|march-launch" || true)" ]'
    cp "$work/conf" "$root/etc/marchd/marchd.conf"
    inside systemctl start marchd.socket marchd.service
    inside systemctl stop "test-sshd-$port"
    inside sh -c 'rm -f /etc/marchd/ssh/id* /etc/marchd/ssh/known_hosts /etc/marchd/ssh/node_key /usr/local/bin/probe'
}

# start_slurm: a cluster of this machine alone, on ports of 127.0.0.1; the first is in $slurm_port.
start_slurm()
{
    local name

    name=$(inside hostname -s)
    inside mkdir -p /run/test-slurm/controller /run/test-slurm/node
    until
        slurm_port=$((20000 + RANDOM % 12000))
        cat >"$root/etc/slurm/slurm.conf" <<END
ClusterName=tests
SlurmctldHost=$name(127.0.0.1)
SlurmctldPort=$slurm_port
SlurmdPort=$((slurm_port + 1))
SlurmUser=root
SlurmdUser=root
StateSaveLocation=/run/test-slurm/controller
SlurmdSpoolDir=/run/test-slurm/node
SlurmctldPidFile=/run/test-slurm/controller.pid
SlurmdPidFile=/run/test-slurm/node.pid
MailProg=/bin/true
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
MpiDefault=none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
SlurmdParameters=config_overrides
ReturnToService=2
NodeName=$name NodeAddr=127.0.0.1 CPUs=4 RealMemory=500 State=UNKNOWN
PartitionName=render Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
        inside systemd-run -q --unit="test-slurmctld-$slurm_port" /usr/sbin/slurmctld -D
        inside systemd-run -q --unit="test-slurmd-$slurm_port" /usr/sbin/slurmd -D -N "$name"
        comes_true eval '! slurm_runs || inside sinfo -h -o %t | grep -qx idle'
        slurm_runs
    do :; done
}

slurm_runs()
{
    inside systemctl is-active -q "test-slurmctld-$slurm_port" && inside systemctl is-active -q "test-slurmd-$slurm_port"
}

slurm_renders()
{
    local id slurm_port

    start_slurm
    cp "$root/etc/marchd/marchd.conf" "$work/conf"
    set_conf "workers = none" "pool = lent launcher=slurm workers=1 max=1 idle=1"
    inside systemctl restart marchd.service
    id=$(submit ann "$(cloud_job 1-3 64 36 lent)")
    as ann march wait "$id"
    landed_once lent 3
    expect "who rendered" "$(inside march workers --json | jq -c '[.. | objects | .pool? // empty] | unique')" '["lent"]'
    expect "the rights of a picture" "$(stat -c %a "$root/srv/marchd/lent/c.0001.exr")" 644
    # srun has the network, and the daemon gets at neither.
    id=$(submit ann "$(cloud_job 1 480 270 lastlent)")
    until_true "its frame is being rendered" eval '[ "$(job_field ann '"$id"' .running)" = 1 ]'
    expect "srun's unit" "$(inside sh -c 'ps -o unit= -p "$(pgrep -o -x srun)"')" march-launch.service
    keys_are_out_of_reach "$(inside pgrep -o -x srun)"
    as ann march wait "$id"
    until_true "the machine is given back" eval '[ -z "$(inside squeue -h)" ]'
    inside systemctl stop "test-slurmd-$slurm_port" "test-slurmctld-$slurm_port"
    inside rm -r /etc/slurm/slurm.conf /run/test-slurm
    cp "$work/conf" "$root/etc/marchd/marchd.conf"
    inside systemctl restart marchd.service
}
