//! Parser of schema texts.

use std::collections::BTreeMap;
use std::sync::Arc;

use crate::lines::{ArrayText, TypeText, declaration, type_text};
use crate::literals;
use crate::names::check_type;
use crate::types::{Constant, Element, Field, FieldType, Length, MessageType, Primitive};

/// Maximum number of levels of nested messages.
const DEEPEST: usize = 64;

/// Types that every ROS 2 system has; some writers leave their text out.
const BUILT_IN: [(&str, &str); 3] = [
    ("builtin_interfaces/Time", "int32 sec\nuint32 nanosec\n"),
    ("builtin_interfaces/Duration", "int32 sec\nuint32 nanosec\n"),
    (
        "service_msgs/ServiceEventInfo",
        "uint8 event_type\nbuiltin_interfaces/Time stamp\nchar[16] client_gid\nint64 sequence_number\n",
    ),
];

/// A parsed schema: the type of a topic with all types that it depends on.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Schema {
    root: Arc<MessageType>,
}

/// Why a schema text cannot be used.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct SchemaError(pub String);

/// Not a message: a service, an action or another schema language.
fn no_message(name: &str) -> SchemaError {
    SchemaError(format!("the schema of {name} is not a ROS 2 message file (ros2msg)"))
}

fn too_deep(name: &str) -> SchemaError {
    SchemaError(format!("messages in {name} are nested in more than {DEEPEST} levels"))
}

impl Schema {
    /// Parses the schema of `type_name` (`pkg/msg/Type`): the text of its message file, then for each type that it depends on
    /// a line of equals signs, a line `MSG: pkg/Type` and its text. The text of an event of a service (`pkg/srv/Type_Event`) may be
    /// the service file, which is what rosbag2 stores.
    ///
    /// # Errors
    /// See [`SchemaError`].
    pub fn parse(type_name: &str, text: &str) -> Result<Self, SchemaError> {
        let mut texts = BTreeMap::new();
        let root = short(type_name);
        let mut sections = sections(text);
        let text = sections.next().map_or("", |(_, text)| text);
        let service =
            root.strip_suffix("_Event").and_then(|service| Some((service, request_and_response(text)?)));
        let event = service.map_or_else(String::new, |(service, _)| event_of(service));
        match service {
            Some((service, (request, response))) => {
                texts.insert(root.clone(), event.as_str());
                texts.insert(format!("{service}_Request"), request);
                texts.insert(format!("{service}_Response"), response);
            }
            None => _ = texts.insert(root.clone(), text),
        }
        for (name, text) in sections {
            let name = name.strip_prefix("MSG:").ok_or_else(|| no_message(&root))?;
            let name = short(name.trim());
            match texts.get(&name) {
                Some(known) if !says_the_same(known, text) => {
                    return Err(SchemaError(format!(
                        "the schema has two different texts of the type {name}: record it again, or take out the wrong one"
                    )));
                }
                _ => _ = texts.entry(name).or_insert(text),
            }
        }
        for (name, text) in BUILT_IN {
            texts.entry(name.to_owned()).or_insert(text);
        }
        let mut resolver = Resolver { texts, known: BTreeMap::new(), open: Vec::new() };
        Ok(Self { root: resolver.message(&root)? })
    }

    /// The type of the topic.
    pub fn root(&self) -> &Arc<MessageType> {
        &self.root
    }
}

/// `pkg/msg/Type` as `pkg/Type`.
fn short(name: &str) -> String {
    match name.split('/').collect::<Vec<_>>()[..] {
        [package, _, last] => format!("{package}/{last}"),
        _ => name.to_owned(),
    }
}

fn request_and_response(text: &str) -> Option<(&str, &str)> {
    let bar = text.lines().find(|line| line.trim() == "---")?;
    let start = bar.as_ptr().addr() - text.as_ptr().addr();
    Some((&text[..start], &text[start + bar.len()..]))
}

/// Returns the message in which ROS 2 publishes the events of a service (REP 2012).
fn event_of(service: &str) -> String {
    format!(
        "service_msgs/ServiceEventInfo info\n{service}_Request[<=1] request\n{service}_Response[<=1] response\n"
    )
}

/// True if two texts of a type have the same declarations; comments and spaces may differ.
fn says_the_same(a: &str, b: &str) -> bool {
    let of = |text| str::lines(text).map(declaration).filter(|line| !matches!(line, Ok(None)));
    a == b || of(a).eq(of(b))
}

/// The parts of a schema between lines of equals signs, each with its first line; that of the first part is empty.
fn sections(text: &str) -> impl Iterator<Item = (&str, &str)> {
    let mut rest = Some(text);
    let mut first = true;
    std::iter::from_fn(move || {
        let section = rest?;
        let (mut body, mut behind, mut at) = (section, None, 0);
        for line in section.split_inclusive('\n') {
            let is_separator = line.len() > 3 && line.trim_end().bytes().all(|b| b == b'=');
            if is_separator && line.trim_end().len() > 3 {
                (body, behind) = (&section[..at], Some(&section[at + line.len()..]));
                break;
            }
            at += line.len();
        }
        rest = behind;
        if std::mem::take(&mut first) {
            return Some(("", body));
        }
        Some(body.split_once('\n').unwrap_or((body, "")))
    })
}

/// True for a type that needs no message file of its own name. `time` and `duration` are those of ROS 1.
fn is_built_in(base: &str) -> bool {
    Primitive::by_name(base).is_some() || ["string", "wstring", "time", "duration"].contains(&base)
}

struct Resolver<'a> {
    texts: BTreeMap<String, &'a str>,
    known: BTreeMap<String, Arc<MessageType>>,
    /// Types whose fields are being resolved.
    open: Vec<String>,
}

impl Resolver<'_> {
    fn message(&mut self, name: &str) -> Result<Arc<MessageType>, SchemaError> {
        if let Some(known) = self.known.get(name) {
            return Ok(known.clone());
        }
        if self.open.iter().any(|open| open == name) {
            return Err(SchemaError(format!("the type {name} contains itself")));
        }
        if self.open.len() >= DEEPEST {
            return Err(too_deep(&self.open[0]));
        }
        self.open.push(name.to_owned());
        let text = self.texts.get(name).copied().unwrap_or("");
        let mut made = MessageType {
            name: name.to_owned(),
            fields: Vec::new(),
            constants: Vec::new(),
            least: 0,
            depth: 1,
        };
        for (number, line) in text.lines().enumerate() {
            let wrong =
                |problem: String| SchemaError(format!("schema of {name}, line {}: {problem}", number + 1));
            if line.trim() == "---" || line.starts_with("IDL:") {
                return Err(no_message(name));
            }
            let Some(line) = declaration(line).map_err(wrong)? else { continue };
            let parts = type_text(line.type_text).map_err(wrong)?;
            if !is_built_in(parts.base) {
                check_type(parts.base).map_err(wrong)?;
            }
            let element = self.element(name, &parts)?;
            let is_taken = made.fields.iter().map(|f| &f.name).chain(made.constants.iter().map(|c| &c.name));
            if is_taken.into_iter().any(|taken| taken == line.name) {
                return Err(wrong(format!("the name {} is there already: choose another one", line.name)));
            }
            if let Some(value) = line.constant {
                if parts.array.is_some() {
                    return Err(wrong(format!(
                        "the constant {} is an array: constants are single values",
                        line.name
                    )));
                }
                literals::check(value, &element).map_err(wrong)?;
                let (name, value) = (line.name.to_owned(), value.to_owned());
                made.constants.push(Constant { name, kind: element, value });
                continue;
            }
            let length = match parts.array {
                None => Length::One,
                Some(ArrayText::Fixed(n)) => Length::Fixed(n),
                Some(ArrayText::Any(bound)) => Length::Any(bound),
            };
            if let Element::Message(inner) = &element {
                made.depth = made.depth.max(inner.depth + 1);
            }
            let kind = FieldType { element, length };
            made.least = made.least.saturating_add(kind.least());
            line.default.map_or(Ok(()), |text| literals::check_default(text, &kind)).map_err(wrong)?;
            let default = line.default.map(str::to_owned);
            made.fields.push(Field { name: line.name.to_owned(), kind, default });
        }
        // ROS 2 writes a message without fields as one byte.
        made.least = made.least.max(1);
        if made.depth > DEEPEST {
            return Err(too_deep(name));
        }
        self.open.pop();
        let made = Arc::new(made);
        self.known.insert(name.to_owned(), made.clone());
        Ok(made)
    }

    fn element(&mut self, in_type: &str, parts: &TypeText<'_>) -> Result<Element, SchemaError> {
        if let Some(primitive) = Primitive::by_name(parts.base) {
            return Ok(Element::Primitive(primitive));
        }
        match parts.base {
            "string" => return Ok(Element::String(parts.bound)),
            "wstring" => return Ok(Element::WString(parts.bound)),
            _ => {}
        }
        let package = in_type.split('/').next().unwrap_or_default();
        let base = parts.base;
        let candidates = match base {
            _ if base.contains('/') => vec![short(base)],
            "time" => vec!["builtin_interfaces/Time".to_owned()],
            "duration" => vec!["builtin_interfaces/Duration".to_owned()],
            "Header" => vec![format!("{package}/Header"), "std_msgs/Header".to_owned()],
            _ => vec![format!("{package}/{base}")],
        };
        match candidates.iter().find(|name| self.texts.contains_key(*name)) {
            Some(name) => Ok(Element::Message(self.message(name)?)),
            None => Err(SchemaError(format!(
                "the schema of {in_type} has no text for the type {} of one of its fields",
                candidates[0]
            ))),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn types_are_found_by_every_form_of_their_name() {
        let bar = "=".repeat(80);
        let text = format!(
            "Header header\nB b\nx_msgs/C[2] c\ny_msgs/msg/D d\ntime t\n{bar}\nMSG: std_msgs/Header\nbuiltin_interfaces/Time \
             stamp\nstring frame_id\n{bar}\nMSG: x_msgs/B\nuint8 LIMIT=3\nint8 v 5\n\n{bar}\nMSG: x_msgs/C\n{bar}\nMSG: \
             y_msgs/msg/D\nfloat32[<=4] f\n"
        );
        let schema = Schema::parse("x_msgs/msg/A", &text).unwrap();
        let names: Vec<&str> = schema.root().fields.iter().map(|f| f.name.as_str()).collect();
        assert_eq!(names, ["header", "b", "c", "d", "t"]);
        // 4 + 4 + 4 (header), 1, 2 x 1 (no fields), 4, 8.
        assert_eq!((schema.root().least, schema.root().depth), (27, 3));
        let Element::Message(b) = &schema.root().fields[1].kind.element else { panic!("not a message") };
        assert_eq!((b.constants[0].value.as_str(), b.fields[0].default.as_deref()), ("3", Some("5")));
    }

    #[test]
    fn an_event_of_a_service_is_read_by_the_text_of_the_service_file() {
        let bar = "=".repeat(80);
        let text = format!("int64 a\nB b\n ---\n{bar}\nMSG: p/B\nint8 v\n");
        let schema = Schema::parse("p/srv/Add_Event", &text).unwrap();
        // A response of one byte: it has no fields.
        let event = [
            &[0, 1, 0, 0, 3, 0, 0, 0, 7, 0, 0, 0, 9, 0, 0, 0][..],
            &[2; 16],
            &[0, 0, 0, 0, 5, 0, 0, 0, 0, 0, 0, 0, 1, 0, 0, 0, 0, 0, 0, 0],
            &[6, 0, 0, 0, 0, 0, 0, 0, 8, 0, 0, 0, 1, 0, 0, 0, 0],
        ];
        let shown = crate::Shown::new(&schema.decode(&event.concat()).unwrap()).json();
        assert!(
            shown.starts_with(r#"{"info":{"event_type":3,"stamp":{"sec":7,"nanosec":9},"client_gid":[2,"#),
            "{shown}"
        );
        assert!(
            shown.ends_with(r#""sequence_number":5},"request":[{"a":6,"b":{"v":8}}],"response":[{}]}"#),
            "{shown}"
        );
        assert!(Schema::parse("p/srv/Add", &text).is_err(), "a service is not a message");
    }

    #[test]
    fn a_schema_that_cannot_be_used_is_an_error_that_names_the_type() {
        let bar = "=".repeat(80);
        let of = |text: &str| Schema::parse("p/msg/A", text).unwrap_err().0;
        for (text, says) in [
            ("B b".to_owned(), "the schema of p/A has no text for the type p/B of one of its fields"),
            ("A a".to_owned(), "the type p/A contains itself"),
            (format!("B b\n{bar}\nMSG: p/B\nA[] a\n"), "the type p/A contains itself"),
            ("int8 a\n---\nint8 b".to_owned(), "the schema of p/A is not a ROS 2 message file (ros2msg)"),
            (
                format!("{bar}\nIDL: p/msg/A\nmodule p {{}};"),
                "the schema of p/A is not a ROS 2 message file (ros2msg)",
            ),
        ] {
            assert_eq!(of(&text), says);
        }
        assert!(of("int8 a\n\nint8[ b").contains("line 3"));
        for (line, problem) in [
            ("uint8 a b c", "\"b c\" after the name"),
            ("uint8 1a", "\"1a\" is not the name of a field"),
            ("uint8[1,2 x", "uint8[1,2 does not end with the bracket"),
            ("uint8 a_", "\"a_\" is not the name of a field"),
            ("uint8 Max=3", "\"Max\" is not the name of a constant"),
            ("uint8 MAX=300", "an integer from 0 to 255"),
            ("uint8[2] PAIR=[1, 2]", "constants are single values"),
            ("int8 v", "the name v is there already"),
            ("uint9 a", "\"uint9\" is not a type"),
            ("uint8", "\"uint8\" is not a field"),
        ] {
            let error = of(&format!("int8 v\n{line} # comment"));
            assert!(error.contains("p/A, line 2") && error.contains(problem), "{line}: {error}");
        }
        let twice =
            |second: &str| format!("B b\n{bar}\nMSG: p/B\nint8 v\nint16 w\n{bar}\nMSG: p/msg/B\n{second}");
        for other in [
            "int16 w\nint8 v\n",
            "int8 v\n",
            "int8 v\nint16 other\n",
            "int8 v\nint16 w\nint8 x\n",
            "int8[ v\n",
        ] {
            assert!(of(&twice(other)).contains("two different texts of the type p/B:"), "{other:?}");
        }
        assert!(Schema::parse("p/msg/A", &twice("int8   v # the same\n\nint16 w")).is_ok());
        assert!(
            of(&format!("int8 v\n{bar}\nMSG: p/A\nint8 w\n"))
                .contains("two different texts of the type p/A:")
        );
        let chain: String = (1..70).map(|n| format!("{bar}\nMSG: p/T{n}\nT{} t\n", n + 1)).collect();
        assert!(of(&format!("T1 t\n{chain}")).contains("more than 64 levels"));
    }
}
