//! The parameter services of one node, asked by this process.

use crate::call::call;
use crate::graph::Graph;
use crate::node::find;
use crate::observer::Observer;
use crate::view::Common;
use grainlab_console::Failure;
use ros2_client::parameters::raw::{ParameterDescriptor, SetParametersResult};
use ros2_client::rcl_interfaces::{
    DescribeParametersRequest, DescribeParametersResponse, GetParametersRequest, GetParametersResponse,
    ListParametersRequest, ListParametersResponse, SetParametersRequest, SetParametersResponse,
};
use ros2_client::{Parameter, ParameterValue};

/// A connection to the domain.
pub(super) struct Client {
    observer: Observer,
    pub(super) graph: Graph,
}

/// A service of the package `rcl_interfaces`.
fn of_interfaces(name: &str) -> (&str, &str) {
    ("rcl_interfaces", name)
}

impl Client {
    pub(super) fn new(common: &Common) -> Result<Self, Failure> {
        let mut observer = Observer::join()?;
        let graph = observer.settled(common.patience());
        Ok(Self { observer, graph })
    }

    /// The full name of a node that is there.
    pub(super) fn node(&self, name: &str) -> Result<String, Failure> {
        find(&self.graph, name).map(|node| node.name.clone())
    }

    /// Whether a node offers parameters.
    pub(super) fn has_parameters(&self, node: &str) -> bool {
        self.graph.services().contains_key(format!("{node}/list_parameters").as_str())
    }

    pub(super) fn list(&mut self, node: &str) -> Result<Vec<String>, Failure> {
        let request = ListParametersRequest { prefixes: Vec::new(), depth: 0 };
        let service = format!("{node}/list_parameters");
        let kind = of_interfaces("ListParameters");
        let answer: ListParametersResponse = call(&mut self.observer, &self.graph, &service, kind, &request)?;
        Ok(answer.result.names)
    }

    pub(super) fn get(&mut self, node: &str, names: &[String]) -> Result<Vec<ParameterValue>, Failure> {
        let request = GetParametersRequest { names: names.to_vec() };
        let service = format!("{node}/get_parameters");
        let kind = of_interfaces("GetParameters");
        let answer: GetParametersResponse = call(&mut self.observer, &self.graph, &service, kind, &request)?;
        Ok(answer.values.into_iter().map(Into::into).collect())
    }

    pub(super) fn describe(
        &mut self,
        node: &str,
        names: &[String],
    ) -> Result<Vec<ParameterDescriptor>, Failure> {
        let request = DescribeParametersRequest { names: names.to_vec() };
        let service = format!("{node}/describe_parameters");
        let kind = of_interfaces("DescribeParameters");
        let answer: DescribeParametersResponse =
            call(&mut self.observer, &self.graph, &service, kind, &request)?;
        Ok(answer.values)
    }

    pub(super) fn set(
        &mut self,
        node: &str,
        name: &str,
        value: ParameterValue,
    ) -> Result<SetParametersResult, Failure> {
        let parameter = Parameter { name: name.to_owned(), value };
        let request = SetParametersRequest { parameter: vec![parameter.into()] };
        let service = format!("{node}/set_parameters");
        let kind = of_interfaces("SetParameters");
        let answer: SetParametersResponse = call(&mut self.observer, &self.graph, &service, kind, &request)?;
        let missing = || Failure::failed(format!("{service} answered without a result"));
        answer.results.into_iter().next().ok_or_else(missing)
    }
}
