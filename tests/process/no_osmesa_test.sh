#!/bin/bash
# Without OSMesa, which newer Mesa has not, EGL's software device renders: by march and by a farm, the picture OSMesa renders.
# SPDX-License-Identifier: Apache-2.0
# The library is hidden from this test alone, by a mount namespace of its own.
if [ -z "${MARCHD_HIDDEN-}" ]; then
    [ "$(id -u)" -eq 0 ] || { echo "skipped: it takes root to hide a library"; exit 77; }
    unshare --mount true 2>/dev/null || { echo "skipped: no namespace of mounts can be made here"; exit 77; }
    MARCHD_HIDDEN=yes exec unshare --mount "$0"
fi
. "$PROJECT_ROOT/tests/process/farm.sh"
march=$bin/march
export MARCHD_SOCKET=$socket

job 48 >"$scratch/cloud.json"
# render NAME BACKEND: into NAME.0048.exr, what is said into NAME.txt.
render()
{
    "$march" render "$scratch/cloud.json" --backend "$2" --out "$scratch/$1.####.exr" >"$scratch/$1.txt" 2>&1
}

libraries=
for library in $(ldconfig -p | sed -n 's/.*libOSMesa\.so.* => //p' | xargs -r readlink -f | sort -u); do
    [ ! -f "$library" ] || libraries="$libraries $library" # one that is hidden already is a device
done
[ -z "$libraries" ] || render osmesa osmesa || fail "march render with OSMesa: $(cat "$scratch/osmesa.txt")"
for library in $libraries; do
    mount --bind /dev/null "$library" || fail "$library cannot be hidden"
done
render hidden osmesa && fail "OSMesa renders though it is hidden"
grep -q "osmesa: no libOSMesa" "$scratch/hidden.txt" || fail "what is said without OSMesa: $(cat "$scratch/hidden.txt")"

# alike FILE: a frame of EGL and one of OSMesa are by the same driver.
alike()
{
    [ -f "$scratch/osmesa.0048.exr" ] || return 0
    "$bin/exr-compare" "$scratch/osmesa.0048.exr" "$1" >"$scratch/far" || fail "$1 is not the picture OSMesa renders"
    awk '$1 > 1e-3 || $2 > 1e-3 { exit 1 }' "$scratch/far" || fail "$1 is $(cat "$scratch/far") from what OSMesa renders"
}

for backend in auto software; do
    render egl $backend || fail "march render --backend $backend without OSMesa: $(cat "$scratch/egl.txt")"
    alike "$scratch/egl.0048.exr"
done

start_daemon
id=$(submit "$(cat "$scratch/cloud.json")")
wait_state "$id" succeeded
worker=$(ask worker.list | jq -c '.result.workers[0] | {backend, renderer, sandbox}')
expect "the workers' backend" "$(jq -r .backend <<<"$worker")" egl
stop_daemon
alike "$(find "$scratch/out" -name '*.exr')"
# A picture of a GPU's says nothing of the software device.
grep -q "llvmpipe\|softpipe" <<<"$worker" || { echo "skipped: a GPU renders here: $worker"; exit 77; }
