//! Actions in their order: variables, conditions, namespaces, processes.

use super::entry::{Condition, Entry, Group, Placed, Program, Text};
use super::words::{substitute, words};
use crate::nodes::{NodeKind, Viewer};
use crate::plan::{NodePlan, PlanError};
use std::collections::BTreeMap;

/// Settings of a place in a launch file.
#[derive(Clone, Debug, Default)]
pub(super) struct Scope {
    variables: BTreeMap<String, String>,
    namespace: String,
    environment: Vec<(String, String)>,
    /// Parameters and remaps of the nodes that follow.
    arguments: Vec<String>,
}

impl Scope {
    /// The outermost scope, with the values that are given to arguments.
    pub(super) fn of(variables: BTreeMap<String, String>) -> Self {
        Self { variables, ..Self::default() }
    }

    /// The text with values for its substitutions.
    fn text(&self, text: &str) -> Result<String, PlanError> {
        let known = || self.variables.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
        substitute(text, |name| self.variables.get(name).cloned(), known)
    }

    fn holds(&self, (if_, unless): Condition<'_>) -> Result<bool, PlanError> {
        let truth = |text: &Text| {
            let value = self.text(&text.0)?;
            match value.to_ascii_lowercase().as_str() {
                "true" | "1" => Ok(true),
                "false" | "0" => Ok(false),
                _ => Err(PlanError(format!(
                    "`{}` is no condition: {value:?} must be true, false, 1 or 0",
                    text.0
                ))),
            }
        };
        Ok(if_.as_ref().map_or(Ok(true), truth)? && !unless.as_ref().map_or(Ok(false), truth)?)
    }

    /// The namespace below that of the scope, or from the root with a slash before it.
    fn below(&self, namespace: &str) -> String {
        let name = namespace.trim_end_matches('/');
        if name.starts_with('/') || name.is_empty() {
            name.to_owned()
        } else {
            format!("{}/{name}", self.namespace)
        }
    }

    /// Runs actions; the processes are added to `plans`.
    pub(super) fn run(
        &mut self,
        entries: &[Placed],
        viewers: &'static [Viewer],
        plans: &mut Vec<NodePlan>,
    ) -> Result<(), PlanError> {
        for Placed { entry, line } in entries {
            let run = self.action(entry, viewers, plans).and_then(|()| distinct(plans));
            run.map_err(|fault| fault.in_line(*line))?;
        }
        Ok(())
    }

    fn action(
        &mut self,
        entry: &Entry,
        viewers: &'static [Viewer],
        plans: &mut Vec<NodePlan>,
    ) -> Result<(), PlanError> {
        match entry {
            Entry::Arg(a) => {
                if !self.variables.contains_key(&a.name) {
                    let none =
                        || PlanError(format!("arg {:?} has no default and no value was given", a.name));
                    let default = self.text(&a.default.as_ref().ok_or_else(none)?.0)?;
                    self.variables.insert(a.name.clone(), default);
                }
                let value = &self.variables[&a.name];
                if !a.choice.is_empty() && !a.choice.iter().any(|c| c.value.0 == *value) {
                    let choices = a.choice.iter().map(|c| c.value.0.as_str()).collect::<Vec<_>>().join(", ");
                    return Err(PlanError(format!(
                        "arg {:?} is {value:?}; it must be one of: {choices}",
                        a.name
                    )));
                }
            }
            Entry::Let(s) if self.holds((&s.if_, &s.unless))? => {
                let value = self.text(&s.value.0)?;
                self.variables.insert(s.name.clone(), value);
            }
            Entry::SetEnv(s) if self.holds((&s.if_, &s.unless))? => {
                let value = self.text(&s.value.0)?;
                self.environment.push((s.name.clone(), value));
            }
            Entry::SetParameter(s) if self.holds((&s.if_, &s.unless))? => {
                let value = self.text(&s.value.0)?;
                self.arguments.extend(["-p".to_owned(), format!("{}:={value}", s.name)]);
            }
            Entry::SetRemap(r) => {
                let rule = format!("{}:={}", self.text(&r.from.0)?, self.text(&r.to.0)?);
                self.arguments.extend(["-r".to_owned(), rule]);
            }
            Entry::PushRosNamespace(n) if self.holds((&n.if_, &n.unless))? => {
                self.namespace = self.below(&self.text(&n.namespace.0)?);
            }
            Entry::Group(group) => self.group(group, viewers, plans)?,
            Entry::Include(include) => {
                return Err(PlanError(format!(
                    "include {}: it is read with the file that has it",
                    include.file
                )));
            }
            Entry::Executable(p) if self.holds((&p.if_, &p.unless))? => {
                let fault = |what: &str| {
                    PlanError(format!(
                        "an executable has {what}; it has cmd, name, output, respawn, on_exit, env"
                    ))
                };
                let cmd = p.cmd.as_deref().ok_or_else(|| fault("no cmd"))?;
                let of_node =
                    [&p.pkg, &p.exec, &p.namespace, &p.args, &p.ros_args].iter().any(|key| key.is_some());
                if of_node || !p.param.is_empty() || !p.remap.is_empty() {
                    return Err(fault("a key of a node"));
                }
                plans.push(self.executable(p, cmd, viewers)?);
            }
            Entry::Node(p) if self.holds((&p.if_, &p.unless))? => plans.push(self.node(p, viewers)?),
            _ => {}
        }
        Ok(())
    }

    fn group(
        &mut self,
        group: &Group,
        viewers: &'static [Viewer],
        plans: &mut Vec<NodePlan>,
    ) -> Result<(), PlanError> {
        if !self.holds((&group.if_, &group.unless))? {
            return Ok(());
        }
        let mut inner = self.clone();
        let run = inner.run(&group.children, viewers, plans);
        run.map_err(|fault| group.file.iter().fold(fault, |fault, file| fault.included(file)))?;
        if group.scoped.is_some() && !self.holds((&group.scoped, &None))? {
            *self = inner;
        }
        Ok(())
    }

    /// A node of this package, as `grainlab run` starts it.
    fn node(&self, p: &Program, viewers: &'static [Viewer]) -> Result<NodePlan, PlanError> {
        let [pkg, exec] = [("pkg", &p.pkg), ("exec", &p.exec)].map(|(key, text)| {
            let text = text.as_ref().filter(|_| p.cmd.is_none());
            self.text(
                &text
                    .ok_or_else(|| {
                        PlanError(format!("a node has pkg, exec and no cmd; {key} or cmd is wrong"))
                    })?
                    .0,
            )
        });
        let (pkg, exec) = (pkg?, exec?);
        if pkg != "grainlab" {
            return Err(PlanError(format!(
                "node {exec} of the package `{pkg}`: only nodes of the package grainlab are started by pkg and exec; write an executable with its cmd"
            )));
        }
        let split = |text: &Option<Text>| -> Result<Vec<String>, PlanError> {
            let text = text.as_ref().map_or("", |t| t.0.as_str());
            let all = words(text)
                .ok_or_else(|| PlanError(format!("node {exec}: a quote in {text:?} is not closed")))?;
            all.iter().map(|word| self.text(word)).collect()
        };
        let name = p.name.as_ref().map(|name| self.text(&name.0)).transpose()?;
        let namespace = match &p.namespace {
            Some(namespace) => self.below(&self.text(&namespace.0)?),
            None => self.namespace.clone(),
        };
        let mut arguments = vec!["run".to_owned(), exec.clone()];
        arguments.extend(split(&p.args)?);
        arguments.push("--ros-args".to_owned());
        arguments.extend(split(&p.ros_args)?);
        let mut give = |flag: &str, rule: String| arguments.extend([flag.to_owned(), rule]);
        name.iter().for_each(|name| give("-r", format!("__node:={name}")));
        if !namespace.is_empty() {
            give("-r", format!("__ns:={namespace}"));
        }
        self.arguments.chunks(2).for_each(|pair| give(&pair[0], pair[1].clone()));
        for of in &p.param {
            match (&of.name, &of.value, &of.from) {
                (Some(name), Some(value), None) => give("-p", format!("{name}:={}", self.text(&value.0)?)),
                (None, None, Some(file)) => give("--params-file", self.text(&file.0)?),
                _ => return Err(PlanError(format!("node {exec}: a param has name and value, or from"))),
            }
        }
        for of in &p.remap {
            give("-r", format!("{}:={}", self.text(&of.from.0)?, self.text(&of.to.0)?));
        }
        let within = namespace.trim_start_matches('/').replace('/', "-");
        let own = name.unwrap_or_else(|| exec.clone());
        let name = if within.is_empty() { own } else { format!("{within}-{own}") };
        self.process(p, name, Some(&exec), "grainlab".to_owned(), arguments, viewers)
    }

    fn executable(&self, p: &Program, cmd: &str, viewers: &'static [Viewer]) -> Result<NodePlan, PlanError> {
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
        let value = |name: &str| {
            let value = self.variables.get(name)?;
            // Parameters of nodes are YAML, in which a path is quoted; a third-party program gets the plain path.
            let plain =
                || serde_json::from_str(value).unwrap_or_else(|_| value.trim_matches('\'').to_owned());
            Some(if named.is_some() { value.clone() } else { plain() })
        };
        let known = || self.variables.keys().map(String::as_str).collect::<Vec<_>>().join(", ");
        let words: Vec<String> =
            words.iter().map(|word| substitute(word, value, known)).collect::<Result<_, _>>()?;
        let (program, arguments) = (words[0].clone(), words[1..].to_vec());
        let by_itself = || {
            let file = std::path::Path::new(&program).file_stem();
            let stem = file.map_or_else(|| program.clone(), |f| f.to_string_lossy().into_owned());
            stem.to_ascii_lowercase().chars().map(|c| if is_plain(c) { c } else { '_' }).collect()
        };
        let given = p.name.as_ref().map(|name| self.text(&name.0)).transpose()?;
        let name = given.or_else(|| named.map(str::to_owned)).unwrap_or_else(by_itself);
        self.process(p, name, named, program, arguments, viewers)
    }

    fn process(
        &self,
        p: &Program,
        name: String,
        node: Option<&str>,
        program: String,
        arguments: Vec<String>,
        viewers: &'static [Viewer],
    ) -> Result<NodePlan, PlanError> {
        if name.is_empty() || !name.chars().all(is_plain) {
            return Err(PlanError(format!(
                "executable name {name:?}: use lower case letters, digits, _ and - (it names a file)"
            )));
        }
        let text = |text: &Option<Text>| text.as_ref().map(|text| self.text(&text.0)).transpose();
        let refuse = |key: &str, value: &str, allowed: &str| {
            PlanError::of(&name, format!("{key}: {value:?} is not supported; use {allowed}"))
        };
        if let Some(output) = text(&p.output)?.filter(|o| !["screen", "log", "both"].contains(&o.as_str())) {
            return Err(refuse("output", &output, "screen, log or both"));
        }
        let respawn = match text(&p.respawn)?.as_deref() {
            None | Some("false" | "False") => false,
            Some("true" | "True") => true,
            Some(other) => return Err(refuse("respawn", other, "true or false")),
        };
        let node = node.map(|name| NodeKind::named(name, viewers)).transpose();
        let node = node.map_err(|unknown| PlanError::of(&name, format!("there is {unknown}")))?;
        let on_exit = text(&p.on_exit)?;
        if let Some(on_exit) = on_exit.as_deref().filter(|o| *o != "shutdown") {
            return Err(refuse("on_exit", on_exit, "shutdown"));
        }
        let mut environment = self.environment.clone();
        for of in &p.env {
            environment.push((of.name.clone(), self.text(&of.value.0)?));
        }
        Ok(NodePlan { node, program, arguments, respawn, name, environment, ends_all: on_exit.is_some() })
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
