#!/bin/sh
# Checks that the vendored RustDDS is the published crate with the changes of nodes/vendor/rustdds.patch, and nothing else.
# With --update, writes that patch anew from the vendored tree.
set -eu

version=0.15.1
commit=cde6e4fd3a587a99e2a23db137eada7c13ca3d56

root=$(CDPATH= cd -- "$(dirname -- "$0")/../.." && pwd)
vendored=$root/nodes/vendor/rustdds
patch=$root/nodes/vendor/rustdds.patch
work=$(mktemp -d)
trap 'rm -rf "$work"' EXIT

# The crate as downloaded and verified by cargo: a separate manifest, so that the [patch] of the workspace does not apply.
mkdir -p "$work/scratch/src"
cat > "$work/scratch/Cargo.toml" <<MANIFEST
[package]
name = "scratch"
version = "0.0.0"
edition = "2021"
[dependencies]
rustdds = "=$version"
MANIFEST
: > "$work/scratch/src/lib.rs"
(cd "$work/scratch" && cargo fetch --quiet)
manifest=$(cd "$work/scratch" && cargo metadata --format-version 1 --offline |
    grep -o '"manifest_path":"[^"]*/rustdds-'"$version"'/Cargo.toml"' | head -n 1 | cut -d'"' -f4)
published=$(dirname "$manifest")
grep -q "\"$commit\"" "$published/.cargo_vcs_info.json" || {
    echo "rustdds $version is not of commit $commit" >&2
    exit 1
}

# The vendored part: the library, not its examples, tests and tools.
mkdir "$work/a" "$work/b"
for part in Cargo.toml LICENSE.md README.md SECURITY.md rustfmt.toml src; do
    cp -R "$published/$part" "$work/a/$part"
    cp -R "$vendored/$part" "$work/b/$part"
done
for part in "$vendored"/* "$vendored"/.[!.]*; do
    case ${part##*/} in
    Cargo.lock | target | '.[!.]*') ;; # not in version control
    *) [ -e "$work/a/${part##*/}" ] || { echo "not of the published crate: $part" >&2; exit 1; } ;;
    esac
done

if [ "${1-}" = --update ]; then
    # Times would make every patch different.
    (cd "$work" && diff -ruN a b) | sed -E 's/^((---|\+\+\+) [^\t]+)\t.*/\1/; /^diff -ruN /d' > "$patch" || true
    echo "$patch: $(grep -c '^+[^+]' "$patch") lines added, $(grep -c '^-[^-]' "$patch") removed"
fi

(cd "$work/a" && patch --quiet -p1 < "$patch")
find "$work/a" -name '*.orig' -delete
diff -r "$work/a" "$work/b" || {
    echo "the vendored RustDDS differs from the published one with $patch; see nodes/vendor/README.md" >&2
    exit 1
}
echo "RustDDS $version with $(grep -c '^+++ ' "$patch") changed files, as kept in $patch"
