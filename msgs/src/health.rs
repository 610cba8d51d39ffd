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

/// Progress of the phase under way, in the report of a simulator.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct PhaseReport {
    /// Name of the phase.
    pub name: String,
    /// Share that is done, 0 to 1, if the end is known beforehand.
    pub share: Option<f64>,
    /// The end conditions that do not hold.
    pub unmet: String,
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

    /// Report with the progress of a phase.
    #[must_use]
    pub fn with_phase(self, phase: &PhaseReport) -> Self {
        let share = phase.share.map_or_else(String::new, |s| format!("{s:.4}"));
        self.with("phase", &phase.name).with("unmet", &phase.unmet).with("phase_share", share)
    }

    /// Report of a node that measures every packing, at work or not.
    #[must_use]
    pub fn with_measuring(self, is_at_work: bool) -> Self {
        self.with("at_work", is_at_work)
    }

    /// Returns whether the node measures a packing now; `None` if it does not measure every packing.
    pub fn measuring(&self) -> Option<bool> {
        self.value("at_work")?.parse().ok()
    }

    /// Returns the value under this name.
    pub fn value(&self, name: &str) -> Option<&str> {
        self.values.iter().find(|(known, _)| known == name).map(|(_, value)| value.as_str())
    }

    /// Returns the progress of a phase; `None` if this is no report of a simulator.
    pub fn phase(&self) -> Option<PhaseReport> {
        let share = self.value("phase_share")?.parse().ok().filter(|s| (0.0..=1.0).contains(s));
        let [name, unmet] = [self.value("phase")?, self.value("unmet")?].map(str::to_owned);
        Some(PhaseReport { name, share, unmet })
    }
}
