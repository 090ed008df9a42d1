# A machine for the system test: systemd-nspawn in control groups of its own, commands in the machine, its shutdown.
# Sourced by tests/service.
leader=
nspawn=
groups=()

# Each machine gets a control group of its own: two systemds in one group would interfere. Failures are ignored, because
# a machine that runs alone needs no group.
make_groups()
{
    local line path mount

    while IFS= read -r line; do
        path=${line#*:*:}
        case $line in
        0::*) mount=$(findmnt -n -o TARGET -t cgroup2 | head -n 1) ;;
        *:name=systemd:*) mount=$(findmnt -n -o TARGET -t cgroup -O name=systemd | head -n 1) ;;
        *) continue ;;
        esac
        [ -n "$mount" ] || continue
        mkdir "$mount${path%/}/marchd-service-$$" 2>/dev/null && groups+=("$mount${path%/}/marchd-service-$$")
    done </proc/self/cgroup
}

remove_groups()
{
    local group

    for group in "${groups[@]}"; do
        find "$group" -depth -type d -exec rmdir {} + 2>/dev/null
    done
    groups=()
}

# boot ROOT: returns once systemd has started all units in the machine.
boot()
{
    local group

    make_groups
    (
        for group in "${groups[@]}"; do
            echo $BASHPID >"$group/cgroup.procs" || true
        done
        exec setpriv --pdeathsig KILL systemd-nspawn -q --register=no --keep-unit --console=pipe -D "$1" \
            --system-call-filter='landlock_create_ruleset landlock_add_rule landlock_restrict_self' \
            --machine="service-$$" -b </dev/null >"$work/console.log" 2>&1
    ) &
    nspawn=$!
    # A plain Debian that does not boot here is no fault of the package.
    comes_true has_begun && [ -n "$leader" ] && comes_true has_booted ||
        skip "systemd-nspawn boots no machine here: $(tail -n 3 "$work/console.log")"
}

# has_begun: the machine's init is found, in $leader, or systemd-nspawn has ended.
has_begun()
{
    local pid

    kill -0 "$nspawn" 2>/dev/null || return 0
    for pid in $(pgrep -P "$nspawn"); do
        [ "$(cat "/proc/$pid/comm")" = systemd ] && leader=$pid && return
    done
    return 1
}

has_booted()
{
    inside systemctl is-system-running --wait 2>/dev/null | grep -qE 'running|degraded'
}

# inside COMMAND...: runs the command in the machine, as root.
inside()
{
    nsenter --target "$leader" --all -- env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 "$@"
}

# as USER COMMAND...: runs the command in the machine, in the user's home.
as()
{
    local user=$1 runtime

    shift
    runtime=/run/user/$(inside id -u "$user")
    inside setpriv --reuid "$user" --regid "$user" --init-groups env --chdir="/home/$user" HOME="/home/$user" \
        USER="$user" XDG_RUNTIME_DIR="$runtime" "$@"
}

# tell_journal SECOND: prints the journal's last lines since then.
tell_journal()
{
    [ -n "$leader" ] && [ -d "/proc/$leader" ] || return
    echo "--- the journal's tail:"
    inside journalctl --no-pager -q -o short-precise --since "@$1" -n 40 2>&1
}

halt_machine()
{
    # The init's end kills all processes of the machine, which are in its PID namespace.
    [ -n "$leader" ] && kill -KILL "$leader" 2>/dev/null
    [ -n "$nspawn" ] && kill -TERM "$nspawn" 2>/dev/null && wait "$nspawn" 2>/dev/null
    leader=
    nspawn=
    sleep 0.2
    remove_groups
}
