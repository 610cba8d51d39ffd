//! The output of these commands.

use crate::graph::Graph;
use crate::observer::Observer;
use clap::ValueEnum;
use grainlab_console::{Failure, json, print};
use grainlab_node_kit::Exit;
use serde::Serialize;

/// Format of a result.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, ValueEnum)]
pub(crate) enum OutputFormat {
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
    /// Time limit of discovery, s
    #[arg(long, value_name = "S", default_value_t = 3.0, value_parser = seconds, allow_negative_numbers = true)]
    pub(crate) spin_time: f64,
}

impl Common {
    /// The graph of the domain of the environment.
    pub(crate) fn graph(&self) -> Result<Graph, Failure> {
        Ok(Observer::join()?.settled(self.patience()))
    }

    pub(crate) fn patience(&self) -> std::time::Duration {
        std::time::Duration::from_secs_f64(self.spin_time)
    }

    /// Prints the value as JSON, or as this text.
    pub(crate) fn show<T: Serialize + ?Sized>(
        &self,
        value: &T,
        text: impl FnOnce() -> String,
    ) -> Result<Exit, Failure> {
        print(&match self.format {
            OutputFormat::Text => text(),
            OutputFormat::Json => json(value)?,
        })?;
        Ok(Exit::Done)
    }
}

/// A time of at least 0 s, at most a day.
pub(crate) fn seconds(text: &str) -> Result<f64, String> {
    let value: f64 = text.parse().map_err(|_| "a number of seconds".to_owned())?;
    if (0.0..=86_400.0).contains(&value) { Ok(value) } else { Err("between 0 and 86400 s".into()) }
}
