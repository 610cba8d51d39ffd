//! The message files: the subset of the ROS 2 interface language that the laboratory uses.

/// One parsed message file.
#[derive(Debug)]
pub(crate) struct MessageFile {
    pub(crate) package: String,
    pub(crate) name: String,
    /// Path below the crate, with forward slashes.
    pub(crate) path: String,
    /// The comment at the head of the file.
    pub(crate) doc: Vec<String>,
    pub(crate) constants: Vec<Constant>,
    pub(crate) fields: Vec<Field>,
}

#[derive(Debug)]
pub(crate) struct Constant {
    pub(crate) base: Base,
    pub(crate) name: String,
    pub(crate) value: String,
    pub(crate) doc: String,
}

#[derive(Debug)]
pub(crate) struct Field {
    pub(crate) base: Base,
    pub(crate) shape: Shape,
    pub(crate) name: String,
    /// Default value as written, of a number or a bool.
    pub(crate) default: Option<String>,
    pub(crate) doc: String,
    /// The declaration as written, without comment.
    pub(crate) declaration: String,
}

/// Type of a field or of its elements.
#[derive(Clone, Debug, PartialEq)]
pub(crate) enum Base {
    /// One of [`PRIMITIVES`].
    Primitive(&'static Primitive),
    /// Another message, "package/Name".
    Message(String),
}

#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) enum Shape {
    One,
    Array(usize),
    Sequence,
}

/// A primitive type: its ROS name, its Rust type, its id in a type description (REP-2016).
#[derive(Debug, PartialEq)]
pub(crate) struct Primitive {
    pub(crate) ros: &'static str,
    pub(crate) rust: &'static str,
    pub(crate) type_id: u32,
}

const fn primitive(ros: &'static str, rust: &'static str, type_id: u32) -> Primitive {
    Primitive { ros, rust, type_id }
}

/// `char` and `wstring` are left out: their meaning differs between tools.
const PRIMITIVES: [Primitive; 13] = [
    primitive("bool", "bool", 15),
    primitive("byte", "u8", 16),
    primitive("float32", "f32", 10),
    primitive("float64", "f64", 11),
    primitive("int8", "i8", 2),
    primitive("uint8", "u8", 3),
    primitive("int16", "i16", 4),
    primitive("uint16", "u16", 5),
    primitive("int32", "i32", 6),
    primitive("uint32", "u32", 7),
    primitive("int64", "i64", 8),
    primitive("uint64", "u64", 9),
    primitive("string", "String", 17),
];

impl MessageFile {
    pub(crate) fn parse(package: &str, name: &str, path: &str, text: &str) -> Result<Self, String> {
        let mut file = Self {
            package: package.to_owned(),
            name: name.to_owned(),
            path: path.to_owned(),
            doc: Vec::new(),
            constants: Vec::new(),
            fields: Vec::new(),
        };
        let mut head = true;
        for (index, line) in text.lines().enumerate() {
            let (declaration, comment) = match line.split_once('#') {
                Some((declaration, comment)) => (declaration.trim(), comment.trim()),
                None => (line.trim(), ""),
            };
            if declaration.is_empty() {
                if head && !comment.is_empty() {
                    file.doc.push(comment.to_owned());
                }
                continue;
            }
            head = false;
            file.declare(declaration, comment).map_err(|e| format!("line {}: {e}", index + 1))?;
        }
        if file.fields.is_empty() {
            return Err("a message needs at least one field".into());
        }
        Ok(file)
    }

    fn declare(&mut self, declaration: &str, comment: &str) -> Result<(), String> {
        let (kind, rest) = declaration.split_once(char::is_whitespace).ok_or("expected a type and a name")?;
        let (base, shape) = self.kind(kind)?;
        let rest = rest.trim();
        if let Some((name, value)) = rest.split_once('=') {
            let constant = Constant {
                base,
                name: name.trim().to_owned(),
                value: value.trim().to_owned(),
                doc: comment.to_owned(),
            };
            let Base::Primitive(p) = &constant.base else {
                return Err("a constant must be of a primitive type".into());
            };
            check_literal(p, &constant.value)?;
            self.constants.push(constant);
            return Ok(());
        }
        let (name, default) = match rest.split_once(char::is_whitespace) {
            Some((name, default)) => (name, Some(default.trim().to_owned())),
            None => (rest, None),
        };
        if !name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_') {
            return Err(format!("field name {name:?} is not lower_snake_case"));
        }
        if let Some(value) = &default {
            match (&base, shape) {
                (Base::Primitive(p), Shape::One) => check_literal(p, value)?,
                _ => return Err(format!("{name}: only a single primitive can have a default")),
            }
        }
        let declaration = declaration.split_whitespace().collect::<Vec<_>>().join(" ");
        self.fields.push(Field {
            base,
            shape,
            name: name.to_owned(),
            default,
            doc: comment.to_owned(),
            declaration,
        });
        Ok(())
    }

    fn kind(&self, kind: &str) -> Result<(Base, Shape), String> {
        let (base, shape) = match kind.split_once('[') {
            None => (kind, Shape::One),
            Some((base, "]")) => (base, Shape::Sequence),
            Some((base, length)) => {
                let length = length.strip_suffix(']').and_then(|n| n.parse().ok()).filter(|n| *n > 0);
                (
                    base,
                    Shape::Array(
                        length.ok_or_else(|| format!("{kind}: expected an array length of 1 or more"))?,
                    ),
                )
            }
        };
        if let Some(primitive) = PRIMITIVES.iter().find(|p| p.ros == base) {
            return Ok((Base::Primitive(primitive), shape));
        }
        let full = if base.contains('/') { base.to_owned() } else { format!("{}/{base}", self.package) };
        if full.rsplit('/').next().is_some_and(|name| name.starts_with(|c: char| c.is_ascii_uppercase())) {
            return Ok((Base::Message(full), shape));
        }
        Err(format!("unknown type {base}"))
    }

    /// Other messages this one names directly, in alphabetical order, each once.
    pub(crate) fn dependencies(&self) -> Vec<&str> {
        let mut names: Vec<&str> = self
            .fields
            .iter()
            .filter_map(|f| match &f.base {
                Base::Message(name) => Some(name.as_str()),
                Base::Primitive(_) => None,
            })
            .collect();
        names.sort_unstable();
        names.dedup();
        names
    }
}

/// Literals are copied into Rust, so they must be plain numbers.
fn check_literal(primitive: &Primitive, value: &str) -> Result<(), String> {
    let good = match primitive.rust {
        "f32" | "f64" => value.parse::<f64>().is_ok_and(f64::is_finite),
        "bool" => matches!(value, "true" | "false"),
        "String" => false,
        _ => value.parse::<i128>().is_ok(),
    };
    if good {
        Ok(())
    } else {
        Err(format!("{value:?} is not a literal of type {} that we support", primitive.ros))
    }
}
