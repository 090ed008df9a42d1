# Jobs in the machine: submitting them, their states and their pictures. Sourced by tests/service.

# cloud_job FRAMES WIDTH HEIGHT FOLDER: prints a job document with a stated method.
# 480x270 takes about half a second a frame on two cores.
cloud_job()
{
    jq -c --arg frames "$1" --argjson width "$2" --argjson height "$3" --arg path "$4/c.####.exr" \
        --slurpfile stated "$here/support/stated_quality.json" '.frames = $frames | .resolution = [$width, $height] |
        .output.path = $path | .quality = $stated[0].cloud' "$here/../jobs/cloud.json"
}

# submit USER DOCUMENT: prints the id.
submit()
{
    local user=$1

    printf '%s\n' "$2" >"$root/home/$user/job.json"
    as "$user" march submit --json job.json | jq -e .id
}

# job_field USER ID JQ-FILTER
job_field()
{
    as "$1" march show --json "$2" | jq -r "$3"
}

done_count()
{
    job_field "$1" "$2" .succeeded
}

has_done()
{
    [ "$(done_count "$1" "$2" 2>/dev/null || echo 0)" -ge "$3" ]
}

has_state()
{
    [ "$(job_field "$1" "$2" .state)" = "$3" ]
}

cancel_all()
{
    local id

    for id in $(inside march list --json | jq -r '.. | objects | select(.state? | IN("queued", "running", "paused")) | .id'); do
        inside march cancel "$id"
    done
}

main_pid()
{
    inside systemctl show -P MainPID marchd.service
}

# has_new_pid PID: the service is active, as another process than PID.
has_new_pid()
{
    [ "$(inside systemctl is-active marchd.service)" = active ] && [ "$(main_pid)" != "$1" ]
}

journal()
{
    inside journalctl --no-pager -o json "$@"
}

# landed_once FOLDER FRAMES [LIST]: the folder has so many pictures and no other file. The pictures of LIST (output of
# list_files, "inode name" a line) are still the same files.
landed_once()
{
    local folder=$root/srv/marchd/$1

    expect "pictures in $1" "$(find "$folder" -name '*.exr' | wc -l)" "$2"
    expect "what is left beside the pictures in $1" "$(find "$folder" -type f ! -name '*.exr')" ""
    [ -z "${3:-}" ] || expect "pictures that were there before and are others now" \
        "$(comm -23 "$3" <(list_files "$1"))" ""
}

list_files()
{
    find "$root/srv/marchd/$1" -name '*.exr' -printf '%i %f\n' | sort
}

# volume_job FILE FOLDER: prints a job that reads the file as 16^3 bytes.
volume_job()
{
    cloud_job 1 32 18 "$2" | jq -c --arg file "$1" '.scene.media[0].density =
        { kind: "grid", file: $file, size: [16, 16, 16], type: "uint8" }'
}

# bomb_job FOLDER: prints a job whose GLSL expands into hundreds of millions of words in the preprocessor.
bomb_job()
{
    cloud_job 1 32 18 "$1" | jq -c --arg text '#define A(x) x + x + x + x + x + x + x + x
#define B(x) A(A(A(x)))
float density(vec3 p, float t) { return B(B(B(p.x))); }
' '.scene.media[0].density = { kind: "glsl", file: "/bomb.glsl", source: $text, lipschitz: 1,
        bounds: { kind: "sphere", center: [0, 0, 0], radius: 1 } } | del(.camera.clip)'
}

# set_conf LINE...: writes the administrator's settings; the daemon does not reread them.
set_conf()
{
    printf '%s\n' "$@" >"$root/etc/marchd/marchd.conf"
}

# reload LINE...: writes the settings and returns once the daemon has logged about them; the log lines are in
# $work/settings, what systemctl ended with in $reload_status.
reload_status=
reload()
{
    local cursor

    reload_status=0
    cursor=$(inside journalctl -u marchd.service -n 1 --show-cursor -q -o cat | sed -n 's/^-- cursor: //p')
    set_conf "$@"
    inside systemctl reload marchd.service || reload_status=$?
    until_true "the daemon speaks of its settings" eval \
        'inside journalctl -q -u marchd.service --after-cursor="'"$cursor"'" -o cat -g "^settings: " >"$work/settings"'
}
