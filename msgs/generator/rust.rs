//! The Rust text of the messages.

use super::Library;
use super::parse::{Base, Constant, Field, MessageFile, Primitive, Shape};
use super::type_hash::{described, rihs01};
use std::collections::BTreeMap;

/// serde and the standard library support arrays up to this length; longer ones need `fixed_array`.
const DERIVED_ARRAY: usize = 32;

/// Returns a module of each package with its messages, and the list of all types.
pub(crate) fn types(library: &Library) -> String {
    let mut packages: BTreeMap<&str, String> = BTreeMap::new();
    let mut list = String::new();
    for file in library.values() {
        *packages.entry(&file.package).or_default() += &message(file, library);
        list += &format!("    TypeInfo::of::<{}::{}>(),\n", file.package, file.name);
    }
    let mut out = String::new();
    for (package, messages) in packages {
        out += &format!("/// Messages of `{package}`.\npub mod {package} {{\n{messages}}}\n\n");
    }
    out + &format!("/// Every type, sorted by name.\nconst TYPES: &[TypeInfo] = &[\n{list}];\n\n")
}

/// Returns the list of the common interfaces of ROS 2, for which no Rust types are written.
pub(crate) fn interfaces(texts: &BTreeMap<String, String>) -> String {
    let list: String = texts.iter().map(|(path, text)| format!("    ({path:?}, {text:?}),\n")).collect();
    format!(
        "/// Texts of the common interfaces, each with its path, `package/msg/Name.msg` or `package/srv/Name.srv`.\n\
         pub const INTERFACES: &[(&str, &str)] = &[\n{list}];\n"
    )
}

/// Returns a macro that calls the macro `$check` with each type.
pub(crate) fn for_every_type(library: &Library) -> String {
    let call = |file: &MessageFile| {
        let module = file.package.replace("grainlab_msgs", "msg");
        format!("        $check!(grainlab_msgs::{module}::{});\n", file.name)
    };
    let calls: String = library.values().map(call).collect();
    format!("macro_rules! for_every_type {{\n    ($check:ident) => {{\n{calls}    }};\n}}\n")
}

fn message(file: &MessageFile, library: &Library) -> String {
    let name = &file.name;
    let full = format!("{}/msg/{name}", file.package);
    let mut out = String::new();
    match file.doc.is_empty() {
        true => out += &format!("/// The standard message `{full}`.\n"),
        false => file.doc.iter().for_each(|line| out += &format!("/// {}\n", escape(line))),
    }
    let by_hand = file.fields.iter().any(|f| f.default.is_some() || is_long(f));
    let default = if by_hand { "" } else { "Default, " };
    let copy = if is_plain(file) && file.nested(library).into_iter().all(is_plain) { "Copy, " } else { "" };
    out +=
        &format!("#[derive(Clone, {copy}Debug, {default}PartialEq, serde::Serialize, serde::Deserialize)]\n");
    out += &format!("pub struct {name} {{\n");
    for field in &file.fields {
        out += &format!("    /// {}\n", field_doc(field));
        if is_long(field) {
            out += "    #[serde(with = \"crate::fixed_array\")]\n";
        }
        out += &format!("    pub r#{}: {},\n", field.name, rust_type(field));
    }
    out += "}\n\n";
    if !file.constants.is_empty() {
        let constants: String = file.constants.iter().map(constant).collect();
        out += &format!("impl {name} {{\n{constants}}}\n\n");
    }
    if by_hand {
        let values: String = file.fields.iter().map(default_value).collect();
        out += &format!(
            "impl Default for {name} {{\n    fn default() -> Self {{\n        Self {{\n{values}        }}\n    }}\n}}\n\n"
        );
    }
    let fields: String = file.fields.iter().map(field_info).collect();
    out + &format!(
        "impl crate::Message for {name} {{
    const PACKAGE: &'static str = {:?};
    const NAME: &'static str = {name:?};
    const TYPE: &'static str = {full:?};
    const HASH: &'static str = {:?};
    const FIELDS: &'static [crate::FieldInfo] = &[\n{fields}    ];
    const DEFINITION: &'static str = {:?};

    fn encoded(&self) -> Vec<u8> {{
        crate::cdr::encode(self)
    }}

    fn decoded(bytes: &[u8]) -> Result<Self, crate::DecodeError> {{
        crate::cdr::decode(bytes)
    }}
}}\n\n",
        file.package,
        rihs01(file, library),
        definition(file, library),
    )
}

/// Returns the schema text as rosbag2 writes it: the message file, then each message in it.
fn definition(file: &MessageFile, library: &Library) -> String {
    let bar = "=".repeat(80);
    let part =
        |inner: &MessageFile| format!("\n{bar}\nMSG: {}/{}\n{}", inner.package, inner.name, inner.text);
    file.text.clone() + &file.nested(library).into_iter().map(part).collect::<String>()
}

/// Returns a field as in a type description (REP-2016).
fn field_info(field: &Field) -> String {
    let (type_id, capacity, nested) = described(field);
    let name = &field.name;
    format!(
        "        crate::FieldInfo {{ name: {name:?}, type_id: {type_id}, capacity: {capacity}, nested: {nested:?} }},\n"
    )
}

fn constant(c: &Constant) -> String {
    let doc = if c.doc.is_empty() { format!("`{}`.", c.name) } else { escape(&c.doc) };
    format!("    /// {doc}\n    pub const {}: {} = {};\n\n", c.name, c.primitive.rust, c.value)
}

fn default_value(field: &Field) -> String {
    let value = match (&field.default, field.shape) {
        (Some(value), _) => value.clone(),
        (None, Shape::Array(n)) if is_long(field) => format!("[{}::default(); {n}]", rust_base(&field.base)),
        (None, _) => "Default::default()".to_owned(),
    };
    format!("            r#{}: {value},\n", field.name)
}

/// True if the fields of a message are single numbers and messages: with plain ones in it, it is small enough for `Copy`.
fn is_plain(file: &MessageFile) -> bool {
    let is_text = |base: &Base| matches!(base, Base::Primitive(Primitive { rust: "String", .. }));
    file.fields.iter().all(|field| field.shape == Shape::One && !is_text(&field.base))
}

fn is_long(field: &Field) -> bool {
    matches!(field.shape, Shape::Array(n) if n > DERIVED_ARRAY)
}

fn rust_type(field: &Field) -> String {
    let base = rust_base(&field.base);
    match field.shape {
        Shape::One => base,
        Shape::Array(n) => format!("[{base}; {n}]"),
        Shape::Sequence => format!("Vec<{base}>"),
    }
}

fn rust_base(base: &Base) -> String {
    match base {
        Base::Primitive(p) => p.rust.to_owned(),
        Base::Message(name) => format!("super::{}", name.replacen('/', "::", 1)),
    }
}

fn field_doc(field: &Field) -> String {
    match field.doc.as_str() {
        "" => format!("`{}`.", field.declaration),
        "1" => "Dimensionless.".to_owned(),
        doc => escape(doc.strip_prefix("1, ").unwrap_or(doc)),
    }
}

/// Comments are plain text; rustdoc reads Markdown.
fn escape(text: &str) -> String {
    let mut out = String::new();
    for c in text.chars() {
        if matches!(c, '[' | ']' | '<' | '>' | '*' | '\\' | '`') {
            out.push('\\');
        }
        out.push(c);
    }
    out
}
