#!/bin/bash
# The man pages agree with the programs' help and with marchd.conf, and a formatter finds no fault in them.
. "$PROJECT_ROOT/tests/process/farm.sh"
pages=$PROJECT_ROOT/deploy/man

"$pages/update" --check "$bin" || fail "a page is out of date"

# The help's verbs and options are the tags of its page, and the tags are all verbs or options of the help.
verbs=$("$bin/march" help --json | jq -r '.verbs[].name')
expect "verbs of march(1)" "$(sed -n 's/^\.SS march \([a-z]*\).*/\1/p' "$pages/march.1")" "$verbs"
for verb in $verbs; do
    expect "options of march $verb" \
        "$(sed -n "/^\.SS march $verb /,/^\.EX/s/^\.B \(\\\\-\\\\-[^ ]*\).*/\1/p" "$pages/march.1" | sed 's/\\//g')" \
        "$("$bin/march" help "$verb" | sed -nE 's/^  (--[^ ]+) .*/\1/p' | grep -vxE -- '--(help|json|socket)')"
done
expect "options of marchd(8)" "$(sed -n '/BEGIN/,/END/s/^\.B \(.*\)/\1/p' "$pages/marchd.8" | grep -o -- '\\-\\-[a-z\-]*' | sed 's/\\//g')" \
    "$("$bin/marchd" --help | grep -oE '^  --[a-z-]+|, --version' | grep -o -- '--.*')"
# A setting is an option of the daemon that a file may hold.
expect "settings of marchd.conf(5)" "$(sed -n 's/^\.B \([a-z\-]*\) = *.*/\1/p' "$pages/marchd.conf.5" | sed 's/\\//g' | sort -u)" \
    "$("$bin/marchd" --help | sed -nE 's/^  --([a-z-]+) [^ ].*/\1/p' | grep -vxE 'config|system|backup|restore' | sort -u)"
expect "options of march-web(8)" "$(sed -n '/BEGIN/,/END/s/^\.B \(.*\)/\1/p' "$pages/march-web.8" | grep -o -- '\\-\\-[a-z\-]*' | sed 's/\\//g')" \
    "$("$bin/march-web" --help | grep -oE '^  --[a-z-]+|, --version' | grep -o -- '--.*')"
expect "settings of march-web.conf(5)" "$(sed -n 's/^\.B \([a-z\-]*\) = *.*/\1/p' "$pages/march-web.conf.5" | sed 's/\\//g' | sort -u)" \
    "$("$bin/march-web" --help | sed -nE 's/^  --([a-z-]+) [^ ].*/\1/p' | grep -vxE 'config|system' | sort -u)"
expect "options of march-worker(8)" "$(sed -nE '/^\.SH OPTIONS/,$s/^\.(B|BI|BR) (\\-\\-[^ ]*).*/\2/p' "$pages/march-worker.8" | sed 's/\\//g')" \
    "$("$bin/march-worker" --help 2>&1 | grep -oE -- '--[a-z-]+')"

# The example of marchd-job(5) is a valid job.
sed -n '/^\.EX/,/^\.EE/{//!p}' "$pages/marchd-job.5" | sed 's/\\-/-/g; s/\\e/\\/g' >"$scratch/first.json"
"$bin/march" validate "$scratch/first.json" || fail "marchd-job(5) shows a wrong job"

if command -v groff >/dev/null; then
    for page in "$pages"/*.[158]; do
        expect "groff's complaints about $page" "$(groff -man -ww -z -Tutf8 -Kutf8 "$page" 2>&1)" ""
    done
else
    echo "no groff here: pages not formatted"
fi
