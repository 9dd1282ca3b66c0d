//! Closed lists of names that are both read and printed.

/// `NAMES`, `all()`, `name()` and `named(text)` of an enum, from one list of names and values.
///
/// A variant with fields has the values of its fields after its name: they are what the name alone stands for.
/// A variant without a name does not compile.
#[doc(hidden)]
#[macro_export]
macro_rules! named {
    ($type:ident { $($name:literal => $variant:ident $({ $($field:tt : $value:expr),+ })?),+ $(,)? }) => {
        // Not every list is used in every way.
        #[allow(dead_code)]
        impl $type {
            /// The names, as files, options and reports have them.
            pub const NAMES: &'static [&'static str] = &[$($name),+];

            /// The values, in the order of the names.
            pub fn all() -> impl Iterator<Item = $type> {
                [$($type::$variant { $($($field: $value),+)? }),+].into_iter()
            }

            /// The name of the value.
            pub fn name(&self) -> &'static str {
                match self {
                    $($type::$variant { .. } => $name),+
                }
            }

            /// The value of this name.
            ///
            /// # Errors
            /// No value has this name.
            pub fn named(name: &str) -> $crate::error::Result<$type> {
                match name {
                    $($name => Ok($type::$variant { $($($field: $value),+)? }),)+
                    other => {
                        let names = <$type>::NAMES.join(", ");
                        Err($crate::error::Error::new(format!("expected one of {names}, found \"{other}\"")))
                    }
                }
            }
        }
    };
}
