#!/bin/bash
# Lists of jobs and frames: filters, pages by a cursor while jobs come and go, and the map of a job's frames.
. "$(dirname "$0")/farm.sh"

# numbered N [NAME]: a paused job with an output of its own.
numbered() { submit "$(job 0-9 ".name = \"${2:-shot} $1\" | .output.path = \"n$1/n.####.exr\"")" true; }

# pages PARAMS: the ids of all pages of job.list, a line a page.
pages()
{
    local answer next=

    while :; do
        answer=$(ask job.list "$(jq -c --arg next "$next" 'if $next == "" then . else .cursor = $next end' <<<"$1")")
        jq -c 'if .error then .error.message else [.result.jobs[].id] end' <<<"$answer"
        next=$(jq -r '.result.next // empty' <<<"$answer")
        [ -n "$next" ] || break
    done
}

ids() { jq -c '[.result.jobs[].id]' <<<"$(ask job.list "$1")"; }
ends() { jq -c '[.result.total, .result.next]' <<<"$(ask job.list "$1")"; }

start_daemon --worker-program "$(stub write:1)"
expect "a list of nothing" "$(ask job.list '{"limit":5}' | jq -c .result)" '{"jobs":[],"next":null,"total":0}'
before_s=$(date +%s)
for n in 1 2 3 4 5 6 7; do numbered $n >/dev/null; done
for n in 8 9 10; do numbered $n Smoke >/dev/null; done
expect "all jobs without a limit" "$(ids '{}') $(ends '{}')" "[1,2,3,4,5,6,7,8,9,10] [10,null]"
expect "pages" "$(pages '{"limit":4}' | xargs)" "[1,2,3,4] [5,6,7,8] [9,10]"
expect "pages, the newest first" "$(pages '{"limit":4,"order":"-id"}' | xargs)" "[10,9,8,7] [6,5,4,3] [2,1]"
expect "a page that is just full" "$(pages '{"limit":5}' | xargs)" "[1,2,3,4,5] [6,7,8,9,10]"
expect "the count of a page" "$(ends '{"limit":4}')" '[10,"u4"]'

# Filters, and pages of what they leave.
expect "by a part of the name" "$(pages '{"name":"sMOKE","limit":2}' | xargs)" "[8,9] [10]"
expect "by name, downwards" "$(pages '{"name":"shot","limit":3,"order":"-id"}' | xargs)" "[7,6,5] [4,3,2] [1]"
expect "the count behind a filter" "$(ends '{"name":"shot","limit":2,"cursor":"u4"}')" '[7,"u6"]'
expect "by owner" "$(ends "{\"owner\":\"$(id -un)\",\"limit\":1}")" '[10,"u1"]'
expect "by an owner without jobs" "$(ends '{"owner":"nobody-at-all"}')" "[0,null]"
ask job.cancel '{"id":3}' >/dev/null
expect "by state" "$(ids '{"state":"canceled","limit":9}')$(ends '{"state":["paused","canceled"],"limit":1}')" '[3][10,"u1"]'
expect "since" "$(ends "{\"since\":$before_s}")" "[10,null]"
expect "since a later time" "$(ends "{\"since\":$((before_s + 100000))}")" "[0,null]"
expect "before" "$(ends "{\"before\":$before_s}")" "[0,null]"
third=$(field 3 .submitted)
expect "since and before meet" "$(ends "{\"since\":$third}" | jq -c '.[0]') $(ends "{\"before\":$third}" | jq -c '.[0]')" "8 2"
expect "ids with a filter" "$(ids '{"ids":[9,3,99,1],"state":"paused"}')$(ends '{"ids":[9,3]}')" "[9,1][2,null]"

# Jobs that come and go between two pages: none twice, none left out that was there all the time.
expect "the first page" "$(ids '{"limit":4}')" "[1,2,3,4]"
for id in 2 4 5; do
    ask job.cancel "{\"id\":$id}" >/dev/null
    wait_until "job $id is deleted" eval '[ "$(ask job.delete "{\"id\":$id}" | jq ".result.files_removed")" = 0 ]'
done
numbered 11 >/dev/null
expect "the second page" "$(ids '{"limit":4,"cursor":"u4"}')" "[6,7,8,9]"
expect "the last page" "$(ids '{"limit":4,"cursor":"u9"}')$(ends '{"limit":4,"cursor":"u9"}')" "[10,11][8,null]"
expect "downwards behind a job that is gone" "$(ids '{"limit":4,"cursor":"d5","order":"-id"}')" "[3,1]"

expect_error "$(ask job.list '{"limit":0}')" -32602 "params.limit: expected an integer from 1 to 1000, got 0"
expect_error "$(ask job.list '{"limit":1001}')" -32602 "params.limit"
for cursor in d4 u u-1 u1x f1 u1234567890123456789 ''; do
    expect_error "$(ask job.list "{\"limit\":1,\"cursor\":\"$cursor\"}")" -32602 'params.cursor: expected "next" of a job.list in the same order'
done
expect_error "$(ask job.list '{"ids":[1],"limit":2}')" -32602 'params.limit: expected none beside "ids"'
expect_error "$(ask job.list '{"ids":[0]}')" -32602 'params.ids[0]: expected an integer'
expect_error "$(ask job.list '{"order":"name"}')" -32602 'params.order: expected one of'
expect_error "$(ask job.list "{\"name\":\"$(printf 'a%.0s' {1..257})\"}")" -32602 'params.name: expected at most 256 bytes'
expect_error "$(ask job.list '{"since":-1}')" -32602 'params.since: expected a number'
expect_error "$(ask job.list '{"ownr":"a"}')" -32602 'did you mean "owner"'

# Frames: a page goes on behind its last frame, whatever the frames before it have become.
frames() { ask job.frames "$1" | jq -c '[[.result.frames[].frame], .result.next, .result.total]'; }
id=$(submit "$(job 19-0 '.output.path = "frames/f.####.exr"')" true)
ask job.cancel "{\"id\":$id}" >/dev/null
expect "frames of a page" "$(frames "{\"id\":$id,\"state\":\"canceled\",\"limit\":8}")" '[[19,18,17,16,15,14,13,12],"f8",20]'
expect "retried" "$(ask job.retry "{\"id\":$id,\"state\":\"canceled\",\"range\":\"15-19\"}" | jq .result.retried)" 5
wait_until "they are rendered" eval '[ "$(field "$id" .succeeded)" = 5 ]'
expect "frames of the next page" "$(frames "{\"id\":$id,\"state\":\"canceled\",\"limit\":8,\"cursor\":\"f8\"}")" \
    '[[11,10,9,8,7,6,5,4],"f16",15]'
expect "frames of the last page" "$(frames "{\"id\":$id,\"limit\":8,\"cursor\":\"f16\"}")" '[[3,2,1,0],null,20]'
expect "frames of a range" "$(frames "{\"id\":$id,\"limit\":2,\"cursor\":\"f8\",\"range\":\"5-12\"}")" '[[11,10],"f10",8]'
expect "a page behind the end" "$(frames "{\"id\":$id,\"cursor\":\"f99\"}")" '[[],null,20]'
expect_error "$(ask job.frames "{\"id\":$id,\"cursor\":\"u8\"}")" -32602 'params.cursor: expected "next" of a job.frames, got "u8"'
expect_error "$(ask job.frames "{\"id\":$id,\"cursor\":\"f8\",\"offset\":1}")" -32602 'params.offset: expected none beside "cursor"'

# The map: a letter and two numbers a frame.
map() { ask job.frame_map "$1" | jq -c ".result | $2"; }
expect "a map" "$(map "{\"id\":$id}" '[.frames, .total, .offset, .states, (.seconds | length), (.errors | length)]')" \
    '["19-0",20,0,"sssssccccccccccccccc",20,20]'
expect "its numbers" "$(map "{\"id\":$id}" '[[.seconds[] | . != null], [.errors[] | select(.)]]')" \
    "$(jq -nc '[[range(20) | . < 5], []]')"
expect "a part of a map" "$(map "{\"id\":$id,\"offset\":3,\"limit\":4}" '[.offset, .total, .states, (.seconds | length)]')" '[3,20,"sscc",4]'
expect "a map behind the end" "$(map "{\"id\":$id,\"offset\":30}" '[.offset, .states, .seconds]')" '[20,"",[]]'
expect_error "$(ask job.frame_map "{\"id\":$id,\"limit\":50001}")" -32602 "params.limit: expected an integer from 1 to 50000, got 50001"
expect_error "$(ask job.frame_map '{"id":9999}')" 1 "there is no such job"
stop_daemon
