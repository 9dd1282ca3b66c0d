//! Choices that a person makes by name.

/// A closed list of values with their names and sentences, from which help, parsers and errors are made.
pub trait Choice: Copy + PartialEq + Send + Sync + 'static {
    /// Each value with its names, of which help shows the first, and its sentence.
    const ALL: &'static [(Self, &'static [&'static str], &'static str)];

    /// The value with this name, if there is one.
    fn named(name: &str) -> Option<Self> {
        Self::ALL.iter().find(|(_, names, _)| names.contains(&name)).map(|(value, _, _)| *value)
    }

    /// The first name.
    fn name(self) -> &'static str {
        let row = Self::ALL.iter().find(|(value, _, _)| *value == self);
        row.expect("the list has every value").1[0]
    }
}

/// Defines an enum and its list of choices. The documentation of a variant is its sentence.
macro_rules! choices {
    (
        $(#[$of_all:meta])*
        pub enum $choice:ident {
            $(#[doc = $sentence:literal] $(#[$more:meta])* $variant:ident = $($name:literal)|+,)+
        }
    ) => {
        $(#[$of_all])*
        pub enum $choice {
            $(#[doc = $sentence] $(#[$more])* $variant,)+
        }

        impl $crate::report::choice::Choice for $choice {
            const ALL: &'static [(Self, &'static [&'static str], &'static str)] =
                &[$(($choice::$variant, &[$($name),+], $sentence)),+];
        }
    };
}

pub(super) use choices;
