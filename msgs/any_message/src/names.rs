//! Names in message files, as rosidl has them.

/// An error unless `name` is that of a field or a package: small letters, digits and single underscores, a letter first, no
/// underscore last.
pub(crate) fn check_field(name: &str) -> Result<(), String> {
    check(name, u8::is_ascii_lowercase, ["a field", "small", "mean_speed"])
}

/// An error unless `name` is that of a constant: as that of a field, in capital letters.
pub(crate) fn check_constant(name: &str) -> Result<(), String> {
    check(name, u8::is_ascii_uppercase, ["a constant", "capital", "MAX_SPEED"])
}

fn check(name: &str, is_letter: fn(&u8) -> bool, [what, letters, example]: [&str; 3]) -> Result<(), String> {
    let plain = name.bytes().all(|b| is_letter(&b) || b.is_ascii_digit() || b == b'_');
    if name.as_bytes().first().is_some_and(is_letter) && plain && !name.contains("__") && !name.ends_with('_')
    {
        return Ok(());
    }
    Err(format!(
        "{name:?} is not the name of {what}: write {letters} letters, digits and single underscores, a letter first and no \
         underscore last, as in {example}"
    ))
}

/// Checks that `name` is a message type (`package/msg/Type` or `package/Type`). The messages of a service or an action have its name
/// with underscores, as in `Add_Request`.
pub(crate) fn check_type(name: &str) -> Result<(), String> {
    let mut parts = name.split('/').rev();
    let last = parts.next().unwrap_or_default();
    let is_capital = |part: &str| {
        part.starts_with(|c: char| c.is_ascii_uppercase()) && part.bytes().all(|b| b.is_ascii_alphanumeric())
    };
    let packages = parts.filter(|part| !["msg", "srv", "action"].contains(part));
    if last.split('_').all(is_capital)
        && name.split('/').count() <= 3
        && packages.into_iter().all(|package| check_field(package).is_ok())
    {
        return Ok(());
    }
    Err(format!(
        "{name:?} is not a type: write a built-in one, such as float64 or string, or that of a message, such as \
         geometry_msgs/Point"
    ))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn names_are_those_that_rosidl_takes() {
        for (names, expected) in [
            (&["a", "mean_speed_2"][..], [true, false]),
            (&["A", "MAX_SPEED_2"], [false, true]),
            (&["1a", "_a", "a_", "A_", "a__b", "A__B", "meanSpeed", "é", ""], [false, false]),
        ] {
            for name in names {
                assert_eq!([check_field(name).is_ok(), check_constant(name).is_ok()], expected, "{name}");
            }
        }
        let types = [
            "Point",
            "geometry_msgs/Point",
            "geometry_msgs/msg/Point",
            "Add_Request",
            "p/srv/Add_SendGoal_Request",
        ];
        let others = ["Add_", "point", "uint9", "Po_int", "Geometry/Point", "a/b/c/Point", ""];
        for (names, expected) in [(&types[..], true), (&others, false)] {
            names.iter().for_each(|name| assert_eq!(check_type(name).is_ok(), expected, "{name}"));
        }
    }
}
