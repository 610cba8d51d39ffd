//! The next event: a binary heap of one time per grain, with times that can be changed.

#[derive(Clone, Debug)]
pub(super) struct Queue {
    heap: Vec<(f64, u32)>,
    /// Index of each grain in the heap.
    index_of: Vec<u32>,
}

impl Queue {
    /// One event per grain, at `times`.
    pub(super) fn new(times: impl Iterator<Item = f64>) -> Self {
        let heap: Vec<(f64, u32)> = times.zip(0..).collect();
        let index_of = (0..heap.len() as u32).collect();
        let mut queue = Self { heap, index_of };
        for at in (0..queue.heap.len() / 2).rev() {
            queue.sift_down(at);
        }
        queue
    }

    #[inline(always)]
    pub(super) fn first(&self) -> Option<(f64, u32)> {
        self.heap.first().copied()
    }

    #[inline]
    pub(super) fn set(&mut self, grain: usize, time: f64) {
        let at = self.index_of[grain] as usize;
        let before = self.heap[at].0;
        if time == before {
            return;
        }
        self.heap[at].0 = time;
        if time < before { self.sift_up(at) } else { self.sift_down(at) }
    }

    fn sift_up(&mut self, mut at: usize) {
        let moving = self.heap[at];
        while at > 0 {
            let above = (at - 1) / 2;
            if self.heap[above].0 <= moving.0 {
                break;
            }
            self.put(at, self.heap[above]);
            at = above;
        }
        self.put(at, moving);
    }

    fn sift_down(&mut self, mut at: usize) {
        let moving = self.heap[at];
        loop {
            let mut below = 2 * at + 1;
            if below >= self.heap.len() {
                break;
            }
            // Without a branch: both are equally likely.
            if let [left, right, ..] = self.heap[below..] {
                below += usize::from(right.0 < left.0);
            }
            if self.heap[below].0 >= moving.0 {
                break;
            }
            self.put(at, self.heap[below]);
            at = below;
        }
        self.put(at, moving);
    }

    #[inline(always)]
    fn put(&mut self, at: usize, entry: (f64, u32)) {
        self.heap[at] = entry;
        self.index_of[entry.1 as usize] = at as u32;
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_is_the_least_after_any_change() {
        let mut times: Vec<f64> = (0..97).map(|k| f64::from(k * 37 % 97)).collect();
        let mut queue = Queue::new(times.iter().copied());
        for step in 0..2000 {
            let grain = step * 31 % 97;
            times[grain] = (step * 7919 % 1009) as f64;
            queue.set(grain, times[grain]);
            let least = times.iter().copied().fold(f64::INFINITY, f64::min);
            let (time, first) = queue.first().unwrap();
            assert_eq!((time, times[first as usize]), (least, least));
        }
    }
}
