//! Words of the `ros2` command line that are not known here, with the form that is.

/// The first words of a command with a flag that may stand anywhere, and the advice.
const HINTS: &[(&str, &str)] = &[
    (
        "topic echo --csv",
        "grainlab topic echo TOPIC --format json prints a line for each message; grainlab bag convert --format csv, of a recording",
    ),
    ("topic echo --filter", "grainlab topic echo TOPIC --format json | jq 'select(...)'"),
    ("topic echo --flow-style", "grainlab topic echo TOPIC --format json"),
    ("topic echo --no-arr", "grainlab topic echo TOPIC -l 0"),
    ("topic echo --no-str", "grainlab topic echo TOPIC --field PATH"),
    ("topic echo --raw", "grainlab bag record TOPIC, then grainlab bag cat"),
    ("topic hz --filter", "grainlab topic echo TOPIC --format json | jq"),
    ("topic hz --wall-time", "grainlab topic hz TOPIC: the time of the publishers, which is wall time"),
    ("service echo", "grainlab service call NAME: requests and answers of others are not shown"),
    ("service call -r", "while grainlab service call NAME; do sleep 1; done"),
    ("param delete", "grainlab param set NODE NAME VALUE: the nodes declare their parameters, and keep them"),
    ("param dump --output-dir", "grainlab param dump NODE > FILE"),
    ("param list --param-type", "grainlab param describe NODE"),
    ("param list --filter", "grainlab param list NODE | grep"),
    (
        "interface proto",
        "grainlab interface show TYPE: fields that topic pub is not given have their defaults",
    ),
    ("bag list", "grainlab bag --help: mcap is the only storage"),
    ("bag burst", "grainlab bag play PATH --step"),
    ("bag play --delay", "sleep S; grainlab bag play PATH"),
    ("bag play --exclude-topics", "grainlab bag play PATH --exclude TOPIC"),
    ("bag record --compression-mode", "grainlab bag record --compression zstd, which is the default"),
    ("bag record --compression-format", "grainlab bag record --compression zstd"),
    ("bag record --max-cache-size", "grainlab bag record: every message is written as it comes"),
    ("bag convert -i", "grainlab bag convert PATH --format FORMAT --output OUT"),
    ("doctor --report", "grainlab doctor --format json"),
    ("launch --show-args", "grainlab launch --help, and the args of the launch file"),
    ("launch --print", "grainlab launch FILE: the processes and their logs are in the run directory"),
    ("wtf", "grainlab doctor"),
    ("action", "grainlab service, topic: no node here has actions"),
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

/// The form of a command of `ros2` that is not known here, from its words without `ros2`.
pub(crate) fn hint(words: &[String]) -> Option<&'static str> {
    let is_it = |key: &&(&str, &str)| {
        let mut before = words.iter();
        key.0.split(' ').all(|part| match part.starts_with('-') {
            true => words.iter().any(|w| w.split('=').next() == Some(part)),
            false => before.next().is_some_and(|w| w == part),
        })
    };
    HINTS.iter().find(is_it).map(|(_, advice)| *advice)
}
