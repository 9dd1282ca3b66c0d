//! Work that is compiled for the registers of the machine.

/// Runs `$work` in [`Scalar::vectorize`](crate::scalar::Scalar::vectorize) of the numbers `$any`.
///
/// The closure has to be inlined: what is left outside of the function that `vectorize` runs is compiled for the registers of every machine.
#[doc(hidden)]
#[macro_export]
macro_rules! vectorized {
    ($any:expr, $work:expr) => {
        $any.vectorize(
            #[inline(always)]
            || $work,
        )
    };
}
