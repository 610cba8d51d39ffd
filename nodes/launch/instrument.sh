#!/bin/sh
# An instrument that is not ours, in front of our inversion: nodes/launch/instrument.py sends wave speeds by CycloneDDS and
# prints the microstructure that comes back.
#
#   nodes/launch/instrument.sh [--json]
#
# GRAINLAB names the binary (default: grainlab on the PATH), PYTHON a Python with cyclonedds (default: python3),
# ROS_DOMAIN_ID the domain (default: 77, apart from other runs on this host). Ends with the exit code of the instrument.
set -eu
export ROS_DOMAIN_ID="${ROS_DOMAIN_ID:-77}"
setsid "${GRAINLAB:-grainlab}" run emt_inversion &
inversion=$!
# In a session of its own, Ctrl-C does not reach the node: it is ended here, whatever happens.
trap 'kill -INT $inversion 2>/dev/null || true; wait $inversion 2>/dev/null || true' EXIT
trap 'exit 130' INT TERM
"${PYTHON:-python3}" "$(dirname "$0")/instrument.py" "$@"
