//! The command `grainlab interface`: definitions of message and service types.

use crate::view::{OutputFormat, full_name, shown};
use grainlab_console::{Failure, Table};
use grainlab_msgs::Topic;
use grainlab_node_kit::Exit;
use grainlab_recordings::{Definitions, MessagePath};
use serde::Serialize;
use std::collections::BTreeSet;

/// Levels of messages in each other, as a schema may have.
const DEEPEST: usize = 64;

/// Commands about interfaces.
#[derive(Debug, clap::Subcommand)]
pub enum Command {
    /// Print the definition of a type, with those of its fields.
    #[command(after_help = "Example:\n  grainlab interface show grainlab_msgs/msg/Stress")]
    Show {
        /// Name of the type, package/msg/Type
        #[arg(value_name = "TYPE")]
        type_name: String,
        /// Leave out all comments; those of nested types are left out anyway
        #[arg(long)]
        no_comments: bool,
        /// Print the comments of nested types, too
        #[arg(long)]
        all_comments: bool,
        /// Folders of message files.
        #[command(flatten)]
        common: Folders,
    },
    /// List the types that are known.
    #[command(after_help = "Example:\n  grainlab interface list --only-msgs")]
    List {
        /// List messages only
        #[arg(short = 'm', long)]
        only_msgs: bool,
        /// List services only
        #[arg(short = 's', long, conflicts_with = "only_msgs")]
        only_srvs: bool,
        /// Folders of message files.
        #[command(flatten)]
        common: Folders,
    },
    /// List the types of a package.
    #[command(after_help = "Example:\n  grainlab interface package grainlab_msgs")]
    Package {
        /// Name of the package
        package: String,
        /// Folders of message files.
        #[command(flatten)]
        common: Folders,
    },
    /// List the packages.
    Packages(Folders),
    /// Show the topics of the laboratory, with type, QoS and writer.
    Topics(Folders),
}

/// The arguments that every command has.
#[derive(Debug, clap::Args)]
pub struct Folders {
    #[command(flatten)]
    messages: MessagePath,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    format: OutputFormat,
}

impl Folders {
    fn list(&self, names: &BTreeSet<String>) -> Result<Exit, Failure> {
        shown(self.format, names, || names.iter().map(|name| format!("{name}\n")).collect())
    }
}

/// A topic of the laboratory.
#[derive(Serialize)]
struct Row {
    topic: &'static str,
    #[serde(rename = "type")]
    type_name: &'static str,
    qos: String,
    writer: &'static str,
}

/// Runs the command.
///
/// # Errors
/// A type or package that is not known.
pub fn run(command: &Command) -> Result<Exit, Failure> {
    match command {
        Command::Show { type_name, no_comments, all_comments, common } => {
            let known = common.messages.definitions()?;
            let type_name = &complete(&known, type_name)?;
            let text = text(&known, type_name)?;
            let comments = match (no_comments, all_comments) {
                (true, _) => 0,
                (_, true) => DEEPEST,
                _ => 1,
            };
            let text = nested(type_name, &text, comments);
            shown(common.format, &text, || text.clone())
        }
        Command::List { only_msgs, only_srvs, common } => {
            let mut names = common.messages.definitions()?.names();
            names.retain(|name| {
                !(*only_msgs && name.contains("/srv/") || *only_srvs && name.contains("/msg/"))
            });
            common.list(&names)
        }
        Command::Package { package, common } => {
            let mut names = common.messages.definitions()?.names();
            names.retain(|name| name.split('/').next() == Some(package));
            if names.is_empty() {
                return Err(Failure::failed(format!(
                    "the package {package} is not known; see grainlab interface packages, or give --msg-path"
                )));
            }
            common.list(&names)
        }
        Command::Packages(common) => {
            let names = common.messages.definitions()?.names();
            common.list(&names.iter().filter_map(|name| name.split('/').next()).map(str::to_owned).collect())
        }
        Command::Topics(common) => {
            let row = |topic: &Topic| Row {
                topic: topic.name,
                type_name: topic.info.type_name,
                qos: topic.qos.to_string(),
                writer: topic.writer,
            };
            let rows: Vec<Row> = grainlab_msgs::topics::TOPICS.iter().map(row).collect();
            shown(common.format, &rows, || {
                let mut table = Table::new(["topic", "type", "QoS", "writer"]);
                rows.iter().for_each(|r| table.row([r.topic, r.type_name, &r.qos, r.writer]));
                table.text()
            })
        }
    }
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
    /// Levels with their comments.
    comments: usize,
    shown: String,
}

/// The first section of `text` with those of its fields.
fn nested(type_name: &str, text: &str, comments: usize) -> String {
    let bar = format!("{}\n", "=".repeat(80));
    let mut sections = text.split(bar.as_str());
    let root = sections.next().unwrap_or_default();
    let others = sections.filter_map(|s| s.strip_prefix("MSG: ")?.split_once('\n')).collect();
    let mut nested = Nested { others, comments, shown: String::new() };
    nested.add(type_name, root, 0);
    nested.shown
}

impl Nested<'_> {
    fn add(&mut self, type_name: &str, text: &str, level: usize) {
        let package = type_name.split('/').next().unwrap_or_default();
        let has_comments = level < self.comments;
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
