# A daemon of a user's own, run by the user's service manager. Sourced by tests/service.

user_daemon_runs()
{
    local id

    inside loginctl enable-linger eve
    until_true "eve's service manager runs" eval 'as eve systemctl --user is-system-running | grep -qE "running|degraded"'
    as eve systemctl --user start marchd.service
    expect "eve's daemon" "$(as eve systemctl --user is-active marchd.service)" active
    expect "who runs it" "$(inside ps -o user= -p "$(as eve systemctl --user show -P MainPID marchd.service)")" eve
    # eve may not use the system's socket: march falls back to her own.
    cloud_job 1-2 64 36 mine >"$root/home/eve/job.json"
    id=$(as eve march submit --json job.json | jq -e .id)
    as eve march wait "$id"
    expect "pictures of eve's" "$(find "$root/home/eve/marchd/mine" -name '*.exr' | wc -l)" 2
    expect "who owns them" "$(stat -c %u "$root/home/eve/marchd/mine/c.0001.exr")" "$(inside id -u eve)"
    # ann has no daemon of her own and uses the system's.
    expect "ann's daemon" "$(job_field ann 1 .owner)" ann
    ends 4 "" as ann march list --socket "/run/user/$(inside id -u eve)/marchd.sock"
    as eve systemctl --user stop marchd.service
    inside loginctl disable-linger eve
    inside loginctl terminate-user eve || true
}
