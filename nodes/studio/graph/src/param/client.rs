//! The parameter services of one node, asked by this process.

use crate::call::call;
use crate::graph::Graph;
use crate::names::absolute;
use crate::node::find;
use crate::observer::Observer;
use crate::view::Common;
use grainlab_console::Failure;
use ros2_client::parameters::raw::SetParametersResult;
use ros2_client::rcl_interfaces::{
    GetParametersRequest, GetParametersResponse, ListParametersRequest, ListParametersResponse,
    SetParametersRequest, SetParametersResponse,
};
use ros2_client::{Message, Parameter, ParameterValue};

/// A connection to the domain.
pub(super) struct Client {
    observer: Observer,
    pub(super) graph: Graph,
}

impl Client {
    pub(super) fn new(common: &Common, is_there: impl Fn(&Graph) -> bool) -> Result<Self, Failure> {
        let mut observer = Observer::join()?;
        let graph = observer.with(common.patience(), is_there);
        Ok(Self { observer, graph })
    }

    /// A connection, and the full name of a node that is there.
    pub(super) fn of(common: &Common, name: &str) -> Result<(Self, String), Failure> {
        let service = format!("{}/list_parameters", absolute(name));
        let client = Self::new(common, |graph| graph.services().contains_key(service.as_str()))?;
        let name = find(&client.graph, name)?.name.clone();
        Ok((client, name))
    }

    pub(super) fn has_parameters(&self, node: &str) -> bool {
        self.graph.services().contains_key(format!("{node}/list_parameters").as_str())
    }

    fn ask<Req: Message + Clone + 'static, Resp: Message + 'static>(
        &mut self,
        service: &str,
        kind: &str,
        request: &Req,
    ) -> Result<Resp, Failure> {
        call(&mut self.observer, &self.graph, service, kind, request)
    }

    pub(super) fn list(&mut self, node: &str) -> Result<Vec<String>, Failure> {
        let request = ListParametersRequest { prefixes: Vec::new(), depth: 0 };
        let service = format!("{node}/list_parameters");
        self.ask(&service, "ListParameters", &request).map(|a: ListParametersResponse| a.result.names)
    }

    pub(super) fn get(&mut self, node: &str, names: &[String]) -> Result<Vec<ParameterValue>, Failure> {
        let request = GetParametersRequest { names: names.to_vec() };
        let answer: GetParametersResponse =
            self.ask(&format!("{node}/get_parameters"), "GetParameters", &request)?;
        Ok(answer.values.into_iter().map(Into::into).collect())
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
        let answer: SetParametersResponse = self.ask(&service, "SetParameters", &request)?;
        let missing = || Failure::failed(format!("{service} answered without a result"));
        answer.results.into_iter().next().ok_or_else(missing)
    }
}
