# Shared by the command line's process tests: what a command prints and how it ends. Sourced in a scratch folder.
failures=0
export XDG_CONFIG_HOME=$PWD/config # a daemon reads no settings of whoever runs the test

fail() {
    echo "FAILED: $*"
    [ ! -f out ] || { echo "stdout:"; cat out; }
    [ ! -f err ] || { echo "stderr:"; cat err; }
    failures=$((failures + 1))
}
# expect CODE COMMAND...: keeps stdout in `out`, stderr in `err`.
expect() {
    code=$1
    shift
    "$@" >out 2>err </dev/null
    got=$?
    [ "$got" -eq "$code" ] || fail "$*: expected exit $code, got $got"
}
