use std::{
  cmp::{max, min},
  collections::BTreeMap,
};

#[allow(unused_imports)]
use log::{debug, error, info, trace, warn};

use crate::{
  discovery::sedp_messages::DiscoveredWriterData,
  rtps::constant::{
    MAX_MISSING_WINDOW, MAX_PLAUSIBLE_SEQUENCE_JUMP, MAX_TRACKED_RANGES_PER_WRITER,
  },
  structure::{
    duration::Duration,
    guid::{EntityId, GUID},
    locator::Locator,
    sequence_number::SequenceNumber,
    time::Timestamp,
  },
};

#[derive(Debug)] // these are not cloneable, because contained data may be large
pub(crate) struct RtpsWriterProxy {
  /// Identifies the remote matched Writer
  pub remote_writer_guid: GUID,

  /// List of unicast (address, port) combinations that can be used to send
  /// messages to the matched Writer or Writers. The list may be empty.
  pub unicast_locator_list: Vec<Locator>,

  /// List of multicast (address, port) combinations that can be used to send
  /// messages to the matched Writer or Writers. The list may be empty.
  pub multicast_locator_list: Vec<Locator>,

  /// Identifies the group to which the matched Reader belongs
  pub remote_group_entity_id: EntityId,

  // See RTPS Spec v2.5 Section 8.4.10.4 on how the WriterProxy is supposed to
  // operate.
  // And 8.4.10.5 on statuses of the (cache) changes received from a writer.
  // The changes are identified by sequence numbers.
  // Any sequence number is at any moment in one of the following states:
  // unknown, missing, received, not_available.
  //
  // Unknown means that we have no information of that change. This is the initial state for
  // everyone. Missing means that writer claims to have it and reader may request it with
  // ACKNACK. Received means that the reader has received the change via DATA (or DATAFRAGs).
  // Not_available means that writer has informed via GAP message that change is not available.

  // Unknown can transition to Missing (via HEARTBEAT), Received (DATA), or not_available (GAP).
  // Missing can transition to Received or Not_available.
  // Received cannot transition to anything.
  // Not_available cannot transition to anything.

  // We keep a set "accounted" and a sequence number counter "ack_base", to keep
  // track of these.

  // All changes below ack_base are either received or not_available.
  // So are all changes in "accounted", which lie at or above ack_base.
  // All others are missing up to what the last HEARTBEAT announced, and unknown
  // above.

  // Ranges (first, one past last), disjoint and not adjacent. A range costs the
  // same however many sequence numbers a packet claims to be in it.
  accounted: BTreeMap<SequenceNumber, SequenceNumber>,

  // Ranges are dropped when ack_base has passed them.
  pub received_heartbeat_count: i32,

  pub sent_ack_nack_count: i32,

  ack_base: SequenceNumber, // We can ACK everything before this number.
  // ack_base can be increased from N-1 to N, if we receive DATA with SequenceNumber N-1
  // heartbeat(first,last) => ack_base can be increased to first.
  // GAP is treated like receiving a message.

  // These are used for quick tracking of
  last_received_sequence_number: SequenceNumber,
  last_received_timestamp: Timestamp, // monotonic

  // Highest sequence number that the Writer has credibly used, by DATA or
  // HEARTBEAT. `None` until the first of them: a Writer may be old when we match.
  horizon: Option<SequenceNumber>,
  // The HEARTBEAT last refused as implausible.
  implausible_heartbeat: Option<(SequenceNumber, Timestamp)>,
}

impl RtpsWriterProxy {
  pub fn new(
    remote_writer_guid: GUID,
    unicast_locator_list: Vec<Locator>,
    multicast_locator_list: Vec<Locator>,
    remote_group_entity_id: EntityId,
  ) -> Self {
    Self {
      remote_writer_guid,
      unicast_locator_list,
      multicast_locator_list,
      remote_group_entity_id,
      accounted: BTreeMap::new(),
      received_heartbeat_count: 0,
      sent_ack_nack_count: 0,
      // Sequence numbering must start at 1.
      // Therefore, we can ACK all sequence numbers below 1 even before receiving anything.
      ack_base: SequenceNumber::new(1),
      last_received_sequence_number: SequenceNumber::new(0),
      last_received_timestamp: Timestamp::INVALID,
      horizon: None,
      implausible_heartbeat: None,
    }
  }

  pub fn next_ack_nack_sequence_number(&mut self) -> i32 {
    let c = self.sent_ack_nack_count;
    self.sent_ack_nack_count = c.wrapping_add(1);
    c
  }

  // Returns a bound, below which everything can be acknowledged, i.e.
  // is received either as DATA or GAP
  pub fn all_ackable_before(&self) -> SequenceNumber {
    self.ack_base
  }

  pub fn update_contents(&mut self, other: Self) {
    self.unicast_locator_list = other.unicast_locator_list;
    self.multicast_locator_list = other.multicast_locator_list;
    self.remote_group_entity_id = other.remote_group_entity_id;
  }

  // This is used to check for DEADLINE policy
  pub fn last_change_timestamp(&self) -> Option<Timestamp> {
    if self.last_received_sequence_number > SequenceNumber::new(0) {
      Some(self.last_received_timestamp)
    } else {
      None
    }
  }

  // Check if we no samples in the received state.
  pub fn no_changes_received(&self) -> bool {
    self.ack_base == SequenceNumber::new(0) && self.accounted.is_empty()
  }

  /// Is this sequence number within reach of what the Writer has used so far?
  pub fn is_plausible(&self, sn: SequenceNumber) -> bool {
    self.horizon.is_none_or(|horizon| {
      i64::from(sn) <= i64::from(horizon).saturating_add(MAX_PLAUSIBLE_SEQUENCE_JUMP)
    })
  }

  fn extend_horizon(&mut self, sn: SequenceNumber) {
    self.horizon = Some(self.horizon.map_or(sn, |horizon| max(horizon, sn)));
  }

  /// Should a HEARTBEAT be acted on? It should not if it repeats one that was
  /// processed, or if what it announces is out of reach. The latter may still be
  /// true of a Writer that we did not hear for long, so it is believed if a
  /// later HEARTBEAT goes on from there, and no plausible one came in between.
  pub fn accept_heartbeat(
    &mut self,
    first: SequenceNumber,
    last: SequenceNumber,
    count: i32,
    now: Timestamp,
  ) -> bool {
    // Copies of a HEARTBEAT arrive close together. A count far below is a new
    // beginning: otherwise one forged count would silence the Writer.
    let older_by = self.received_heartbeat_count.wrapping_sub(count);
    if self.horizon.is_some() && (0..HEARTBEAT_COUNT_MEMORY).contains(&older_by) {
      return false;
    }
    let highest = max(first, last);
    if !self.is_plausible(highest) {
      let confirmed = self.implausible_heartbeat.is_some_and(|(before, when)| {
        highest >= before
          && i64::from(highest) - i64::from(before) <= MAX_PLAUSIBLE_SEQUENCE_JUMP
          && now.duration_since(when) >= IMPLAUSIBLE_HEARTBEAT_CONFIRMATION
      });
      if !confirmed {
        if self
          .implausible_heartbeat
          .is_none_or(|(before, _)| highest < before)
        {
          self.implausible_heartbeat = Some((highest, now));
        }
        return false;
      }
    }
    self.implausible_heartbeat = None;
    self.received_heartbeat_count = count;
    self.extend_horizon(last);

    // DATA told us of more than the Writer says to have written, and not just now,
    // so it was not from the Writer.
    if last < self.last_received_sequence_number
      && now.duration_since(self.last_received_timestamp) >= IMPLAUSIBLE_HEARTBEAT_CONFIRMATION
    {
      let next = last.saturating_next();
      self.last_received_sequence_number = last;
      self.horizon = Some(last);
      self.ack_base = min(self.ack_base, next);
      self.accounted.split_off(&next);
      if let Some(mut highest) = self.accounted.last_entry() {
        let end = min(*highest.get(), next);
        *highest.get_mut() = end;
      }
    }
    // A GAP told us of more than the Writer says to have. Ask again for what is
    // not there yet. Never for what was received.
    if last.saturating_next() < self.ack_base {
      let after_received = self.last_received_sequence_number.saturating_next();
      self.ack_base = min(self.ack_base, after_received);
      self.accounted = self.accounted.split_off(&self.ack_base);
    }
    true
  }

  // Given an availability range from a HEARTBEAT, find out what we are missing,
  // as far as one ACKNACK can tell: up to MAX_MISSING_WINDOW from the first.
  //
  // Note: Heartbeat gives bounds only. Some samples within that range may
  // have been received already, or not really available, i.e. there may be GAPs
  // in the range.
  pub fn missing_seqnums(
    &self,
    hb_first_sn: SequenceNumber,
    hb_last_sn: SequenceNumber,
  ) -> Vec<SequenceNumber> {
    if hb_first_sn > hb_last_sn {
      if hb_first_sn > hb_last_sn.saturating_next() {
        warn_sparsely!(
          "Negative range of missing_seqnums first={hb_first_sn:?} last={hb_last_sn:?}"
        );
      } else {
        // first == last+1
        // This is normal. See RTPS 2.5 Spec Section "8.3.8.6.3 Validity"
        // It means nothing is available. Since nothing is available, nothing is
        // missing.
      }
      return vec![];
    }

    // The first missing one. Ranges are not adjacent, so at most one is skipped.
    let mut next = max(hb_first_sn, self.ack_base); // ignore those that we already have
    if let Some(end) = self.end_of_range_with(next) {
      next = end;
    }
    if next > hb_last_sn {
      return vec![];
    }
    // one past the last of interest
    let end = min(
      i64::from(hb_last_sn).saturating_add(1),
      i64::from(next).saturating_add(MAX_MISSING_WINDOW),
    );
    let end = SequenceNumber::from(end);

    let mut missing_seqnums = Vec::with_capacity(32); // out of hat value
    let mut known = self.accounted.range(next..end).peekable();
    while next < end {
      match known.peek() {
        Some((&first, &one_past)) if first == next => {
          next = one_past;
          known.next();
        }
        _ => {
          missing_seqnums.push(next);
          next = next.plus_1();
        }
      }
    }
    missing_seqnums
  }

  // One past the end of the range that contains this sequence number, if any.
  fn end_of_range_with(&self, seqnum: SequenceNumber) -> Option<SequenceNumber> {
    self
      .accounted
      .range(..=seqnum)
      .next_back()
      .map(|(_, &end)| end)
      .filter(|&end| end > seqnum)
  }

  // Check if we have already received this sequence number
  // or it has been marked as not_available
  pub fn should_ignore_change(&self, seqnum: SequenceNumber) -> bool {
    seqnum < self.ack_base || self.end_of_range_with(seqnum).is_some()
  }

  // This is used to mark DATA as received.
  pub fn received_changes_add(&mut self, seq_num: SequenceNumber, receive_timestamp: Timestamp) {
    // Update deadline tracker
    if seq_num > self.last_received_sequence_number {
      self.last_received_timestamp = receive_timestamp;
      if self.is_plausible(seq_num) {
        self.last_received_sequence_number = seq_num;
        self.extend_horizon(seq_num);
      }
    }
    self.account_for(seq_num, seq_num.saturating_next());
  }

  // Used to add individual irrelevant changes from GAP message
  pub fn set_irrelevant_change(&mut self, seq_num: SequenceNumber) {
    self.account_for(seq_num, seq_num.saturating_next());
  }

  // Used to add range of irrelevant changes from GAP submessage or unavailable
  // changes from HEARTBEAT submessage
  pub fn irrelevant_changes_range(
    &mut self,
    remove_from: SequenceNumber,
    remove_until_before: SequenceNumber,
  ) {
    // check sanity
    if remove_from > remove_until_before {
      warn_sparsely!(
        "irrelevant_changes_range: negative range: remove_from={remove_from:?} \
         remove_until_before={remove_until_before:?}"
      );
      return;
    }
    self.account_for(remove_from, remove_until_before);
  }

  // Used to mark messages irrelevant because of a HEARTBEAT message.
  //
  // smallest_seqnum is the lowest key to be retained
  pub fn irrelevant_changes_up_to(&mut self, smallest_seqnum: SequenceNumber) {
    if smallest_seqnum > self.ack_base {
      self.irrelevant_changes_range(SequenceNumber::new(0), smallest_seqnum);
    }
  }

  // Everything in begin..end is received or not available.
  fn account_for(&mut self, begin: SequenceNumber, end: SequenceNumber) {
    let begin = max(begin, self.ack_base);
    if begin >= end {
      return;
    }
    if begin == self.ack_base && self.accounted.is_empty() {
      self.ack_base = end; // in order, nothing beyond: the usual case
      return;
    }

    // Merge with ranges that overlap or touch.
    let (mut merged_begin, mut merged_end) = (begin, end);
    while let Some((&first, &one_past)) = self.accounted.range(..=merged_end).next_back() {
      if one_past < begin {
        break;
      }
      merged_begin = min(merged_begin, first);
      merged_end = max(merged_end, one_past);
      self.accounted.remove(&first);
    }
    if merged_begin <= self.ack_base {
      self.ack_base = merged_end;
    } else {
      self.accounted.insert(merged_begin, merged_end);
    }

    // Memory-safety backstop: under best-effort loss `ack_base` can stall at a
    // permanently missing sample while ranges pile up above it. Give up on the
    // oldest missing ones.
    while self.accounted.len() > MAX_TRACKED_RANGES_PER_WRITER {
      if let Some((_, one_past)) = self.accounted.pop_first() {
        self.ack_base = one_past;
      }
    }
  }

  fn discovered_or_default(drd: &[Locator], default: &[Locator]) -> Vec<Locator> {
    if drd.is_empty() {
      default.to_vec()
    } else {
      drd.to_vec()
    }
  }

  pub fn from_discovered_writer_data(
    discovered_writer_data: &DiscoveredWriterData,
    default_unicast_locators: &[Locator],
    default_multicast_locators: &[Locator],
  ) -> RtpsWriterProxy {
    let unicast_locator_list = Self::discovered_or_default(
      &discovered_writer_data.writer_proxy.unicast_locator_list,
      default_unicast_locators,
    );
    let multicast_locator_list = Self::discovered_or_default(
      &discovered_writer_data.writer_proxy.multicast_locator_list,
      default_multicast_locators,
    );

    RtpsWriterProxy {
      remote_writer_guid: discovered_writer_data.writer_proxy.remote_writer_guid,
      remote_group_entity_id: EntityId::UNKNOWN,
      unicast_locator_list,
      multicast_locator_list,
      accounted: BTreeMap::new(),
      received_heartbeat_count: 0,
      sent_ack_nack_count: 0,
      ack_base: SequenceNumber::default(),
      last_received_sequence_number: SequenceNumber::new(0),
      last_received_timestamp: Timestamp::INVALID,
      horizon: None,
      implausible_heartbeat: None,
    }
  } // fn

  #[cfg(test)]
  pub fn tracked_ranges_count(&self) -> usize {
    self.accounted.len()
  }
} // impl

// How far back a HEARTBEAT's count counts as a copy of one already processed.
const HEARTBEAT_COUNT_MEMORY: i32 = 1024;

// A HEARTBEAT out of reach has to be repeated after this long to be believed.
const IMPLAUSIBLE_HEARTBEAT_CONFIRMATION: Duration = Duration::from_secs(1);

#[cfg(test)]
mod bounded_map_tests {
  use super::*;
  use crate::structure::guid::GuidPrefix;

  fn test_proxy() -> RtpsWriterProxy {
    RtpsWriterProxy::new(
      GUID::new(GuidPrefix::UNKNOWN, EntityId::UNKNOWN),
      vec![],
      vec![],
      EntityId::UNKNOWN,
    )
  }

  // Regression: a best-effort writer sends no HEARTBEAT/GAP, so the changes map
  // used to accumulate one entry per received sample forever. With eager pruning
  // below ack_base, contiguous delivery must keep the map ~empty.
  #[test]
  fn changes_map_does_not_grow_on_contiguous_delivery() {
    let mut wp = test_proxy();
    let n: i64 = 50_000;
    for i in 1..=n {
      wp.received_changes_add(SequenceNumber::new(i), Timestamp::INVALID);
    }
    // Everything received in order: ack_base advanced past the last sample.
    assert_eq!(wp.all_ackable_before(), SequenceNumber::new(n + 1));
    assert!(
      wp.tracked_ranges_count() <= 1,
      "changes map grew unbounded on contiguous delivery: {} entries",
      wp.tracked_ranges_count()
    );
  }

  // Regression: with a permanently missing sample (best-effort loss) ack_base
  // stalls, so pruning below it is not enough. The hard cap must still bound the
  // map by giving up on the stalled gap.
  #[test]
  fn changes_map_bounded_with_permanent_gap() {
    let mut wp = test_proxy();
    // Every odd sample is lost.
    let n: i64 = MAX_TRACKED_RANGES_PER_WRITER as i64 * 4;
    for i in 1..=n {
      wp.received_changes_add(SequenceNumber::new(2 * i), Timestamp::INVALID);
    }
    assert!(
      wp.tracked_ranges_count() <= MAX_TRACKED_RANGES_PER_WRITER,
      "changes map exceeded cap {} under a permanent gap: {} entries",
      MAX_TRACKED_RANGES_PER_WRITER,
      wp.tracked_ranges_count()
    );
  }
  fn sn(n: i64) -> SequenceNumber {
    SequenceNumber::new(n)
  }

  fn missing(wp: &RtpsWriterProxy, first: i64, last: i64) -> Vec<i64> {
    let missing = wp.missing_seqnums(sn(first), sn(last));
    missing.into_iter().map(i64::from).collect()
  }

  fn at(seconds: u32) -> Timestamp {
    Timestamp::from_ticks(u64::from(seconds) << 32)
  }

  #[test]
  fn what_is_missing_does_not_depend_on_the_order_of_arrival() {
    let arrivals: [&[i64]; 3] = [&[1, 3, 4, 7], &[7, 4, 3, 1], &[3, 7, 1, 4]];
    for order in arrivals {
      let mut wp = test_proxy();
      for &i in order {
        wp.received_changes_add(sn(i), Timestamp::INVALID);
      }
      wp.irrelevant_changes_range(sn(6), sn(7));
      assert_eq!(missing(&wp, 1, 9), vec![2, 5, 8, 9]);
      assert_eq!(wp.all_ackable_before(), sn(2));
      assert!(wp.should_ignore_change(sn(4)) && !wp.should_ignore_change(sn(5)));
      wp.received_changes_add(sn(2), Timestamp::INVALID);
      assert_eq!(wp.all_ackable_before(), sn(5));
      wp.received_changes_add(sn(5), Timestamp::INVALID);
      assert_eq!(wp.all_ackable_before(), sn(8));
      assert_eq!(wp.tracked_ranges_count(), 0);
    }
  }

  #[test]
  fn a_huge_claim_costs_no_more_than_a_small_one() {
    let mut wp = test_proxy();
    assert_eq!(missing(&wp, 1, i64::MAX).len() as i64, MAX_MISSING_WINDOW);
    wp.irrelevant_changes_range(sn(10), sn(200_000_000));
    assert_eq!(wp.tracked_ranges_count(), 1);
    assert_eq!(missing(&wp, 1, i64::MAX), (1..10).collect::<Vec<_>>());
    wp.irrelevant_changes_range(sn(1), sn(i64::MAX));
    wp.received_changes_add(sn(i64::MAX), Timestamp::INVALID);
    assert!(missing(&wp, i64::MAX, i64::MAX).len() <= 1);
  }

  #[test]
  fn a_forged_heartbeat_is_refused_and_the_true_ones_go_on() {
    let mut wp = test_proxy();
    assert!(wp.accept_heartbeat(sn(1), sn(10), 1, at(0)));
    assert!(!wp.accept_heartbeat(sn(1), sn(10), 1, at(0)), "a copy");
    assert!(!wp.accept_heartbeat(sn(1), sn(1 << 40), i32::MAX, at(1)));
    assert!(!wp.accept_heartbeat(sn(1 << 40), sn(1 << 40), 7, at(1)));
    assert!(wp.accept_heartbeat(sn(1), sn(11), 2, at(3)));
    // plausible but for its count
    assert!(wp.accept_heartbeat(sn(1), sn(11), i32::MAX, at(3)));
    assert!(wp.accept_heartbeat(sn(1), sn(12), 3, at(3)));
    assert!(
      !wp.accept_heartbeat(sn(1), sn(1 << 40), 4, at(9)),
      "not confirmed"
    );
  }

  #[test]
  fn a_writer_not_heard_for_long_is_believed_the_second_time() {
    let mut wp = test_proxy();
    assert!(wp.accept_heartbeat(sn(1), sn(10), 1, at(0)));
    let far = 10 * MAX_PLAUSIBLE_SEQUENCE_JUMP;
    assert!(!wp.accept_heartbeat(sn(far), sn(far + 10), 900, at(60)));
    assert!(wp.accept_heartbeat(sn(far), sn(far + 20), 901, at(62)));
  }

  #[test]
  fn forged_data_far_ahead_is_undone_by_the_writers_heartbeat() {
    let mut wp = test_proxy();
    assert!(wp.accept_heartbeat(sn(1), sn(3), 1, at(0)));
    for i in [1, 2, 3, 300_000] {
      wp.received_changes_add(sn(i), at(1));
    }
    wp.irrelevant_changes_range(sn(4), sn(300_000));
    assert!(wp.should_ignore_change(sn(4)));
    assert!(wp.accept_heartbeat(sn(1), sn(4), 2, at(3)));
    assert_eq!(wp.all_ackable_before(), sn(5));
    assert!(!wp.should_ignore_change(sn(5)) && wp.should_ignore_change(sn(3)));
  }

  #[test]
  fn a_forged_gap_is_undone_by_the_writers_heartbeat() {
    let mut wp = test_proxy();
    for i in 1..=5 {
      wp.received_changes_add(sn(i), Timestamp::INVALID);
    }
    assert!(wp.is_plausible(sn(1000)) && !wp.is_plausible(sn(200_000_000)));
    wp.irrelevant_changes_range(sn(6), sn(1000));
    assert!(wp.should_ignore_change(sn(6)));
    assert!(wp.accept_heartbeat(sn(1), sn(7), 1, at(0)));
    assert_eq!(missing(&wp, 1, 7), vec![6, 7]);
    assert!(!wp.should_ignore_change(sn(8)), "the next sample is heard");
    assert!(
      wp.should_ignore_change(sn(5)),
      "what was received is not taken twice"
    );
  }
}
