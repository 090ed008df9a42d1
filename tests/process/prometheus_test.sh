#!/bin/bash
# The daemon's metrics, the alerts and the dashboard's queries are what Prometheus takes.
. "$(dirname "$0")/farm.sh"
command -v promtool >/dev/null || { echo "SKIP: there is no promtool: deploy/packages monitoring"; exit 77; }
rules=$PROJECT_ROOT/deploy/prometheus/marchd.rules.yml
dashboard=$PROJECT_ROOT/deploy/grafana/marchd.json

start_daemon --worker-program "$(stub audited:1)"
"$bin/march" metrics --socket "$socket" >"$scratch/idle" || fail "march metrics: status $?"
id=$(submit "$(job 1-4 '.quality = { tolerance: 0.05 }')")
wait_state "$id" succeeded
"$bin/march" metrics --socket "$socket" >"$scratch/busy" || fail "march metrics: status $?"
for text in idle busy; do
    said=$(promtool check metrics <"$scratch/$text" 2>&1) || fail "promtool check metrics: $said"
    expect "what promtool finds" "$said" ""
done

# Each series that rules and panels ask for is there.
sed -n 's/^# TYPE \([a-z_]*\) histogram$/\1_bucket\n\1_sum\n\1_count/p; s/^# TYPE \([a-z_]*\) .*/\1/p' "$scratch/busy" | sort >"$scratch/there"
jq -r '.panels[].targets[]?.expr' "$dashboard" >"$scratch/queries"
[ "$(wc -l <"$scratch/queries")" -gt 20 ] || fail "the dashboard has hardly a query"
for file in "$rules" "$scratch/queries"; do
    unknown=$(grep -o 'marchd_[a-z_]*' "$file" | sort -u | comm -23 - "$scratch/there")
    expect "series of $file that no daemon has" "$unknown" ""
done
# Each family is on the dashboard but those that are always 1 or told by others.
shown=$(grep -oh 'marchd_[a-z_]*' "$scratch/queries" "$rules" | sed 's/_bucket$//; s/_sum$//; s/_count$//' | sort -u)
expect "families that nobody sees" "$(sed -n 's/^# TYPE \([a-z_]*\) .*/\1/p' "$scratch/busy" | sort | comm -23 - <(echo "$shown"))" ""

promtool check rules "$rules" >"$scratch/said" 2>&1 || fail "promtool check rules: $(cat "$scratch/said")"
cp "$rules" "$PROJECT_ROOT/tests/process/prometheus_rules.yml" "$scratch"
(cd "$scratch" && promtool test rules prometheus_rules.yml) >"$scratch/said" 2>&1 || fail "promtool test rules: $(cat "$scratch/said")"
# A query is checked as a rule.
jq '{groups: [{name: "dashboard", rules: [.panels[].targets[]?.expr | gsub("\\$__rate_interval"; "1m") | {record: "q", expr: .}]}]}' \
    "$dashboard" >"$scratch/queries.yml"
promtool check rules --lint=none "$scratch/queries.yml" >"$scratch/said" 2>&1 || fail "a query of the dashboard: $(cat "$scratch/said")"
stop_daemon
