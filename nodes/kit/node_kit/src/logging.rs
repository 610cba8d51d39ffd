//! Log lines: to stderr in the format of ROS 2, and to `/rosout`.

use crate::args::RosArgs;
use crate::dds::{LOG_TARGET, wall_nanos};
use grainlab_console::{colour_wanted, escape_controls, write_above_live_line};
use grainlab_msgs::rcl_interfaces::Log;
use grainlab_msgs::wall_stamp;
use log::{Level, LevelFilter, Metadata, Record};
use std::cell::Cell;
use std::collections::VecDeque;
use std::fs::File;
use std::io::{IsTerminal, Write};
use std::sync::{Mutex, OnceLock, PoisonError};

/// Maximum number of lines queued for `/rosout`; a full queue drops the oldest.
const BACKLOG: usize = 1000;

/// Libraries whose errors alone are logged, because their warnings concern single packets.
const LIBRARIES: [&str; 3] = [LOG_TARGET, "ros2_client", "mio"];

/// The logger of the process, of every thread that entered no other one.
static OF_PROCESS: Logger = Logger {
    settings: Mutex::new(LogSettings {
        name: String::new(),
        level: LevelFilter::Off,
        logger_levels: Vec::new(),
        to: Destination::None,
        rosout: false,
        queue: VecDeque::new(),
        dropped: 0,
    }),
};

thread_local! {
    /// True while this thread publishes the lines: those about publishing would follow each other without end.
    static PUBLISHES: Cell<bool> = const { Cell::new(false) };
    /// The logger of the node that this thread works for.
    static CURRENT: Cell<&'static Logger> = const { Cell::new(&OF_PROCESS) };
}

/// Destination of the lines, besides `/rosout`.
enum Destination {
    None,
    Stderr { colour: bool },
    File(File),
}

/// The settings that can change after the logger is installed.
struct LogSettings {
    name: String,
    level: LevelFilter,
    logger_levels: Vec<(String, LevelFilter)>,
    to: Destination,
    rosout: bool,
    queue: VecDeque<Log>,
    /// Number of lines that the full queue dropped since it was last taken.
    dropped: usize,
}

/// The logger of this process, or of one of several nodes in it.
pub struct Logger {
    settings: Mutex<LogSettings>,
}

impl Logger {
    /// Installs the logger, or changes the name and levels of the installed one. `node` is the fully qualified
    /// node name. A logger of other code that was installed before keeps stderr.
    pub fn install(node: &str, args: &RosArgs) -> &'static Logger {
        let colour = colour_wanted(|name| std::env::var(name).ok(), std::io::stderr().is_terminal());
        let settings = LogSettings::of(node, args, Destination::Stderr { colour });
        log::set_max_level(settings.most());
        *OF_PROCESS.lock() = settings;
        if !is_set() {
            OF_PROCESS.lock().to = Destination::None;
        }
        &OF_PROCESS
    }

    /// The logger of one of several nodes in this process, into `file`.
    pub fn of_node(node: &str, args: &RosArgs, file: File) -> &'static Logger {
        is_set();
        let settings = LogSettings::of(node, args, Destination::File(file));
        log::set_max_level(log::max_level().max(settings.most()));
        Box::leak(Box::new(Logger { settings: Mutex::new(settings) }))
    }

    /// Sends the lines of this thread to this logger from now on.
    pub(crate) fn enter(&'static self) {
        CURRENT.set(self);
    }

    pub(crate) fn of_thread() -> &'static Logger {
        CURRENT.get()
    }

    fn lock(&self) -> std::sync::MutexGuard<'_, LogSettings> {
        self.settings.lock().unwrap_or_else(PoisonError::into_inner)
    }

    /// Takes the queued lines for `/rosout`, in the order of their stamps.
    /// The first one states the number of older lines that the full queue dropped, if any.
    pub fn drain(&self) -> Vec<Log> {
        let mut settings = self.lock();
        let mut lines: Vec<Log> = settings.queue.drain(..).collect();
        let dropped = std::mem::take(&mut settings.dropped);
        if let (1.., Some(first)) = (dropped, lines.first()) {
            let msg = format!("{dropped} lines before this one are on stderr alone");
            lines.insert(0, Log { msg, level: Log::WARN, ..first.clone() });
        }
        lines
    }

    /// Hands the queued lines for `/rosout` to `each`, in the order of their stamps. Lines that this thread logs meanwhile
    /// are not queued.
    pub(crate) fn publish<E>(&self, each: impl FnMut(&Log) -> Result<(), E>) -> Result<(), E> {
        PUBLISHES.set(true);
        let published = self.drain().iter().try_for_each(each);
        PUBLISHES.set(false);
        published
    }

    /// Queues no more lines for `/rosout`: the final counts are to be reported.
    pub fn close(&self) {
        self.lock().rosout = false;
    }
}

/// Hands each line to the logger of its thread.
struct Router;

/// Installs the router, once for the process; false if other code has installed its own before.
fn is_set() -> bool {
    static SET: OnceLock<bool> = OnceLock::new();
    *SET.get_or_init(|| log::set_logger(&Router).is_ok())
}

impl LogSettings {
    fn of(node: &str, args: &RosArgs, to: Destination) -> Self {
        Self {
            // ROS 2 writes namespaces with dots in logger names.
            name: node.trim_start_matches('/').replace('/', "."),
            level: args.log_level,
            logger_levels: args.logger_levels.clone(),
            to: if args.stderr { to } else { Destination::None },
            rosout: args.rosout,
            queue: VecDeque::new(),
            dropped: 0,
        }
    }

    /// The level of the most talkative module.
    fn most(&self) -> LevelFilter {
        self.logger_levels.iter().map(|(_, level)| *level).fold(self.level, Ord::max)
    }

    fn level_of(&self, target: &str) -> LevelFilter {
        let named = |logger: &str| {
            target.strip_prefix(logger).is_some_and(|rest| rest.is_empty() || rest.starts_with("::"))
        };
        match self.logger_levels.iter().rfind(|(logger, _)| named(logger)) {
            Some((_, level)) => *level,
            None if LIBRARIES.iter().any(|library| named(library)) => self.level.min(LevelFilter::Error),
            None => self.level,
        }
    }
}

/// Name on stderr, number in messages, colour as in rcutils.
fn severity(level: Level) -> (&'static str, u8, &'static str) {
    match level {
        Level::Error => ("ERROR", Log::ERROR, "\x1b[31m"),
        Level::Warn => ("WARN", Log::WARN, "\x1b[33m"),
        Level::Info => ("INFO", Log::INFO, ""),
        Level::Debug => ("DEBUG", Log::DEBUG, "\x1b[32m"),
        Level::Trace => ("TRACE", Log::DEBUG, "\x1b[32m"),
    }
}

impl log::Log for Router {
    fn enabled(&self, metadata: &Metadata) -> bool {
        metadata.level() <= CURRENT.get().lock().level_of(metadata.target())
    }

    fn log(&self, record: &Record) {
        if !self.enabled(record.metadata()) {
            return;
        }
        let text = record.args().to_string();
        let (name, number, paint) = severity(record.level());
        let mut settings = CURRENT.get().lock();
        // Stamped under the lock, so that the lines of all threads are queued in the order of their stamps.
        let stamp = wall_stamp(wall_nanos());
        let line = || {
            let text = escape_controls(&text);
            format!("[{name}] [{}.{:09}] [{}]: {text}", stamp.sec, stamp.nanosec, settings.name)
        };
        match &settings.to {
            Destination::None => {}
            Destination::Stderr { colour: true } if !paint.is_empty() => {
                write_above_live_line(&format!("{paint}{}\x1b[0m\n", line()));
            }
            Destination::Stderr { .. } => write_above_live_line(&(line() + "\n")),
            // A full disk ends the recording, which says so; the log cannot.
            Destination::File(file) => _ = (&*file).write_all((line() + "\n").as_bytes()),
        }
        if settings.rosout && !PUBLISHES.get() {
            if settings.queue.len() >= BACKLOG {
                settings.queue.pop_front();
                settings.dropped += 1;
            }
            let entry = Log {
                stamp,
                level: number,
                name: settings.name.clone(),
                msg: text,
                file: record.file().unwrap_or_default().into(),
                function: record.module_path().unwrap_or_default().into(),
                line: record.line().unwrap_or_default(),
            };
            settings.queue.push_back(entry);
        }
    }

    fn flush(&self) {}
}

#[cfg(test)]
mod tests {
    use super::*;

    fn settings(level: LevelFilter, logger_levels: &[(&str, LevelFilter)]) -> LogSettings {
        LogSettings {
            name: "n".into(),
            level,
            logger_levels: logger_levels.iter().map(|(n, l)| ((*n).into(), *l)).collect(),
            to: Destination::None,
            rosout: true,
            queue: VecDeque::new(),
            dropped: 0,
        }
    }

    #[test]
    fn libraries_log_only_errors_by_default() {
        let quiet = settings(LevelFilter::Debug, &[]);
        assert_eq!(quiet.level_of("grainlab_dem_simulator::run"), LevelFilter::Debug);
        assert_eq!(quiet.level_of("ros2_client::node"), LevelFilter::Error);
        assert_eq!(quiet.level_of("ros2_client_like"), LevelFilter::Debug);
        let asked = settings(LevelFilter::Info, &[("ros2_client", LevelFilter::Trace)]);
        assert_eq!(asked.level_of("ros2_client::node"), LevelFilter::Trace);
        assert_eq!(asked.level_of("mio"), LevelFilter::Error);
    }

    #[test]
    fn a_line_that_quotes_an_escape_sequence_shows_it_and_the_other_lines_follow_each_other() {
        let folder = tempfile::tempdir().unwrap();
        let path = folder.path().join("n.log");
        let logger = Logger::of_node("/n", &RosArgs::default(), File::create(&path).unwrap());
        // A thread of its own, because a thread keeps its logger.
        let logs = move || {
            logger.enter();
            log::error!("a stranger \x1b[31m is here");
        };
        std::thread::spawn(logs).join().unwrap();
        let text = std::fs::read_to_string(&path).unwrap();
        assert!(text.contains(r"a stranger \u{1b}[31m is here") && text.ends_with('\n'), "{text:?}");
    }
}
