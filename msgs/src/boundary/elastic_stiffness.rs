//! `ElasticStiffness`: the stiffness of a packing, its bounds, and details of the solve.

use super::check::{Check, one_or_none};
use super::error::BoundaryError;
use crate::msg;
use grainlab_core::Stiffness;
use grainlab_core::results::{ElasticStiffness, StiffnessBounds, StiffnessMethod};

const CHECK: Check = Check("PackingReport.stiffness");

const fn code(method: StiffnessMethod) -> u8 {
    match method {
        StiffnessMethod::FrozenNetwork => msg::ElasticStiffness::METHOD_FROZEN_NETWORK,
        StiffnessMethod::PrestressedNetwork => msg::ElasticStiffness::METHOD_PRESTRESSED_NETWORK,
        StiffnessMethod::StrainProbe => msg::ElasticStiffness::METHOD_PROBE,
    }
}

pub(super) fn elastic_stiffness_message(s: &ElasticStiffness) -> msg::ElasticStiffness {
    msg::ElasticStiffness {
        method: code(s.method),
        smooth: s.smooth,
        stiffness: s.tensor.row_major(),
        stddev: s.stddev.row_major(),
        residual: s.residual,
        iterations: s.iterations,
        affine: s.bounds.affine.row_major(),
        uniform_rotation: s.bounds.uniform_rotation.row_major(),
        bulk_reuss_bound: one_or_none(s.bounds.bulk_reuss),
    }
}

pub(super) fn elastic_stiffness(m: &msg::ElasticStiffness) -> Result<ElasticStiffness, BoundaryError> {
    let matrix = |field: &str, values: &[f64; 36]| {
        CHECK.all_finite(field, values)?;
        Ok::<_, BoundaryError>(Stiffness::from_row_major(values))
    };
    for (i, stddev) in m.stddev.iter().enumerate() {
        CHECK.not_negative(format_args!("stddev[{i}]"), *stddev)?;
    }
    let method = StiffnessMethod::ALL.into_iter().find(|method| code(*method) == m.method);
    let read = ElasticStiffness {
        smooth: m.smooth,
        method: method.ok_or_else(|| {
            let known = "0 (frozen network), 2 (probe), 4 (prestressed network)";
            CHECK.code("method", m.method, known)
        })?,
        tensor: matrix("stiffness", &m.stiffness)?,
        stddev: matrix("stddev", &m.stddev)?,
        residual: CHECK.not_negative("residual", m.residual)?,
        iterations: m.iterations,
        bounds: StiffnessBounds {
            affine: matrix("affine", &m.affine)?,
            uniform_rotation: matrix("uniform_rotation", &m.uniform_rotation)?,
            bulk_reuss: CHECK.optional_not_negative("bulk_reuss_bound", &m.bulk_reuss_bound)?,
        },
    };
    // Small strains of a simulation have errors of their own.
    if read.method != StiffnessMethod::StrainProbe {
        consistent(&read)?;
    }
    Ok(read)
}

/// A solved stiffness is symmetric, and relaxation makes it softer, both to the residual of its solve.
fn consistent(s: &ElasticStiffness) -> Result<(), BoundaryError> {
    let (c, (affine, bulk)) = (s.tensor.row_major(), (s.bounds.affine.bulk_voigt(), s.tensor.bulk_voigt()));
    let largest = c.iter().fold(0.0f64, |a, v| a.max(v.abs()));
    let slack = (1e-6 + 10.0 * s.residual) * largest;
    for at in 0..36 {
        let across = c[6 * (at % 6) + at / 6];
        let symmetric = (c[at] - across).abs() <= slack;
        CHECK.that(symmetric, format_args!("stiffness[{at}]"), c[at], "that of the transposed entry")?;
    }
    let requirement = "at least the bulk modulus of the relaxed stiffness";
    CHECK.that(affine + slack >= bulk, "affine (bulk modulus)", affine, requirement)?;
    Ok(())
}
