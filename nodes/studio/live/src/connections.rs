//! The open connections of the page.

use std::collections::VecDeque;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, Ordering};
use tokio::task::{AbortHandle, JoinSet};

/// The open connections. Connections without a request make room for others.
#[derive(Default)]
pub(crate) struct Connections {
    all: JoinSet<()>,
    /// The connections that have sent no complete request, from the oldest to the newest, and whether they have by now.
    silent: VecDeque<(AbortHandle, Arc<AtomicBool>)>,
}

impl Connections {
    /// Maximum number of connections at a time. A browser takes one to follow, and some more while the page loads.
    pub(crate) const MAX: usize = 64;

    /// Makes room for one more connection, if necessary by the end of the oldest connection that has sent no complete request. Returns
    /// false if every connection has sent one.
    pub(crate) async fn make_room(&mut self) -> bool {
        while self.all.try_join_next().is_some() {}
        self.silent.retain(|(handle, asked)| !asked.load(Ordering::Relaxed) && !handle.is_finished());
        if self.all.len() < Self::MAX {
            return true;
        }
        let Some((oldest, _)) = self.silent.pop_front() else { return false };
        oldest.abort();
        self.all.join_next().await;
        true
    }

    /// Serves a connection, which sets the flag that it gets when it has received a request.
    pub(crate) fn serve<F>(&mut self, connection: impl FnOnce(Arc<AtomicBool>) -> F)
    where
        F: Future<Output = ()> + Send + 'static,
    {
        let asked = Arc::new(AtomicBool::new(false));
        let handle = self.all.spawn(connection(Arc::clone(&asked)));
        self.silent.push_back((handle, asked));
    }
}
