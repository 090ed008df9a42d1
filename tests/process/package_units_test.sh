#!/bin/sh
# The units are valid to systemd, as restricted as promised, and allow what rendering needs.
set -eu
. "$PROJECT_ROOT/tests/process/package_files.sh"
command -v systemd-analyze >/dev/null || { echo "skipped: there is no systemd-analyze"; exit 77; }
scratch=$(mktemp -d "${TMPDIR:-/tmp}/package_units_test.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
deploy=$PROJECT_ROOT/deploy

# systemd-analyze only warns of settings that it does not know.
understands() { # WHOSE OPTION...
    whose=$1
    shift
    XDG_RUNTIME_DIR=$scratch systemd-analyze verify --man=no "$@" >"$scratch/said" 2>&1 || fail "$whose units: $(cat "$scratch/said")"
    ! grep march "$scratch/said" || fail "systemd does not understand the $whose units"
}
# The system's units are checked in a root of their own, which has the program at its installed path.
mkdir -p "$scratch/root/usr/lib/systemd/system" "$scratch/root/usr/bin"
ln -s usr/bin usr/lib "$scratch/root"
cp /lib/systemd/system/*.target /lib/systemd/system/*.slice "$deploy"/marchd.service "$deploy"/marchd.socket "$deploy"/march-launch.* "$deploy"/march-web.service \
    "$scratch/root/usr/lib/systemd/system"
cp /bin/true "$scratch/root/usr/bin/march-launch"
cp /bin/true "$scratch/root/usr/bin/march-web"
cp /bin/true "$scratch/root/usr/bin/marchd"
cp /bin/true "$scratch/root/usr/bin/march"
understands system --root="$scratch/root" marchd.service marchd.socket march-launch.service march-launch.socket march-web.service
for kind in service socket; do
    cp "$deploy/marchd.$kind" "$scratch/root/usr/lib/systemd/system/marchd@.$kind"
done
understands template --root="$scratch/root" marchd@two.service marchd@two.socket
# A user's units are checked with another program, because they cannot be given a root.
mkdir "$scratch/user"
for unit in marchd march-launch; do
    sed 's|^\(Exec[A-Za-z]*\)=/usr/bin/march[a-z-]*|\1=/bin/true|' "$deploy/user/$unit.service" >"$scratch/user/$unit.service"
    cp "$deploy/user/$unit.socket" "$scratch/user"
done
understands user --user "$scratch"/user/*

# Exposure is at most 2.0.
for unit in marchd.service march-launch.service march-web.service; do
    systemd-analyze security --offline=true --no-pager --threshold=20 "$deploy/$unit" >"$scratch/said" 2>&1 ||
        fail "$unit: exposure above 2.0: $(tail -n 1 "$scratch/said")"
    grep -q 'Overall exposure level' "$scratch/said" || fail "systemd-analyze tells no exposure: $(cat "$scratch/said")"
done

# has UNIT LINE, lacks UNIT KEY
has() { grep -qxF -- "$2" "$deploy/$1" || fail "$1: expected $2"; }
lacks() { ! grep -qE -- "^$2=" "$deploy/$1" || fail "$1: $2 must not be set"; }
lacks marchd.service PrivateDevices   # GPUs
lacks marchd.service PrivateUsers     # peers' user ids
lacks marchd.service ProcSubset       # NVIDIA's driver
lacks marchd.service RuntimeDirectory # systemd would remove the socket with it
lacks marchd.service DynamicUser      # pictures have an owner
for unit in marchd.service user/marchd.service; do
    lacks $unit MemoryDenyWriteExecute # llvmpipe compiles what it renders
    lacks $unit RestrictSUIDSGID       # openat2, by which files are opened below their roots
done
has marchd.service Requires=%N.socket
has user/marchd.service Requires=marchd.socket
for unit in marchd.service user/marchd.service; do
    has $unit Type=notify
    has $unit NotifyAccess=main
    has $unit WatchdogSec=30
    has $unit KillMode=mixed
    has $unit OOMPolicy=continue
    for call in seccomp landlock_create_ruleset landlock_add_rule landlock_restrict_self capset; do
        grep -E '^SystemCallFilter=[^~]' "$deploy/$unit" | grep -qw $call || fail "$unit: a worker may not call $call"
    done
done
has marchd.service 'DeviceAllow=char-drm rw'
has marchd.service 'DeviceAllow=char-nvidia* rw'
has marchd.service 'StateDirectoryMode=0700'
# A root that is not there stops nothing; where a disk is to be mounted on it, the service waits for that.
has marchd.service 'ReadWritePaths=-/srv/%N'
has marchd.service 'RequiresMountsFor=/srv/%N'
# A reload is over when the daemon has answered, and fails where it does: at the socket that the socket's unit opens.
for unit in marchd user/marchd; do
    opened=$(sed -n 's/^ListenStream=//p' "$deploy/$unit.socket")
    has $unit.service "ExecReload=/usr/bin/march reload --socket $opened"
done
# The daemon has no network; who has one sees nothing of the daemon, and serves only its user.
has marchd.service 'PrivateNetwork=yes'
has marchd.service 'RestrictAddressFamilies=AF_UNIX'
has marchd.service 'InaccessiblePaths=-/etc/marchd/ssh'
has marchd.service "ExecStart=/usr/bin/marchd --system --launch-socket /run/marchd/march-launch.sock"
has march-launch.socket 'ListenSequentialPacket=/run/marchd/%N.sock'
has march-launch.socket 'SocketMode=0600'
has march-launch.socket "SocketUser=$(sed -n 's/^User=//p' "$deploy/march-launch.service")"
[ "$(sed -n 's/^User=//p' "$deploy/march-launch.service")" = "$(sed -n 's/^User=//p' "$deploy/marchd.service")" ] ||
    fail "march-launch.service is of another user than marchd.service"
lacks march-launch.service StateDirectory
lacks march-launch.service ReadWritePaths
has march-launch.service Before=marchd.service # frames that run on nodes may finish, too
has march-launch.service 'PrivateUsers=yes' # one user, but neither gets at the other by /proc
grep -q '^InaccessiblePaths=.* -/run/marchd$' "$deploy/march-launch.service" || fail "march-launch.service sees the daemon's socket"
# The page is another user, who sees nothing of the queue, writes nothing but a cache, and makes pictures in fenced workers.
[ "$(sed -n 's/^User=//p' "$deploy/march-web.service")" != "$(sed -n 's/^User=//p' "$deploy/marchd.service")" ] ||
    fail "march-web.service is of marchd's user"
[ "$(sed -n 's/^User=//p' "$deploy/march-web.service")" = "$(sed -n 's/^#web-user = //p' "$deploy/marchd.conf")" ] ||
    fail "marchd.conf takes another web-user for the page's"
lacks march-web.service StateDirectory
lacks march-web.service ReadWritePaths
lacks march-web.service RestrictSUIDSGID # openat2
has march-web.service 'PrivateUsers=yes'
has march-web.service 'ProtectSystem=strict'
has march-web.service 'CacheDirectory=marchd-web'
grep -q '^InaccessiblePaths=-/var/lib/marchd .*-/etc/marchd/ssh$' "$deploy/march-web.service" || fail "march-web.service sees the queue"
for call in seccomp landlock_create_ruleset landlock_add_rule landlock_restrict_self; do
    grep -E '^SystemCallFilter=[^~]' "$deploy/march-web.service" | grep -qw $call || fail "march-web.service: a worker may not call $call"
done
has marchd.socket 'ListenStream=/run/marchd/%N.sock'
has marchd.socket 'SocketMode=0660'
has marchd.socket 'SocketGroup=marchd'
has user/marchd.socket 'ListenStream=%t/marchd.sock'
has user/marchd.socket 'SocketMode=0600'
has user/march-launch.socket 'SocketMode=0600'
has user/marchd.service "ExecStart=/usr/bin/marchd --launch-socket $(sed -n 's/^ListenSequentialPacket=//p' "$deploy/user/march-launch.socket")"

# systemd waits longer than the daemon's own limit for stopping.
limit=$(sed -n 's/^#stop-timeout = //p' "$deploy/marchd.conf")
waits=$(sed -n 's/^TimeoutStopSec=//p' "$deploy/marchd.service")
[ "$waits" -gt "$((limit + 10))" ] || fail "systemd kills after $waits s what may take $limit s to finish"

# Users and folders are those that the programs ask for.
if [ "$(id -u)" -ne 0 ]; then
    echo "users and folders: only root can make them, not looked at"
    exit 0
fi
mkdir "$scratch/root/etc"
systemd-sysusers --root="$scratch/root" "$deploy/marchd.sysusers" >"$scratch/said" 2>&1 || fail "sysusers: $(cat "$scratch/said")"
for group in marchd "$(sed -n 's/^#admin-group = //p' "$deploy/marchd.conf")"; do
    grep -q "^$group:" "$scratch/root/etc/group" || fail "sysusers make no group $group"
done
systemd-sysusers --root="$scratch/root" "$deploy/march-web.sysusers" >"$scratch/said" 2>&1 || fail "sysusers: $(cat "$scratch/said")"
grep -q '^marchd:.*:marchd-web$' "$scratch/root/etc/group" || fail "marchd-web cannot open the daemon's socket"
for group in video render; do
    grep -q "^$group:.*:marchd$" "$scratch/root/etc/group" || fail "marchd is not of group $group, whose the GPUs are"
done
systemd-tmpfiles --root="$scratch/root" --create "$deploy/marchd.tmpfiles" >"$scratch/said" 2>&1 || fail "tmpfiles: $(cat "$scratch/said")"
uid=$(sed -n 's/^marchd:[^:]*:\([0-9]*\):.*/\1/p' "$scratch/root/etc/passwd")
gid=$(sed -n 's/^marchd:[^:]*:\([0-9]*\):.*/\1/p' "$scratch/root/etc/group")
found=$(cd "$scratch/root" && stat -c '%n %a %u:%g' etc/marchd/ssh run/marchd srv/marchd srv/marchd-input | tr '\n' ' ')
[ "$found" = "etc/marchd/ssh 750 0:$gid run/marchd 755 0:0 srv/marchd 755 $uid:$gid srv/marchd-input 2775 0:$gid " ] || fail "folders: $found"

# What was given to another user, for a service with another User=, is left to them at the next boot or upgrade.
chown 4242 "$scratch/root/srv/marchd"
systemd-tmpfiles --root="$scratch/root" --create "$deploy/marchd.tmpfiles"
[ "$(stat -c %u "$scratch/root/srv/marchd")" = 4242 ] || fail "/srv/marchd is taken from its owner"
