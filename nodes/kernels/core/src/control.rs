//! Targets of a loading path for each strain component, and the law that answers.

/// Control of one component of the strain rate (Voigt order xx, yy, zz, yz, xz, xy, tensor components).
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ComponentControl {
    /// No strain of this component.
    Held,
    /// The servo drives this stress component to the setpoint, Pa, positive in compression.
    Stress(f64),
    /// This strain rate, 1/s, positive in extension.
    StrainRate(f64),
}

/// Law from a stress error to a strain rate.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ServoLaw {
    /// Rate = (σ − σ*)/(K τ): the error divided by the present tangent stiffness and by the response time τ.
    Scaled {
        /// Response time τ, s; more than half a control interval. The strain is affine, so that no wave has to cross the
        /// cell: a few periods of a contact are enough.
        response_time: f64,
    },
    /// Eq. 1 with its gain as a share of the critical one: rate ← (1 − leak)·rate + share·g_c·(σ − σ*), where g_c =
    /// (4 − 2 leak)/(K h) follows the present tangent stiffness K and the control interval h. Stable and equally fast at
    /// every pressure and control period.
    Normalised {
        /// Share of the critical gain, above 0 and below 1.
        share: f64,
        /// Share of the rate forgotten each control period, in [0, 1]. Above 0 no swing of the stress lasts, also where the packing
        /// damps none, as a lattice; 0 leaves no error under plastic flow.
        leak: f64,
    },
    /// Eq. 1: rate ← (1 − leak)·rate + gain·(σ − σ*), once each control period.
    Integral {
        /// Gain g, 1/(Pa·s).
        gain: f64,
        /// Share of the rate forgotten each control period, in [0, 1]; 0 is Eq. 1 to the letter.
        leak: f64,
    },
}
