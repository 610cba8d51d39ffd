//! The message files: the subset of the ROS 2 interface language that the laboratory uses.

use super::Library;
use std::fmt::Debug;
use std::str::FromStr;

pub(crate) struct MessageFile {
    pub(crate) package: String,
    pub(crate) name: String,
    /// Path in the crate, with forward slashes.
    path: String,
    pub(crate) text: String,
    /// The comment at the head of the file.
    pub(crate) doc: Vec<String>,
    pub(crate) constants: Vec<Constant>,
    pub(crate) fields: Vec<Field>,
}

pub(crate) struct Constant {
    pub(crate) primitive: &'static Primitive,
    pub(crate) name: String,
    /// The value as a Rust literal.
    pub(crate) value: String,
    pub(crate) doc: String,
}

pub(crate) struct Field {
    pub(crate) base: Base,
    pub(crate) shape: Shape,
    pub(crate) name: String,
    /// The default of a number or a bool, as a Rust literal.
    pub(crate) default: Option<String>,
    pub(crate) doc: String,
    /// The declaration as written, without comment.
    pub(crate) declaration: String,
    /// Number of the line, from 1.
    line: usize,
}

/// Type of a field or of its elements.
pub(crate) enum Base {
    Primitive(&'static Primitive),
    /// Another message, "package/Name".
    Message(String),
}

#[derive(Clone, Copy, PartialEq)]
pub(crate) enum Shape {
    One,
    Array(usize),
    Sequence,
}

/// A primitive type: its ROS name, its Rust type, its id in a type description (REP-2016).
pub(crate) struct Primitive {
    ros: &'static str,
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
    /// Parses the file at `path`, which faults name with their line.
    pub(crate) fn parse(package: &str, path: &str, text: String) -> Result<Self, String> {
        let name = path.rsplit('/').next().and_then(|name| name.strip_suffix(".msg"));
        let mut file = Self {
            package: package.to_owned(),
            name: name
                .ok_or_else(|| format!("{path}: only files of messages (.msg) are expected here"))?
                .into(),
            path: path.to_owned(),
            text: String::new(),
            doc: Vec::new(),
            constants: Vec::new(),
            fields: Vec::new(),
        };
        for (index, line) in text.lines().enumerate() {
            let (declaration, comment) = line.split_once('#').unwrap_or((line, ""));
            let (declaration, comment) = (declaration.trim(), comment.trim());
            if !declaration.is_empty() {
                let declared = file.declare(declaration, comment, index + 1);
                declared.map_err(|problem| format!("{path}:{}: {problem}", index + 1))?;
            } else if file.fields.is_empty() && file.constants.is_empty() && !comment.is_empty() {
                file.doc.push(comment.to_owned());
            }
        }
        if file.fields.is_empty() {
            return Err(format!("{path}:{}: a message needs at least one field", text.lines().count()));
        }
        file.text = text;
        Ok(file)
    }

    fn declare(&mut self, declaration: &str, comment: &str, line: usize) -> Result<(), String> {
        let (kind, rest) = declaration.split_once(char::is_whitespace).ok_or("expected a type and a name")?;
        let (base, shape) = self.kind(kind)?;
        let doc = comment.to_owned();
        let constant = rest.split_once('=');
        let (name, value) = match constant.or_else(|| rest.trim().split_once(char::is_whitespace)) {
            Some((name, value)) => (name.trim(), Some(value.trim())),
            None => (rest.trim(), None),
        };
        let mut known = self.fields.iter().map(|f| &f.name).chain(self.constants.iter().map(|c| &c.name));
        if known.any(|known| known == name) {
            return Err(format!("the name {name} exists already"));
        }
        check_name(name, constant.is_some())?;
        let literal = match (&base, shape, value) {
            (_, _, None) => None,
            (Base::Primitive(p), Shape::One, Some(value)) => Some(literal(p, value)?),
            _ => return Err(format!("{name}: only a single primitive can have a value")),
        };
        match (base, literal) {
            (Base::Primitive(primitive), Some(value)) if constant.is_some() => {
                self.constants.push(Constant { primitive, name: name.to_owned(), value, doc });
            }
            (base, default) => self.fields.push(Field {
                base,
                shape,
                name: name.to_owned(),
                default,
                doc,
                declaration: declaration.split_whitespace().collect::<Vec<_>>().join(" "),
                line,
            }),
        }
        Ok(())
    }

    fn kind(&self, kind: &str) -> Result<(Base, Shape), String> {
        let (base, shape) = match kind.split_once('[') {
            None => (kind, Shape::One),
            Some((base, "]")) => (base, Shape::Sequence),
            Some((base, length)) => {
                let length = length.strip_suffix(']').and_then(|n| n.parse().ok()).filter(|n| *n > 0);
                let length =
                    length.ok_or_else(|| format!("{kind}: expected an array length of 1 or more"))?;
                (base, Shape::Array(length))
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

    /// Refuses fields of a message that no file defines, or that contains this one.
    pub(crate) fn check_nested(&self, library: &Library) -> Result<(), String> {
        for field in &self.fields {
            let Base::Message(name) = &field.base else { continue };
            let fault = |problem: String| format!("{}:{}: {problem}", self.path, field.line);
            let inner = library.get(name).ok_or_else(|| fault(format!("no message file defines {name}")))?;
            if std::ptr::eq(inner, self) || inner.nested(library).iter().any(|file| std::ptr::eq(*file, self))
            {
                return Err(fault(format!("{name} contains {}, the message itself", self.name)));
            }
        }
        Ok(())
    }

    /// Returns every message that this message contains, once each: depth first, and in alphabetical order within a message.
    pub(crate) fn nested<'a>(&self, library: &'a Library) -> Vec<&'a Self> {
        let mut found = Vec::new();
        self.add_nested(library, &mut found);
        found
    }

    fn add_nested<'a>(&self, library: &'a Library, found: &mut Vec<&'a Self>) {
        let name = |field: &Field| match &field.base {
            Base::Message(name) => Some(name.clone()),
            Base::Primitive(_) => None,
        };
        let mut names: Vec<String> = self.fields.iter().filter_map(name).collect();
        names.sort_unstable();
        for inner in names.iter().filter_map(|name| library.get(name)) {
            if !found.iter().any(|known| std::ptr::eq(*known, inner)) {
                found.push(inner);
                inner.add_nested(library, found);
            }
        }
    }
}

fn check_name(name: &str, is_constant: bool) -> Result<(), String> {
    let (first, case) =
        if is_constant { ('A'..='Z', "UPPER_SNAKE_CASE") } else { ('a'..='z', "lower_snake_case") };
    let is_good = |c: char| first.contains(&c) || c.is_ascii_digit() || c == '_';
    if name.starts_with(|c| first.contains(&c)) && name.chars().all(is_good) {
        return Ok(());
    }
    Err(format!("the name {name:?} is not {case}"))
}

fn literal(primitive: &Primitive, value: &str) -> Result<String, String> {
    fn read<T: FromStr + Debug>(value: &str) -> Option<String> {
        value.parse().ok().map(|value: T| format!("{value:?}"))
    }
    let literal = match primitive.rust {
        "bool" => read::<bool>(value),
        "u8" => read::<u8>(value),
        "i8" => read::<i8>(value),
        "u16" => read::<u16>(value),
        "i16" => read::<i16>(value),
        "u32" => read::<u32>(value),
        "i32" => read::<i32>(value),
        "u64" => read::<u64>(value),
        "i64" => read::<i64>(value),
        "f32" | "f64" if value.parse().is_ok_and(f64::is_finite) => read::<f64>(value),
        _ => None,
    };
    literal.ok_or_else(|| format!("{value:?} is not a literal of type {} that we support", primitive.ros))
}
