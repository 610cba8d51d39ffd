#!/bin/sh
# A third-party instrument with the inversion node: nodes/launch/instrument.py sends wave speeds by CycloneDDS and prints
# the microstructure that it receives.
#
#   nodes/launch/instrument.sh [--json]
#   nodes/launch/instrument.sh FOLDER --grain-shear-modulus PA --poisson NU [--once]    # record_instrument.py
#
# GRAINLAB names the binary (default: grainlab on the PATH), PYTHON a Python with cyclonedds (default: python3),
# ROS_DOMAIN_ID the domain (default: 77, apart from other runs on this host). Ends with the exit code of the instrument.
set -eu
export ROS_DOMAIN_ID="${ROS_DOMAIN_ID:-77}"
setsid "${GRAINLAB:-grainlab}" run emt_inversion &
inversion=$!
# The node has its own session, which Ctrl-C does not reach: it is ended here in any case.
trap 'kill -INT $inversion 2>/dev/null || true; wait $inversion 2>/dev/null || true' EXIT
trap 'exit 130' INT TERM
program=instrument.py
[ ! -d "${1:-}" ] || program=record_instrument.py
"${PYTHON:-python3}" "$(dirname "$0")/$program" "$@"
