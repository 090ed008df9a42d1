# Permissions of users, and of jobs in the sandbox. Sourced by tests/service.

# The users ann and bob may render, carol administers, eve has no rights at the daemon.
add_people()
{
    local name

    for name in ann bob carol eve; do
        inside useradd --create-home --shell /bin/bash "$name"
    done
}

let_people_in()
{
    inside usermod -a -G marchd ann
    inside usermod -a -G marchd bob
    inside usermod -a -G marchd,marchd-admin carol
}

# ends STATUS TEXT COMMAND...: the command exits with the status and prints the text (a regular expression).
ends()
{
    local wanted=$1 text=$2 status=0

    shift 2
    "$@" >"$work/out" 2>&1 || status=$?
    [ "$status" = "$wanted" ] && grep -qE -- "$text" "$work/out" && return
    fail "$*: expected status $wanted and \"$text\", got status $status and \"$(cat "$work/out")\""
}

strangers_are_refused()
{
    local id

    id=$(submit ann "$(cloud_job 1-2 64 36 first)")
    as ann march wait "$id"
    landed_once first 2
    expect "owner" "$(job_field ann "$id" .owner)" ann
    cloud_job 1 64 36 stranger >"$root/home/eve/job.json"
    ends 4 marchd as eve march submit job.json
    ends 4 marchd as eve march list
    [ ! -e "$root/srv/marchd/stranger" ] || fail "a stranger's folder was made"
}

jobs_have_owners()
{
    local id verb

    id=$(submit ann "$(cloud_job 1-200 480 270 anns)")
    as bob march show "$id" >/dev/null
    for verb in pause cancel; do
        ends 4 "belongs to ann" as bob march "$verb" "$id"
    done
    ends 4 "belongs to ann" as bob march prio "$id" 90
    expect "its state" "$(job_field ann "$id" '[.state, .priority] | join(" ")')" "running 50"
    as carol march pause "$id"
    expect "its state" "$(job_field ann "$id" '.reason')" "paused by carol"
    as ann march resume "$id"
    inside march cancel "$id"
    expect "its reason" "$(job_field ann "$id" '.reason')" "canceled by root"
    expect "the journal's owner" "$(journal MARCHD_JOB="$id" | jq -r .MARCHD_OWNER | sort -u)" ann
    journal MARCHD_JOB="$id" | jq -r .MESSAGE | grep -q 'paused by carol' || fail "the journal does not say who paused it"
}

cloud_is_the_same()
{
    local id frame apart

    id=$(submit ann "$(cloud_job 10-12 160 90 compared)")
    as ann march wait "$id"
    landed_once compared 3
    mkdir -p "$work/outside"
    cloud_job 10-12 160 90 compared >"$work/outside/job.json"
    "$bin/march" render "$work/outside/job.json" --out "$work/outside/c.####.exr"
    for frame in 0010 0011 0012; do
        apart=$("$bin/exr-compare" "$root/srv/marchd/compared/c.$frame.exr" "$work/outside/c.$frame.exr")
        # The limit is that of the same code on the same driver; a driver that is built differently rounds differently.
        awk -v light="${apart% *}" -v depth="${apart#* }" 'BEGIN { exit !(light <= 1e-3 && depth <= 1e-3) }' ||
            fail "frame $frame is apart by (light, depth) $apart"
    done
    echo "apart (light, depth): $apart"
    expect "the picture's owner" "$(stat -c %a "$root/srv/marchd/compared/c.0010.exr")" 644
}

# Workers apply Landlock and seccomp under the unit too, where the kernel has Landlock.
workers_are_fenced()
{
    local id sandbox

    id=$(submit ann "$(cloud_job 1-2 64 36 fenced)")
    as ann march wait "$id"
    sandbox=$(as ann march workers --json | jq -r '[.workers[] | select(.done > 0) | .sandbox] | unique | join("; ")')
    echo "$sandbox"
    [[ $sandbox == *landlock*seccomp* ]] || fail "expected landlock and seccomp, got \"$sandbox\""
    # The unit restricts the daemon; a worker is restricted further.
    inside sh -c 'for pid in $(pgrep -u marchd -f march-worker); do grep -E "^(NoNewPrivs|Seccomp):" /proc/$pid/status; done' >"$work/out"
    grep -q 'Seccomp:.2' "$work/out" && ! grep -q 'NoNewPrivs:.0' "$work/out" || fail "$(cat "$work/out")"
}

inputs_stay_below_roots()
{
    local document file id

    trap 'rm -f "$root/etc/own.raw" "$root/srv/marchd-input/way-out.raw"' EXIT
    # The files are valid volumes and readable to all: only the input roots forbid them.
    inside sh -c 'for file in /home/ann/own.raw /etc/own.raw; do head -c 4096 /dev/urandom >$file; chmod 644 $file; done'
    inside chmod 755 /home/ann
    for file in /home/ann/own.raw /etc/own.raw /srv/marchd-input/../../home/ann/own.raw; do
        document=$(volume_job "$file" stolen)
        printf '%s\n' "$document" >"$root/home/ann/job.json"
        ends 4 "expected a file below .*own.raw" as ann march submit job.json
    done
    # A link below a root leads out of it.
    inside ln -s /etc/own.raw /srv/marchd-input/way-out.raw
    printf '%s\n' "$(volume_job /srv/marchd-input/way-out.raw stolen)" >"$root/home/ann/job.json"
    as ann march submit job.json >"$work/out" 2>&1 || true
    id=$(grep -oE '^[0-9]+$' "$work/out" || true)
    if [ -n "$id" ]; then
        ends 1 "" as ann march wait "$id"
        as ann march log "$id" >"$work/out"
    fi
    grep -q 'way-out.raw' "$work/out" || fail "it is not the link that is refused: $(cat "$work/out")"
    cat "$work/out"
    expect "pictures of stolen files" "$(find "$root/srv/marchd/stolen" -name '*.exr' 2>/dev/null | wc -l)" 0
}
