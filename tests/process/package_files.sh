# Shared by the package's tests: the installed files, from the tree's own lists where a folder is installed as a whole.
fail() {
    echo "FAILED: $*"
    exit 1
}

# below FOLDER TARGET: the folder's files, named by their paths below the target.
below() { (cd "$PROJECT_ROOT/$1" && find . -type f | sed "s|^\.|$2|"); }

# worker_files PREFIX: those of march-worker, which are a package of their own.
worker_files() {
    printf '%s\n' "$1/bin/march-worker" "$1/share/man/man8/march-worker.8"
}

# python_files PREFIX: those of the Python client, likewise.
python_files() {
    below python/marchd "$1/lib/python3/dist-packages/marchd" | grep -v __pycache__
}

# web_files PREFIX UNIT-FOLDER: those of march-web, likewise.
web_files() {
    printf '%s\n' "$1/bin/march-web" "$1/lib/sysusers.d/marchd-web.conf" "$1/share/man/man5/march-web.conf.5" \
        "$1/share/man/man8/march-web.8" "$1/share/marchd/schema.json" "$2/march-web.service" /etc/marchd/march-web.conf
    below web/page "$1/share/marchd/page"
}

# installed_files PREFIX UNIT-FOLDER: prints the paths of all other installed files.
installed_files() {
    {
        cat <<END
$1/bin/march
$1/bin/march-launch
$1/bin/marchd
$1/lib/systemd/user/march-launch.service
$1/lib/systemd/user/march-launch.socket
$1/lib/systemd/user/marchd.service
$1/lib/systemd/user/marchd.socket
$1/lib/sysusers.d/marchd.conf
$1/lib/tmpfiles.d/marchd.conf
$1/share/bash-completion/completions/march
$1/share/bash-completion/completions/marchd
$1/share/doc/marchd/CHANGELOG.md
$1/share/doc/marchd/CONTRIBUTING.md
$1/share/doc/marchd/README.md
$1/share/doc/marchd/STYLE.md
$1/share/fish/vendor_completions.d/march.fish
$1/share/fish/vendor_completions.d/marchd.fish
$1/share/marchd/openrpc.json
$1/share/zsh/vendor-completions/_march
$2/march-launch.service
$2/march-launch.socket
$2/march-launch@.service
$2/march-launch@.socket
$2/marchd.service
$2/marchd.socket
$2/marchd@.service
$2/marchd@.socket
/etc/marchd/marchd.conf
/etc/marchd/ssh/config
END
        below docs "$1/share/doc/marchd/docs"
        below deploy/grafana "$1/share/marchd/grafana"
        below deploy/prometheus "$1/share/marchd/prometheus"
        below jobs "$1/share/marchd/jobs" | grep -Ev '/smoke/simulate$|/cumulus/grow$|/textures/draw_[a-z]*$'
        for page in "$PROJECT_ROOT"/deploy/man/*.[158]; do
            case "$page" in */march-worker.8 | */march-web.*) continue ;; esac
            [ ! -f "$page" ] || echo "$1/share/man/man${page##*.}/${page##*/}"
        done
    } | sort
}
