//! The run that a process belongs to.
//!
//! Each run has a new id. Every process of the run has the id in the GUID prefix of its DDS participant,
//! so that the writer of a sample identifies the run: without a byte in any message, from the first sample on, and
//! for best-effort readers, too. There are two alternatives. A partition would hide the topics from ROS 2 tools, which
//! cannot join one. The user data of a participant arrive with discovery, later than the first best-effort samples.

use std::collections::hash_map::RandomState;
use std::fmt;
use std::hash::{BuildHasher, Hasher};
use std::time::SystemTime;

/// Environment variable with the run: 12 hexadecimal digits, or any other text, from which an id is derived.
pub const RUN_VARIABLE: &str = "GRAINLAB_RUN";

/// Environment variable with the member number of a process in its run, 1 to 254: the same after a restart.
pub const MEMBER_VARIABLE: &str = "GRAINLAB_MEMBER";

/// Environment variable with the process id of the launcher: its descendants belong to the run, whatever DDS they use.
pub const ROOT_VARIABLE: &str = "GRAINLAB_RUN_ROOT";

/// The vendor id of RustDDS, the first bytes of each GUID prefix.
const VENDOR: [u8; 2] = [0x01, 0x12];

/// Identity of one run: 48 bits, of which the first eight are not all zero.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct RunId([u8; 6]);

impl RunId {
    /// A new random id.
    pub fn fresh() -> Self {
        Self::of_bits(random())
    }

    /// The run with the name `text`: 12 hexadecimal digits, or any other text, from which an id is derived.
    pub fn named(text: &str) -> Self {
        let digits = text.len() == 12 && text.bytes().all(|b| b.is_ascii_hexdigit());
        let bits = u64::from_str_radix(text, 16).ok().filter(|bits| digits && bits >> 40 != 0);
        match bits.map(u64::to_be_bytes) {
            Some([_, _, id @ ..]) => Self(id),
            None => Self::of_bits(fnv1a(text.as_bytes())),
        }
    }

    fn of_bits(bits: u64) -> Self {
        let [first, rest @ ..] = bits.to_le_bytes();
        Self([first.max(1), rest[0], rest[1], rest[2], rest[3], rest[4]])
    }
}

/// 12 hexadecimal digits.
impl fmt::Display for RunId {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        self.0.iter().try_for_each(|byte| write!(f, "{byte:02x}"))
    }
}

/// Whose samples a process accepts.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Scope {
    /// All samples: a tool, or a node started by hand.
    #[default]
    Everyone,
    /// Only those of its own run: of the processes with its run id, or, without one, of those that have none.
    OwnRun,
}

/// The place of a process in its run.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Identity {
    /// The run; `None` for a process that was started by hand.
    pub run: Option<RunId>,
    /// Member number, 1 to 254; 0 for none.
    pub member: u8,
    /// Process id of the launcher.
    pub root: Option<u32>,
    /// Whose samples it accepts.
    pub scope: Scope,
}

impl Identity {
    /// The identity of this process, from its environment. A process of a run accepts the samples of that run; one
    /// without a run accepts those of `otherwise`.
    pub fn from_env(otherwise: Scope) -> Self {
        Self::from_variables(otherwise, |name| std::env::var(name).ok())
    }

    /// Reads the identity from any source of variables; an empty one counts as unset.
    pub fn from_variables(otherwise: Scope, lookup: impl Fn(&str) -> Option<String>) -> Self {
        let get = |name: &str| lookup(name).filter(|value| !value.is_empty());
        let run = get(RUN_VARIABLE).map(|text| RunId::named(&text));
        let Some(run) = run else { return Self { scope: otherwise, ..Self::default() } };
        Self {
            run: Some(run),
            member: get(MEMBER_VARIABLE).and_then(|text| text.parse().ok()).unwrap_or(0),
            root: get(ROOT_VARIABLE).and_then(|text| text.parse().ok()),
            scope: Scope::OwnRun,
        }
    }

    /// The identity of a member of a run.
    pub fn member_of(run: RunId, member: u8) -> Self {
        Self { run: Some(run), member, root: None, scope: Scope::OwnRun }
    }

    /// A GUID prefix for a participant of this process: vendor, run, member, two random bytes that differ at each
    /// start, and a check byte. Without a run: vendor, zero, and nine random bytes.
    pub fn guid_prefix(&self) -> [u8; 12] {
        let chance = [random(), random()].map(u64::to_le_bytes).concat();
        self.guid_prefix_with(std::array::from_fn(|i| chance[i]))
    }

    /// A GUID prefix with given bytes in place of random ones; a member of a run uses two of them.
    pub(crate) fn guid_prefix_with(&self, chance: [u8; 9]) -> [u8; 12] {
        let mut prefix = [0; 12];
        prefix[..2].copy_from_slice(&VENDOR);
        match self.run {
            Some(run) => {
                prefix[2..8].copy_from_slice(&run.0);
                prefix[8] = self.member;
                prefix[9..11].copy_from_slice(&chance[7..]);
                prefix[11] = check(&prefix);
            }
            None => prefix[3..].copy_from_slice(&chance),
        }
        prefix
    }
}

/// The run in a participant's GUID prefix; `None` without a run and for other software.
pub fn run_of(prefix: &[u8; 12]) -> Option<RunId> {
    // Other programs with RustDDS have random bytes there.
    let has_run = prefix[..2] == VENDOR && prefix[2] != 0 && prefix[11] == check(prefix);
    has_run.then(|| RunId(std::array::from_fn(|i| prefix[2 + i])))
}

/// True if a participant may be one of this program, in a run or by hand; another program has such a prefix by chance, one of 256
/// with RustDDS.
pub fn may_be_ours(prefix: &[u8; 12]) -> bool {
    run_of(prefix).is_some() || (prefix[..2] == VENDOR && prefix[2] == 0)
}

/// The check byte of the eleven bytes before it.
fn check(prefix: &[u8; 12]) -> u8 {
    fnv1a(&prefix[..11]) as u8
}

/// The member number of a participant.
pub fn member_of(prefix: &[u8; 12]) -> u8 {
    prefix[8]
}

/// Random bits, different for each call and process.
fn random() -> u64 {
    let mut hasher = RandomState::new().build_hasher();
    hasher.write_u32(std::process::id());
    hasher.write_u128(SystemTime::now().duration_since(SystemTime::UNIX_EPOCH).map_or(0, |t| t.as_nanos()));
    hasher.finish()
}

/// The FNV-1a hash, the same in every process and release.
fn fnv1a(bytes: &[u8]) -> u64 {
    bytes.iter().fold(0xcbf2_9ce4_8422_2325, |hash, byte| {
        (hash ^ u64::from(*byte)).wrapping_mul(0x0000_0100_0000_01b3)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_prefix_of_a_member_has_run_and_number_and_differs_at_each_start() {
        let run = RunId::fresh();
        let identity = Identity::member_of(run, 3);
        let (a, b) = (identity.guid_prefix(), identity.guid_prefix());
        assert_ne!(a, b);
        for prefix in [a, b] {
            assert_eq!((run_of(&prefix), member_of(&prefix)), (Some(run), 3));
        }
        assert_eq!(run_of(&Identity::default().guid_prefix()), None);
        assert_eq!(run_of(&[0x01, 0x10, 9, 9, 9, 9, 9, 9, 1, 1, 1, 1]), None, "another vendor's");
        assert!(may_be_ours(&a) && may_be_ours(&Identity::default().guid_prefix()));
        assert!(!may_be_ours(&[0x01, 0x10, 9, 9, 9, 9, 9, 9, 1, 1, 1, 1]));
        let random = (0..=255).map(|last| [0x01, 0x12, 9, 9, 9, 9, 9, 9, 1, 1, 1, last]);
        assert_eq!(
            random.filter(|prefix| run_of(prefix).is_some()).count(),
            1,
            "other software with RustDDS"
        );
    }

    #[test]
    fn a_run_id_reads_back_from_its_digits_and_any_text_names_a_run() {
        let run = RunId::fresh();
        assert_eq!(RunId::named(&run.to_string()), run);
        assert_eq!(RunId::named("left"), RunId::named("left"));
        assert_ne!(RunId::named("left"), RunId::named("right"));
        for name in ["", "00ffffffffff", "+12345678901", "12345678901", "xx3456789012"] {
            assert_ne!(RunId::named(name).to_string(), name, "not an id");
        }
    }

    #[test]
    fn the_environment_names_run_place_and_root() {
        let variables = |name: &str| match name {
            RUN_VARIABLE => Some("left".to_owned()),
            MEMBER_VARIABLE => Some("4".to_owned()),
            ROOT_VARIABLE => Some("77".to_owned()),
            _ => None,
        };
        let identity = Identity::from_variables(Scope::Everyone, variables);
        let expected = Identity { root: Some(77), ..Identity::member_of(RunId::named("left"), 4) };
        assert_eq!(identity, expected);
        let by_hand = Identity::from_variables(Scope::Everyone, |_| None);
        assert_eq!(by_hand, Identity::default());
    }
}
