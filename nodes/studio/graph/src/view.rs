//! The output of these commands.

use crate::graph::Graph;
use crate::observer::Observer;
use clap::ValueEnum;
use grainlab_any_message::Schema;
use grainlab_console::{Failure, json, print};
use grainlab_node_kit::Exit;
use grainlab_recordings::MessagePath;
use serde::Serialize;

/// Format of a result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub enum OutputFormat {
    /// Text for readers.
    #[default]
    Text,
    /// One JSON document; the keys are stable.
    Json,
}

/// The arguments that every command has.
#[derive(Clone, Copy, Debug, clap::Args)]
pub struct Common {
    /// Format of the result
    #[arg(long, value_enum, default_value_t)]
    pub(crate) format: OutputFormat,
    /// Time limit of discovery, which ends when the graph has not changed for 2 s
    #[arg(long, value_name = "S", default_value_t = 15.0, value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) spin_time: f64,
}

impl Common {
    pub(crate) fn graph(&self) -> Result<Graph, Failure> {
        self.graph_with(|_| false)
    }

    /// The graph, which is not waited for any longer when it has what is asked for.
    pub(crate) fn graph_with(&self, is_there: impl Fn(&Graph) -> bool) -> Result<Graph, Failure> {
        Ok(Observer::join()?.with(self.patience(), is_there))
    }

    pub(crate) fn patience(&self) -> std::time::Duration {
        std::time::Duration::from_secs_f64(self.spin_time)
    }

    pub(crate) fn show<T: Serialize + ?Sized>(
        &self,
        value: &T,
        text: impl FnOnce() -> String,
    ) -> Result<Exit, Failure> {
        shown(self.format, value, text)
    }
}

pub(crate) fn shown<T: Serialize + ?Sized>(
    format: OutputFormat,
    value: &T,
    text: impl FnOnce() -> String,
) -> Result<Exit, Failure> {
    print(&match format {
        OutputFormat::Text => text(),
        OutputFormat::Json => json(value)?,
    })?;
    Ok(Exit::Done)
}

/// The full name of a message type: `package/Type` is `package/msg/Type`.
pub(crate) fn full_name(type_name: &str) -> String {
    match type_name.split_once('/') {
        Some((package, name)) if !name.contains('/') => format!("{package}/msg/{name}"),
        _ => type_name.to_owned(),
    }
}

/// The schema of a message type, with its full name.
pub(crate) fn schema(type_name: &str, messages: &MessagePath) -> Result<(String, Schema), Failure> {
    let full = full_name(type_name);
    let text = messages.definitions()?.text(&full, "").map_err(Failure::failed)?;
    let schema = Schema::parse(&full, &text).map_err(Failure::failed)?;
    Ok((full, schema))
}

/// A time of at least 0 s, at most a day.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "a number of seconds".to_owned())?;
    if (0.0..=86_400.0).contains(&value) { Ok(value) } else { Err("between 0 and 86400 s".into()) }
}
