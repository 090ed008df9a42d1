# A Debian root for the system test: made once by debootstrap, kept as a tarball, unpacked for each run. Sourced by
# tests/service.
# The root is of this machine's Debian release, for which the package is built.
suite=$(. /etc/os-release && echo "${VERSION_CODENAME-}")
# The packages jq and procps are for the test itself, ssh's and Slurm's for nodes; the others are those of any Debian with
# systemd.
root_packages=systemd,systemd-sysv,dbus,dbus-user-session,libpam-systemd,jq,procps,openssh-server,openssh-client
root_packages+=,slurmctld,slurmd,slurm-client,munge
cache=${XDG_CACHE_HOME:-/var/cache}/marchd-tests

# find_mirror ARCHIVE: prints the archive's mirror in this machine's own apt sources. It prints nothing where there is
# none, and debootstrap uses its default.
find_mirror()
{
    cat /etc/apt/sources.list /etc/apt/sources.list.d/*.sources /etc/apt/sources.list.d/*.list 2>/dev/null |
        grep -oE "https?://[^ ]+/$1/?( |\$)" | head -n 1 | tr -d ' '
}

# make_base DEB WORKER-DEB WEB-DEB FILE: packages are fetched but not installed, because installing the right ones is for the .deb's
# Depends.
make_base()
{
    local deb=$1 worker=$2 web=$3 file=$4 mirror security
    local root=$work/base

    mirror=$(find_mirror debian) || true
    security=$(find_mirror debian-security) || true
    echo "making a Debian root (once, a minute or two)"
    debootstrap --variant=minbase --include="$root_packages" "$suite" "$root" ${mirror:+"$mirror"} >"$work/debootstrap.log" 2>&1 ||
        skip "debootstrap could not make a root: $(tail -n 1 "$work/debootstrap.log")"
    # Snapshots of mirrors may be out of date. The timers of apt are off, which could act in the middle of a check.
    printf '%s\n' 'Acquire::Check-Valid-Until "false";' 'Acquire::Check-Date "false";' \
        'APT::Keep-Downloaded-Packages "true";' >"$root/etc/apt/apt.conf.d/90test"
    ln -s /dev/null "$root/etc/systemd/system/apt-daily.timer"
    ln -s /dev/null "$root/etc/systemd/system/apt-daily-upgrade.timer"
    ln -s /dev/null "$root/etc/systemd/system/console-getty.service"
    # The machine has the host's network: a check starts an sshd where nobody else is.
    ln -sf /dev/null "$root/etc/systemd/system/ssh.service"
    ln -sf /dev/null "$root/etc/systemd/system/ssh.socket"
    # A package built with a security update depends on that version or later.
    [ -z "$security" ] || echo "deb $security $suite-security main" >>"$root/etc/apt/sources.list"
    cp "$deb" "$root/marchd.deb"
    cp "$worker" "$root/marchd-worker.deb"
    cp "$web" "$root/marchd-web.deb"
    chroot "$root" sh -c 'apt-get update -qq && apt-get install -y -qq --download-only /marchd.deb /marchd-worker.deb /marchd-web.deb' \
        >"$work/download.log" 2>&1 ||
        skip "apt could not fetch what the package depends on: $(tail -n 1 "$work/download.log")"
    rm "$root/marchd.deb" "$root/marchd-worker.deb" "$root/marchd-web.deb"
    tar -C "$root" -cf "$file.$$" . && mv "$file.$$" "$file"
    rm -rf "$root"
}

# make_root DEB WORKER-DEB WEB-DEB FOLDER: unpacks the root that fits the package's dependencies.
make_root()
{
    local deb=$1 worker=$2 web=$3 folder=$4 key file

    key=$({
        echo "$suite $root_packages"
        for file in "$deb" "$worker" "$web"; do
            dpkg-deb --field "$file" Depends Pre-Depends Recommends | sed -E 's/marchd(-worker)? [(]= [^)]*[)]/marchd\1/'
        done
        cat "$here/system/root.sh"
    } | sha256sum | cut -c 1-16)
    file=$cache/root-$key.tar
    mkdir -p "$cache" "$folder"
    {
        flock 8
        if [ ! -f "$file" ]; then
            make_base "$deb" "$worker" "$web" "$file"
            # The newest three roots are kept; older ones are for dependencies that changed.
            find "$cache" -name 'root-*.tar' -printf '%T@ %p\n' | sort -rn | tail -n +4 | cut -d ' ' -f 2- | xargs -r rm -f
        fi
        tar -C "$folder" -xf "$file"
    } 8>"$cache/lock"
}
