//! Linear and nonlinear statics, natural vibrations, and the stability of a network.

#[doc(inline)]
pub use springfit_bodies::solve::{
    Applied, Ending, Equilibrium, Factor, Modes, Solved, Stability, Standing, StaticMethod, StaticSolver, is_definite,
    lowest_modes,
};

/// Newton's method for equilibria at large deformation. A spring that turns in tension is stiffer than its constant.
///
/// ```
/// use springfit::model::{LengthSpring, Network, Support};
/// use springfit::solve::{Ending, Newton};
///
/// let spring = LengthSpring { points: [0, 1], constant: 50.0, rest: 1.0 }; // N/m, m
/// let network = Network { dimension: 2, lengths: vec![spring], others: Vec::new() };
/// let support = Support { prescribed: vec![Some(0.0), Some(0.0), None, Some(0.0)] };
/// let points = [0.0, 0.0, 1.0, 0.0]; // m
/// let found = Newton::default().solve(&network, &points, &support, &[0.0, 0.0, 5.0, 0.0])?;
/// assert_eq!(found.ending, Ending::Converged);
/// assert!((found.displacement[2] - 0.1).abs() < 1e-12);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_bodies::solve::Newton;

/// The equations of the free degrees of freedom of a body: `K u = f`.
///
/// ```
/// use springfit::model::{LengthSpring, Network, Support};
/// use springfit::solve::System;
///
/// let spring = LengthSpring { points: [0, 1], constant: 2.0, rest: 1.0 }; // N/m, m
/// let network = Network { dimension: 2, lengths: vec![spring], others: Vec::new() };
/// let support = Support { prescribed: vec![Some(0.0), Some(0.0), None, Some(0.0)] };
/// let system = System::new(&network.stiffness(&[0.0, 0.0, 1.0, 0.0]), &support)?;
/// let factor = system.factorize()?.expect("the spring is held");
/// assert_eq!(system.solve(&factor, &[0.0, 0.0, 3.0, 0.0]).0, [0.0, 0.0, 1.5, 0.0]); // m under 3 N
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_bodies::solve::System;
