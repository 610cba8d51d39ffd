//! Priors from files, and the one that a model has.

use super::case::Case;
use grainlab_console::{Failure, say};
use grainlab_emt::Prior;
use grainlab_recordings::input;
use std::path::Path;
use std::sync::Arc;

/// Gives the prior to every case that infers one of its quantities. Fails if none does, or if it excludes the domain of a model.
pub(super) fn apply(path: &Path, cases: &mut [Case]) -> Result<(), Failure> {
    let name = path.display();
    let text = input::text(path, input::SETTINGS).map_err(|e| Failure::failed(format!("{name}: {e}")))?;
    apply_text(&name.to_string(), &text, cases)
}

pub(super) fn apply_text(name: &str, text: &str, cases: &mut [Case]) -> Result<(), Failure> {
    let prior = Prior::parse(text).map_err(|e| Failure::usage(format!("{name}: {e}")))?;
    for quantity in prior.quantities() {
        let without = |case: &&Case| !case.model.quantities(&case.calibration).contains(&quantity);
        let mut models: Vec<&str> = cases.iter().filter(without).map(|case| case.model.name()).collect();
        models.dedup();
        if !models.is_empty() && cases.iter().all(|case| without(&case)) {
            let models = models.join(", ");
            return Err(Failure::usage(format!("{name}: [{quantity}]: no model infers it ({models})")));
        }
        if !models.is_empty() {
            say!("grainlab: {name}: [{quantity}] is not used by {}", models.join(", "));
        }
    }
    for case in cases {
        let own = prior.only(&case.model.quantities(&case.calibration));
        let domain = case.model.prior_domain(&case.calibration);
        own.completed(&domain).map_err(|e| Failure::usage(format!("{name}: {e}")))?;
        case.prior = (own != Prior::default()).then(|| Arc::new(own));
    }
    Ok(())
}

pub(super) fn text(case: &Case) -> Result<String, Failure> {
    let domain = case.model.prior_domain(&case.calibration);
    let prior = case.own_prior().completed(&domain).map_err(Failure::usage)?;
    let mut text = format!(
        "# The prior of model {}, calibration {}: grainlab invert --prior FILE\n# distribution = \"normal\" (mean, stddev), \
         \"uniform\" (low, high) or \"truncated-normal\" (mean, stddev, low and high or one of them)\n",
        case.model.name(),
        case.calibration.name()
    );
    let follows = case.model.quantities(&case.calibration);
    let follows: Vec<&str> =
        follows.into_iter().filter(|q| domain.structure[*q as usize].is_none()).map(|q| q.name()).collect();
    if !follows.is_empty() {
        text += &format!(
            "# {} follow from these; a section of theirs multiplies what the calibration says of them.\n",
            follows.join(" and ")
        );
    }
    Ok(text + "\n" + &prior.to_toml())
}
