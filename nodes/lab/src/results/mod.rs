//! What commands find, in the forms in which it is printed and stored.

pub(crate) mod inference;
