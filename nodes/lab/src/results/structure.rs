//! The structure of a packing, with the stable keys of `grainlab analyze`. Tensors are in Voigt order, tensor components.

use grainlab_core::structure::{
    FORCE_BIN_WIDTH, Forces, Mobilisation, NetworkPart, ORIENTATION_BINS, StressForceFabric,
};
use grainlab_core::{Fabric, SymTensor, Vec3};
use serde::Serialize;

/// q/p below which a share of the deviatoric stress is a share of nothing.
const NO_DEVIATOR: f64 = 1e-3;

/// All but coordination and the contacts' own fabric, which stand beside it.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct StructureView {
    /// Axis of eps, of the orientation histogram and of all `along_axis`.
    pub(crate) reference_axis: [f64; 3],
    pub(crate) axis: AxisView,
    pub(crate) fabrics: FabricsView,
    pub(crate) orientation: OrientationView,
    pub(crate) stress_normal_pa: [f64; 6],
    pub(crate) stress_tangential_pa: [f64; 6],
    /// Null without normal forces.
    pub(crate) stress_force_fabric: Option<AnisotropiesView>,
    pub(crate) strong: NetworkView,
    pub(crate) weak: NetworkView,
    /// Null without normal forces.
    pub(crate) forces: Option<ForcesView>,
    /// Null without friction, and without a limit to it.
    pub(crate) friction: Option<FrictionView>,
}

/// The axis found and its noise.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct AxisView {
    pub(crate) found: [f64; 3],
    /// About the axis found.
    pub(crate) eps: f64,
    /// Among packings like this one, about any axis.
    pub(crate) eps_stddev: Option<f64>,
    pub(crate) angle_stddev_rad: Option<f64>,
    pub(crate) determined: bool,
}

/// Weighted fabrics, trace 1, and the fourth-order one.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct FabricsView {
    pub(crate) normal_forces: [f64; 6],
    pub(crate) tangential_forces: [f64; 6],
    pub(crate) stiffness: [f64; 6],
    /// xxxx xxxy xxxz xxyy xxyz xxzz xyyy xyyz xyzz xzzz yyyy yyyz yyzz yzzz zzzz.
    pub(crate) fourth_order: [f64; 15],
    pub(crate) fourth_order_magnitude: f64,
    /// Coefficient of P4 about the reference axis.
    pub(crate) p4: f64,
}

/// Contacts and overlaps by x = |n·axis|; overlaps are null where there is no contact.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct OrientationView {
    /// Edges of the bins.
    pub(crate) x: [f64; ORIENTATION_BINS + 1],
    pub(crate) contacts: [u32; ORIENTATION_BINS],
    pub(crate) overlap_m: [Option<f64>; ORIENTATION_BINS],
    pub(crate) sqrt_overlap_sqrt_m: [Option<f64>; ORIENTATION_BINS],
    /// Eq. 6 by maximum likelihood, with the standard error of independent contacts.
    pub(crate) eps: Option<f64>,
    pub(crate) eps_stddev: Option<f64>,
    pub(crate) chi2_per_dof: Option<f64>,
    /// Of sqrt(overlap), with the standard error of independent contacts.
    pub(crate) g: Option<f64>,
    pub(crate) g_stddev: Option<f64>,
}

/// Anisotropies of the stress-force-fabric relation.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct AnisotropiesView {
    pub(crate) contacts: [f64; 6],
    pub(crate) normal_forces: [f64; 6],
    pub(crate) branches: [f64; 6],
    pub(crate) tangential_forces: [f64; 6],
    /// (3/2) h.a.h of each: a of a distribution 1 + a (x^2 - 1/3).
    pub(crate) along_axis: AlongAxis,
    /// (2/5) (a_c + a_n + a_l + (3/2) a_t).
    pub(crate) predicted_q_over_p: f64,
    pub(crate) q_over_p: Option<f64>,
}

/// One number of each tensor.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub(crate) struct AlongAxis {
    pub(crate) contacts: f64,
    pub(crate) normal_forces: f64,
    pub(crate) branches: f64,
    pub(crate) tangential_forces: f64,
}

/// The strong or the weak network.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct NetworkView {
    pub(crate) contacts: u32,
    pub(crate) share_of_contacts: Option<f64>,
    pub(crate) eps: f64,
    pub(crate) fabric: [f64; 6],
    pub(crate) stress_pa: [f64; 6],
    pub(crate) share_of_pressure: Option<f64>,
    /// s_part : s / s : s with s the stress deviator; null where q/p is below 1e-3.
    pub(crate) share_of_deviator: Option<f64>,
    /// Deviatoric invariant q of its own stress over the whole pressure.
    pub(crate) q_over_pressure: Option<f64>,
}

/// Distribution of f = F_n/<F_n>.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct ForcesView {
    pub(crate) mean_normal_n: f64,
    pub(crate) mean_tangential_n: f64,
    /// <f^2>, <f^3>, <f^4>.
    pub(crate) moments: [f64; 3],
    pub(crate) participation: f64,
    pub(crate) largest: f64,
    pub(crate) bin_width: f64,
    pub(crate) contacts: Vec<u32>,
}

/// Mobilised friction |F_t|/(mu F_n).
#[derive(Clone, Debug, PartialEq, Serialize)]
pub(crate) struct FrictionView {
    pub(crate) mean: f64,
    pub(crate) share_at_limit: f64,
    /// By tenths.
    pub(crate) contacts: Vec<u32>,
}

impl From<&Fabric> for StructureView {
    fn from(f: &Fabric) -> Self {
        let s = &f.structure;
        let stress = s.stress.total();
        let network = |n: &NetworkPart| NetworkView::new(n, f.contacts, &stress);
        Self {
            reference_axis: s.reference_axis.into(),
            axis: AxisView {
                found: f.axis.into(),
                eps: s.axis.eps,
                eps_stddev: s.axis.eps_stddev,
                angle_stddev_rad: s.axis.angle_stddev,
                determined: s.axis.determined,
            },
            fabrics: FabricsView {
                normal_forces: f.force_fabric.voigt(),
                tangential_forces: s.tangential_fabric.voigt(),
                stiffness: f.stiffness_fabric.voigt(),
                fourth_order: s.fourth_order.components,
                fourth_order_magnitude: s.fourth_order.magnitude,
                p4: f.fourth_order,
            },
            orientation: OrientationView::from(&s.orientation),
            stress_normal_pa: s.stress.normal.voigt(),
            stress_tangential_pa: s.stress.tangential.voigt(),
            stress_force_fabric: s
                .stress_force_fabric
                .map(|a| AnisotropiesView::new(&a, &stress, &s.reference_axis)),
            strong: network(&s.strong),
            weak: network(&s.weak),
            forces: s.forces.as_ref().map(ForcesView::from),
            friction: s.mobilisation.as_ref().map(|m| FrictionView::new(m, f.mobilised)),
        }
    }
}

impl From<&grainlab_core::structure::Orientation> for OrientationView {
    fn from(o: &grainlab_core::structure::Orientation) -> Self {
        let known = |means: &[f64; ORIENTATION_BINS]| {
            std::array::from_fn(|b| (o.contacts[b] > 0).then_some(means[b]))
        };
        Self {
            x: std::array::from_fn(|b| b as f64 / ORIENTATION_BINS as f64),
            contacts: o.contacts,
            overlap_m: known(&o.overlap),
            sqrt_overlap_sqrt_m: known(&o.sqrt_overlap),
            eps: o.contact_fit.map(|f| f.eps),
            eps_stddev: o.contact_fit.map(|f| f.eps_stddev),
            chi2_per_dof: o.contact_fit.map(|f| f.chi2_per_dof),
            g: o.overlap_fit.map(|f| f.g),
            g_stddev: o.overlap_fit.and_then(|f| f.g_stddev),
        }
    }
}

impl AnisotropiesView {
    fn new(a: &StressForceFabric, stress: &SymTensor, axis: &Vec3) -> Self {
        let along = |t: &SymTensor| 1.5 * t.along(axis);
        let pressure = stress.mean();
        Self {
            contacts: a.contacts.voigt(),
            normal_forces: a.normal_forces.voigt(),
            branches: a.branches.voigt(),
            tangential_forces: a.tangential_forces.voigt(),
            along_axis: AlongAxis {
                contacts: along(&a.contacts),
                normal_forces: along(&a.normal_forces),
                branches: along(&a.branches),
                tangential_forces: along(&a.tangential_forces),
            },
            predicted_q_over_p: a.stress_ratio().deviatoric_invariant(),
            q_over_p: (pressure > 0.0).then(|| stress.deviatoric_invariant() / pressure),
        }
    }
}

impl NetworkView {
    fn new(n: &NetworkPart, contacts: u32, stress: &SymTensor) -> Self {
        let pressure = stress.mean();
        let (q, s) = (stress.deviatoric_invariant(), stress.deviator());
        let loaded = pressure > 0.0;
        Self {
            contacts: n.contacts,
            share_of_contacts: (contacts > 0).then(|| f64::from(n.contacts) / f64::from(contacts)),
            eps: n.eps,
            fabric: n.fabric.voigt(),
            stress_pa: n.stress.voigt(),
            share_of_pressure: loaded.then(|| n.stress.mean() / pressure),
            share_of_deviator: (loaded && q > NO_DEVIATOR * pressure)
                .then(|| n.stress.contract(&s) / s.contract(&s)),
            q_over_pressure: loaded.then(|| n.stress.deviatoric_invariant() / pressure),
        }
    }
}

impl From<&Forces> for ForcesView {
    fn from(f: &Forces) -> Self {
        Self {
            mean_normal_n: f.mean_normal,
            mean_tangential_n: f.mean_tangential,
            moments: f.moments,
            participation: f.participation(),
            largest: f.largest,
            bin_width: FORCE_BIN_WIDTH,
            contacts: f.contacts.to_vec(),
        }
    }
}

impl FrictionView {
    fn new(m: &Mobilisation, at_limit: f64) -> Self {
        Self { mean: m.mean, share_at_limit: at_limit, contacts: m.contacts.to_vec() }
    }
}
