//! Details of an explicit probe, for the results of `grainlab analyze`.

use grainlab_console::Table;
use serde::Serialize;

/// One probe: all six columns.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ProbeView {
    /// Strain.
    pub amplitude: f64,
    /// Largest |C_ab - C_ba| over the largest entry of C.
    pub asymmetry: f64,
    /// Total number of solver steps.
    pub steps: u32,
    /// Contacts that opened, formed, or were at the Coulomb limit under either strain, over all columns.
    pub opened: u32,
    /// See `opened`.
    pub closed: u32,
    /// See `opened`.
    pub sliding: u32,
    /// Largest difference between the forward and the backward column, relative to the largest entry.
    pub forward_backward: Option<f64>,
    /// Largest standard error over the largest entry of C.
    pub error: f64,
}

/// Probes of several amplitudes.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScanView {
    /// In the order of amplitudes.
    pub probes: Vec<ScannedView>,
    /// Least and largest amplitude of the linear regime; null if no two neighbours agree.
    pub linear: Option<[f64; 2]>,
}

/// One of them.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct ScannedView {
    /// Strain.
    pub amplitude: f64,
    /// Null if it failed; then there is a reason.
    pub probe: Option<ProbeView>,
    /// The reason.
    pub failure: Option<String>,
    /// Largest difference from the frozen network over its C11; null without a stiffness.
    pub off_network: Option<f64>,
}

impl ScanView {
    /// One line per amplitude, and the linear regime.
    pub(crate) fn text(&self) -> String {
        let mut t = Table::new([
            "amplitude",
            "off network",
            "error",
            "+/- differ",
            "opened",
            "closed",
            "sliding",
            "steps",
        ]);
        for s in &self.probes {
            let share = |v: Option<f64>| v.map_or_else(|| "-".to_owned(), |v| format!("{v:.1e}"));
            let count = |v: Option<u32>| v.map_or_else(|| "-".to_owned(), |v| v.to_string());
            let p = s.probe.as_ref();
            t.row([
                format!("{:e}", s.amplitude),
                share(s.off_network),
                share(p.map(|p| p.error)),
                share(p.and_then(|p| p.forward_backward)),
                count(p.map(|p| p.opened)),
                count(p.map(|p| p.closed)),
                count(p.map(|p| p.sliding)),
                count(p.map(|p| p.steps)),
            ]);
        }
        let mut text = t.text();
        text += &match self.linear {
            Some([least, largest]) => format!("linear from {least:e} to {largest:e}\n"),
            None if self.probes.len() < 2 => {
                "one amplitude alone does not show whether the response is linear: give two or more\n"
                    .to_owned()
            }
            None => "no two neighbouring amplitudes agree: no linear regime seen\n".to_owned(),
        };
        for s in &self.probes {
            if let Some(failure) = &s.failure {
                text += &format!("{:e}: {failure}\n", s.amplitude);
            }
        }
        text
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn one_amplitude_alone_is_not_said_to_disagree_with_others() {
        let probe = |amplitude| ScannedView { amplitude, probe: None, failure: None, off_network: None };
        let text = |probes: Vec<ScannedView>| ScanView { probes, linear: None }.text();
        assert!(text(vec![probe(1e-6)]).contains("one amplitude alone"));
        assert!(text(vec![probe(1e-7), probe(1e-6)]).contains("no two neighbouring amplitudes agree"));
    }
}
