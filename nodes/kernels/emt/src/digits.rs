//! Numbers in messages, with as many digits as tell them apart.

/// Decimals beyond which two numbers are printed as equal.
const MOST_DIGITS: usize = 16;

/// Decimals of the quantities of a state.
const DIGITS: usize = 4;

/// A value outside a range, and the ends of the range, with `digits` decimals, or more if the value and the nearer end would
/// look equal.
pub(crate) fn apart(value: f64, range: [f64; 2], digits: usize) -> [String; 3] {
    written(value, range, digits, |v, digits| format!("{v:.digits$}"))
}

/// Texts of [`apart`] for a quantity of the state or structure of this name: p/E* is so small that decimals do not show it.
pub(crate) fn of_quantity(quantity: &str, value: f64, range: [f64; 2]) -> [String; 3] {
    match quantity {
        _ if quantity.starts_with("p/E*") => written(value, range, 2, |v, digits| format!("{v:.digits$e}")),
        _ => apart(value, range, DIGITS),
    }
}

/// A quantity that is too far from the packings of a calibration.
pub(crate) fn too_far(quantity: &str, value: f64, range: [f64; 2], calibration: &str) -> String {
    let [shown, low, high] = of_quantity(quantity, value, range);
    format!(
        "{quantity} = {shown} is too far from the packings of calibration `{calibration}`, [{low}, {high}], for an estimate"
    )
}

/// A quantity that a prior has moved out of the domain of the model.
pub(crate) fn moved_out(quantity: &str, value: f64, range: [f64; 2]) -> String {
    let [shown, low, high] = of_quantity(quantity, value, range);
    format!("{quantity} = {shown} is outside [{low}, {high}], the domain of the model")
}

fn written(value: f64, range: [f64; 2], digits: usize, text: impl Fn(f64, usize) -> String) -> [String; 3] {
    let [low, high] = range;
    let end = if value < low { low } else { high };
    let differ = |digits: &usize| text(value, *digits) != text(end, *digits);
    let digits = (digits..=MOST_DIGITS).find(differ).unwrap_or(MOST_DIGITS);
    [value, low, high].map(|v| text(v, digits))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn small_reduced_pressures_are_told_apart_by_their_exponents() {
        let text = too_far("p/E*", 1.1e-12, [2.3e-8, 1.63e-4], "grainlab");
        assert!(text.contains("p/E* = 1.10e-12 is") && text.contains("[2.30e-8, 1.63e-4]"), "{text}");
        assert_eq!(of_quantity("p/E*", 1.6301e-4, [2e-8, 1.63e-4])[0], "1.6301e-4");
        assert_eq!(too_far("q/p", 0.5, [0.0, 0.49999], "x").matches("0.50000").count(), 1);
    }
}
