#!/bin/bash
# Nodes by ssh, through real sshds of this user on 127.0.0.1: frames, banners, kills, and what is said when ssh fails.
#   tests/cluster_parts/ssh_test.sh     with the programs of PROGRAM_FOLDER (build/clang/bin)
# Exit status 77, with the reason, where there is no sshd.
here=$(cd "$(dirname "$0")/../.." && pwd)
export PROGRAM_FOLDER=${PROGRAM_FOLDER:-$here/build/clang/bin} PROJECT_ROOT=$here
sshd=$(PATH=$PATH:/usr/sbin:/sbin command -v sshd) && command -v ssh ssh-keygen >/dev/null ||
    { echo "skipped: there is no sshd (apt-get install openssh-server openssh-client)"; exit 77; }
# An sshd of root wants a folder in /run: it gets one of its own.
if [ "$(id -u)" -eq 0 ] && [ ! -d /run/sshd ]; then
    [ -z "${HAS_OWN_RUN-}" ] || { echo "skipped: /run/sshd cannot be made"; exit 77; }
    exec unshare --mount bash -c 'mount -t tmpfs run /run && mkdir -m 755 /run/sshd; HAS_OWN_RUN=1 exec "$0"' "$here/tests/cluster_parts/ssh_test.sh"
fi
. "$here/tests/process/farm.sh"
patience_s=${PATIENCE_S:-$patience_s}
keys=$scratch/ssh
mkdir -m 700 "$keys"
declare -A sshd_pid port

ssh-keygen -q -t ed25519 -N '' -f "$keys/user" && ssh-keygen -q -t ed25519 -N '' -f "$keys/other" || fail "ssh-keygen"
cp "$keys/user.pub" "$keys/authorized"
# What the login shell runs first on each machine.
cat >"$keys/login" <<'END'
#!/bin/sh
echo "Welcome to this machine."
printf 'You have mail. '
exec sh -c "$SSH_ORIGINAL_COMMAND"
END
chmod +x "$keys/login"

# start_sshd NAME: with its own host key, on the port that it had before, or a free one.
start_sshd()
{
    local name=$1 tries

    [ -f "$keys/host-$name" ] || ssh-keygen -q -t ed25519 -N '' -f "$keys/host-$name" || fail "ssh-keygen"
    for tries in $(seq 50); do
        : "${port[$name]:=$((20000 + RANDOM % 12000))}"
        cat >"$keys/sshd-$name" <<END
ListenAddress 127.0.0.1:${port[$name]}
HostKey $keys/host-$name
AuthorizedKeysFile $keys/authorized
PidFile none
UsePAM no
StrictModes no
PasswordAuthentication no
KbdInteractiveAuthentication no
PermitRootLogin prohibit-password
ForceCommand $keys/login
END
        : >"$keys/log-$name"
        "$sshd" -D -e -f "$keys/sshd-$name" 2>"$keys/log-$name" &
        sshd_pid[$name]=$!
        wait_until "sshd listens or ends" eval 'grep -q "Server listening" "$keys/log-$name" || ! kill -0 "${sshd_pid[$name]}" 2>/dev/null'
        kill -0 "${sshd_pid[$name]}" 2>/dev/null && return
        grep -q "already in use" "$keys/log-$name" || fail "sshd: $(cat "$keys/log-$name")"
        wait "${sshd_pid[$name]}"
        port[$name]=
    done
    fail "no free port"
}

# knows NAME KEY: what this user holds for the host key of NAME.
knows() { echo "$1 $(cut -d' ' -f1,2 "$keys/$2.pub")" >>"$keys/known_hosts"; }

host()
{
    cat >>"$keys/config" <<END
Host $1
    Port $2
    HostKeyAlias $1
    ${3-}
END
}

descendants() { local child; for child in $(pgrep -P "$1"); do echo "$child"; descendants "$child"; done; }
# node_pid NAME: of march-worker --node under that sshd.
node_pid() { for pid in $(descendants "${sshd_pid[$1]}"); do [[ $(tr '\0' ' ' <"/proc/$pid/cmdline") != *march-worker*"--node "* ]] || echo "$pid"; done 2>/dev/null | tail -n 1; }
is_gone() { ! grep -q '^State:.[^Z]' "/proc/$1/status" 2>/dev/null; }
all_gone() { local pid; for pid in $1; do is_gone "$pid" || return 1; done; }
workers() { ask worker.list | jq -c "[.result.workers[] | $1]"; }
reason() { ask worker.list | jq -r "[.result.workers[] | select(.node == \"$1\")][0].reason"; }
states() { ask worker.list | jq -r "[.result.workers[] | select(.node == \"$1\") | .state] | unique | join(\",\")"; }
has_states() { [ "$(states "$1")" = "$2" ]; }
has_done() { [ "$(field "$1" .succeeded)" -ge "$2" ]; }

start_sshd anna
start_sshd ben
knows anna host-anna
knows ben host-ben
knows carl other # another host key than the one it has; dora has none here
knows eric host-anna
host anna "${port[anna]}"
host ben "${port[ben]}"
host carl "${port[anna]}"
host dora "${port[anna]}"
host eric "${port[anna]}" "IdentityFile $keys/other"
cat >>"$keys/config" <<END
Host *
    HostName 127.0.0.1
    User $(id -un)
    IdentitiesOnly yes
    UserKnownHostsFile $keys/known_hosts
    GlobalKnownHostsFile /dev/null
Host * !eric
    IdentityFile $keys/user
END
cat >"$scratch/stub-node" <<END
#!/bin/sh
exec "$bin/march-worker" "\$@" --worker "$(stub write:20)"
END
chmod +x "$scratch/stub-node"
unset SSH_AUTH_SOCK

# A real picture, by real workers behind a shell that prints.
start_daemon --workers none --pool "far launcher=ssh nodes=anna ssh-config=$keys/config program=$bin/march-worker"
wait_until "the node's worker is idle" has_states anna idle
grep -q 'node anna: Welcome to this machine.' "$scratch/daemon.log" || fail "the banner is not in the log"
id=$(submit "$(job 1-2 '.output.path = "real/r.####.exr"')")
wait_state "$id" succeeded
"$bin/march" verify "$scratch/out/real" >"$scratch/verified" || fail "verify: $(cat "$scratch/verified")"
node=$(node_pid anna)
children=$(pgrep -P "$node")
stop_daemon
wait_until "the node and its workers are gone" all_gone "$node $children"

# What ssh says when it fails stands with the workers, as one sentence.
start_daemon --workers none \
    --pool "far launcher=ssh nodes=anna=2,ben ssh-config=$keys/config program=$scratch/stub-node heartbeat=5" \
    --pool "bad launcher=ssh nodes=carl,dora,eric ssh-config=$keys/config" \
    --pool "none launcher=ssh nodes=ben program=/nowhere/march-worker ssh-config=$keys/config"
for name in anna ben; do wait_until "workers of $name are idle" eval '[[ $(states $name) == *idle* ]]'; done
# says NAME TEXT: in the table for people. A node that is tried again says so meanwhile.
says() { "$bin/march" workers --socket "$socket" | grep -qF "node $1: $2"; }
wait_until "carl's key is refused" says carl "its stream ended: Host key verification failed."
wait_until "dora's key is refused" says dora "its stream ended: Host key verification failed."
wait_until "eric refuses" says eric "its stream ended: $(id -un)@127.0.0.1: Permission denied (publickey)."

# A node is killed: its frames are rendered elsewhere, and it comes back.
id=$(submit "$(job 1-200 '.output.path = "kill/k.####.exr"')")
wait_until "frames are done" has_done "$id" 10
node=$(node_pid anna)
children=$(pgrep -P "$node")
[ -n "$children" ] || fail "the node has no workers"
kill -KILL "$node"
wait_state "$id" succeeded
expect_files kill 200
wait_until "its workers are gone" all_gone "$children"
wait_until "it is back" has_states anna idle

# A machine's sshd is gone with all its sessions: what it started ends by itself, frames go elsewhere until it is back.
id=$(submit "$(job 1-200 '.output.path = "cut/c.####.exr"')")
wait_until "frames are done" has_done "$id" 10
node=$(node_pid anna)
children=$(pgrep -P "$node")
sessions=$(for pid in $(descendants "${sshd_pid[anna]}"); do [ "$(cat "/proc/$pid/comm")" != sshd ] || echo "$pid"; done)
# shellcheck disable=SC2086 # a list of numbers
kill -KILL "${sshd_pid[anna]}" $sessions
wait_until "the node and its workers are gone" all_gone "$node $children"
wait_state "$id" succeeded
expect_files cut 200
wait_until "its absence is told" eval '[[ "$(reason anna)" == *"Connection refused"* ]]'
start_sshd anna
wait_until "it is back" has_states anna idle
expect "attempts that failed" "$(ask job.log "{\"id\":$id}" | jq '[.result.attempts[] | select(.outcome == "failed")] | length')" 0

# A daemon that is killed leaves nothing on its nodes.
node=$(node_pid anna)
children=$(pgrep -P "$node")
kill_daemon
wait_until "the node and its workers are gone" all_gone "$node $children"
echo "nodes by ssh: ok"
