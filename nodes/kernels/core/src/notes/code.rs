//! The codes of notes, with their sentences.

use super::shown::Shown;
use super::status::Status;
use super::table::with_table;
use std::borrow::Cow;

macro_rules! codes {
    ($($(#[$doc:meta])* $variant:ident $code:ident $status:ident [$($subject:ident)*] ($($number:ident)*) $text:expr;)+) => {
        /// The notes of this program.
        #[derive(Clone, Copy, Debug, PartialEq, Eq)]
        pub enum Code {
            $($(#[$doc])* $variant,)+
        }

        impl Code {
            /// Every note of this program.
            pub const ALL: &[Self] = &[$(Self::$variant,)+];

            /// Returns the code in messages and JSON.
            pub const fn name(self) -> &'static str {
                match self { $(Self::$variant => stringify!($code),)+ }
            }

            /// Returns the status that the note gives an estimate.
            pub const fn severity(self) -> Status {
                match self { $(Self::$variant => Status::$status,)+ }
            }

            /// Returns the names of the numbers, in the order of [`Note::values`](super::Note::values).
            pub const fn numbers(self) -> &'static [&'static str] {
                match self { $(Self::$variant => &[$(stringify!($number),)*],)+ }
            }

            pub(super) const fn subjects(self) -> &'static [&'static str] {
                match self { $(Self::$variant => &[$(stringify!($subject),)*],)+ }
            }

            pub(super) fn text(self, subjects: &[Cow<'static, str>], numbers: &[Shown]) -> String {
                match self {
                    $(Self::$variant => {
                        let ([$($subject,)*], [$($number,)*]) = (subjects, numbers) else { return String::new() };
                        $(let $number = *$number;)*
                        String::from($text)
                    })+
                }
            }
        }
    };
}

with_table!(codes);

fn counted(contacts: Shown, one: &str, many: &str) -> String {
    if contacts == Shown::from(1.0) {
        format!("1 contact {one}")
    } else {
        format!("{contacts} contacts {many}")
    }
}

impl Code {
    /// Returns the note of this program with this code.
    pub fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().copied().find(|code| code.name() == name)
    }

    pub(super) fn fits(self, subjects: usize, values: usize) -> bool {
        (self.subjects().len(), self.numbers().len()) == (subjects, values)
    }
}
