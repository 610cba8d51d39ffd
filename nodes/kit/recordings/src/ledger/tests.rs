use super::*;

const A: Guid = Guid([1; 16]);
const B: Guid = Guid([2; 16]);

fn only(ledger: &Ledger) -> TopicTally {
    let tallies = ledger.tallies();
    assert_eq!(tallies.len(), 1);
    tallies.into_iter().next().unwrap()
}

/// Published, recorded and lost messages of the only topic.
fn counts(ledger: &Ledger) -> (u64, u64, u64) {
    let t = only(ledger);
    (t.published, t.recorded, t.lost)
}

/// A ledger of messages with these numbers; `/image` counts from its first message.
fn entered(topic: &str, numbers: &[i64]) -> Ledger {
    let mut ledger = Ledger::default();
    ledger.count_from_first("/image");
    numbers.iter().for_each(|n| assert!(ledger.enter(topic, A, *n)));
    ledger
}

#[test]
fn a_gap_in_the_middle_is_a_loss_and_a_late_arrival_heals_it() {
    let mut ledger = entered("/stress", &[1, 2, 6, 7]);
    assert_eq!(counts(&ledger), (7, 4, 3));
    assert_eq!(only(&ledger).writers[0].gaps, [(3, 5)]);
    assert!(ledger.enter("/stress", A, 4));
    assert_eq!(only(&ledger).writers[0].gaps, [(3, 3), (5, 5)]);
    assert!(ledger.enter("/stress", A, 3) && ledger.enter("/stress", A, 5));
    let t = only(&ledger);
    assert_eq!((t.lost, t.repeated), (0, 0));
    assert!(t.writers[0].gaps.is_empty());
}

#[test]
fn a_message_that_arrives_twice_is_counted_apart_and_not_as_published() {
    let mut ledger = entered("/stress", &[1, 2]);
    let held = [(A, 1), (A, 3), (B, 1)].map(|(writer, n)| ledger.holds("/stress", &writer, n));
    assert_eq!(held, [true, false, false]);
    assert!(!ledger.enter("/stress", A, 1) && !ledger.enter("/stress", A, 2));
    let t = only(&ledger);
    assert_eq!((t.published, t.recorded, t.lost, t.repeated, t.redelivered), (2, 2, 0, 0, 2));
    // One that is left out was published, and is not lost.
    ledger.leave_out("/stress", A, 3);
    assert_eq!(counts(&ledger), (3, 2, 0));
    let t = only(&ledger);
    let both = &merge(vec![vec![t.clone()], vec![t]])[0];
    assert_eq!((both.published, both.recorded, both.lost), (3, 2, 0));
}

#[test]
fn what_a_writer_sent_before_and_after_is_known_from_its_report_and_its_numbers() {
    // Two messages before the recorder joined, one lost at the end.
    let mut ledger = entered("/packing", &[3, 4, 5]);
    assert_eq!(only(&ledger).lost, 2);
    ledger.report("/packing", A, 6);
    assert_eq!((ledger.outstanding(), counts(&ledger)), (3, (6, 3, 3)));
    let writer = &only(&ledger).writers[0];
    assert_eq!((writer.first, writer.last, writer.reported), (Some(3), Some(5), Some(6)));
    // A late report with a smaller number changes nothing.
    ledger.report("/packing", A, 2);
    assert_eq!(only(&ledger).published, 6);
}

#[test]
fn writers_are_accounted_apart_and_a_silent_topic_appears() {
    let mut ledger = entered("/stress", &[1]);
    ledger.expect("/moduli");
    ledger.enter("/stress", B, 1);
    ledger.report("/stress", B, 1);
    ledger.name(B, "/dem_simulator");
    let t = ledger.tallies();
    assert_eq!((t[0].name.as_str(), t[0].recorded, t[0].published), ("/moduli", 0, 0));
    assert_eq!((t[1].published, t[1].recorded, t[1].lost, t[1].repeated), (2, 2, 0, 0));
    assert_eq!(t[1].writers[1].node.as_deref(), Some("/dem_simulator"));
    assert_eq!(t[1].writers[0].reported, None);
}

#[test]
fn all_messages_of_a_writer_without_received_ones_are_lost() {
    let mut ledger = Ledger::default();
    ledger.report("/stress", A, 40);
    assert_eq!((counts(&ledger), only(&ledger).writers[0].last), ((40, 0, 40), None));
}

#[test]
fn what_a_writer_announced_and_never_sent_is_lost() {
    let mut ledger = entered("/image", &[3, 4]);
    // A late recorder: messages that were offered and replaced before the first one came are not counted.
    ledger.announce("/image", A, Some(1), 20);
    assert_eq!((ledger.outstanding(), counts(&ledger)), (16, (18, 2, 16)));
    ledger.announce("/image", A, Some(1), 3);
    assert_eq!(only(&ledger).published, 18);
}

#[test]
fn a_writer_of_which_nothing_arrived_owes_what_it_offered_and_a_volatile_one_nothing() {
    let mut ledger = entered("/image", &[]);
    ledger.announce("/image", A, None, 20);
    ledger.announce("/image", B, Some(1), 0);
    assert!(ledger.tallies().is_empty());
    ledger.announce("/image", A, Some(18), 20);
    assert_eq!((ledger.outstanding(), counts(&ledger)), (3, (3, 0, 3)));
    // Once a message arrives, the counts begin with it.
    ledger.enter("/image", A, 19);
    assert_eq!(counts(&ledger), (2, 1, 1));
}

#[test]
fn messages_that_cannot_be_received_are_lost_before_between_and_after_others() {
    let mut ledger = entered("/image", &[6, 8]);
    ledger.fail("/image", A, 5, 9);
    ledger.fail("/image", B, 1, 1);
    assert_eq!(counts(&ledger), (6, 2, 4));
    let t = only(&ledger);
    assert_eq!(t.writers[0].gaps, [(5, 5), (7, 7)]);
    assert_eq!(ledger.outstanding(), 0, "nobody waits for them");
    ledger.announce("/image", A, None, 11);
    assert_eq!(ledger.outstanding(), 2);
    assert_eq!(merge(vec![vec![t.clone()]]), [t]);
}

#[test]
fn guids_survive_their_text_and_other_texts_are_refused() {
    let guid = Guid(std::array::from_fn(|i| 17 * i as u8));
    assert_eq!(guid.to_string().parse(), Ok(guid));
    for bad in ["", "00", "+0000000000000000000000000000000", "g0000000000000000000000000000000"] {
        assert!(bad.parse::<Guid>().is_err(), "{bad}");
    }
}

#[test]
fn extreme_numbers_and_a_million_gaps_neither_overflow_nor_fill_the_memory() {
    let mut ledger = Ledger::default();
    for n in [i64::MAX, i64::MAX - 1, i64::MIN, 0, -1, 1] {
        ledger.enter("/stress", A, n);
        ledger.enter("/stress", A, n);
    }
    let t = only(&ledger);
    assert_eq!(t.published, i64::MAX as u64);
    assert!(t.lost > 0 && t.redelivered >= 3, "{t:?}");
    let mut ledger = Ledger::default();
    for n in 1..1_000_000 {
        assert!(ledger.enter("/stress", A, 2 * n));
    }
    let t = only(&ledger);
    assert_eq!((t.recorded, t.lost), (999_999, 999_999));
    assert!(ledger.topics["/stress"][&A].sequence.gaps().count() <= 4096);
    // The lowest gaps were dropped: their numbers, if received later, count as redelivered.
    assert!(!ledger.enter("/stress", A, 1) && ledger.enter("/stress", A, 2 * 999_999 - 1));
}
