# How checks of the system test run and what is said of them. Sourced by tests/service.
passed=0
failed=0

# In a check: ends it.
fail()
{
    echo "FAIL: $*" >&2
    exit 1
}

skip()
{
    echo "tests/service: skipped: $*" >&2
    exit 77
}

# expect WHAT ACTUAL WANTED
expect()
{
    [ "$2" = "$3" ] || fail "$1: expected \"$3\", got \"$2\""
}

patience_s=600 # a guard against what never happens, not a measure: machines are slow and busy

# comes_true COMMAND...
comes_true()
{
    local end=$((SECONDS + patience_s))

    until "$@"; do
        [ "$SECONDS" -lt "$end" ] || return 1
        sleep 0.1
    done
}

# until_true WHAT COMMAND...
until_true()
{
    local what=$1

    shift
    comes_true "$@" || fail "not within $patience_s s: $what"
}

# check TITLE FUNCTION: a check of its own; what it says is shown only if it fails. Must not stand in a condition, which
# would turn off set -e in it.
check()
{
    local title=$1 begin=$EPOCHREALTIME status seconds

    [[ $title =~ $wanted ]] || return
    (
        set -e
        "$2"
    ) >"$work/said" 2>&1
    status=$?
    seconds=$(awk -v a="$begin" -v b="$EPOCHREALTIME" 'BEGIN { printf "%.1f", b - a }')
    if [ "$status" -eq 0 ]; then
        printf 'ok   %6s s  %s\n' "$seconds" "$title"
        [ -z "${VERBOSE:-}" ] || sed 's/^/       /' "$work/said"
        passed=$((passed + 1))
        return
    fi
    printf 'FAIL %6s s  %s\n' "$seconds" "$title"
    sed 's/^/       /' "$work/said"
    tell_journal "${begin%.*}" 2>&1 | sed 's/^/       /'
    cancel_all >/dev/null 2>&1 # the next check is about its own jobs
    failed=$((failed + 1))
    return
}

# After a check without which the others say nothing.
stop_if_failed()
{
    [ "$failed" -eq 0 ] || finish
}

finish()
{
    echo "$passed checks passed, $failed failed, $SECONDS s"
    [ "$failed" -eq 0 ]
    exit
}
