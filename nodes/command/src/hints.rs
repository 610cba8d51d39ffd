//! Advice for words that this command line does not have: words of earlier versions, and words of `ros2`.

/// Words of earlier versions: the first words of a command, with a flag that may stand anywhere, and what to use instead.
/// `a|b` are alternatives, and `--flag=value` is that value of a flag that remains.
const REMOVED: &[(&str, &str)] = &[
    (
        "service call",
        "grainlab param list, get and set call the services of parameters; others: ros2 service call NAME TYPE REQUEST",
    ),
    (
        "service",
        "grainlab node info NODE lists the services of a node with their types; all else: ros2 service",
    ),
    (
        "topic bw",
        "grainlab topic hz TOPIC --format json has bandwidth, bytes per second; or ros2 topic bw TOPIC",
    ),
    (
        "topic delay",
        "grainlab topic hz TOPIC --format json has transport, the time from the publisher to here; the age of header stamps: ros2 topic delay TOPIC",
    ),
    ("topic type", "grainlab topic info TOPIC prints the type first; or ros2 topic type TOPIC"),
    ("topic find", "grainlab topic list --types | grep -w TYPE; or ros2 topic find TYPE"),
    ("topic list -v|--verbose|--show-types", "grainlab topic list --types"),
    ("topic list -c|--count|--count-topics|--count-services|--count-nodes", "grainlab topic list | wc -l"),
    (
        "topic list -a|--all|--include-hidden|--include-hidden-topics|--include-hidden-services",
        "ros2 topic list --include-hidden-topics",
    ),
    ("topic info -v|--verbose", "grainlab topic info TOPIC prints the endpoints in any case"),
    ("topic hz -w|--window", "grainlab topic hz TOPIC --duration S; or ros2 topic hz TOPIC --window N"),
    ("topic pub --max-wait-time-secs", "timeout S grainlab topic pub ..."),
    (
        "topic pub --keep-alive",
        "grainlab topic pub without --once and --times stays until Ctrl-C; or ros2 topic pub --keep-alive S",
    ),
    ("topic pub -p|--print", "grainlab topic pub ... | awk 'NR % N == 0' prints every Nth message"),
    (
        "topic echo|pub --qos-profile",
        "--qos-reliability, --qos-durability and --qos-depth; sensor_data is best_effort, volatile, 5",
    ),
    ("topic echo|pub --qos-history", "--qos-depth N; keep_all was 10000"),
    (
        "topic echo|pub --qos-reliability=system_default|--qos-durability=system_default",
        "reliable is that reliability, volatile that durability; topic pub has them by default",
    ),
    (
        "node list -t|-v|--types|--verbose|--show-types",
        "grainlab node list; what one node has: grainlab node info NODE",
    ),
    ("node list -c|--count|--count-topics|--count-services|--count-nodes", "grainlab node list | wc -l"),
    (
        "node list -a|--all|--include-hidden|--include-hidden-topics|--include-hidden-services",
        "ros2 node list --all",
    ),
    (
        "param describe",
        "grainlab run --help has type, default, range and meaning of each parameter; of a running node: ros2 param describe NODE NAME",
    ),
    (
        "param dump",
        "grainlab param list NODE, and grainlab param get NODE NAME; as a file: ros2 param dump NODE",
    ),
    (
        "param load",
        "grainlab param set NODE NAME VALUE for each value; a whole file: ros2 param load NODE FILE",
    ),
    (
        "interface topics",
        "grainlab topic list --types and topic info TOPIC, of a running laboratory; msgs/README.md has the table of topics",
    ),
    (
        "interface list|package|packages",
        "grainlab topic list --types has the types in use; all types: ros2 interface list, package PACKAGE and packages",
    ),
    (
        "interface show --no-comments",
        "grainlab interface show TYPE | sed 's/ *#.*//'; or ros2 interface show --no-comments TYPE",
    ),
    (
        "interface show --all-comments",
        "grainlab interface show of the type of the field prints its comments; or ros2 interface show --all-comments TYPE",
    ),
    (
        "bag export --format=vtkhdf",
        "use --format vtk, for ParaView, or --format csv, which loses nothing and is read back",
    ),
    ("--no-daemon", "leave it out: no daemon exists, each command looks at the domain itself"),
    (
        "bag add-schemas",
        "grainlab bag convert PATH --msg-path DIR --format mcap --output OUT; an empty DIR adds the definitions that this program has",
    ),
    ("bag compress", "grainlab bag convert PATH --compression zstd --format mcap --output OUT"),
    (
        "bag cut|convert --no-latched",
        "leave out the messages whose log time is the start and whose time of publishing is before it",
    ),
    ("bag cut", "grainlab bag convert PATH --start-offset S --duration S --format mcap --output OUT"),
    ("bag filter", "grainlab bag convert PATH --topics TOPIC --format mcap --output OUT"),
    ("bag merge", "grainlab bag convert PATH PATH --format mcap --output OUT"),
    (
        "bag convert --format=parquet",
        "--format csv, then pandas.read_csv(FILE).to_parquet(OUT); for columns of text, read_csv with dtype=str and keep_default_na=False",
    ),
    (
        "bag convert --explode",
        "--format json, then pandas.json_normalize(LINES, [\"data\", ARRAY]), or grainlab.open(PATH) in Python",
    ),
    (
        "bag record --snapshot|--trigger",
        "record all, then grainlab bag convert PATH --start-offset S --format mcap --output OUT, which adds the latched messages",
    ),
    ("bag convert --preset", "--compression none, lz4 or zstd"),
    ("bag convert --level", "--compression zstd, which has the level 1"),
    ("bag convert --chunk-size", "chunks of 1 MiB, as bag convert writes them"),
    (
        "bench",
        "in a checkout of the repository, cargo run --release -p grainlab_bench -- overview, or the other bench with its flags; --help lists all",
    ),
    (
        "verify",
        "in a checkout of the repository, cargo run --release -p grainlab_verify -- with the same flags",
    ),
];

/// Words of `ros2`, in the same form.
const ROS2: &[(&str, &str)] = &[
    (
        "topic echo --csv",
        "grainlab topic echo TOPIC --format json prints a line for each message; grainlab bag convert --format csv, of a recording",
    ),
    ("topic echo --filter", "grainlab topic echo TOPIC --format json | jq 'select(...)'"),
    ("topic echo --no-arr", "grainlab topic echo TOPIC -l 0"),
    ("param delete", "grainlab param set NODE NAME VALUE: the nodes declare their parameters, and keep them"),
    (
        "interface proto",
        "grainlab interface show TYPE: fields that topic pub is not given have their defaults",
    ),
    ("bag play --exclude-topics", "grainlab bag play PATH --exclude TOPIC"),
    ("bag convert -i", "grainlab bag convert PATH --format FORMAT --output OUT"),
    ("doctor --report", "grainlab doctor --format json"),
    ("launch --show-args", "grainlab launch --help, and the args of the launch file"),
    ("launch --print", "grainlab launch FILE: the processes and their logs are in the run directory"),
    ("wtf", "grainlab doctor"),
    ("action", "grainlab topic: no node here has actions"),
    ("lifecycle", "grainlab node state: no node here has managed states"),
    ("component", "grainlab launch --one-process runs the nodes of a scene in one process"),
    ("daemon", "there is no daemon: each command looks at the domain itself"),
    ("multicast", "grainlab doctor, which tests multicast"),
    ("pkg", "grainlab --help: every node is a sub-command of grainlab run"),
    (
        "security",
        "DDS Security is not part of this program: stay on this host, the default, or put a VPN between the hosts",
    ),
];

/// Returns the advice for a command line that was refused, from its words without the program. A flag that was refused within
/// a word, as `-v` of `-tv`, is a word of its own at the end.
pub(crate) fn hint(words: &[String]) -> Option<String> {
    let words: Vec<&String> = words.iter().filter(|word| *word != "help").collect();
    let has = |flag: &str| match flag.split_once('=') {
        Some((name, value)) => {
            words.iter().any(|w| *w == flag) || words.windows(2).any(|w| w[0] == name && w[1] == value)
        }
        None => words.iter().any(|w| w.split('=').next() == Some(flag)),
    };
    // The words of a key that are in the line, if all are.
    let typed = |key: &str| {
        let mut before = words.iter();
        let found = key.split(' ').map(|part| match part.starts_with('-') {
            true => part.split('|').find(|flag| has(flag)),
            false => before.next().and_then(|word| part.split('|').find(|p| p == *word)),
        });
        found.collect::<Option<Vec<_>>>().map(|found| found.join(" "))
    };
    let removed = |(key, advice): &(&str, &str)| Some(format!("{} was removed: {advice}", typed(key)?));
    let of_ros2 = |(key, advice): &(&str, &str)| Some(format!("instead of ros2 {}: {advice}", typed(key)?));
    REMOVED.iter().find_map(removed).or_else(|| ROS2.iter().find_map(of_ros2))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lines with the words of a key: with each of its alternatives, and with a value as a word of its own.
    fn lines(key: &str) -> Vec<String> {
        let with = |lines: Vec<String>, part: &str| -> Vec<String> {
            lines.iter().flat_map(|line| part.split('|').map(move |word| format!("{line} {word}"))).collect()
        };
        let lines = key.split(' ').fold(vec![String::new()], with);
        lines.iter().flat_map(|line| [line.clone(), line.replace('=', " ")]).collect()
    }

    #[test]
    fn every_word_of_a_key_gets_its_advice_wherever_it_stands_and_words_that_remain_get_none() {
        let hint = |line: &str| hint(&line.split_whitespace().map(str::to_owned).collect::<Vec<_>>());
        for (key, advice) in REMOVED.iter().chain(ROS2) {
            for line in lines(key) {
                let found = hint(&line).unwrap_or_else(|| panic!("{line}: no advice"));
                assert!(found.ends_with(&format!(": {advice}")), "{line}: {found}");
            }
        }
        for (line, start) in [
            ("service find", "service was removed: "),
            ("topic list -a", "topic list -a was removed: "),
            ("topic info /x -v", "topic info -v was removed: "),
            ("topic hz /x --window=100", "topic hz --window was removed: "),
            ("bag export run --format vtkhdf --out x", "bag export --format=vtkhdf was removed: "),
            ("bag cut x --start 1 --no-latched", "bag cut --no-latched was removed: "),
            ("help bag merge", "bag merge was removed: "),
            ("bag help cut", "bag cut was removed: "),
            ("bench overview", "bench was removed: "),
            ("doctor --no-daemon", "--no-daemon was removed: "),
            ("action list", "instead of ros2 action: "),
        ] {
            let found = hint(line).unwrap_or_else(|| panic!("{line}: no advice"));
            assert!(found.starts_with(start), "{line}: {found}");
        }
        for line in
            ["topic list -t", "topic echo /x --qos-reliability reliable", "param get /x y", "bag info x"]
        {
            assert_eq!(hint(line), None);
        }
    }
}
