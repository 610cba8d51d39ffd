#!/bin/sh
# Nodes of `grainlab launch` as plain processes, for scripts.
#
#   nodes/launch/by_hand.sh [SCENE] [SEED] [DIRECTORY]
#
# GRAINLAB names the binary (default: grainlab on the PATH), ROS_DOMAIN_ID the domain (default: 0). Ends when the
# loading path is done and the last packing is inverted; Ctrl-C ends it earlier. Exits with the recorder's code.
set -eu
grainlab=${GRAINLAB:-grainlab}
scene=${1:-demo}
seed=${2:--1}
directory=${3:-}

# One run: its processes ignore all others in the domain, and the recorder leaves those out.
export GRAINLAB_RUN="${GRAINLAB_RUN:-by_hand_$$}" GRAINLAB_RUN_ROOT=$$

GRAINLAB_MEMBER=1 setsid "$grainlab" run recorder --ros-args -p scene:="$scene" -p seed:="$seed" ${directory:+-p output:="$directory"} &
recorder=$!
GRAINLAB_MEMBER=2 setsid "$grainlab" run emt_inversion &
others=$!
GRAINLAB_MEMBER=3 setsid "$grainlab" run fabric_analyzer &
others="$others $!"
GRAINLAB_MEMBER=4 setsid "$grainlab" run servo_controller --ros-args -p min_readers:=2 &
others="$others $!"
GRAINLAB_MEMBER=5 setsid "$grainlab" run dem_simulator --ros-args -p scene:="$scene" -p seed:="$seed" \
    -p wait_for:=[stress,packing,clock] -p min_readers:=2 -p finish:=inverted &
simulator=$!

# Each node has its own session: Ctrl-C reaches only this script, which ends the nodes in order.
trap 'kill -TERM $simulator 2>/dev/null || true' INT TERM
code=0
wait "$simulator" || code=$?
kill -TERM $others 2>/dev/null || true
for process in $others; do wait "$process" || true; done
kill -TERM "$recorder" 2>/dev/null || true
wait "$recorder" || { recorded=$?; [ "$code" -ne 0 ] || code=$recorded; }
exit "$code"
