#!/bin/sh
# Checks that each vendored crate is the published one with the patches of nodes/vendor/patches/CRATE in order, and nothing else.
# With --update, writes what the patches leave as one more patch, whose message is to be filled in.
set -eu

update=${1-}
root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd)
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# check NAME VERSION COMMIT PARTS: the crate as downloaded and verified by cargo, with its patch, is the vendored one.
check() {
    name=$1 version=$2 commit=$3 parts=$4
    vendored=$root/nodes/vendor/$name
    patches=$root/nodes/vendor/patches/$name
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
    for patch in "$patches"/*.patch; do
        (cd "$here/a" && patch --quiet -p1 < "$patch")
    done
    find "$here/a" -name '*.orig' -delete
    rm -rf "$here/a/src/bin" "$here/a/src/ros2" "$here/a/src/ros2.rs"
    for part in "$vendored"/* "$vendored"/.[!.]*; do
        case ${part##*/} in
        Cargo.lock | target | '.[!.]*') ;; # not in version control
        *) [ -e "$here/a/${part##*/}" ] || { echo "not of the published crate: $part" >&2; exit 1; } ;;
        esac
    done

    if [ "$update" = --update ] && ! diff -rq "$here/a" "$here/b" > "$here/differing"; then
        number=$(ls "$patches" | tail -n 1 | cut -c1-4 | sed 's/^0*//')
        patch=$patches/$(printf '%04d' $((number + 1)))-new.patch
        {
            printf 'From: AUTHOR\nSubject: [PATCH] WHAT\n\nWHY\n\nTest: WHICH.\n\n'
            # Times would make every patch different.
            (cd "$here" && diff -ruN a b) | sed -E 's/^((---|\+\+\+) [^\t]+)\t.*/\1/; /^diff -ruN /d'
        } > "$patch" || true
        (cd "$here/a" && patch --quiet -p1 < "$patch")
        find "$here/a" -name '*.orig' -delete
        echo "$patch: fill in its message, and name it by that"
    fi

    diff -r "$here/a" "$here/b" || {
        echo "the vendored $name differs from the published one with $patches; see nodes/vendor/README.md" >&2
        exit 1
    }
    echo "$name $version with $(ls "$patches" | wc -l) patches of $patches"
}

check rustdds 0.15.1 cde6e4fd3a587a99e2a23db137eada7c13ca3d56 'Cargo.toml LICENSE.md README.md SECURITY.md rustfmt.toml src'
check ros2-client 0.12.1 0ee1267ede7f7db835f66466e11ee26cf1173507 'Cargo.toml README.md rustfmt.toml src'
