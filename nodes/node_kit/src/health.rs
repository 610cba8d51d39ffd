//! The health of a node.

/// How bad it is, in the numbers of `diagnostic_msgs/DiagnosticStatus`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Level {
    /// All is well.
    #[default]
    Ok = 0,
    /// Something a user should look at.
    Warn = 1,
    /// The node cannot do its work.
    Error = 2,
    /// What the node reports is old.
    Stale = 3,
}

impl Level {
    /// From the number on the wire.
    pub fn from_wire(level: u8) -> Level {
        match level {
            0 => Level::Ok,
            1 => Level::Warn,
            3 => Level::Stale,
            _ => Level::Error,
        }
    }
}

/// How a node is, for `/diagnostics`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Health {
    /// How bad it is.
    pub level: Level,
    /// One line for a person.
    pub message: String,
    /// Numbers by name; units in the names, as in `waiting_s`.
    pub values: Vec<(String, String)>,
}

impl Health {
    /// All is well.
    pub fn ok(message: impl Into<String>) -> Self {
        Self { message: message.into(), ..Self::default() }
    }

    /// Something a user should look at.
    pub fn warn(message: impl Into<String>) -> Self {
        Self { level: Level::Warn, message: message.into(), values: Vec::new() }
    }

    /// The node cannot do its work.
    pub fn error(message: impl Into<String>) -> Self {
        Self { level: Level::Error, message: message.into(), values: Vec::new() }
    }

    /// The same with one more value.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, value: impl ToString) -> Self {
        self.values.push((name.into(), value.to_string()));
        self
    }
}
