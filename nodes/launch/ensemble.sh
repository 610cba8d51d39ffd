#!/bin/sh
# Prepares packings of one kind, measures them, and prints one line of CSV for each, for `grainlab calibrate` and
# `grainlab invert --table FILE --judge`.
#
#   nodes/launch/ensemble.sh SCENE "MU2 ..." FIRST_SEED LAST_SEED [RUNS] > measurements.csv
#
# SCENE is a scene whose friction takes each MU2 in turn, such as those in nodes/scenes/ensemble.
# GRAINLAB names the binary (default: grainlab on the PATH). Runs are written to RUNS (default: recordings/runs). A run that
# exists there, by the name of scene, mu2 and seed, is measured and not repeated, so that an interrupted ensemble can be
# continued: use another folder after editing a scene.
set -eu
grainlab=${GRAINLAB:-grainlab}
[ $# -ge 4 ] || { sed -n '5p' "$0" | cut -c 5- >&2; exit 2; }
scene=$1 frictions=$2 first=$3 last=$4 runs=${5:-recordings/runs}
fail() { echo "ensemble.sh: $1" >&2; exit 2; }
for seed in "$first" "$last"; do
    case $seed in '' | *[!0-9]*) fail "a seed is a whole number, not \"$seed\"" ;; esac
done
[ "$first" -le "$last" ] || fail "there is no seed from $first to $last"
"$grainlab" scene show "$scene" --set friction=0.1 > /dev/null || fail "mu2 is the friction of the scene"
preparation=$(basename "$scene" .toml)
columns=grains,phi,pressure_pa,k,z,eps,eps_stiffness,g_total,g_elastic,g_contact
columns=$columns,g12_pa,g13_pa,theta_pa,ti_c11_pa,ti_c33_pa,ti_c13_pa,grain_shear_modulus_pa,poisson

# The first successful run of this name, or nothing. An interrupted run also writes a summary, but its last packing is not
# at rest.
finished() {
    for summary in "$runs/$1"-*/summary.json; do
        if [ -f "$summary" ] && grep -q '^  "exit": 0,$' "$summary"; then
            dirname "$summary"
            return
        fi
    done
}

row=$(mktemp)
trap 'rm -f "$row"' EXIT
header=preparation,mu2,seed,$columns
for mu2 in $frictions; do
    # A name must not contain a point: 0.05 becomes 005.
    name=${preparation}_$(printf %s "$mu2" | tr -d .)
    seed=$first
    while [ "$seed" -le "$last" ]; do
        run=$(finished "$name-$seed")
        if [ -z "$run" ]; then
            "$grainlab" launch --scene "$scene" --set "name=$name" --set "friction=$mu2" --seed "$seed" --out "$runs" > /dev/null
            run=$(finished "$name-$seed")
            [ -n "$run" ] || fail "no run $name-$seed came to its end in $runs"
        fi
        "$grainlab" analyze "$run" --format csv --columns "$columns" > "$row"
        [ -z "$header" ] || { echo "$header"; header=; }
        sed "1d; s/^/$preparation,$mu2,$seed,/" "$row"
        seed=$((seed + 1))
    done
done
