//! How long a list of pairs holds.

/// A bound on how much closer pairs came since a list was made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Approach {
    /// Skin of the list, m.
    pub(crate) skin: f64,
    /// No grain travelled farther relative to the affine motion, m.
    pub(crate) travel: f64,
    /// Sum of |L| dt.
    pub(crate) strained: f64,
    pub(crate) steps: u64,
}

impl Approach {
    pub(crate) fn new(skin: f64) -> Self {
        Self { skin, travel: 0.0, strained: 0.0, steps: 0 }
    }

    pub(crate) fn advance(&mut self, travel: f64, strain: f64) {
        self.strained += strain;
        // What was travelled before is strained along.
        self.travel += travel * (1.0 + self.strained);
        self.steps += 1;
    }

    /// Whether a pair missing from the list could touch: the list holds pairs closer than S + skin, the affine motion
    /// brings the others no closer than (1 − strained)(S + skin), and each grain of a pair travelled at most `travel`.
    pub(crate) fn is_stale(&self, reach: f64) -> bool {
        (1.0 - self.strained) * (reach + self.skin) - 2.0 * self.travel <= reach
    }
}
