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
