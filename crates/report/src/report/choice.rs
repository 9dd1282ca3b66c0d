//! Choices that a person makes by name, with what help says of them.

/// A closed list of values with their names and sentences, from which options of the command line are made.
pub trait Choice: Copy + Send + Sync + 'static {
    /// Each value with its names, of which help shows the first, and its sentence.
    const ALL: &'static [(Self, &'static [&'static str], &'static str)];
}

/// Defines an enum, its names as [`named`](springfit_foundation::named!) does, and its list of choices. The documentation of a variant is its
/// sentence.
macro_rules! choices {
    (
        $(#[$of_all:meta])*
        pub enum $choice:ident {
            $(#[doc = $sentence:literal] $(#[$more:meta])* $variant:ident = $name:literal $(| $alias:literal)*,)+
        }
    ) => {
        $(#[$of_all])*
        pub enum $choice {
            $(#[doc = $sentence] $(#[$more])* $variant,)+
        }

        springfit_foundation::named!($choice { $($name => $variant),+ });

        impl $crate::report::choice::Choice for $choice {
            const ALL: &'static [(Self, &'static [&'static str], &'static str)] =
                &[$(($choice::$variant, &[$name $(, $alias)*], $sentence)),+];
        }
    };
}

pub(super) use choices;
