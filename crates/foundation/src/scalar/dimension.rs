//! Dimensions of bodies that are known to the compiler.

/// Runs `$work` with the dimension of a body, 1 to 3, as a constant `$d`, so that loops over coordinates unroll.
#[doc(hidden)]
#[macro_export]
macro_rules! of_dimension {
    ($dimension:expr, |$d:ident| $work:expr) => {
        match $dimension {
            1 => {
                const $d: usize = 1;
                $work
            }
            2 => {
                const $d: usize = 2;
                $work
            }
            _ => {
                const $d: usize = 3;
                $work
            }
        }
    };
}
