#!/bin/bash
# Every job in jobs/ renders through the farm. Its frames are the same for all chunks, workers and orders and after a
# restart, and nearly the same on another backend.
. "$PROJECT_ROOT/tests/process/farm.sh"

# Three small frames of each job: a march through llvmpipe under sanitizers is slow.
small=(--set 'resolution=[32,18]' --set output.pixel=float)
# A method is stated for each, as backends may plan otherwise.
stated=$PROJECT_ROOT/tests/support/stated_quality.json
backend_limit=1e-4

names() { basename -s .json -a "$PROJECT_ROOT"/jobs/*.json | grep -vx schema; }

frames_of() # NAME: prints the first, a middle and the last frame
{
    local first last
    first=$(jq -r '.frames | split("-")[0]' "$PROJECT_ROOT/jobs/$1.json")
    last=$(jq -r '.frames | split("-")[1]' "$PROJECT_ROOT/jobs/$1.json")
    echo "$first,$(((first + last) / 2)),$last"
}

reversed() { tr , '\n' <<<"$1" | tac | paste -sd,; }

# farm FOLDER [ORDER]: submits every job with its frames in the order that the command ORDER gives, and waits.
farm()
{
    local ids=() id quality

    for name in $(names); do
        quality=$(jq -c --arg name "$name" '.[$name] // $own[0].quality' --slurpfile own "$PROJECT_ROOT/jobs/$name.json" "$stated")
        id=$("$bin/march" submit "$PROJECT_ROOT/jobs/$name.json" --socket "$socket" "${small[@]}" \
            --set "quality=$quality" --set "frames=$("${2:-echo}" "$(frames_of "$name")")" --set "output.path=$1/$name.####.exr") ||
            fail "$name was not accepted"
        ids+=("$id")
    done
    "$bin/march" wait --socket "$socket" "${ids[@]}" >"$scratch/wait.log" 2>&1 || {
        cat "$scratch/wait.log" >&2
        fail "a job did not succeed"
    }
}

# same FOLDER-A FOLDER-B LIMIT-OF-LIGHT LIMIT-OF-DEPTH: fails where a picture differs by more.
same()
{
    local count=0 apart

    for a in "$scratch/out/$1"/*.exr; do
        apart=$("$bin/exr-compare" "$a" "$scratch/out/$2/$(basename "$a")") || fail "$(basename "$a") cannot be compared"
        awk -v light="$3" -v depth="$4" '{ exit !($1 <= light && $2 <= depth) }' <<<"$apart" ||
            fail "$(basename "$a") of $1 and $2 differ by $apart"
        count=$((count + 1))
    done
    [ "$count" = $((3 * $(names | wc -l))) ] || fail "$count pictures in $1"
}

for name in $(names); do
    [ "$name" = cloud_seed ] || jq -e '.quality | .tolerance and (has("method") | not)' "$PROJECT_ROOT/jobs/$name.json" >/dev/null ||
        fail "$name leaves its method to a plan: it states a tolerance and no method"
done

start_daemon --backend software
mkdir -p "$scratch/out"
farm once
stop_daemon
start_daemon --backend software --workers 1
farm again reversed
stop_daemon
same once again 0 0
start_daemon --backend egl --workers 1
farm egl
stop_daemon
# Depth is where transmittance falls below one half: rounding moves that threshold in a few pixels.
same once egl "$backend_limit" 1e-2
