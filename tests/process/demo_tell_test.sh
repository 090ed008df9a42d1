#!/bin/bash
# What deploy/demo says at its end: its frames' error, within its bound, and what the plain sum would have taken for it.
. "$PROJECT_ROOT/tests/process/farm.sh"
PATH=$bin:$PATH
export MARCHD_SOCKET=$socket
cd "$scratch" || exit 1

# holds EXPRESSION WHAT: of awk; the numbers that were told are its variables.
holds()
{
    awk "BEGIN { exit !($1) }" || fail "$2: $1 does not hold for: $(cat said)"
}

# read_said: sets the numbers of both lines.
read_said()
{
    local number='([0-9.e+-]+)'

    [[ $(sed -n 1p said) =~ ^$number\ frames\ by\ ([a-z]+(\ and\ [a-z]+)*),\ planned,\ rendered\ and\ audited\ in\ $number\ s:\ their\ error\ is\ at\ most\ $number\ %\ of\ the\ light,\ below\ $number\ %\ with\ a\ confidence\ of\ 95\ %$ ]] ||
        fail "the first line: $(cat said)"
    count=${BASH_REMATCH[1]} methods=${BASH_REMATCH[2]} seconds=${BASH_REMATCH[4]} error=${BASH_REMATCH[5]} bound=${BASH_REMATCH[6]}
    [[ $(sed -n 2p said) =~ ^The\ plain\ sum\ \(riemann:\ uniform\ steps\)\ would\ have\ taken\ (about|more\ than)\ $number\ (s|minutes)\ to\ $number\ %:\ counted,\ from\ $number\ s\ that\ ([0-9]+x[0-9]+)\ pixels\ of\ frame\ $number\ took$ ]] ||
        fail "the second line: $(cat said)"
    word=${BASH_REMATCH[1]} sum=${BASH_REMATCH[2]} unit=${BASH_REMATCH[3]} sum_error=${BASH_REMATCH[4]} part=${BASH_REMATCH[5]}
    size=${BASH_REMATCH[6]} frame=${BASH_REMATCH[7]}
}

# Known tables: the largest of all numbers; of frames that are done; seconds between two rungs follow a power of the error.
table()
{
    cat <<'TABLE'
   FRAME  STATE      TRY  RENDER S  ENCODE S        BYTES  METHOD         AUDIT % / 95 %     CUT %  TRACED %  FILE, FAILURE OR PHASE
       0  succeeded    1     0.012     0.001         4096  midpoint             1 / 1.5         -         -  /c/c.0000.exr
       1  succeeded    2     0.014     0.001         4096  cached            0.85 / 1.9       0.1      3.42  /c/c.0001.exr
       2  failed       3         -         -            -  midpoint              7 / 9         -         -  missed
TABLE
}
# chart ERROR...: rungs with these errors; the first took 0.1 s, each other twice as long.
chart()
{
    local s=0.1 rung=0 e

    echo 'name,scene,frame,width_px,height_px,backend,renderer,series,rung,quality,outcome,seconds,repeats,timer,relative_rmse,'
    for e; do
        echo "c,0f,12,32,18,osmesa,\"a, b\",riemann,$rung,\"{\"\"method\"\":\"\"riemann\"\",\"\"step\"\":1}\",measured,$s,3,wall,$e,1,reference,576,"
        s=$(awk "BEGIN { print 2 * $s }") rung=$((rung + 1))
    done
    echo "c,0f,12,32,18,osmesa,\"a, b\",riemann,$rung,\"{}\",too slow,3,0,wall,0,0,reference,576,"
}
table >frames
chart 0.08 0.02 0.005 0.001 >chart.csv
"$PROJECT_ROOT/deploy/demo_tell" frames 7 57600 chart.csv >said || fail "demo_tell"
read_said
expect "frames, methods, seconds" "$count $methods $seconds" "2 midpoint and cached 7"
expect "error and bound in percent" "$error $bound" "1 1.9"
# 0.2 s for 2 % and 0.4 s for 0.5 %: 0.28 s for 1 %, a hundred times.
expect "the plain sum" "$word $sum $unit to $sum_error from $part $size $frame" "about 28 s to 1 from 0.28 32x18 12"
chart 0.08 0.02 >chart.csv
"$PROJECT_ROOT/deploy/demo_tell" frames 7 5760000 chart.csv >said || fail "demo_tell"
read_said
expect "a plain sum that is not exact enough" "$word $sum $unit to $sum_error from $part" "more than 33 minutes to 2 from 0.2"
chart >chart.csv
"$PROJECT_ROOT/deploy/demo_tell" frames 7 57600 chart.csv >said || fail "demo_tell"
grep -qx "The plain sum (riemann) does not render this scene\." said || fail "no plain sum: $(cat said)"

# What march frames and march chart say now.
start_daemon
jq '.frames = "0-1" | .resolution = [64, 36] | .quality = {"tolerance": 0.02} | .output = {"path": "cloud/c.####.exr"}' \
    "$PROJECT_ROOT/jobs/cloud.json" >cloud.json
march submit cloud.json --wait >said 2>&1 || fail "march submit: $(cat said)"
march frames 1 >frames
march frames 1 --json >frames.json
stop_daemon
march chart cloud.json --frame 1 --methods riemann --quick --size 16x9 --point-limit 1 --out chart >said 2>&1 || fail "march chart: $(cat said)"
"$PROJECT_ROOT/deploy/demo_tell" frames 3 4608 chart/cloud.csv >said || fail "demo_tell"
cat said
read_said
expect "frames, seconds" "$count $seconds" "2 3"
grep -q " ${methods%% *} " frames || fail "no frame is by $methods"
holds "0 < $error && $error <= $bound && $error <= 2" "error, bound, tolerance"
# Two digits are told.
holds "sqrt(($error / $(jq '[.frames[].measured_error] | max' frames.json) / 100 - 1) ^ 2) < 0.06" "the frames' error"
holds "sqrt(($bound / $(jq '[.frames[].error95] | max' frames.json) / 100 - 1) ^ 2) < 0.06" "the frames' bound"
expect "what was measured" "$size of $frame" "16x9 of 1"
[ "$word" != about ] || holds "sqrt(($sum_error / $error - 1) ^ 2) < 0.06" "the error of the plain sum"
holds "$sum_error >= 0.94 * $error" "the error of the plain sum"
expect "the unit" "$unit" s
sed -n 's/.*,measured,\([^,]*\),[0-9]*,wall,.*/\1/p' chart/cloud.csv | sort -g >measured
holds "0.94 * $(head -n 1 measured) <= $part && $part <= 1.06 * $(tail -n 1 measured)" "measured seconds: $(cat measured)"
holds "sqrt(($sum / ($part * 4608 / 144) - 1) ^ 2) < 0.11" "seconds of 32 times as many pixels"
