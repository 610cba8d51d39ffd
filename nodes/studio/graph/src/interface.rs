//! The command `grainlab interface`: definitions of message and service types.

use crate::view::{OutputFormat, shown};
use grainlab_console::{Failure, Table};
use grainlab_msgs::Topic;
use grainlab_node_kit::Exit;
use grainlab_recordings::Definitions;
use serde::Serialize;
use std::collections::BTreeSet;
use std::path::PathBuf;

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
    /// Folder with message files, package/msg/Type.msg; may be repeated
    #[arg(long, value_name = "DIR")]
    msg_path: Vec<PathBuf>,
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    format: OutputFormat,
}

impl Folders {
    fn known(&self) -> Definitions {
        Definitions::with_folders(&self.msg_path)
    }

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
            let text = text(&common.known(), type_name)?;
            let text = nested(&text, !no_comments, *all_comments);
            shown(common.format, &text, || text.clone())
        }
        Command::List { only_msgs, only_srvs, common } => {
            let mut names = common.known().names();
            names.retain(|name| {
                !(*only_msgs && name.contains("/srv/") || *only_srvs && name.contains("/msg/"))
            });
            common.list(&names)
        }
        Command::Package { package, common } => {
            let mut names = common.known().names();
            names.retain(|name| name.split('/').next() == Some(package));
            if names.is_empty() {
                return Err(Failure::failed(format!(
                    "the package {package} is not known; see grainlab interface packages, or give --msg-path"
                )));
            }
            common.list(&names)
        }
        Command::Packages(common) => {
            let names = common.known().names();
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

/// The text of a message with the sections of the types of its fields, or of a service.
fn text(known: &Definitions, type_name: &str) -> Result<String, Failure> {
    if let Some(service) = known.service(type_name) {
        return Ok(service.to_owned());
    }
    let full = match type_name.split_once('/') {
        Some((package, name)) if !name.contains('/') => format!("{package}/msg/{name}"),
        _ => type_name.to_owned(),
    };
    known.text(&full, "").map_err(Failure::failed)
}

/// The first section with those of its fields below them, each level by a tab further to the right.
fn nested(text: &str, comments: bool, all_comments: bool) -> String {
    let bar = format!("{}\n", "=".repeat(80));
    let mut sections = text.split(bar.as_str());
    let root = sections.next().unwrap_or_default();
    let others: Vec<(&str, &str)> =
        sections.filter_map(|s| s.strip_prefix("MSG: ")?.split_once('\n')).collect();
    let mut shown = String::new();
    below(
        root,
        &others,
        0,
        &|level| if level == 0 { comments } else { comments && all_comments },
        &mut shown,
    );
    shown
}

fn below(
    text: &str,
    others: &[(&str, &str)],
    level: usize,
    comments: &dyn Fn(usize) -> bool,
    shown: &mut String,
) {
    for line in text.trim_end().lines() {
        let bare = line.split('#').next().unwrap_or_default();
        let line = if comments(level) { line } else { bare.trim_end() };
        if line.is_empty() && !comments(level) {
            continue;
        }
        *shown += &format!("{}{line}\n", "\t".repeat(level));
        let word = bare.split_whitespace().next().unwrap_or_default();
        let base = word.split(['[', '<']).next().unwrap_or_default();
        let is_it = |(name, _): &&(&str, &str)| {
            *name == base || name.split_once('/').is_some_and(|(_, short)| short == base)
        };
        // The time of builtin_interfaces is in no section of some texts.
        if let Some((_, inner)) = others.iter().find(is_it).filter(|_| level < 64) {
            below(inner, others, level + 1, comments, shown);
        }
    }
}
