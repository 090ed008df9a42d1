#!/bin/sh
# cmake --install installs exactly the listed files, and the units name the installed programs. The programs run from
# there: the daemon finds its worker, and the examples are valid.
set -eu
. "$PROJECT_ROOT/tests/process/package_files.sh"
scratch=$(mktemp -d "${TMPDIR:-/tmp}/package_install_test.XXXXXX")
trap 'rm -rf "$scratch"' EXIT
built=$(dirname "$PROGRAM_FOLDER")
prefix=$(sed -n 's/^CMAKE_INSTALL_PREFIX:PATH=//p' "$built/CMakeCache.txt")
root=$scratch/root

DESTDIR=$root cmake --install "$built" >"$scratch/log" 2>&1 || fail "cmake --install: $(tail -n 5 "$scratch/log")"
{
    installed_files "$prefix" "$prefix/lib/systemd/system" && worker_files "$prefix" && python_files "$prefix" &&
        web_files "$prefix" "$prefix/lib/systemd/system"
} | sort >"$scratch/expected"
(cd "$root" && find . ! -type d | sed 's/^\.//' | sort) >"$scratch/found"
diff "$scratch/expected" "$scratch/found" >"$scratch/diff" || fail "installed otherwise (< expected, > found): $(cat "$scratch/diff")"
odd=$(find "$root" -type f ! -perm 644 ! -path '*/bin/*')
[ -z "$odd" ] || fail "expected mode 644: $odd"
[ -x "$root$prefix/bin/march-worker" ] || fail "march-worker cannot be run"

for unit in system/marchd.service user/marchd.service; do
    grep -q "^ExecStart=$prefix/bin/marchd" "$root$prefix/lib/systemd/$unit" || fail "$unit starts another marchd"
done
grep -qx "ExecStart=$prefix/bin/march-launch" "$root$prefix/lib/systemd/system/march-launch.service" ||
    fail "march-launch.service starts another march-launch"
grep -qx "ExecStart=$prefix/bin/march-web --system" "$root$prefix/lib/systemd/system/march-web.service" ||
    fail "march-web.service starts another march-web"
# A further farm's unit is the first one's, but for what tells the daemon its places.
units=$root$prefix/lib/systemd/system
cmp -s "$units/marchd.socket" "$units/marchd@.socket" || fail "marchd@.socket is another"
# differs UNIT: prints the lines that are the further farm's own.
differs() { diff "$units/$1" "$units/$(echo "$1" | sed 's/[.]/@./')" | sed -n 's/^> //p'; }
expect() { [ "$2" = "$3" ] || fail "$1: expected \"$3\", got \"$2\""; }
expect marchd@.service "$(differs marchd.service)" "Wants=march-launch@%i.socket
After=%N.socket march-launch@%i.socket local-fs.target remote-fs.target systemd-modules-load.service nvidia-persistenced.service
ExecStart=$prefix/bin/marchd --system --config /etc/marchd/%i.conf --state /var/lib/%N --socket /run/marchd/%N.sock \
--launch-socket /run/marchd/march-launch@%i.sock"
expect march-launch@.socket "$(differs march-launch.socket)" PartOf=marchd@%i.service
expect march-launch@.service "$(differs march-launch.service)" "PartOf=marchd@%i.service
Before=marchd@%i.service
ExecStart=$prefix/bin/march-launch --config /etc/marchd/%i.conf
InaccessiblePaths=-/var/lib/marchd -/var/lib/marchd@%i -/var/cache/marchd -/var/cache/marchd@%i -/srv/marchd -/srv/marchd@%i \
-/srv/marchd-input -/run/marchd"
cmp -s "$PROJECT_ROOT/deploy/marchd.conf" "$root/etc/marchd/marchd.conf" || fail "marchd.conf is not the one of the tree"

# Examples name their files relative to themselves; the scan's file comes from another package.
for job in "$root$prefix"/share/marchd/jobs/*.json; do
    case "$job" in */schema.json | */scan.json) continue ;; esac
    "$root$prefix/bin/march" validate "$job" >"$scratch/log" 2>&1 || fail "$job: $(cat "$scratch/log")"
done
"$root$prefix/bin/march" render "$root$prefix/share/marchd/jobs/opaque.json" --frames 0 --set 'resolution=[32,18]' \
    --out "$scratch/out/####.exr" >"$scratch/log" 2>&1 || fail "what is installed does not render: $(cat "$scratch/log")"
[ -s "$scratch/out/0000.exr" ] || fail "nothing was rendered"
