//! Time for which a list of pairs stays valid.

/// A bound on how much closer pairs have come since a list was made.
#[derive(Clone, Copy, Debug)]
pub(crate) struct DisplacementBound {
    /// Skin of the list, m.
    pub(crate) skin: f64,
    /// No grain moved farther relative to the affine motion, m.
    pub(crate) displacement: f64,
    /// Sum of |L| dt.
    pub(crate) strain: f64,
    pub(crate) steps: u64,
}

impl DisplacementBound {
    pub(crate) fn new(skin: f64) -> Self {
        Self { skin, displacement: 0.0, strain: 0.0, steps: 0 }
    }

    pub(crate) fn advance(&mut self, displacement: f64, strain: f64) {
        self.strain += strain;
        // Earlier displacements are strained too.
        self.displacement += displacement * (1.0 + self.strain);
        self.steps += 1;
    }

    /// True if a pair missing from the list could touch. The list holds pairs closer than S + skin. The affine motion brings
    /// the others no closer than (1 − strain)(S + skin), and each grain of a pair moved by at most `displacement`.
    pub(crate) fn is_stale(&self, reach: f64) -> bool {
        (1.0 - self.strain) * (reach + self.skin) - 2.0 * self.displacement <= reach
    }
}
