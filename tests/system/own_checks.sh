# Farms beside the first: a second one of the system, and a user's own, run by the user's service manager. Sourced by
# tests/service.

two=/run/marchd/marchd@two.sock

# renders_on_two FOLDER: ann renders a frame on the second farm.
renders_on_two()
{
    cloud_job 1 64 36 "$1" >"$root/home/ann/job.json"
    as ann march submit --wait --socket "$two" job.json
    [ -f "$root/srv/marchd@two/$1/c.0001.exr" ] || fail "no picture below /srv/marchd@two"
}

start_second_farm()
{
    inside install -d -o marchd -g marchd /srv/marchd@two
    printf '%s\n' 'output-root = /srv/marchd@two' 'workers = 1' >"$root/etc/marchd/two.conf"
    inside systemctl start marchd@two.socket "$@"
}

second_farm_runs()
{
    start_second_farm
    renders_on_two plain
    expect "the id of its first job" "$(as ann march list --json --socket "$two" | jq -c '[.jobs[].id]')" "[1]"
    expect "the queue's folder" "$(inside stat -c '%U %a' /var/lib/marchd@two)" "marchd 700"
    ends 4 marchd as eve march list --socket "$two"
    # Another user may run it. What is theirs stays theirs at a boot.
    inside useradd --system farm
    inside mkdir /etc/systemd/system/marchd@two.service.d
    printf '[Service]\nUser=farm\n' >"$root/etc/systemd/system/marchd@two.service.d/user.conf"
    inside sh -c 'systemctl stop marchd@two.socket marchd@two && chown -R farm /srv/marchd@two && systemctl daemon-reload'
    inside systemctl start marchd@two.socket marchd@two
    renders_on_two farms
    expect "who runs it" "$(inside ps -o user= -p "$(inside systemctl show -P MainPID marchd@two)")" farm
    expect "the queue's folder" "$(inside stat -c '%U %a' /var/lib/marchd@two)" "farm 700"
    inside rm -r /etc/systemd/system/marchd@two.service.d
    inside systemctl daemon-reload
}

user_daemon_runs()
{
    local id

    inside loginctl enable-linger eve
    until_true "eve's service manager runs" eval 'as eve systemctl --user is-system-running | grep -qE "running|degraded"'
    # Her only workers are a node's, which march-launch starts as her.
    as eve mkdir -p .config
    printf '%s\n' 'workers = none' "pool = here launcher=command nodes=x command='/usr/bin/march-worker --node'" \
        >"$root/home/eve/.config/marchd.conf"
    as eve systemctl --user start marchd.service
    expect "eve's daemon" "$(as eve systemctl --user is-active marchd.service)" active
    expect "who runs it" "$(inside ps -o user= -p "$(as eve systemctl --user show -P MainPID marchd.service)")" eve
    # eve may not use the system's socket: march falls back to her own.
    cloud_job 1-2 64 36 mine >"$root/home/eve/job.json"
    id=$(as eve march submit --json job.json | jq -e .id)
    as eve march wait "$id"
    expect "eve's workers" "$(as eve march workers --json | jq -c '[.. | objects | .pool? // empty] | unique')" '["here"]'
    expect "pictures of eve's" "$(find "$root/home/eve/marchd/mine" -name '*.exr' | wc -l)" 2
    expect "who owns them" "$(stat -c %u "$root/home/eve/marchd/mine/c.0001.exr")" "$(inside id -u eve)"
    # ann has no daemon of her own and uses the system's.
    id=$(submit ann "$(cloud_job 1 64 36 hers)")
    expect "ann's daemon" "$(job_field ann "$id" .owner)" ann
    as ann march wait "$id"
    ends 4 "" as ann march list --socket "/run/user/$(inside id -u eve)/marchd.sock"
    as eve systemctl --user stop marchd.service
    inside loginctl disable-linger eve
    inside loginctl terminate-user eve || true
}
