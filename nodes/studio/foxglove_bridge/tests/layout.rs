//! The layout for viewers fits the topics.

use grainlab_msgs::{Topic, TypeInfo};
use serde_json::Value;

/// Every `path` of a plot and topic of a panel, below this value.
fn paths(value: &Value, found: &mut Vec<String>) {
    match value {
        Value::Object(entries) => {
            for (key, value) in entries {
                match (key.as_str(), value) {
                    ("value" | "topicToRender", Value::String(path)) => found.push(path.clone()),
                    ("topics", Value::Object(topics)) => found.extend(topics.keys().cloned()),
                    _ => paths(value, found),
                }
            }
        }
        Value::Array(values) => values.iter().for_each(|value| paths(value, found)),
        _ => {}
    }
}

#[test]
fn every_value_of_the_layout_is_a_field_of_its_topic() {
    let layout: Value = serde_json::from_str(include_str!("../../../launch/foxglove.layout.json")).unwrap();
    let mut found = Vec::new();
    paths(&layout, &mut found);
    assert!(found.len() > 12, "{found:?}");
    for path in &found {
        let mut parts = path.split('.');
        let topic = parts.next().unwrap();
        let row = Topic::by_name(topic).unwrap_or_else(|| panic!("no topic {topic}"));
        let mut info = &row.info;
        for part in parts {
            let name = part.split('[').next().unwrap();
            let field =
                info.fields.iter().find(|f| f.name == name).unwrap_or_else(|| panic!("{path}: no {name}"));
            assert_eq!(
                field.type_id > 144,
                part.contains('['),
                "{path}: an entry of a sequence has its place"
            );
            info = TypeInfo::by_name(field.nested).unwrap_or(info);
        }
    }
    // Each panel that the layout places has its settings.
    let text = layout["layout"].to_string();
    for panel in layout["configById"].as_object().unwrap().keys() {
        assert!(text.contains(&format!("{panel:?}")), "{panel} is not shown");
    }
}
