//! Merges the counts of several recorders of one run: a resumed run is recorded by one recorder after
//! another.

use std::collections::BTreeMap;

use super::tally::{LISTED_GAPS, TopicTally, WriterTally};

/// Merges counts, in the order of their recorders. A writer that several of them received is counted once.
pub fn merge(accounts: Vec<Vec<TopicTally>>) -> Vec<TopicTally> {
    let mut topics = BTreeMap::<String, BTreeMap<String, WriterTally>>::new();
    for topic in accounts.into_iter().flatten() {
        let writers = topics.entry(topic.name).or_default();
        for writer in topic.writers {
            let both = match writers.remove(&writer.guid) {
                Some(earlier) => of_one_writer(&earlier, &writer),
                None => writer,
            };
            writers.insert(both.guid.clone(), both);
        }
    }
    topics.into_iter().map(|(name, writers)| topic(name, writers.into_values().collect())).collect()
}

pub(super) fn topic(name: String, writers: Vec<WriterTally>) -> TopicTally {
    let sum = |of: fn(&WriterTally) -> u64| writers.iter().map(of).fold(0u64, u64::saturating_add);
    TopicTally {
        name,
        published: sum(published),
        recorded: sum(|w| w.recorded),
        lost: sum(|w| w.lost),
        repeated: sum(|w| w.repeated),
        conflicting: sum(|w| w.conflicting),
        redelivered: sum(|w| w.redelivered),
        writers,
    }
}

fn received(w: &WriterTally) -> u64 {
    [w.repeated, w.conflicting, w.left_out].into_iter().fold(w.recorded, u64::saturating_add)
}

fn published(w: &WriterTally) -> u64 {
    received(w).saturating_add(w.lost)
}

/// Merges the counts of one writer by two recorders, one after the other or at the same time.
fn of_one_writer(a: &WriterTally, b: &WriterTally) -> WriterTally {
    let published = published(a).max(published(b));
    let gaps = common(&missing(a), &missing(b));
    let last = a.last.max(b.last);
    let each = received(a).saturating_add(received(b));
    // Both may have received a message; if all gaps are listed, they give the number missing in both.
    let listed = a.gaps.len() < LISTED_GAPS && b.gaps.len() < LISTED_GAPS;
    let below: u64 =
        gaps.iter().map(|(from, to)| to.abs_diff(*from).saturating_add(1)).fold(0, u64::saturating_add);
    let behind = published.saturating_sub(last.unwrap_or(0).max(0) as u64);
    let lost =
        if listed { below.saturating_add(behind).min(published) } else { published.saturating_sub(each) };
    let first = [a.first, b.first].into_iter().flatten().min();
    let received = published - lost;
    let repeated = a.repeated.saturating_add(b.repeated).min(received);
    let conflicting = a.conflicting.saturating_add(b.conflicting).min(received - repeated);
    // Left out by both, or by one after the other: no more are recorded than by each.
    let kept = received - repeated - conflicting;
    let neither = kept.saturating_sub(a.recorded.saturating_add(b.recorded));
    let left_out =
        neither.max(a.left_out.max(b.left_out)).min(a.left_out.saturating_add(b.left_out)).min(kept);
    WriterTally {
        guid: a.guid.clone(),
        node: b.node.clone().or_else(|| a.node.clone()),
        recorded: kept - left_out,
        reported: a.reported.max(b.reported),
        first,
        last,
        failed: [a.failed, b.failed].into_iter().flatten().min(),
        lost,
        gaps: gaps.into_iter().take(LISTED_GAPS).collect(),
        repeated,
        conflicting,
        left_out,
        redelivered: a
            .redelivered
            .saturating_add(b.redelivered)
            .saturating_add(each.saturating_sub(received)),
    }
}

/// Ranges of numbers that one recorder does not have: its gaps, and all after its last.
fn missing(w: &WriterTally) -> Vec<(i64, i64)> {
    let behind = w.last.map_or(1, |last| last.saturating_add(1));
    w.gaps.iter().copied().chain([(behind, i64::MAX)]).collect()
}

/// The intersection of two sorted lists of ranges, without the unbounded range.
fn common(a: &[(i64, i64)], b: &[(i64, i64)]) -> Vec<(i64, i64)> {
    let (mut i, mut k, mut found) = (0, 0, Vec::new());
    while let (Some(x), Some(y)) = (a.get(i), b.get(k)) {
        let (from, to) = (x.0.max(y.0), x.1.min(y.1));
        if from <= to && to < i64::MAX {
            found.push((from, to));
        }
        if x.1 <= y.1 {
            i += 1;
        } else {
            k += 1;
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::ledger::Ledger;
    use grainlab_msgs::Guid;

    const A: Guid = Guid([1; 16]);
    const B: Guid = Guid([2; 16]);

    fn account(entries: &[(Guid, &[i64])], report: Option<u64>) -> Vec<TopicTally> {
        let mut ledger = Ledger::default();
        for (guid, numbers) in entries {
            numbers.iter().for_each(|n| _ = ledger.enter("/stress", *guid, *n));
            report.into_iter().for_each(|n| ledger.report("/stress", *guid, n));
        }
        ledger.tallies()
    }

    #[test]
    fn recorders_of_different_writers_add_up() {
        let both = merge(vec![account(&[(A, &[1, 2, 3])], Some(4)), account(&[(B, &[1, 2])], Some(2))]);
        assert_eq!((both[0].published, both[0].recorded, both[0].lost), (6, 5, 1));
        assert_eq!(both[0].writers.len(), 2);
    }

    #[test]
    fn what_a_second_recorder_missed_and_the_first_has_is_not_lost() {
        let both = merge(vec![account(&[(A, &[1, 2, 4])], None), account(&[(A, &[7, 8, 10])], Some(11))]);
        let w = &both[0].writers[0];
        assert_eq!(w.gaps, [(3, 3), (5, 6), (9, 9)]);
        assert_eq!((both[0].published, both[0].recorded, both[0].lost), (11, 6, 5));
        assert_eq!((w.first, w.last, w.reported), (Some(1), Some(10), Some(11)));
    }

    #[test]
    fn what_both_recorded_is_one_message_that_was_delivered_twice() {
        let both = merge(vec![account(&[(A, &[1, 2, 3])], None), account(&[(A, &[2, 3, 4])], None)]);
        let t = &both[0];
        assert_eq!((t.published, t.recorded, t.lost, t.repeated, t.redelivered), (4, 4, 0, 0, 2));
    }

    #[test]
    fn one_account_stays_as_it_is() {
        let one = account(&[(A, &[1, 4]), (B, &[2])], Some(6));
        assert_eq!(merge(vec![one.clone()]), one);
    }

    #[test]
    fn published_is_what_was_recorded_repeated_and_lost() {
        let mut ledger = Ledger::default();
        [1, 2, 2, 5].iter().for_each(|n| _ = ledger.enter("/stress", A, *n));
        ledger.repeat("/stress", A, 6);
        ledger.conflict("/stress", B, 1);
        let one = ledger.tallies();
        assert_eq!(merge(vec![one.clone()]), one);
        let both = merge(vec![one, account(&[(A, &[5, 7])], Some(9))]);
        let t = &both[0];
        assert_eq!((t.published, t.recorded, t.repeated, t.lost, t.redelivered), (10, 4, 1, 4, 2));
        assert_eq!(t.conflicting, 1, "what contradicts a message stays in the counts when a run is resumed");
        assert!(
            t.dispute().is_some_and(|line| line.contains(&B.to_string()) && line.contains(&A.to_string()))
        );
    }
}
