#!/bin/bash
# Pictures of frames over HTTP: of real frames, of files that strangers put in their place, and what is kept of them.
. "$(dirname "$0")/farm.sh"
. "$(dirname "$0")/web.sh"

# start_showing OPTION...: starts march-web with a cache and a worker of the test's own.
start_showing()
{
    start_web --cache-dir "$scratch/cache/web" --worker-program "$scratch/worker" "$@"
}

stop_showing()
{
    stop_web
    if grep -F "$token" "$scratch/web.log"; then fail "a token is in the log"; fi
}

png_size() { python3 -c 'import struct,sys; b=open(sys.argv[1],"rb").read(); assert b[:8]==b"\x89PNG\r\n\x1a\n"; print("%dx%d"%struct.unpack(">II",b[16:24]))' "$scratch/body"; }
starts() { wc -l <"$scratch/starts"; }

run_for_others
cp "$PROGRAM_FOLDER/march-web" "$PROGRAM_FOLDER/exr-make" "$scratch/bin"
mkdir -m 777 "$scratch/cache"
: >"$scratch/starts"
chmod 666 "$scratch/starts"
printf '#!/bin/sh\necho >>%s\nexec %s/march-worker "$@"\n' "$scratch/starts" "$bin" >"$scratch/worker"
chmod 755 "$scratch/worker"
start_daemon
token=$(token read)
start_showing
id=$(submit "$(job 0-79x40 '.output.aovs = ["Z", "transmittance"]')")
wait_state "$id" succeeded
waiting=$(submit "$(job 0-5 '.output.path = "later/l.####.exr"')" true)

# A picture, its parts and its channels.
expect_get 200 "/frame/$id/40.png"
expect "its type" "$(head_of content-type)" image/png
expect "its size" "$(png_size)" 32x18
expect "what is known of it" "$(head_of marchd-picture | jq -c '[.file_width_px, .file_height_px, (.exposure | type)]')" '[32,18,"number"]'
expect_get 200 "/frame/$id/40.png?size=8&exposure=2"
expect "a small one" "$(png_size) $(head_of marchd-picture | jq .exposure)" "8x5 2"
expect_get 200 "/frame/$id/40.png?x=30&y=10&w=2&h=3&channel=A"
expect "a part" "$(png_size)" 2x3
expect_get 200 "/frame/$id/40.png?channel=transmittance"
expect_get 200 "/frame/$id/40.png?channel=Z"
expect "the depth" "$(head_of marchd-picture | jq -c 'has("exposure"), (.near <= .far)' | xargs)" "false true"
expect_get 200 "/frame/$id/40.json"
expect "the header" "$(jq -c '[.width_px, .attributes["marchd:frame"], (.attributes["marchd:jobHash"] | length)]' "$scratch/body")" '[32,40,32]'
expect "the channels" "$(jq -c '[.channels[].name]' "$scratch/body")" '["A","B","G","R","Z","transmittance.B","transmittance.G","transmittance.R"]'

# What is known is not sent, and what was made is not made again.
before=$(starts)
expect_get 200 "/frame/$id/40.png"
etag=$(head_of etag)
expect "a known picture" "$(get "/frame/$id/40.png" "If-None-Match: $etag")$(wc -c <"$scratch/body")" 3040
expect "workers for what was made before" "$(starts)" "$before"

# Twenty browsers ask for one picture at once: it is made once.
python3 - "$web_port" "$token" "/frame/$id/0.png?size=30" <<'PYTHON' || fail "twenty at once"
import sys, web_client
clients = [web_client.Client(int(sys.argv[1])) for _ in range(20)]
for client in clients:
    client.send(f"GET {sys.argv[3]} HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {sys.argv[2]}\r\n\r\n".encode())
answers = [client.answer() for client in clients]
assert all(answer.status == 200 and answer.body == answers[0].body for answer in answers), answers
PYTHON
expect "workers for twenty at once" "$(starts)" $((before + 1))

# Wrong questions.
expect_get 400 "/frame/$id/40.png?size=5000" "size: expected"
expect_get 400 "/frame/$id/40.png?file=/etc/passwd" "expected channel"
expect_get 400 "/frame/$id/40.png?channel=albedo" "expected one of color"
expect_get 400 "/frame/$id/40.exr" "expected /frame/JOB/N.png"
expect_get 404 "/frame/$id/41.png" "no such frame"
expect_get 404 "/frame/99/0.png"
expect_get 404 "/frame/$waiting/3.png" "no file yet: it is queued"
kept=$token token=
expect_get 401 "/frame/$id/40.png"
token=marchd_nonsense
expect_get 401 "/frame/$id/40.png"
token=$kept

# What a stranger may put in a frame's place.
frame=$scratch/out/cloud/$(basename "$(ask job.frames "{\"id\":$id}" | jq -r '.result.frames[0].path')")
cp "$frame" "$scratch/good.exr"
put() { rm -f "$frame"; "$@"; }
put ln -s /etc/passwd "$frame"
expect_get 422 "/frame/$id/0.png" "by no link"
put ln -s "$scratch/good.exr" "$frame"
expect_get 422 "/frame/$id/0.png" "by no link"
put mkfifo "$frame"
expect_get 422 "/frame/$id/0.png" "regular file"
put sh -c "head -c 500 '$scratch/good.exr' >'$frame'"
expect_get 422 "/frame/$id/0.png"
expect_get 422 "/frame/$id/0.png" # said again without another try
put sh -c "printf 'v/1\\001' >'$frame'"
expect_get 422 "/frame/$id/0.json"
rm "$frame"
expect_get 404 "/frame/$id/0.png" "not there"
# Small files of lines of 16,384 pixels: 4,096 of three channels, and 16,384 of 256.
python3 - "$scratch" <<'PYTHON' || fail "the bombs"
import struct, sys, zlib
def write(path, channel_count, height):
    side = 16384
    names = sorted(["R", "G", "B"] + ["x%03d" % i for i in range(channel_count - 3)])
    attribute = lambda name, kind, data: name.encode() + b"\0" + kind.encode() + b"\0" + struct.pack("<i", len(data)) + data
    box = struct.pack("<4i", 0, 0, side - 1, height - 1)
    channels = b"".join(name.encode() + b"\0" + struct.pack("<iB3xii", 2, 0, 1, 1) for name in names) + b"\0"
    head = struct.pack("<II", 20000630, 2) + attribute("channels", "chlist", channels) + attribute("compression", "compression", b"\3") \
        + attribute("dataWindow", "box2i", box) + attribute("displayWindow", "box2i", box) + attribute("lineOrder", "lineOrder", b"\0") \
        + attribute("pixelAspectRatio", "float", struct.pack("<f", 1)) + attribute("screenWindowCenter", "v2f", struct.pack("<2f", 0, 0)) \
        + attribute("screenWindowWidth", "float", struct.pack("<f", 1)) + b"\0"
    deflate, pieces, zeros = zlib.compressobj(9), [], bytes(1 << 20)
    for _ in range(16 * side * channel_count * 4 >> 20):
        pieces.append(deflate.compress(zeros))
    packed = b"".join(pieces) + deflate.flush()
    with open(path, "wb") as file:
        file.write(head)
        at = len(head) + 8 * (height // 16)
        for i in range(height // 16):
            file.write(struct.pack("<Q", at + i * (8 + len(packed))))
        for i in range(height // 16):
            file.write(struct.pack("<ii", i * 16, len(packed)) + packed)
write(sys.argv[1] + "/flat.exr", 3, 4096)
write(sys.argv[1] + "/bomb.exr", 256, 16384)
PYTHON
stop_showing
start_showing --picture-time 2
put cp "$scratch/bomb.exr" "$frame"
status=$(get "/frame/$id/0.png?size=64")
[[ $status = 50[04] ]] || fail "a bomb gets $status: $(cat "$scratch/body")"
stop_showing
start_showing --picture-time 3600 --picture-memory 200M
put cp "$scratch/flat.exr" "$frame"
expect_get 200 "/frame/$id/0.png?size=64&exposure=0"
expect "a huge picture" "$(png_size)" 64x16
# The farm's own workers had nothing to do with it, and the good frames are there.
expect_get 200 "/frame/$id/40.png"
expect "frames of the farm's workers" "$(ask worker.list | jq '[.result.workers[].done] | add')" 2
put cp "$scratch/good.exr" "$frame"
expect_get 200 "/frame/$id/0.png"
stop_showing

# Who goes away is not waited for: two pictures are being made when a third is asked for and given up, and then a fourth.
printf '#!/bin/sh\necho >>%s\nuntil [ -e %s/go ]; do sleep 0.05; done\nexec %s/march-worker "$@"\n' "$scratch/starts" "$scratch" "$bin" \
    >"$scratch/patient"
chmod 755 "$scratch/patient"
rm -rf "$scratch/cache/web"
start_showing --worker-program "$scratch/patient"
before=$(starts)
python3 - "$web_port" "$token" "/frame/$id/40.png?size" "$scratch" "$before" <<'PYTHON' || fail "a browser that goes away"
import sys, time, web_client
port, token, path, scratch, before = int(sys.argv[1]), sys.argv[2], sys.argv[3], sys.argv[4], int(sys.argv[5])
def begin(size):
    client = web_client.Client(port)
    client.send(f"GET {path}={size} HTTP/1.1\r\nHost: localhost\r\nAuthorization: Bearer {token}\r\n\r\n".encode())
    return client
def wait_for(text, count, file="web.log"):
    while open(f"{scratch}/{file}").read().count(text) < count:
        time.sleep(0.05)
first, second = begin(1), begin(2)
wait_for("\n", before + 2, "starts")
third = begin(3)
wait_for("a picture of", 3)
third.socket.close()
wait_for("not waited for any more", 1)
fourth = begin(4)
wait_for("a picture of", 4)
open(scratch + "/go", "w").close()
assert [client.answer().status for client in (first, second, fourth)] == [200, 200, 200]
PYTHON
expect "pictures that were made" "$(starts)" $((before + 3))
stop_showing

# Killed while it makes pictures and half of one is written, it begins again; the cache keeps its limit.
printf '#!/bin/sh\nexec sleep 100000\n' >"$scratch/slow"
chmod 755 "$scratch/slow"
rm -rf "$scratch/cache/web"
start_showing --worker-program "$scratch/slow"
timeout 5 python3 -c 'import sys,web_client; web_client.ask(int(sys.argv[1]), "GET", sys.argv[3], web_client.bearer(sys.argv[2]))' \
    "$web_port" "$token" "/frame/$id/40.png" 2>/dev/null
kill -KILL "$web_pid"
wait "$web_pid" 2>/dev/null
echo half >"$scratch/cache/web/work-0/made"
echo half >"$scratch/cache/web/0123456789abcdef0123456789abcdef"
start_showing --cache-bytes 6000
for size in 1 2 3 4 5 6 7 8 9 10; do
    expect_get 200 "/frame/$id/40.png?size=$size"
    bytes=$(find "$scratch/cache/web" -type f -printf '%s\n' | awk '{ sum += $1 } END { print sum + 0 }')
    [ "$bytes" -le 6000 ] || fail "the cache has $bytes bytes"
done
[ ! -e "$scratch/cache/web/0123456789abcdef0123456789abcdef" ] || fail "half a picture is kept"
stop_showing

# A user of its own that may not read the picture says so.
if [ "$(id -u)" = 0 ]; then
    rm -rf "$scratch/cache/web"
    chmod 666 "$socket"
    chmod 755 "$scratch/out" "$scratch/out/cloud"
    chmod 600 "$frame"
    as_web=(setpriv --reuid=65533 --regid=65533 --clear-groups)
    start_showing
    expect_get 403 "/frame/$id/0.png" "march-web may not read it"
    chmod 644 "$frame"
    expect_get 200 "/frame/$id/0.png"
    stop_showing
fi
stop_daemon
