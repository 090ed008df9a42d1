# A booted machine for the system test: systemd-nspawn in control groups of its own, commands in it, its end. Sourced by
# tests/service.
leader=
nspawn=
groups=()

# Two machines in one control group would be one systemd's to the other. Best effort: alone, none of it matters.
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

# boot ROOT: returns once its systemd has started all it starts.
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
    # A plain Debian that does not boot here says nothing of ours.
    comes_true has_begun && [ -n "$leader" ] && comes_true has_booted ||
        skip "systemd-nspawn boots no machine here: $(tail -n 3 "$work/console.log")"
}

# Finds the machine's init, or that there is none and will be none.
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

# inside COMMAND...: in the machine, as root.
inside()
{
    nsenter --target "$leader" --all -- env -i PATH=/usr/sbin:/usr/bin:/sbin:/bin HOME=/root LC_ALL=C.UTF-8 "$@"
}

# as USER COMMAND...: in the machine, in the user's home.
as()
{
    local user=$1 runtime

    shift
    runtime=/run/user/$(inside id -u "$user")
    inside setpriv --reuid "$user" --regid "$user" --init-groups env --chdir="/home/$user" HOME="/home/$user" \
        USER="$user" XDG_RUNTIME_DIR="$runtime" "$@"
}

# tell_journal SECOND: its tail since then.
tell_journal()
{
    [ -n "$leader" ] && [ -d "/proc/$leader" ] || return
    echo "--- the journal's tail:"
    inside journalctl --no-pager -q -o short-precise --since "@$1" -n 40 2>&1
}

halt_machine()
{
    # Its init takes all with it: they are in its namespace of processes.
    [ -n "$leader" ] && kill -KILL "$leader" 2>/dev/null
    [ -n "$nspawn" ] && kill -TERM "$nspawn" 2>/dev/null && wait "$nspawn" 2>/dev/null
    leader=
    nspawn=
    sleep 0.2
    remove_groups
}
