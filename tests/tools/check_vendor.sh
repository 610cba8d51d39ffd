#!/bin/sh
# Checks that each vendored crate is the published one with the changes of nodes/vendor/CRATE.patch, and nothing else.
# With --update, writes those patches anew from the vendored trees.
set -eu

update=${1-}
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# check NAME VERSION COMMIT PARTS: the crate as downloaded and verified by cargo, with its patch, is the vendored one.
check() {
    name=$1 version=$2 commit=$3 parts=$4
    vendored=$root/nodes/vendor/$name
    patch=$root/nodes/vendor/$name.patch
    here=$work/$name

    # A separate manifest, so that the [patch] of the workspace does not apply.
    mkdir -p "$here/scratch/src"
    cat > "$here/scratch/Cargo.toml" <<MANIFEST
[package]
name = "scratch"
version = "0.0.0"
edition = "2021"
[dependencies]
$name = "=$version"
MANIFEST
    : > "$here/scratch/src/lib.rs"
    (cd "$here/scratch" && cargo fetch --quiet)
    manifest=$(cd "$here/scratch" && cargo metadata --format-version 1 --offline |
        grep -o '"manifest_path":"[^"]*/'"$name-$version"'/Cargo.toml"' | head -n 1 | cut -d'"' -f4)
    published=$(dirname "$manifest")
    grep -q "\"$commit\"" "$published/.cargo_vcs_info.json" || {
        echo "$name $version is not of commit $commit" >&2
        exit 1
    }

    # The vendored part: the library, not its programs, examples, tests and tools.
    mkdir "$here/a" "$here/b"
    for part in $parts; do
        cp -R "$published/$part" "$here/a/$part"
        cp -R "$vendored/$part" "$here/b/$part"
    done
    rm -rf "$here/a/src/bin" "$here/a/src/ros2" "$here/a/src/ros2.rs"
    for part in "$vendored"/* "$vendored"/.[!.]*; do
        case ${part##*/} in
        Cargo.lock | target | '.[!.]*') ;; # not in version control
        *) [ -e "$here/a/${part##*/}" ] || { echo "not of the published crate: $part" >&2; exit 1; } ;;
        esac
    done

    if [ "$update" = --update ]; then
        # Times would make every patch different.
        (cd "$here" && diff -ruN a b) | sed -E 's/^((---|\+\+\+) [^\t]+)\t.*/\1/; /^diff -ruN /d' > "$patch" || true
        echo "$patch: $(grep -c '^+[^+]' "$patch") lines added, $(grep -c '^-[^-]' "$patch") removed"
    fi

    (cd "$here/a" && patch --quiet -p1 < "$patch")
    find "$here/a" -name '*.orig' -delete
    diff -r "$here/a" "$here/b" || {
        echo "the vendored $name differs from the published one with $patch; see nodes/vendor/README.md" >&2
        exit 1
    }
    echo "$name $version with $(grep -c '^+++ ' "$patch") changed files, as kept in $patch"
}

check rustdds 0.15.1 cde6e4fd3a587a99e2a23db137eada7c13ca3d56 'Cargo.toml LICENSE.md README.md SECURITY.md rustfmt.toml src'
check ros2-client 0.12.1 0ee1267ede7f7db835f66466e11ee26cf1173507 'Cargo.toml README.md rustfmt.toml src'
