#!/bin/bash
# march-launch starts the launchers of a daemon that cannot: frames, ends on either side, and what it refuses to start.
. "$(dirname "$0")/farm.sh"
launch_socket=$scratch/launch.sock
launch_pid=

cat >"$scratch/launch" <<END
#!/bin/sh
echo "Welcome to \$1."
echo \$\$ >"$scratch/pid-\$1"
env >"$scratch/env-\$1"
umask >"$scratch/umask-\$1"
exec "$bin/march-worker" --node --worker "$(stub write:20)"
END
chmod +x "$scratch/launch"
cat >"$scratch/marchd.conf" <<END
pool = far launcher=command nodes=anna=2,ben heartbeat=5 command='$scratch/launch {node}'
pool = none launcher=command nodes=carl command='$scratch/no-such-program {node}'
END

# As in its unit, no other user may read what it would write.
start_launch()
{
    rm -f "$launch_socket"
    (cd "$scratch" && umask 077 && exec env TMPDIR=/none LD_LIBRARY_PATH=/none "$bin/march-launch" --config marchd.conf --socket "$launch_socket" 2>>launch.log) &
    launch_pid=$!
    wait_until "march-launch listens" test -S "$launch_socket"
}

# start_walled: a daemon that may start no program but workers of its own machine, of which it has none.
start_walled() { start_daemon --workers none --config "$scratch/marchd.conf" --launch-socket "$launch_socket"; }
workers() { ask worker.list | jq -c "[.result.workers[] | $1]"; }
reason() { ask worker.list | jq -r "[.result.workers[] | select(.node == \"$1\")][0].reason"; }
all_idle() { [ "$(ask worker.list | jq -c '[.result.workers[] | select(.pool == "far") | .state] | unique')" = '["idle"]' ]; }
node_pid() { cat "$scratch/pid-$1"; }
is_gone() { ! grep -q '^State:.[^Z]' "/proc/$1/status" 2>/dev/null; }
all_gone() { local pid; for pid in $1; do is_gone "$pid" || return 1; done; }
workers_of() { pgrep -P "$1" | tr '\n' ' '; }
said() { [[ "$(reason "$1")" == *"$2"* ]]; }

start_launch
start_walled
wait_until "all workers are idle" all_idle
grep -q 'node anna: Welcome to anna.' "$scratch/daemon.log" || fail "the banner is not in the log"
for name in anna ben; do
    parent=$(awk '{ print $4 }' "/proc/$(node_pid $name)/stat")
    [ "$(cat "/proc/$parent/comm")" = march-launch ] || fail "$name was started by $(cat "/proc/$parent/comm")"
done
wait_until "the reason is told" said carl "march-launch: $scratch/no-such-program: No such file or directory"
id=$(submit "$(job 1-60)")
wait_state "$id" succeeded
expect_files cloud 60
expect "the umask of a launcher" "$(cat "$scratch/umask-anna")" 0077
expect "rights of pictures" "$(stat -c %a "$scratch"/out/cloud/* | sort -u)" "$(printf '%o' $((0666 & ~$(umask) & 0644)))"
expect "folders of this machine that nodes hear of" "$(grep -E '^(TMPDIR|LD_LIBRARY_PATH)=' "$scratch/env-anna")" ""

# A node that ends, and one whose launcher is killed, are started again; nothing is left of them.
pid=$(node_pid anna)
children=$(workers_of "$pid")
kill -KILL "$pid"
wait_until "its workers are gone" all_gone "$children"
wait_until "the node is started again" all_idle
[ "$(node_pid anna)" != "$pid" ] || fail "anna is the old one"

# Without march-launch there are no nodes, and the reason says so; they come back with it.
nodes="$(node_pid anna) $(node_pid ben)"
kill -KILL "$launch_pid"
wait "$launch_pid" 2>/dev/null
wait_until "what it had started is gone" all_gone "$nodes"
wait_until "the reason is told" said anna "march-launch, at $launch_socket: Connection refused"
start_launch
wait_until "the nodes are back" all_idle

# The daemon that ends, or is killed, ends its launchers.
pid=$(node_pid ben)
children=$(workers_of "$pid")
stop_daemon
wait_until "the node and its workers are gone" all_gone "$pid $children"
start_walled
wait_until "the nodes are back" all_idle
pid=$(node_pid ben)
children=$(workers_of "$pid")
kill_daemon
wait_until "the node and its workers are gone" all_gone "$pid $children"
wait_until "nothing of them is left" eval '[ -z "$(workers_of "$launch_pid")" ]'

# What a daemon that was taken over could ask for: a line "KIND WORD..." each. Prints what the command said and how it ended.
cat >"$scratch/ask" <<'END'
import os, socket, sys

def ask(kind, words):
    peer = socket.socket(socket.AF_UNIX, socket.SOCK_SEQPACKET)
    peer.connect(sys.argv[1])
    pipes = [os.pipe() for _ in range(4)]
    fds = [pipes[0][0], pipes[1][1], pipes[2][1]]
    if kind == "turned": fds = [pipes[0][1], pipes[1][0], pipes[2][1]]
    if kind == "file": fds[1] = os.open("/dev/null", os.O_WRONLY)
    if kind == "two": fds = fds[:2]
    if kind == "four": fds.append(pipes[3][1])
    if kind == "none": fds = []
    text = b"".join(word.encode() + b"\0" for word in words)
    if kind == "unended": text = text[:-1]
    if kind == "long": text += b"x" * 5000 + b"\0"
    if kind != "nobody": socket.send_fds(peer, [text], fds) # who is answered unheard
    for _, end in pipes: os.close(end)
    errors = os.fdopen(pipes[2][0]).read().strip() if kind == "pipes" else kind
    print(errors + "; " + peer.recv(1000).decode())

for line in sys.stdin:
    kind, *words = line.split()
    if kind == "nobody": os.setgroups([]); os.setgid(65534); os.setuid(65534)
    ask(kind, words)
END
asks() { python3 "$scratch/ask" "$launch_socket"; }
rm -f "$scratch"/pid-*
asks >"$scratch/said" <<END
pipes near node anna
pipes far node dora
pipes far node -oProxyCommand=id
pipes far /bin/sh -c id
pipes far node anna id
pipes far
turned far node anna
file far node anna
two far node anna
four far node anna
none far node anna
unended far node anna
long far node anna
many far node 1 2 3 4 5 6 7 8 9
END
no="; march-launch refused it"
odd="; march-launch does not understand what it is asked for"
cat >"$scratch/expected" <<END
march-launch: $scratch/marchd.conf: there is no pool near$no
march-launch: $scratch/marchd.conf: pool far has no node dora$no
march-launch: $scratch/marchd.conf: pool far has no node -oProxyCommand=id$no
march-launch: $scratch/marchd.conf: pool far runs no command "/bin/sh" with 2 arguments$no
march-launch: $scratch/marchd.conf: pool far runs no command "node" with 2 arguments$no
march-launch: $scratch/marchd.conf: pool far runs no command "" with 0 arguments$no
turned$odd
file$odd
two$odd
four$odd
none$odd
unended$odd
long$odd
many$odd
END
diff "$scratch/expected" "$scratch/said" || fail "march-launch answers otherwise (< expected)"
[ -z "$(ls "$scratch"/pid-* 2>/dev/null)" ] || fail "something was started"
expect "the socket's rights" "$(stat -c %a "$launch_socket")" 600
said=$(asks <<<"pipes far node anna")
[[ $said == *"; the launcher ended with exit status 0" && -s $scratch/pid-anna ]] || fail "the node itself, for comparison: $said"
# What the file no longer has is not started, whatever the daemon remembers; nor is anything while the file has a mistake.
sed -i '/far/d' "$scratch/marchd.conf"
said=$(asks <<<"pipes far node anna")
[[ $said == *"there is no pool far$no" ]] || fail "a pool of yesterday: $said"
echo "colour = red" >>"$scratch/marchd.conf"
said=$(asks <<<"pipes far node anna")
[[ $said == *"colour: there is no such setting"*"$no" ]] || fail "a wrong file: $said"
if [ "$(id -u)" -eq 0 ]; then
    chmod 711 "$scratch" && chmod 666 "$launch_socket"
    expect "another user" "$(asks <<<"nobody far node anna")" "nobody; march-launch serves only the user that it runs as"
fi
kill -0 "$launch_pid" || fail "march-launch ended"
