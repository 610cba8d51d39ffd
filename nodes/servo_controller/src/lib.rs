//! The servo node: answers every stress with a strain rate.
