#!/bin/bash
# Programs say what they were built from: version, commit, and the libraries that they are linked with; march says it of all.
. "$PROJECT_ROOT/tests/process/farm.sh"
built=$(dirname "$bin")
version=$(sed -n 's/^project(marchd VERSION \([0-9.]*\).*/\1/p' "$PROJECT_ROOT/CMakeLists.txt")
commit=$(sed -n 's/.* = "\(.*\)";$/\1/p' "$built/commit.c")

# One name for what a linker and people call a library: cjson of libcjson.so.1 and cJSON, z of libz.so.1 and zlib.
plain_names() { tr '[:upper:]' '[:lower:]' | sed -E 's/^lib//; s/[-.].*//; s/lib$|core$//; s/[0-9]*$//' | sort; }

# says PROGRAM LINES: what it links, the C library and sanitizers apart, is what it lists.
says()
{
    expect "what $1 is" "$(sed -n 1,2p <<<"$2")" "$1 $version"$'\n'"commit ${commit:-unknown}"
    expect "libraries of $1" "$(sed 1,2d <<<"$2" | sed 's/ .*//' | plain_names)" \
        "$(objdump -p "$bin/$1" | awk '$1 == "NEEDED" { print $2 }' | grep -vE '^(lib(c|m|dl|rt|pthread|asan|ubsan|gcc_s)|ld-.*)\.so' | plain_names)"
    sed 1,2d <<<"$2" | grep -vE '^[A-Za-z]+ [0-9]+(\.[0-9]+)*( \(compiled with\))?$' && fail "a line of $1 is no library's"
}
for program in march-worker marchd; do
    says "$program" "$("$bin/$program" --version)"
done
"$bin/march" version >"$scratch/all"
says march "$(sed '/^$/,$d' "$scratch/all")"
expect "what march says of the others" "$(sed '1,/^$/d' "$scratch/all")" "$("$bin/march-worker" --version; echo; "$bin/marchd" --version)"
expect "march --version" "$("$bin/march" --version)" "$(cat "$scratch/all")"

# The same as JSON.
"$bin/march" version --json >"$scratch/json"
expect "lines of JSON" "$(wc -l <"$scratch/json")" 1
expect "march version --json" \
    "$(jq -r '[{program: "march"} + del(.programs), .programs[]] | .[] | "\(.program) \(.version)", "commit \(.commit // "unknown")",
        (.libraries | to_entries[] | "\(.key) \(.value)"), ""' "$scratch/json")" "$(cat "$scratch/all")"

# Alone, beside a program that fails, and beside an older one that says its version only.
mkdir "$scratch/alone"
cp "$bin/march" "$scratch/alone"
expect "programs beside none" "$("$scratch/alone/march" version --json | jq -c .programs)" '[]'
printf '#!/bin/sh\necho march-worker 9\nexit 1\n' >"$scratch/alone/march-worker"
printf '#!/bin/sh\necho marchd 0.0.1\n' >"$scratch/alone/marchd"
chmod +x "$scratch/alone"/march*
expect "programs beside old ones" "$("$scratch/alone/march" version --json | jq -c .programs)" '[{"program":"marchd","version":"0.0.1"}]'

# Where the commit comes from: a history, files that differ from it, a tarball; and a tree with neither.
script=$PROJECT_ROOT/cmake/commit_script.cmake
tree=$scratch/tree
commit_of() { cmake -DROOT="$1" -DOUTPUT="$scratch/commit.c" -P "${2:-$script}" && sed -n 's/.* = "\(.*\)";$/\1/p' "$scratch/commit.c"; }
mkdir "$tree"
expect "no history" "$(commit_of "$tree")" ""
cp "$script" "$PROJECT_ROOT/CMakeLists.txt" "$tree"
echo 'commit_script.cmake export-subst' >"$tree/.gitattributes"
in_tree() { git -C "$tree" -c user.name=test -c user.email=test@example.org "$@"; }
in_tree init -q
in_tree add .
in_tree commit -q -m first
hash=$(in_tree rev-parse --short=12 HEAD)
expect "a history" "$(commit_of "$tree")" "$hash"
touch -d @1 "$scratch/commit.c"
expect "the same history" "$(commit_of "$tree")" "$hash"
expect "when the file was written" "$(stat -c %Y "$scratch/commit.c")" 1
echo >>"$tree/CMakeLists.txt"
expect "files that differ" "$(commit_of "$tree")" "$hash-dirty"
mkdir "$scratch/tarball"
in_tree archive HEAD | tar -x -C "$scratch/tarball"
expect "a tarball" "$(commit_of "$scratch/tarball" "$scratch/tarball/commit_script.cmake")" "$hash"
