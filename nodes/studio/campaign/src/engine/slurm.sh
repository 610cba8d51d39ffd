# Client of Slurm: slurm.sh limit | queued JOBS NAME | wait JOBS NAME | submit JOBS NAME OPTION... SCRIPT
# The file JOBS has the numbers of the jobs of a campaign, as sbatch prints them: NUMBER or NUMBER;CLUSTER.
action=$0 jobs=${1-} name=${2-}
# Settings of the user that would hide a job, or wait before its number is written.
unset SQUEUE_STATES SQUEUE_PARTITION SQUEUE_USERS SQUEUE_ACCOUNT SBATCH_WAIT

# Those jobs of the file that are queued or running; by the name of the job, as a number that Slurm has forgotten is an error.
queued() {
    [ -s "$jobs" ] || return 0
    cluster=$(sed -n 's/.*;//p' "$jobs" | tail -n 1)
    all=$(squeue --noheader --format=%F --name="$name" ${cluster:+"--clusters=$cluster"}) || return 1
    sed 's/;.*//' "$jobs" | sort -u | while read -r job; do
        if echo "$all" | grep -qx " *$job *"; then echo "$job"; fi
    done
}

case $action in
limit)
    # The numbers of tasks are below MaxArraySize.
    size=$(scontrol show config 2> /dev/null | sed -n 's/^MaxArraySize *= *//p')
    echo $((${size:-1001} - 1))
    exit
    ;;
queued)
    queued
    exit
    ;;
submit)
    # Ctrl-C in a terminal does not come between a submission and its number, which sbatch itself writes.
    trap '' INT
    shift 2
    # None of the jobs before is queued, or another one is wanted. Options of the command line precede SBATCH_*.
    sbatch --parsable "$@" >> "$jobs" || exit 1
    ;;
esac
# A controller that does not answer is asked again. The wait ends with the campaign.
pause=1
while kill -0 "$PPID" 2> /dev/null; do
    if all=$(queued) && [ -z "$all" ]; then
        echo "job $(tail -n 1 "$jobs") ended: see logs/slurm-*.log and sacct"
        rm -f "$jobs"
        exit 0
    fi
    sleep $pause
    [ $pause -ge 15 ] || pause=$((pause + 1))
done
