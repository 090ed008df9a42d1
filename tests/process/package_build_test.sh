#!/bin/sh
# The Debian package is built by one command and holds the installed files, its setting file, its scripts and its
# dependencies.
set -eu
. "$PROJECT_ROOT/tests/process/package_files.sh"
for program in dpkg-buildpackage dpkg-deb dh; do
    command -v $program >/dev/null || { echo "skipped: there is no $program (deploy/packages package)"; exit 77; }
done
scratch=$(mktemp -d "${TMPDIR:-/tmp}/package_build_test.XXXXXX")
trap 'rm -rf "$scratch"' EXIT

# What is packed here is unpacked at once.
export DPKG_DEB_COMPRESSOR_TYPE=gzip DPKG_DEB_COMPRESSOR_LEVEL=1
"$PROJECT_ROOT/deploy/package" --out "$scratch/out" --revision 7 >"$scratch/built" || fail "deploy/package"
{ read -r package && read -r worker && read -r web && read -r python; } <"$scratch/built"
version=$(sed -n 's/^project(marchd VERSION \([0-9.]*\).*/\1/p' "$PROJECT_ROOT/CMakeLists.txt")
[ "$package" = "$scratch/out/marchd_$version-7_$(dpkg --print-architecture).deb" ] || fail "built as $package"
[ "$worker" = "$scratch/out/marchd-worker_$version-7_$(dpkg --print-architecture).deb" ] || fail "built as $worker"
[ "$web" = "$scratch/out/marchd-web_$version-7_$(dpkg --print-architecture).deb" ] || fail "built as $web"
[ "$python" = "$scratch/out/python3-marchd_$version-7_all.deb" ] || fail "built as $python"
[ "$(dpkg-deb -f "$package" Version)" = "$version-7" ] || fail "version $(dpkg-deb -f "$package" Version)"

# The package's files are the installed ones and those that Debian requires; man pages and the changelog are compressed.
case "$(. /etc/os-release && echo "$ID $VERSION_ID")" in
'debian 12') units=/lib/systemd/system ;;
*) units=/usr/lib/systemd/system ;;
esac
# packed PACKAGE NAME: what the package has is the list on standard input and what Debian requires of a package of that name.
packed() {
    {
        sed 's|^\(/usr/share/man/.*\)|\1.gz|; s|/CHANGELOG\.md$|/changelog.gz|'
        echo "/usr/share/doc/$2/changelog.Debian.gz"
        echo "/usr/share/doc/$2/copyright"
        echo "/usr/share/lintian/overrides/$2"
    } | sort >"$scratch/expected"
    dpkg-deb -c "$1" >"$scratch/listed"
    grep -v '^d' "$scratch/listed" | awk '{ print $6 }' | sed 's/^\.//' | sort >"$scratch/found"
    diff "$scratch/expected" "$scratch/found" >"$scratch/diff" || fail "$2 is packed otherwise (< expected, > found): $(cat "$scratch/diff")"
    ! grep -v ' root/root ' "$scratch/listed" || fail "files of another than root"
}
installed_files /usr "$units" | packed "$package" marchd
worker_files /usr | packed "$worker" marchd-worker
web_files /usr "$units" | packed "$web" marchd-web
python_files /usr | packed "$python" python3-marchd
dpkg-deb --fsys-tarfile "$package" | tar -xO ./usr/share/doc/marchd/copyright >"$scratch/copyright"
for line in 'Format: https://www.debian.org/doc/packaging-manuals/copyright-format/1.0/' 'Files: *' 'License: Apache-2.0' \
    ' /usr/share/common-licenses/Apache-2.0.'; do
    grep -qxF -- "$line" "$scratch/copyright" || fail "copyright lacks: $line"
done
maintainer=$(dpkg-deb -f "$package" Maintainer)
[ "$maintainer" = "${DEBFULLNAME:-marchd developers} <${DEBEMAIL:-marchd@example.org}>" ] || fail "maintained by $maintainer"

dpkg-deb -e "$package" "$scratch/control"
[ "$(tr '\n' ' ' <"$scratch/control/conffiles")" = "/etc/marchd/marchd.conf /etc/marchd/ssh/config " ] ||
    fail "conffiles: $(cat "$scratch/control/conffiles")"
# depends PACKAGE NAME...
depends() {
    file=$1
    shift
    for need in "$@"; do
        dpkg-deb -f "$file" Depends | sed 's,[|\,],\n,g' | grep -q "^ *$need\(t64\)\{0,1\} *\((.*\)\{0,1\}$" ||
            fail "$file does not depend on $need"
    done
}
depends "$package" libc6 libuv1 libsqlite3-0 libsystemd0 systemd "marchd-worker (= $version-7)"
depends "$python" python3:any
PYTHONDONTWRITEBYTECODE=1 PYTHONPATH=$scratch/unpacked/usr/lib/python3/dist-packages
export PYTHONDONTWRITEBYTECODE PYTHONPATH
dpkg-deb -x "$python" "$scratch/unpacked"
(cd "$scratch" && python3 -c 'import marchd; assert marchd.__file__.startswith("'"$scratch"'")') || fail "the package's modules cannot be imported"
depends "$worker" libc6 libuv1 libegl1 libegl-mesa0 libgl1-mesa-dri
depends "$web" libc6 libuv1 libwebsockets17 libcurl4 libmd0 libwebsockets-evlib-uv libjs-chart.js "marchd (= $version-7)"
! dpkg-deb -f "$worker" Depends | grep -qE 'systemd|sqlite' || fail "a node does not need $(dpkg-deb -f "$worker" Depends)"
dpkg-deb -I "$worker" | grep -qE ' (post|pre)(inst|rm) ' && fail "marchd-worker has scripts"
[ "$(dpkg-deb -f "$worker" Recommends)" = libosmesa6 ] || fail "does not recommend OSMesa, which newer releases lack"
dpkg-deb -f "$worker" Suggests | grep -q libnanovdb-tools || fail "does not suggest the OpenVDB converter"

# does SCRIPT TEXT: the script of the package contains the text.
does() { grep -qF -- "$2" "$scratch/control/$1" || fail "$1: expected $2"; }
for script in postinst prerm postrm; do
    sh -n "$scratch/control/$script" || fail "$script is no shell script"
done
does postinst 'systemd-sysusers'
does postinst 'systemd-tmpfiles'
does postinst "deb-systemd-helper enable 'marchd.service'"
does postinst "deb-systemd-helper enable 'marchd.socket'"
does postinst "deb-systemd-invoke \$_dh_action 'marchd.service'"
does postinst "deb-systemd-invoke start 'marchd.socket'"
does prerm "deb-systemd-invoke stop 'marchd.service'"
does prerm "deb-systemd-invoke stop 'marchd.socket'"
does postinst "deb-systemd-invoke try-restart 'marchd@*.service'"
does prerm "deb-systemd-invoke stop 'marchd@*.socket' 'marchd@*.service'"
# The user that owns the folders is created before them; clients wait at the socket while an upgrade goes on.
users=$(grep -n systemd-sysusers "$scratch/control/postinst" | head -n 1 | cut -d: -f1)
folders=$(grep -n systemd-tmpfiles "$scratch/control/postinst" | head -n 1 | cut -d: -f1)
[ "$users" -lt "$folders" ] || fail "folders are made before their owner"
! grep -A 2 '= *upgrade' "$scratch/control/prerm" || fail "an upgrade stops something before the new files are there"

# The page is off until somebody turns it on; its user is made without the service.
dpkg-deb -e "$web" "$scratch/web"
[ "$(cat "$scratch/web/conffiles")" = /etc/marchd/march-web.conf ] || fail "conffiles of marchd-web: $(cat "$scratch/web/conffiles")"
grep -q systemd-sysusers "$scratch/web/postinst" || fail "marchd-web makes no user"
! grep -E "deb-systemd-invoke start|_dh_action=start" "$scratch/web/postinst" || fail "marchd-web starts itself"
# An upgrade enables again what somebody has enabled.
grep -B 9 "deb-systemd-helper enable" "$scratch/web/postinst" | grep -q "was-enabled 'march-web.service'" ||
    fail "marchd-web turns itself on"
! grep -q march-web "$scratch/control/postinst" || fail "marchd turns the page on"

if command -v shellcheck >/dev/null; then
    shellcheck -s sh "$PROJECT_ROOT/deploy/package" "$PROJECT_ROOT"/deploy/debian/post* "$PROJECT_ROOT"/deploy/debian/prerm || fail "shellcheck"
fi
if command -v lintian >/dev/null; then
    lintian --fail-on error,warning --allow-root "$package" "$worker" "$web" "$python" || fail "lintian"
fi
