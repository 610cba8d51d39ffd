//! Actions in their order: variables, conditions, namespaces, processes.

use super::entry::{Entry, Executable, Node, Placed, Text};
use super::words::{substitute, words};
use crate::nodes::NodeKind;
use crate::plan::{NodePlan, PlanError};
use std::collections::BTreeMap;

/// Settings of a place in a launch file.
#[derive(Clone, Debug)]
pub(super) struct Scope {
    variables: BTreeMap<String, String>,
    namespace: String,
    environment: Vec<(String, String)>,
}

impl Scope {
    /// Returns the outermost scope, with the values that are given to arguments.
    pub(super) fn new(variables: BTreeMap<String, String>) -> Self {
        Self { variables, namespace: String::new(), environment: Vec::new() }
    }

    /// Returns the text with values for its substitutions.
    fn text(&self, text: &str) -> Result<String, PlanError> {
        substitute(text, &self.variables, str::to_owned)
    }

    fn optional(&self, text: &Option<Text>) -> Result<Option<String>, PlanError> {
        text.as_ref().map(|text| self.text(&text.0)).transpose()
    }

    fn holds(&self, if_: &Option<Text>, unless: &Option<Text>) -> Result<bool, PlanError> {
        let truth = |text: &Option<Text>, otherwise: bool| match self.optional(text)? {
            None => Ok(otherwise),
            Some(value) => match value.to_ascii_lowercase().as_str() {
                "true" | "1" => Ok(true),
                "false" | "0" => Ok(false),
                _ => {
                    let fault = "a condition (if, unless) must be true, false, 1 or 0";
                    Err(PlanError(format!("{value:?}: {fault}")))
                }
            },
        };
        Ok(truth(if_, true)? && !truth(unless, false)?)
    }

    /// Returns the namespace below the namespace of the scope, or from the root with a slash before it.
    fn below(&self, namespace: &str) -> String {
        let name = namespace.trim_end_matches('/');
        if name.starts_with('/') || name.is_empty() {
            name.to_owned()
        } else {
            format!("{}/{name}", self.namespace)
        }
    }

    /// Runs actions; the processes are added to `plans`.
    pub(super) fn run(&mut self, entries: &[Placed], plans: &mut Vec<NodePlan>) -> Result<(), PlanError> {
        for Placed { entry, line } in entries {
            let run = self.action(entry, plans).and_then(|()| distinct(plans));
            run.map_err(|fault| fault.in_line(*line))?;
        }
        Ok(())
    }

    fn action(&mut self, entry: &Entry, plans: &mut Vec<NodePlan>) -> Result<(), PlanError> {
        match entry {
            Entry::Arg(a) if !self.variables.contains_key(&a.name) => {
                let none = || PlanError(format!("arg {:?} has no default and no value was given", a.name));
                let default = self.optional(&a.default)?.ok_or_else(none)?;
                self.variables.insert(a.name.clone(), default);
            }
            Entry::Let(s) if self.holds(&s.if_, &s.unless)? => {
                let value = self.text(&s.value.0)?;
                self.variables.insert(s.name.clone(), value);
            }
            Entry::SetEnv(s) if self.holds(&s.if_, &s.unless)? => {
                self.environment.push((s.name.clone(), self.text(&s.value.0)?));
            }
            Entry::PushRosNamespace(n) if self.holds(&n.if_, &n.unless)? => {
                self.namespace = self.below(&self.text(&n.namespace.0)?);
            }
            Entry::Group(children) => self.clone().run(children, plans)?,
            Entry::Include(i) if self.holds(&i.if_, &i.unless)? => {
                let children = i.children.as_deref().unwrap_or_default();
                self.run(children, plans).map_err(|fault| fault.included(&i.file))?;
            }
            Entry::Executable(p) if self.holds(&p.if_, &p.unless)? => plans.push(self.executable(p)?),
            Entry::Node(p) if self.holds(&p.if_, &p.unless)? => plans.push(self.node(p)?),
            _ => {}
        }
        Ok(())
    }

    /// Returns a node of this package, as `grainlab run` starts it.
    fn node(&self, p: &Node) -> Result<NodePlan, PlanError> {
        let (pkg, exec) = (self.text(&p.pkg.0)?, self.text(&p.exec.0)?);
        if pkg != "grainlab" {
            return Err(PlanError(format!(
                "node {exec} of the package `{pkg}`: only nodes of the package grainlab are started by pkg and exec; write an executable with its cmd"
            )));
        }
        let name = self.optional(&p.name)?;
        let namespace = match self.optional(&p.namespace)? {
            Some(namespace) => self.below(&namespace),
            None => self.namespace.clone(),
        };
        let mut arguments = vec!["run".to_owned(), exec.clone()];
        if let Some(Text(text)) = &p.args {
            let all = words(text)
                .ok_or_else(|| PlanError(format!("node {exec}: a quote in {text:?} is not closed")))?;
            for word in all {
                arguments.push(self.text(&word)?);
            }
        }
        arguments.push("--ros-args".to_owned());
        let mut give = |flag: &str, rule: String| arguments.extend([flag.to_owned(), rule]);
        name.iter().for_each(|name| give("-r", format!("__node:={name}")));
        if !namespace.is_empty() {
            give("-r", format!("__ns:={namespace}"));
        }
        for parameter in &p.param {
            match (&parameter.name, &parameter.value, &parameter.from) {
                (Some(name), Some(value), None) => give("-p", format!("{name}:={}", self.text(&value.0)?)),
                (None, None, Some(file)) => give("--params-file", self.text(&file.0)?),
                _ => return Err(PlanError(format!("node {exec}: a param has name and value, or from"))),
            }
        }
        for rule in &p.remap {
            give("-r", format!("{}:={}", self.text(&rule.from.0)?, self.text(&rule.to.0)?));
        }
        let within = namespace.trim_start_matches('/').replace('/', "-");
        let own = name.unwrap_or_else(|| exec.clone());
        let name = if within.is_empty() { own } else { format!("{within}-{own}") };
        let command = ("grainlab".to_owned(), arguments);
        self.process([&p.output, &p.respawn, &p.on_exit], name, Some(&exec), command)
    }

    fn executable(&self, p: &Executable) -> Result<NodePlan, PlanError> {
        let cmd = &p.cmd;
        let command = || {
            PlanError(format!(
                "executable `{cmd}`: write `grainlab run NODE ...`, or a program with its arguments"
            ))
        };
        let words = words(cmd).ok_or_else(command)?;
        let named = match words.as_slice() {
            [program, run, node, ..] if program == "grainlab" && run == "run" => Some(node.as_str()),
            [program, ..] if program != "grainlab" && !program.is_empty() => None,
            _ => return Err(command()),
        };
        let form = |value: &str| {
            // Parameters of nodes are YAML, in which a path is quoted; a third-party program gets the plain path.
            let plain =
                || serde_json::from_str(value).unwrap_or_else(|_| value.trim_matches('\'').to_owned());
            if named.is_some() { value.to_owned() } else { plain() }
        };
        let words: Vec<String> =
            words.iter().map(|word| substitute(word, &self.variables, form)).collect::<Result<_, _>>()?;
        let (program, arguments) = (words[0].clone(), words[1..].to_vec());
        let by_itself = || {
            let file = std::path::Path::new(&program).file_stem();
            let stem = file.map_or_else(|| program.clone(), |f| f.to_string_lossy().into_owned());
            stem.to_ascii_lowercase().chars().map(|c| if is_plain(c) { c } else { '_' }).collect()
        };
        let name = self.optional(&p.name)?.or_else(|| named.map(str::to_owned)).unwrap_or_else(by_itself);
        self.process([&p.output, &p.respawn, &p.on_exit], name, named, (program, arguments))
    }

    fn process(
        &self,
        [output, respawn, on_exit]: [&Option<Text>; 3],
        name: String,
        node: Option<&str>,
        (program, arguments): (String, Vec<String>),
    ) -> Result<NodePlan, PlanError> {
        if name.is_empty() || !name.chars().all(is_plain) {
            return Err(PlanError(format!(
                "executable name {name:?}: use lower case letters, digits, _ and - (it names a file)"
            )));
        }
        let one_of = |key: &str, text: &Option<Text>, allowed: &[&str]| match self.optional(text)? {
            Some(value) if !allowed.contains(&value.as_str()) => {
                let fault = format!("{key}: {value:?} is not supported; use {}", allowed.join(" or "));
                Err(PlanError::of(&name, fault))
            }
            value => Ok(value),
        };
        one_of("output", output, &["screen", "log", "both"])?;
        let respawn = one_of("respawn", respawn, &["true", "false", "True", "False"])?;
        let on_exit = one_of("on_exit", on_exit, &["shutdown"])?;
        let node = node.map(NodeKind::named).transpose();
        let node = node.map_err(|unknown| PlanError::of(&name, format!("there is {unknown}")))?;
        let (respawn, ends_all) =
            (respawn.is_some_and(|r| r.eq_ignore_ascii_case("true")), on_exit.is_some());
        let environment = self.environment.clone();
        Ok(NodePlan { node, program, arguments, respawn, name, environment, ends_all })
    }
}

/// Refuses a process with the name of an earlier one.
fn distinct(plans: &[NodePlan]) -> Result<(), PlanError> {
    match plans.split_last() {
        Some((last, others)) if others.iter().any(|p| p.name == last.name) => {
            let name = &last.name;
            Err(PlanError(format!("two executables are called {name:?}: give one of them another name")))
        }
        _ => Ok(()),
    }
}

fn is_plain(c: char) -> bool {
    c.is_ascii_lowercase() || c.is_ascii_digit() || c == '_' || c == '-'
}
