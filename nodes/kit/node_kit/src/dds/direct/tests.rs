use super::*;

#[test]
fn a_body_comes_back_with_the_header_it_travelled_with() {
    for (encoding, header) in
        [(RepresentationIdentifier::CDR_LE, [0, 1, 0, 0]), (RepresentationIdentifier::CDR_BE, [0, 0, 0, 0])]
    {
        let Ok(body) = KeepBytes.decode_bytes(&[7, 8], encoding);
        assert_eq!(body.0[..4], header);
        assert_eq!(body.0[4..], [7, 8]);
    }
}

#[test]
fn rtps_ticks_become_nanoseconds_to_half_a_tick() {
    for (ticks, expected) in [(0, 0), (1 << 32, 1_000_000_000), ((5 << 32) | (1 << 31), 5_500_000_000)] {
        assert_eq!(nanos(Timestamp::from_ticks(ticks)), expected);
    }
}

#[test]
fn qos_that_does_not_fit_is_named_by_its_policies_with_what_to_type() {
    let [strict, loose] = [true, false].map(|both| policies(both, both, 5, 10));
    let durability = "durability, requested transient_local, offered volatile (--qos-durability transient_local or volatile)";
    let both = format!(
        "reliability, requested reliable, offered best_effort (--qos-reliability reliable or best_effort); {durability}"
    );
    assert_eq!(unfit(&strict, &loose), both);
    assert_eq!(unfit(&strict, &policies(true, false, 5, 10)), durability);
}
