//! Markup, which only this crate makes: from texts, which are escaped, and from templates.

use minijinja::{AutoEscape, Environment, UndefinedBehavior, Value};
use serde::{Serialize, Serializer};
use std::ops::{Add, AddAssign, Deref};
use std::sync::LazyLock;

/// Elements of a page. A text becomes markup by its escapes alone, and a template is part of the program, so that no file and no
/// message writes elements.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Html(String);

impl Html {
    /// Elements that this crate has drawn.
    pub(crate) fn drawn(markup: String) -> Self {
        Self(markup)
    }

    /// JSON, CSV or other data within a `script` element, which only `</` could end. A reader of JSON sees the same text.
    pub(crate) fn data(text: &str) -> Self {
        Self(text.replace("</", "<\\/").replace("<!--", "<\\!--"))
    }
}

impl<T: AsRef<str>> From<T> for Html {
    fn from(text: T) -> Self {
        Self(escaped(text.as_ref()))
    }
}

impl From<Html> for String {
    fn from(Html(markup): Html) -> Self {
        markup
    }
}

impl Deref for Html {
    type Target = str;

    fn deref(&self) -> &str {
        &self.0
    }
}

impl Serialize for Html {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        Value::from_safe_string(self.0.clone()).serialize(serializer)
    }
}

impl AddAssign for Html {
    fn add_assign(&mut self, more: Self) {
        self.0 += &more.0;
    }
}

impl Add for Html {
    type Output = Self;

    fn add(mut self, more: Self) -> Self {
        self += more;
        self
    }
}

impl FromIterator<Html> for Html {
    fn from_iter<I: IntoIterator<Item = Html>>(all: I) -> Self {
        all.into_iter().fold(Self::default(), Add::add)
    }
}

pub(crate) fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;").replace('"', "&quot;")
}

/// Without filters: none of a template leaves out the escapes.
static TEMPLATES: LazyLock<Environment<'static>> = LazyLock::new(|| {
    let mut templates = Environment::empty();
    templates.set_undefined_behavior(UndefinedBehavior::Strict);
    templates.set_auto_escape_callback(|_| AutoEscape::Html);
    templates.set_keep_trailing_newline(true);
    templates.set_trim_blocks(true);
    // The escapes of the library include quotes and slashes of texts.
    templates.set_formatter(|out, _, value| match value.as_str() {
        Some(markup) if value.is_safe() => Ok(out.write_str(markup)?),
        _ if value.is_none() => Ok(()),
        _ => Ok(out.write_str(&escaped(&value.to_string()))?),
    });
    templates
});

/// A template with its values, for [`html!`](crate::html!).
///
/// # Panics
/// If the template has an error, or lacks a value.
pub fn rendered(template: &'static str, values: Value) -> Html {
    match TEMPLATES.render_str(template, values) {
        Ok(markup) => Html(markup),
        Err(error) => panic!("{error:#}, in the template {template}"),
    }
}

/// Elements from a template of the program, by the syntax of Jinja: `html!("<p>{{ name }}</p>", name => "a & b")`. Texts are
/// escaped, [`Html`] is not; `None` is nothing.
#[macro_export]
macro_rules! html {
    ($template:expr $(, $($values:tt)*)?) => {
        $crate::rendered($template, $crate::minijinja::context! { $($($values)*)? })
    };
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_escaped_in_templates_and_alone_and_markup_is_not_escaped_again() {
        let text = "<b title=\"x\">&</b>";
        let escaped = "&lt;b title=&quot;x&quot;&gt;&amp;&lt;/b&gt;";
        assert_eq!(&*Html::from(text), escaped);
        let inner = html!("<i>{{ text }}</i>", text);
        assert_eq!(*inner, *format!("<i>{escaped}</i>"));
        let many = [inner.clone(), Html::default(), inner.clone()];
        let outer = html!("{% for m in many %}{{ m }}{% endfor %}{{ none }}", many, none => None::<Html>);
        assert_eq!(outer, inner.clone() + inner);
        assert_eq!(
            &*Html::data("</script><!-- \"&\""),
            "<\\/script><\\!-- \"&\"",
            "data cannot end a script"
        );
    }

    #[test]
    #[should_panic(expected = "undefined value")]
    fn a_template_without_a_value_that_it_names_is_no_empty_text() {
        let _ = html!("<p>{{ name }}</p>", nome => "x");
    }
}
