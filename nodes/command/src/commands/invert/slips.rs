//! Columns of a table that are named almost like one that is read.

/// Words for the same thing, in a column's name and in that of the input.
const WORDS: [(&str, &str); 2] = [("p", "pressure"), ("nu", "poisson")];

/// Words for a standard deviation, wherever they stand in a name.
const SIGMA: [&str; 11] =
    ["sigma", "stddev", "std", "stdev", "sd", "se", "sem", "error", "err", "uncertainty", "unc"];

/// Letters before a quantity for its error, as in dG12 and u_G12.
const DELTA: [&str; 2] = ["d", "u"];

/// Names of the flags and of Python for what a table calls otherwise.
const SYNONYMS: [(&str, &str); 15] = [
    ("qp", "axial_q_over_p"),
    ("spread", "size_spread"),
    ("young_pa", "grain_shear_modulus_pa"),
    ("young_modulus_pa", "grain_shear_modulus_pa"),
    ("youngs_modulus_pa", "grain_shear_modulus_pa"),
    ("relative_sigma", "g12_sigma_pa"),
    ("modulus_sigma", "g12_sigma_pa"),
    ("q_pressure", "axial_q_over_p"),
    ("gamma_delta", "gamma_over_delta"),
    ("stress_ratio", "axial_q_over_p"),
    ("stress_ratio_sigma", "axial_q_over_p_sigma"),
    ("solid_fraction", "phi"),
    ("poisson_ratio", "poisson"),
    ("poisson_ratio_sigma", "poisson_sigma"),
    ("sigma", "speed_sigma"),
];

/// Units of columns, each a thousand times the one before.
const UNITS: [&str; 4] = ["pa", "kpa", "mpa", "gpa"];

const SPELLED: [&str; 4] = ["Pa", "kPa", "MPa", "GPa"];

/// Shortest name in which one letter may be wrong: below it, other names are as near.
const LONG: usize = 5;

/// Shortest name that another name is taken to extend.
const SHORTEST: usize = 3;

/// The name that a column probably means: the same but for case, separators, its unit, a word for standard deviation, its first
/// word, or one letter. `None` for unlike names, and for those that begin with `_`.
pub(super) fn meant<'a>(column: &str, known: &[&'a str]) -> Option<&'a str> {
    if column.starts_with('_') {
        return None;
    }
    let written = words(column);
    let whole = written.join("_");
    let synonyms = SYNONYMS.iter().filter(|(synonym, _)| *synonym == whole);
    if let Some(name) =
        synonyms.flat_map(|(_, meant)| known.iter().copied().find(|name| name == meant)).next()
    {
        return Some(name);
    }
    let (short, joined) = (bare(&written), written.concat());
    let same = |name: &&str| {
        let full = bare(&words(name));
        let without_first = full.get(1..).filter(|rest| rest.len() > 1 && rest[0] != "sigma");
        let of_delta = DELTA
            .iter()
            .filter_map(|d| joined.strip_prefix(d))
            .any(|rest| format!("{rest}sigma") == full.concat());
        !short.is_empty() && (short == full || short.concat() == full.concat())
            || without_first == Some(&short[..])
            || of_delta
            // An error of nothing in particular.
            || short == ["sigma"] && full.last().is_some_and(|w| w == "sigma")
    };
    let nearly = |name: &&str| {
        let of_name = words(name).concat();
        joined.len() >= LONG && of_name.len() >= LONG && strsim::osa_distance(&joined, &of_name) == 1
    };
    known.iter().copied().find(same).or_else(|| known.iter().copied().find(nearly))
}

/// Unit of a column, and what its values are multiplied by to get the unit of the name that is meant; `None` if both have the same
/// unit, or one has none.
pub(super) fn converted(column: &str, meant: &str) -> Option<(&'static str, String)> {
    let unit = |name: &str| words(name).iter().rev().find_map(|w| UNITS.iter().position(|unit| unit == w));
    let (own, other) = (unit(column)?, unit(meant)?);
    (own != other).then(|| (SPELLED[own], format!("1e{}", 3 * (own as i32 - other as i32))))
}

/// The name that a column begins with, followed by something else, as in phi_percent. Names of one letter and of truths begin
/// other names, too.
pub(super) fn extended<'a>(column: &str, known: &[&'a str]) -> Option<&'a str> {
    let written = words(column);
    let begins = |name: &&&str| {
        let name = bare(&words(name));
        name.concat().len() >= SHORTEST && written.len() > name.len() && written.starts_with(&name)
    };
    let is_own =
        |name: &&&str| !column.starts_with('_') && !["grains", "eps", "k_hat", "smooth"].contains(*name);
    known.iter().filter(is_own).filter(begins).max_by_key(|name| name.len()).copied()
}

/// The words of a name in lower case, a word for standard deviation last.
fn words(name: &str) -> Vec<String> {
    let lower = name.to_lowercase();
    let words = lower.split(|c: char| !c.is_alphanumeric()).filter(|w| !w.is_empty());
    let words: Vec<&str> =
        words.map(|w| WORDS.iter().find(|(from, _)| *from == w).map_or(w, |(_, to)| *to)).collect();
    let is_error =
        |(n, w): (usize, &&str)| SIGMA.contains(w) || n == 0 && words.len() > 1 && DELTA.contains(w);
    let (errors, others): (Vec<_>, Vec<_>) = words.iter().enumerate().partition(|(n, w)| is_error((*n, w)));
    let last = (!errors.is_empty()).then_some("sigma");
    others.into_iter().map(|(_, w)| *w).chain(last).map(str::to_owned).collect()
}

/// The words without units.
fn bare(words: &[String]) -> Vec<String> {
    words.iter().filter(|w| !UNITS.contains(&w.as_str())).cloned().collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    const KNOWN: [&str; 13] = [
        "g12_pa",
        "g13_pa",
        "g12_sigma_pa",
        "pressure_pa",
        "p_kpa",
        "axial_q_over_p",
        "grain_shear_modulus_pa",
        "poisson",
        "phi",
        "theta_pa",
        "gamma_over_delta",
        "k",
        "contact_law",
    ];

    #[test]
    fn a_slip_of_a_name_is_that_name() {
        for (column, name) in [
            ("G12_PA", "g12_pa"),
            ("G13_PA", "g13_pa"),
            ("g12", "g12_pa"),
            ("g12-pa", "g12_pa"),
            ("g12_mpa", "g12_pa"),
            ("g12_sigma", "g12_sigma_pa"),
            ("g12_stddev_pa", "g12_sigma_pa"),
            ("g12_error", "g12_sigma_pa"),
            ("sigma_g12", "g12_sigma_pa"),
            ("stddev_g12_pa", "g12_sigma_pa"),
            ("g12_unc_pa", "g12_sigma_pa"),
            ("u_g12", "g12_sigma_pa"),
            ("dG12", "g12_sigma_pa"),
            ("error", "g12_sigma_pa"),
            ("q/p", "axial_q_over_p"),
            ("q_p", "axial_q_over_p"),
            ("nu", "poisson"),
            ("gamma_delta", "gamma_over_delta"),
            ("Pressure", "pressure_pa"),
            ("presure_pa", "pressure_pa"),
            ("p", "pressure_pa"),
            ("q_over_p", "axial_q_over_p"),
            ("stress_ratio", "axial_q_over_p"),
            ("shear_modulus_pa", "grain_shear_modulus_pa"),
            ("poison", "poisson"),
            ("poisson_ratio", "poisson"),
            ("tehta_pa", "theta_pa"),
            ("Phi", "phi"),
            ("qp", "axial_q_over_p"),
            ("young_pa", "grain_shear_modulus_pa"),
            ("relative_error", "g12_sigma_pa"),
            ("modulus_error", "g12_sigma_pa"),
            ("K", "k"),
        ] {
            assert_eq!(meant(column, &KNOWN), Some(name), "{column}");
        }
    }

    #[test]
    fn a_slip_of_a_unit_is_named_with_its_factor() {
        for (column, name, expected) in [
            ("pressure_kpa", "pressure_pa", Some(("kPa", "1e3"))),
            ("G12-GPa", "g12_pa", Some(("GPa", "1e9"))),
            ("P_Pa", "p_kpa", Some(("Pa", "1e-3"))),
            ("g12", "g12_pa", None),
            ("presure_pa", "pressure_pa", None),
            ("phi_percent", "phi", None),
        ] {
            let expected = expected.map(|(unit, factor)| (unit, factor.to_owned()));
            assert_eq!(converted(column, name), expected, "{column}");
        }
    }

    #[test]
    fn a_name_that_extends_that_of_an_input_is_meant_for_it() {
        for (column, name) in [
            ("phi_percent", "phi"),
            ("grain_shear_modulus_gpa_at_20_C", "grain_shear_modulus_pa"),
            ("pressure_cell", "pressure_pa"),
        ] {
            assert_eq!(extended(column, &KNOWN), Some(name), "{column}");
        }
        for column in ["phi", "_phi_percent", "k_of_spring", "pressured", "set.phi", "eps_v", "relaxed.theta"]
        {
            assert_eq!(extended(column, &KNOWN), None, "{column}");
        }
    }

    #[test]
    fn unlike_names_and_those_marked_as_others_are_left_alone() {
        for column in [
            "name",
            "sample_id",
            "operator",
            "temperature",
            "mu2",
            "seed",
            "preparation",
            "set.friction",
            "psi",
            "x",
            "time",
            "relaxed.k",
            "e",
            "delta",
            "law_of_grains",
            "_g12",
            "_G12_PA",
            "",
        ] {
            assert_eq!(meant(column, &KNOWN), None, "{column}");
        }
    }
}
