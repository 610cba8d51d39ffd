#!/bin/sh
# Runs a command beside a Slurm cluster of this host alone, which ends with it: slurm_node.sh FOLDER COMMAND...
# Exit code 77 if Slurm (Debian: slurm-wlm) is not installed or does not start here.
set -eu
folder=$1
shift
for program in munged slurmctld slurmd sbatch sinfo; do
    command -v "$program" > /dev/null || { echo "no $program: install slurm-wlm" >&2; exit 77; }
done
[ "$(id -u)" = 0 ] || { echo "slurmd needs root" >&2; exit 77; }
mkdir -p "$folder/state" "$folder/spool"
chmod 755 "$folder"
host=$(hostname -s)
# Ports of this process alone, so that two tests can run at a time.
port=$((20000 + $$ % 10000))
cat > "$folder/slurm.conf" << END
ClusterName=grainlab
SlurmctldHost=$host(127.0.0.1)
SlurmctldPort=$port
SlurmdPort=$((port + 1))
AuthType=auth/munge
AuthInfo=socket=$folder/munge.socket
SlurmUser=root
SlurmdUser=root
StateSaveLocation=$folder/state
SlurmdSpoolDir=$folder/spool
SlurmctldPidFile=$folder/slurmctld.pid
SlurmdPidFile=$folder/slurmd.pid
ProctrackType=proctrack/linuxproc
TaskPlugin=task/none
SelectType=select/cons_tres
SelectTypeParameters=CR_CPU
MpiDefault=none
NodeName=$host NodeAddr=127.0.0.1 CPUs=$(nproc) State=UNKNOWN
PartitionName=main Nodes=ALL Default=YES MaxTime=INFINITE State=UP
END
export SLURM_CONF="$folder/slurm.conf"
head -c 1024 /dev/urandom > "$folder/munge.key"
chmod 400 "$folder/munge.key"
munged --foreground --force --key-file="$folder/munge.key" --socket="$folder/munge.socket" --pid-file="$folder/munge.pid" \
    --log-file="$folder/munged.log" --seed-file="$folder/munge.seed" &
munged=$!
slurmctld -D > "$folder/slurmctld.log" 2>&1 &
controller=$!
slurmd -D > "$folder/slurmd.log" 2>&1 &
node=$!
trap 'kill $node $controller $munged 2> /dev/null; wait' EXIT
n=0
until sinfo --noheader --format %t 2> /dev/null | grep -q idle; do
    n=$((n + 1))
    [ $n -lt 60 ] || { echo "Slurm does not start here: $(tail -n 1 "$folder/slurmctld.log")" >&2; exit 77; }
    sleep 0.5
done
"$@"
