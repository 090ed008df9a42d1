# Installing, inspecting, upgrading and purging the package. Sourced by tests/service.

# make_revision DEB FILE SUFFIX: writes the same package with a later version, which needs that of marchd-worker.
make_revision()
{
    local folder=$work/revision

    rm -rf "$folder"
    dpkg-deb -R "$1" "$folder"
    sed -i "s/^Version: .*/&$3/; s/marchd-worker (= [^)]*/&$3/" "$folder/DEBIAN/control"
    dpkg-deb --root-owner-group -b "$folder" "$2" >/dev/null
    rm -rf "$folder"
}

apt()
{
    inside env DEBIAN_FRONTEND=noninteractive apt-get -qq -y -o Dpkg::Use-Pty=0 "$@"
}

# unowned_files: files that no package owns, without logs, the records of systemd and apt, and the test's own.
unowned_files()
{
    comm -23 <(find "$root" -xdev \( -path "$root/proc" -o -path "$root/sys" -o -path "$root/dev" -o -path "$root/run" \
        -o -path "$root/tmp" -o -path "$root/var/tmp" -o -path "$root/var/log" -o -path "$root/var/lib/dpkg" \
        -o -path "$root/var/lib/apt" -o -path "$root/var/cache/apt" -o -path "$root/root" -o -path "$root/home" \) -prune \
        -o -printf '/%P\n' | sort) <(cat "$root"/var/lib/dpkg/info/*.list | sort -u)
}

package_installs()
{
    unowned_files >"$work/before"
    apt install /root/marchd.deb /root/marchd-worker.deb
    expect "state of the package" "$(inside dpkg-query -W -f '${db:Status-Status}' marchd)" installed
    expect "version" "$(inside marchd --version | head -n 1)" "marchd $(inside dpkg-query -W -f '${Version}' marchd | sed 's/-.*//')"
    inside march help >/dev/null
}

service_is_active()
{
    expect "socket" "$(inside systemctl is-active marchd.socket)" active
    expect "service" "$(inside systemctl is-active marchd.service)" active
    expect "at a boot" "$(inside systemctl is-enabled marchd.socket marchd.service | tr '\n' ' ')" "enabled enabled "
    expect "the socket's rights" "$(inside stat -c '%G %a' /run/marchd/marchd.sock)" "marchd 660"
    expect "who runs it" "$(inside ps -o user= -p "$(main_pid)")" marchd
    expect "the queue's folder" "$(inside stat -c '%U %a' /var/lib/marchd)" "marchd 700"
    until_true "a worker is ready" eval '[ "$(journal -u marchd.service | grep -c "ready: ")" -ge 1 ]'
}

status_tells()
{
    tells_status()
    {
        inside systemctl status --no-pager -l marchd.service >"$work/status"
        grep -q 'Status: "jobs: 0; frames: 0 queued, 0 running"' "$work/status"
    }
    comes_true tells_status || { cat "$work/status"; fail "no such line"; }
    expect "failed units" "$(inside systemctl --failed --no-legend --plain | grep -c marchd)" 0
}

exposure_is_low()
{
    local exposure

    exposure=$(inside systemd-analyze security --no-pager marchd.service | sed -nE 's/.*exposure level.*: ([0-9.]+) .*/\1/p')
    echo "exposure: $exposure"
    awk -v e="$exposure" 'BEGIN { exit !(e != "" && e <= 2.0) }' || fail "exposure is $exposure"
}

upgrade_goes_on()
{
    local id second waiting

    reload "user-jobs = 3" "log-level = debug"
    # A client that waits for a job goes on waiting.
    cloud_job 1 64 36 waited >"$root/home/ann/job.json"
    as ann march submit --paused --wait job.json >"$work/waited" 2>"$work/told" &
    waiting=$!
    until_true "a client waits" grep -q 'paused by ann' "$work/told"
    id=$(submit ann "$(cloud_job 1-7 480 270 upgraded)")
    until_true "two frames are done" has_done ann "$id" 2
    list_files upgraded >"$work/list"
    start_second_farm marchd@two
    second=$(inside systemctl show -P MainPID marchd@two)
    apt install /root/marchd-next.deb /root/marchd-worker-next.deb
    [ "$(inside systemctl show -P MainPID marchd@two)" != "$second" ] || fail "the second farm is the old one still"
    expect "second farm" "$(inside systemctl is-active marchd@two.service)" active
    [[ $(inside dpkg-query -W -f '${Version}' marchd) == *+next ]] || fail "the package is not the next"
    expect "service" "$(inside systemctl is-active marchd.service)" active
    as ann march resume "$(sed -n '1s/^job \([0-9]*\): .*/\1/p' "$work/told")"
    wait "$waiting"
    grep -q '^the daemon closed the connection: waiting' "$work/told" || fail "the client was told: $(cat "$work/told")"
    as ann march wait "$id"
    landed_once upgraded 7 "$work/list"
    expect "attempts" "$(as ann march frames --json "$id" | jq -c '[.. | .attempts? // empty] | unique')" "[1]"
    grep -q '^user-jobs = 3$' "$root/etc/marchd/marchd.conf" || fail "the administrator's settings are gone"
}

# Frames that take longer than stop-timeout are there before the daemon stops.
drained_upgrade_loses_nothing()
{
    local id running number

    reload "user-jobs = 3" "log-level = debug" "stop-timeout = 1"
    id=$(submit ann "$(cloud_job 1-5 1280 720 drained)")
    until_true "a frame is done" has_done ann "$id" 1
    running=$(as ann march frames --json "$id" | jq -r '.. | objects | select(.state? == "running") | .frame')
    [ -n "$running" ] || fail "no frame is running"
    inside march drain --wait
    for number in $running; do
        [ -f "$root/srv/marchd/drained/$(printf 'c.%04d.exr' "$number")" ] || fail "frame $number was running, and is not there"
    done
    list_files drained >"$work/list"
    [ "$(wc -l <"$work/list")" -lt 5 ] || fail "it was over before the upgrade"
    as ann march show "$id" | grep -q 'drained by root' || fail "why it waits: $(as ann march show "$id")"
    apt install /root/marchd-last.deb /root/marchd-worker-last.deb
    as ann march wait "$id"
    landed_once drained 5 "$work/list"
    expect "attempts" "$(as ann march frames --json "$id" | jq -c '[.. | .attempts? // empty] | unique')" "[1]"
    reload "user-jobs = 3"
}

purge_leaves_nothing()
{
    rm -rf "$root/etc/marchd/two.conf" "$root/srv/marchd@two"
    apt purge marchd marchd-worker
    expect "processes" "$(inside pgrep -a 'march' || true)" ""
    expect "unit" "$(inside systemctl is-active marchd.service marchd.socket | tr '\n' ' ')" "inactive inactive "
    expect "folders" "$(find "$root/run" "$root/var/lib" "$root/var/cache" "$root/etc" -maxdepth 1 -name 'marchd*')" ""
    inside test ! -e /run/marchd || fail "/run/marchd is left"
    unowned_files >"$work/after"
    # The user that owns pictures stays, by Debian's custom: it is in files that existed before.
    # Certificates are those of ca-certificates, which may have come with what marchd-web needs.
    comm -13 "$work/before" "$work/after" |
        grep -vE '^/(srv/marchd|etc/ssl|etc/ca-certificates(\.conf)?|usr/local/share/ca-certificates)(/|$)' >"$work/left" || true
    expect "what is left" "$(cat "$work/left")" ""
    [ "$(find "$root/srv/marchd" -name '*.exr' | wc -l)" -gt 0 ] || fail "what was rendered is gone"
}
