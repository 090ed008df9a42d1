# Running the checks of the system test and reporting on them. Sourced by tests/service.
passed=0
failed=0
has_turns=
turn=0

# fail WORD...: ends the check.
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

# expect WHAT ACTUAL WANTED: fails where the two differ.
expect()
{
    [ "$2" = "$3" ] || fail "$1: expected \"$3\", got \"$2\""
}

patience_s=600 # a guard, far longer than any wait on slow and busy machines

# comes_true COMMAND...: repeats the command until it succeeds, for at most $patience_s.
comes_true()
{
    local end=$((SECONDS + patience_s))

    until "$@"; do
        [ "$SECONDS" -lt "$end" ] || return 1
        sleep 0.1
    done
}

# until_true WHAT COMMAND...: fails where the command does not come true.
until_true()
{
    local what=$1

    shift
    comes_true "$@" || fail "not within $patience_s s: $what"
}

# check TITLE FUNCTION: runs the function as a check and shows its output only if it fails. A check must not be part of
# a condition, which would turn off set -e in it.
check()
{
    local title=$1 begin=$EPOCHREALTIME status seconds

    [[ $title =~ $wanted ]] || return
    [ -z "$has_turns" ] || [ $((turn++ % parts)) -eq $((part % parts)) ] || return
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
    cancel_all >/dev/null 2>&1 # the next check counts its own jobs
    failed=$((failed + 1))
    return
}

# stop_if_failed: ends the test where the checks so far are needed by all others.
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
