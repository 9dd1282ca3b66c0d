//! The finite element model and the network of a mesh; loads, supports, masses.

#[doc(inline)]
pub use springfit_bodies::model::{
    Action, BendingSprings, BlockStiffness, Body, CompressedRows, ConsistentMasses, Elastic, Entries, LengthSpring,
    Lumping, MaterialPoints, MeasureSpring, PreparedNetwork, Response, RestTension, Specimen, SpringLaw,
    bending_springs, displaced, edge_springs, fibre_springs, is_exact, length_shares, lumped_masses, patch_springs,
    unheld_bodies,
};

/// The springs of a whole body.
///
/// ```
/// use springfit::model::{LengthSpring, Network};
///
/// let spring = LengthSpring { points: [0, 1], constant: 50.0, rest: 1.0 }; // N/m, m
/// let network = Network { dimension: 2, lengths: vec![spring], others: Vec::new() };
/// assert_eq!(network.len(), 1);
/// ```
#[doc(inline)]
pub use springfit_bodies::model::Network;

/// What is held of the points of a body, and where it is moved to.
///
/// ```
/// # use springfit::element::Element;
/// # use springfit::material::{Material, State};
/// # use springfit::mesh::{BoxMesh, Selection};
/// # let element = std::sync::Arc::new(Element::load("hex8")?);
/// # let bar = BoxMesh { element, size: vec![1.0, 0.1, 0.1], cells: vec![4, 1, 1], origin: vec![0.0; 3] }.build()?;
/// use springfit::model::Support;
///
/// let mut support = Support::free(&bar);
/// support.fix(&Selection::Group("xmin".into()).points(&bar)?, &[0, 1, 2], 3);
/// assert_eq!(support.prescribed.iter().filter(|value| value.is_some()).count(), 4 * 3);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_bodies::model::Support;

/// The exact network of a body, whose stiffness is that of its finite elements.
///
/// ```
/// # use springfit::element::Element;
/// # use springfit::material::{Material, State};
/// # use springfit::mesh::{BoxMesh, Selection};
/// # let element = std::sync::Arc::new(Element::load("hex8")?);
/// # let bar = BoxMesh { element, size: vec![1.0, 0.1, 0.1], cells: vec![4, 1, 1], origin: vec![0.0; 3] }.build()?;
/// use springfit::fit::ExactFit;
/// use springfit::material::MaterialMap;
/// use springfit::model::{exact_network, finite_elements};
///
/// let material = Material::new(10e3, 0.3, State::Solid)?;
/// let network = exact_network(&bar, &MaterialMap::from(material), &ExactFit::default(), &[])?;
/// assert!(network.len() > bar.cell_count());
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_bodies::model::exact_network;

/// The stiffness of the finite elements of a mesh. A bar of section A that is pulled by a force F grows by `F L/(E A)`.
///
/// ```
/// # use springfit::element::Element;
/// # use springfit::material::{Material, State};
/// # use springfit::mesh::{BoxMesh, Selection};
/// # let element = std::sync::Arc::new(Element::load("hex8")?);
/// # let bar = BoxMesh { element, size: vec![1.0, 0.1, 0.1], cells: vec![4, 1, 1], origin: vec![0.0; 3] }.build()?;
/// use springfit::model::{Action, Support, finite_elements, nodal_forces};
/// use springfit::solve::System;
///
/// let moduli = Material::new(10e3, 0.0, State::Solid)?.moduli();
/// let mut support = Support::free(&bar);
/// support.fix(&Selection::Group("xmin".into()).points(&bar)?, &[0, 1, 2], 3);
/// let end = Selection::Group("xmax".into());
/// let forces = nodal_forces(&bar, &end, &Action::traction(&[100.0, 0.0, 0.0]), 1.0)?; // Pa, N
/// let system = System::new(&finite_elements(&bar, moduli), &support)?;
/// let factor = system.factorize()?.expect("a stable body");
/// let u = system.solve(&factor, &forces).0; // m
/// for point in end.points(&bar)? {
///     assert!((u[3 * point] - 100.0 * 1.0 / 10e3).abs() < 1e-12);
/// }
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_bodies::model::finite_elements;

/// The lumped masses of a body, kg.
///
/// ```
/// # use springfit::element::Element;
/// # use springfit::material::{Material, State};
/// # use springfit::mesh::{BoxMesh, Selection};
/// # let element = std::sync::Arc::new(Element::load("hex8")?);
/// # let bar = BoxMesh { element, size: vec![1.0, 0.1, 0.1], cells: vec![4, 1, 1], origin: vec![0.0; 3] }.build()?;
/// use springfit::model::masses;
///
/// let m = masses(&bar, 1000.0, 1.0); // kg/m³
/// assert!((m.iter().sum::<f64>() - 1000.0 * 1.0 * 0.1 * 0.1).abs() < 1e-12);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_bodies::model::masses;

/// The forces at points of a traction, a pressure, a body force or a moment, N.
///
/// ```
/// # use springfit::element::Element;
/// # use springfit::material::{Material, State};
/// # use springfit::mesh::{BoxMesh, Selection};
/// # let element = std::sync::Arc::new(Element::load("hex8")?);
/// # let bar = BoxMesh { element, size: vec![1.0, 0.1, 0.1], cells: vec![4, 1, 1], origin: vec![0.0; 3] }.build()?;
/// use springfit::model::{Action, nodal_forces};
///
/// let end = Selection::Group("xmax".into());
/// let forces = nodal_forces(&bar, &end, &Action::traction(&[100.0, 0.0, 0.0]), 1.0)?; // Pa
/// assert!((forces.iter().sum::<f64>() - 100.0 * 0.1 * 0.1).abs() < 1e-15);
/// # Ok::<(), springfit::error::Error>(())
/// ```
#[doc(inline)]
pub use springfit_bodies::model::nodal_forces;
