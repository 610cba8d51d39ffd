# The members of a task run one after another, also if one fails: the exit code is that of the last one that failed.
# A finished run is left as it is, an interrupted one is continued.
unset ROS_DOMAIN_ID
mkdir -p "$logs"
code=0
# A task that is cancelled begins no further member.
trap 'exit 143' INT TERM
run() {
    log=$logs/$1.log
    shift
    "$@" >> "$log" 2>&1 || code=$?
}
