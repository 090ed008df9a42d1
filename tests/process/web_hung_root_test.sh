#!/bin/bash
# The disk of one root answers nothing: pictures and explanations of others come, its own get an error, and march-web ends.
. "$(dirname "$0")/farm.sh"
. "$(dirname "$0")/web.sh"

holder() { cat "$scratch/holder"; }
shows() { [ "$(get "$1")" = 200 ]; }
mkdir "$scratch/good" "$scratch/bad" "$scratch/in"
"$PROJECT_ROOT/tests/process/hung_disk.py" "$scratch/bad" "$scratch/holder" /bin/true
[ $? != 77 ] || { echo "skip: no disk that hangs can be made here"; exit 77; }
head -c 512 /dev/zero >"$scratch/bad/v.raw"
start_daemon --output-root "$scratch/good" --output-root "$scratch/bad" --input-root "$scratch/bad" --input-root "$scratch/in"
token=$(token read)
good=$(submit "$(job 0-3 ".output.path = \"$scratch/good/g.####.exr\"")")
bad=$(submit "$(job 0-3 ".output.path = \"$scratch/bad/b.####.exr\"")")
reads=$(submit "$(job 0-3 ".output.path = \"$scratch/good/r.####.exr\" | .quality = {\"method\": \"midpoint\", \"step\": 0.1, \"light_step\": 0.1} |
    .scene.media[0].density = {\"kind\": \"grid\", \"file\": \"$scratch/bad/v.raw\", \"size\": [8, 8, 8], \"type\": \"uint8\", \"scale\": 0.01, \"spacing\": [0.1, 0.1, 0.1]}")" true)
wait_state "$good" succeeded
wait_state "$bad" succeeded

as_web=("$PROJECT_ROOT/tests/process/hung_disk.py" "$scratch/bad" "$scratch/holder")
start_web --cache-dir "$scratch/cache" --picture-time 3600 # a look at a disk has 10 s of it

# While one browser waits for the disk, others get what is elsewhere: at once, or where a slow machine's good disk, too, has not
# answered in time, when they ask again.
python3 - "$web_port" "$token" "$patience_s" "/frame/$bad/0.png" "/job/$reads/explain" "/frame/$good/1.png" "/job/$good/explain" <<'PYTHON' || fail "a disk that hangs"
import sys, time, web_client
port, token, patience_s, *paths = sys.argv[1:]
def begin(path):
    client = web_client.Client(int(port))
    client.send(f"GET {path} HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {token}\r\n\r\n".encode())
    return client
slow = [begin(path) for path in paths[:2]]
ends = time.monotonic() + float(patience_s)
quick = [begin(path) for path in paths[2:]]
while (statuses := [client.answer().status for client in quick]) != [200, 200]:
    assert set(statuses) <= {200, 504} and time.monotonic() < ends, statuses
    quick = [begin(path) for path in paths[2:]]
answers = [client.answer() for client in slow]
for answer in answers:
    assert answer.status == 504 and b"disk" in answer.body and b"does not answer" in answer.body, (answer.status, answer.body)
PYTHON
# It is known by now, and others still come.
expect_get 504 "/frame/$bad/1.png" "does not answer"
wait_until "another's picture" shows "/frame/$good/2.json"
kill -0 "$(holder)" || fail "the disk answers by now"

# The disk comes back.
kill -TERM "$(holder)"
wait_until "a picture of the disk that came back" shows "/frame/$bad/2.png"
wait_until "an explanation" shows "/job/$reads/explain"
stop_web

# Its end waits for no disk. A sanitizer's look for leaks stops all threads, which one that hangs cannot.
export ASAN_OPTIONS=${ASAN_OPTIONS-}:detect_leaks=0
start_web --cache-dir "$scratch/cache" --picture-time 3600
get "/frame/$bad/3.png" >/dev/null &
wait_until "it is asked for" grep -q "a picture of /frame/$bad/3.png" "$scratch/web.log"
python3 -c 'import os, sys, time; time.sleep(float(sys.argv[2])); os.kill(int(sys.argv[1]), 9)' "$web_pid" "$patience_s" &
sleep 0.3 # most times it hangs by then
stop_web # killed, its status is another
stop_daemon
