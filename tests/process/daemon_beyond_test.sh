#!/bin/bash
# What single scattering leaves out: in headers, in plans, and in the words of explain, submit and chart.
. "$(dirname "$0")/farm.sh"

# thick ORDERS QUALITY [JQ-FILTER]: a ball of depth 6 beside a lamp. Its pictures of single scattering lack about 60 %.
thick()
{
    cat <<END | jq -c "${3:-.}"
{"version": 1, "name": "thick", "frames": "0-3", "fps": 24, "resolution": [64, 48],
 "camera": {"position": [0.6, 0.8, 4], "target": [0, 0, 0], "fov": 33},
 "lights": [{"kind": "point", "position": [2, 2.5, 1.5], "intensity": 20}],
 "scene": {"scattering": {"orders": $1}, "media": [{"sigma_s": 3, "sigma_a": 0.1,
   "density": {"kind": "homogeneous", "bounds": {"kind": "sphere", "radius": 1}}}]},
 "quality": $2, "output": {"path": "thick.####.exr"}}
END
}

# number FILE ATTRIBUTE: of its header, in percent; nothing where it has none.
number()
{
    python3 - "$1" "$2" <<'END'
import struct, sys
header = open(sys.argv[1], "rb").read(65536)
name = sys.argv[2].encode() + b"\0double\0"
at = header.find(name)
if at >= 0:
    print(round(100 * struct.unpack_from("<d", header, at + len(name) + 4)[0]))
END
}

# within WHAT NUMBER LEAST MOST
within()
{
    [ -n "$2" ] && [ "$2" -ge "$3" ] && [ "$2" -le "$4" ] || fail "$1: expected $3 to $4, got \"$2\""
}

within_header()
{
    within "$1" "$(number "$1" marchd:beyond)" 50 70
    within "$1, at most" "$(number "$1" marchd:beyond95)" "$(number "$1" marchd:beyond)" 85
}

sentence='single scattering leaves out [0-9.]* % of the picture.s light, at most [0-9.]* %; scene.scattering.orders "all" models it'
march() { "$bin/march" "$@" </dev/null; }
cd "$scratch" || exit 1
thick 1 '{"tolerance": 0.05}' >tolerant.json
thick 1 '{"method": "midpoint", "step": 0.1, "light_step": 0.1}' >stated.json
thick '"all"' '{"method": "paths", "paths": 4, "samples": 2}' >all.json
thick 1 '"draft"' >draft.json
thick 1 '{"tolerance": 0.05}' '.frames = "0" | .scene.media[0] |= . + {"sigma_s": 0, "emission": 1}' >glow.json

# A farm's frames tell it, each of a plan the same, and the plan tells it too.
start_daemon --worker-program "$bin/march-worker"
id=$(march submit tolerant.json --socket "$socket" 2>err) || fail "submit: $(cat err)"
grep -q "^warning: quality.tolerance: 0.05 is of the orders that are modelled: $sentence$" err || fail "submit warns: $(cat err)"
expect "warnings" "$(grep -c '^warning' err)" 1
wait_state "$id" succeeded
first=$(number out/thick.0000.exr marchd:beyond)
for frame in 0 1 2 3; do
    within_header "out/thick.000$frame.exr"
    expect "frame $frame" "$(number "out/thick.000$frame.exr" marchd:beyond)" "$first"
done
within "the plan's" "$(ask job.plans "{\"id\":$id}" | jq '.result.plans[0].beyond.error * 100 | round')" "$first" "$first"
march frames "$id" --socket "$socket" >out.txt || fail "frames"
head -n 1 out.txt | grep -q 'TRACED %  BEYOND % / 95 %  FILE' || fail "the titles of march frames: $(cat out.txt)"
[[ $(tr -s ' ' <out.txt | sed -n 2p) =~ \ ([0-9.]+)\ /\ [0-9.]+\ $scratch/out/thick.0000.exr$ ]] || fail "the row of march frames: $(cat out.txt)"
within "that of march frames" "$(printf '%.0f' "${BASH_REMATCH[1]}")" "$first" "$first"
march frames "$id" --socket "$socket" --json >out.txt || fail "frames --json"
expect "those of march frames --json" "$(jq -r '.frames | map(.beyond.error * 100 | round | tostring) | join(" ")' out.txt)" "$first $first $first $first"
jq -e '.frames[0].beyond | .error95 >= .error' out.txt >/dev/null || fail "the bound of march frames --json: $(cat out.txt)"
march verify out >out.txt || fail "verify: $(cat out.txt)"
grep -q "; the modelled orders of scattering leave out $first % (95 %: below [0-9]* %); all well$" out.txt || fail "verify: $(cat out.txt)"
expect "submit --json is quiet" "$(march submit tolerant.json --set output.path=j.####.exr --socket "$socket" --json 2>&1 | jq -r 'keys[]')" id
id=$(march submit all.json --set output.path=all.####.exr --socket "$socket" 2>err) || fail "submit of all orders: $(cat err)"
! grep -q warning err || fail "all orders leave nothing out: $(cat err)"
expect "their frames --json" "$(march frames "$id" --socket "$socket" --json | jq -c '.frames | map(has("beyond")) | unique')" "[false]"
stop_daemon

# So do frames that are rendered here, whatever their quality.
render() { march render "$1.json" --frames 0 --out "$scratch/$1.####.exr" --backend software >out.txt 2>&1 || fail "render $1: $(cat out.txt)"; }
for name in tolerant stated draft; do
    render $name
    within_header $name.0000.exr
done
render glow
expect "what emits and does not scatter" "$(number glow.0000.exr marchd:beyond)" 0
render all
expect "all orders" "$(number all.0000.exr marchd:beyond)" ""
# Its paths are counted, those of both samples.
expect "paths" "$(number all.0000.exr marchd:paths)" 800
expect "a march's paths" "$(number stated.0000.exr marchd:paths)" ""
march render tolerant.json --frames 0 --plan-of tolerant.0000.exr --out again.####.exr --backend software >out.txt 2>&1 || fail "$(cat out.txt)"
expect "a frame rendered again" "$(number again.0000.exr marchd:beyond)" "$(number tolerant.0000.exr marchd:beyond)"

# People are told in a sentence, and warned once where it is over the tolerance.
march explain tolerant.json >out.txt 2>err
grep -q "multiple scattering  *light is scattered once at most; $sentence$" out.txt || fail "explain: $(cat out.txt)"
expect "explain's warnings" "$(grep -c "^warning: .*$sentence$" err)" 1
within "explain --json" "$(march explain tolerant.json --json 2>/dev/null | jq '.beyond.error * 100 | round')" 50 70
march explain stated.json >out.txt 2>err
grep -q "light is scattered once at most; $sentence$" out.txt || fail "explain of a stated method: $(cat out.txt)"
expect "warnings without a tolerance" "$(cat err)" ""
expect "explain of all orders" "$(march explain all.json --json 2>&1 | jq 'has("beyond")')" false
march explain "$PROJECT_ROOT/jobs/glass.json" >out.txt 2>/dev/null
grep -q "how much light single scattering leaves out is not known: paths follow diffuse surfaces only" out.txt || fail "glass: $(cat out.txt)"
march submit --dry-run tolerant.json >out.txt 2>err || fail "dry run: $(cat err)"
grep -q "^    $sentence$" out.txt || fail "a dry run: $(cat out.txt)"
expect "a dry run's warnings" "$(grep -c '^warning' err)" 1
march chart stated.json --size 16x12 --methods midpoint:1,midpoint:2 --out chart --backend software >out.txt 2>err || fail "chart: $(cat err)"
grep -q "^Errors are of the orders that are modelled: $sentence.$" out.txt || fail "chart: $(cat out.txt)"
