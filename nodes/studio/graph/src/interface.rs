//! The command `grainlab interface`: definitions of message and service types.

use crate::view::{OutputFormat, full_name, shown};
use grainlab_console::Failure;
use grainlab_node_kit::Exit;
use grainlab_recordings::{Definitions, MessagePath};

/// Levels of messages in each other, as a schema may have.
const DEEPEST: usize = 64;

/// Commands about interfaces.
#[derive(Debug, clap::Subcommand)]
pub enum Command {
    /// Print the definition of a type with its comments, and the definitions of its fields without.
    #[command(after_help = "Example:\n  grainlab interface show grainlab_msgs/msg/Stress")]
    Show {
        /// Name of the type, package/msg/Type
        #[arg(value_name = "TYPE")]
        type_name: String,
        /// Folders of message files.
        #[command(flatten)]
        messages: MessagePath,
        /// Format of the result
        #[arg(long, value_enum, default_value_t)]
        format: OutputFormat,
    },
}

/// Runs the command.
///
/// # Errors
/// A type that is not known.
pub fn run(command: &Command) -> Result<Exit, Failure> {
    let Command::Show { type_name, messages, format } = command;
    let known = messages.definitions()?;
    let type_name = &complete(&known, type_name)?;
    let text = nested(type_name, &text(&known, type_name)?);
    shown(*format, &text, || text.clone())
}

/// The full name of a type that may be given without its package.
fn complete(known: &Definitions, type_name: &str) -> Result<String, Failure> {
    let full = known.names().into_iter().filter(|full| full.rsplit('/').next() == Some(type_name));
    match &full.collect::<Vec<_>>()[..] {
        [] => Ok(type_name.to_owned()),
        [full] => Ok(full.clone()),
        all => Err(Failure::usage(format!("{type_name} is the name of several types: {}", all.join(", ")))),
    }
}

/// The text of a message with the sections of the types of its fields, or of a service.
fn text(known: &Definitions, type_name: &str) -> Result<String, Failure> {
    let service = known.service(type_name).map(str::to_owned);
    service.map_or_else(|| known.text(&full_name(type_name), "").map_err(Failure::failed), Ok)
}

/// The text of a type with those of its fields below them, each level by a tab further to the right.
struct Nested<'a> {
    /// Texts by names, as in `std_msgs/Header`.
    others: Vec<(&'a str, &'a str)>,
    shown: String,
}

/// The first section of `text` with those of its fields.
fn nested(type_name: &str, text: &str) -> String {
    let bar = format!("{}\n", "=".repeat(80));
    let mut sections = text.split(bar.as_str());
    let root = sections.next().unwrap_or_default();
    let others = sections.filter_map(|s| s.strip_prefix("MSG: ")?.split_once('\n')).collect();
    let mut nested = Nested { others, shown: String::new() };
    nested.add(type_name, root, 0);
    nested.shown
}

impl Nested<'_> {
    fn add(&mut self, type_name: &str, text: &str, level: usize) {
        let package = type_name.split('/').next().unwrap_or_default();
        let has_comments = level == 0;
        for line in text.trim_end().lines() {
            let bare = line.split('#').next().unwrap_or_default();
            let line = if has_comments { line } else { bare.trim_end() };
            if line.is_empty() && !has_comments {
                continue;
            }
            self.shown += &format!("{}{line}\n", "\t".repeat(level));
            let word = bare.split_whitespace().next().unwrap_or_default();
            let base = word.split(['[', '<']).next().unwrap_or_default().replace("/msg/", "/");
            let full = if base.contains('/') { base } else { format!("{package}/{base}") };
            let inner = self.others.iter().find(|(name, _)| *name == full).copied();
            if let Some((name, inner)) = inner.filter(|_| level < DEEPEST) {
                self.add(name, inner, level + 1);
            }
        }
    }
}
