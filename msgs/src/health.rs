//! The health of a node.

/// The severity, numbered as in `diagnostic_msgs/DiagnosticStatus`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Level {
    /// No problem is known.
    #[default]
    Ok = 0,
    /// The user should check something.
    Warn = 1,
    /// The node cannot do its work.
    Error = 2,
    /// The node's report is out of date.
    Stale = 3,
}

impl Level {
    /// The level of a number in a message.
    pub fn from_wire(level: u8) -> Level {
        match level {
            0 => Level::Ok,
            1 => Level::Warn,
            3 => Level::Stale,
            _ => Level::Error,
        }
    }
}

/// The state of a node, for `/diagnostics`.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Health {
    /// Severity of the state.
    pub level: Level,
    /// One line for the user.
    pub message: String,
    /// Numbers by name; units in the names, as in `waiting_s`.
    pub values: Vec<(String, String)>,
}

impl Health {
    /// A report without problems.
    pub fn ok(message: impl Into<String>) -> Self {
        Self { message: message.into(), ..Self::default() }
    }

    /// The user should check something.
    pub fn warn(message: impl Into<String>) -> Self {
        Self { level: Level::Warn, message: message.into(), values: Vec::new() }
    }

    /// The node cannot do its work.
    pub fn error(message: impl Into<String>) -> Self {
        Self { level: Level::Error, message: message.into(), values: Vec::new() }
    }

    /// Report with one more value.
    #[must_use]
    pub fn with(mut self, name: impl Into<String>, value: impl ToString) -> Self {
        self.values.push((name.into(), value.to_string()));
        self
    }
}
