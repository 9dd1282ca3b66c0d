//! Sizes of elements that are known to the compiler.

/// Runs `$work` in the registers of `$any`, a `$T`, with the dimension as a constant `$d` and the number of nodes as
/// `$n`. Each of the common sizes is compiled separately, so that its loops unroll: with few nodes the overhead of
/// loops dominates.
macro_rules! of_size {
    ($T:ty, $any:expr, $size:expr, |$d:ident, $n:ident| $work:expr) => {{
        macro_rules! with {
            ($dimension:literal, $nodes:expr) => {{
                const $d: usize = $dimension;
                let $n: usize = $nodes;
                $any.vectorize(
                    #[inline(always)]
                    || $work,
                )
            }};
        }
        match $size {
            (2, 3) if <$T>::UNROLLED => with!(2, 3),
            (2, 4) if <$T>::UNROLLED => with!(2, 4),
            (3, 4) if <$T>::UNROLLED => with!(3, 4),
            (3, 8) if <$T>::UNROLLED => with!(3, 8),
            (1, nodes) => with!(1, nodes),
            (2, nodes) => with!(2, nodes),
            (_, nodes) => with!(3, nodes),
        }
    }};
}
pub(super) use of_size;
