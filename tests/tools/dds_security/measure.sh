#!/bin/sh
# Measures DDS Security of RustDDS as published: cost of a build, round trips, who receives from whom, CycloneDDS.
# usage, as root: measure.sh FOLDER [all|cost|trips|access|cyclone|fast]. Needs cargo, openssl with headers, unshare and ip; cyclone and fast need
# the Debian packages cyclonedds-dev, cyclonedds-tools and libfastrtps-dev. Everything runs in a network of loopback alone.
set -eu
here=$(CDPATH= cd -- "$(dirname -- "$0")" && pwd)
mkdir -p "$1"
work=$(CDPATH= cd -- "$1" && pwd)
part=${2-all}
bin=$work/security/release/dds_security
lax=$work/lax/release/dds_security
cyclone=$work/cyclone
fast=$work/fast

build() { # TARGET OPTIONS...
    target=$work/$1
    shift
    (cd "$here" && env time -f '%U s user, %S s system' cargo build --quiet --release --target-dir "$target" "$@" 2>&1 | tail -n 1)
}

cost() {
    for features in '' '--features security'; do
        target=$work/$([ -z "$features" ] && echo plain || echo security)
        rm -rf "$target"
        (cd "$here" && cargo fetch --quiet
        cargo tree -e normal --prefix none $features | sed 's/ (\*)//' | sort -u | wc -l)
        build "${target##*/}" $features
        touch "$here/main.rs"
        build "${target##*/}" $features
        stat -c '%s bytes' "$target/release/dds_security"
    done
}

trips() {
    "$bin" echo "$work/keys/alice" 0 1 2 3 4 5 & echo=$!
    "$bin" ping "$work/keys/bob" 1000 3000 0 1 2 3 4 5
    "$bin" ping "$work/keys/bob" 60000 1000 0 1 2 3 4 5
    "$bin" ping "$work/keys/bob" 100000 1000 0 1 2 3
    kill $echo
    # Samples of more than one datagram whose data are encrypted, between participants that have exchanged nothing yet.
    for domain in 4 5 4 5; do
        "$bin" echo "$work/keys/alice" $domain & echo=$!
        timeout 25 "$bin" ping "$work/keys/bob" 100000 100 $domain || echo "domain $domain, 100000 bytes: none in 25 s"
        kill $echo
    done
}

pair() { # DOMAIN PROGRAM PARTICIPANT PROGRAM PARTICIPANT
    (cd "$work/keys" && "$2" chat "$3" 1 8 "$1" > "$work/first" 2> "$work/first.log") & first=$!
    (cd "$work/keys" && "$4" chat "$5" 2 8 "$1" > "$work/second" 2> "$work/second.log") || true
    wait $first || true
    echo "domain $1: ${2#"$work/"} $3 $(tail -n 1 "$work/first" | cut -c -200), ${4#"$work/"} $5 $(tail -n 1 "$work/second" | cut -c -200)"
}

access() {
    pair 2 "$bin" alice "$bin" bob
    for domain in 1 2 3 4 5 6; do pair $domain "$bin" alice "$bin" -; done
    for other in stranger elsewhere reader late thief forger; do pair 2 "$bin" alice "$bin" $other; done
    # Insiders whose own library asks for no permissions.
    for domain in 1 2 3 4 5; do pair $domain "$bin" alice "$lax" elsewhere; done
    pair 2 "$bin" alice "$lax" late
}

cyclone() {
    export LD_LIBRARY_PATH=/usr/lib/x86_64-linux-gnu/libddsc0debian
    export CYCLONEDDS_URI='<Tracing><Verbosity>warning</Verbosity></Tracing>'
    pair 0 "$bin" - "$cyclone" -
    for domain in 1 2 3 4 5; do pair $domain "$bin" alice "$cyclone" bob; done
    for other in - stranger elsewhere; do pair 2 "$bin" alice "$cyclone" $other; done
    pair 5 "$cyclone" alice "$cyclone" bob
}

fast() {
    pair 0 "$bin" - "$fast" -
    for domain in 1 2 3 4 5; do pair $domain "$bin" alice "$fast" bob; done
    for other in - stranger elsewhere; do pair 2 "$bin" alice "$fast" $other; done
}

if [ "$part" = inside ]; then
    ip link set lo up
    ip link set lo multicast on
    ip route add 224.0.0.0/4 dev lo
    for part in $3; do $part; done
    exit
fi
case $part in all | cost) cost ;; esac
rm -rf "$work/keys"
sh "$here/keys.sh" "$work/keys"
build security --features security > /dev/null
case $part in all | access)
    published=$(cd "$here" && cargo metadata --format-version 1 | grep -o '"manifest_path":"[^"]*/rustdds-0.15.1/Cargo.toml"' | cut -d'"' -f4)
    rm -rf "$work/rustdds"
    cp -R "$(dirname "$published")" "$work/rustdds"
    sed -i 's/^    self.check_entity(/    return Ok(true);\n&/' "$work"/rustdds/src/security/access_control/access_control_builtin/local_entity_access_control.rs
    build lax --features security --config "patch.crates-io.rustdds.path='$work/rustdds'" > /dev/null ;;
esac
case $part in all | cyclone)
    (cd "$work" && idlc -l c "$here/sample.idl" && gcc -I. "$here/cyclone.c" sample.c -lddsc -o cyclone) ;;
esac
case $part in all | fast) g++ -O1 "$here/fast.cpp" -o "$fast" -lfastrtps -lfastcdr ;; esac
[ "$part" = all ] && part='trips access cyclone fast'
[ "$part" = cost ] || exec unshare -n sh "$0" "$work" inside "$part"
