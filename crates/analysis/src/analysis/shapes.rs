//! Random shapes of an element. The same seed always gives the same shapes.

use crate::element::Element;
use crate::error::{Error, Result};
use crate::random::Random;
use crate::stiffness::Geometry;

/// How far nodes are moved, in units of the reference cell: far enough to distort it, and most shapes remain valid.
// With this distance and the affine maps below all of 2 000 hexahedra of 8 or 20 nodes are valid, and 93 % of quadratic
// tetrahedra. With twice the distance 52 % of the latter are valid, and with four times 14 %.
const JITTER: f64 = 0.15;
/// The size of the random entries of the affine maps of random shapes.
// In the plane the determinant of such a map is at least `(1 − 0.4)² − 0.4² = 0.2`. With entries of up to 0.8 a third
// of the quadratic tetrahedra and a quarter of the hexahedra of 20 nodes are tangled.
const AFFINE: f64 = 0.4;

/// How shapes are drawn.
#[derive(Debug, Clone, Copy, PartialEq, Eq, Default)]
pub enum ShapeFamily {
    /// The reference cell under a random affine map, with each node moved at random.
    #[default]
    Random,
    /// The reference cell with each node moved at random.
    Distorted,
}

crate::named!(ShapeFamily {
    "random" => Random,
    "distorted" => Distorted,
});

/// A set of shapes of an element.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct ShapeSet {
    /// How they are drawn.
    pub family: ShapeFamily,
    /// Each coordinate of a node is moved by up to this length, in units of the reference cell.
    pub distortion: f64,
    /// The shapes are stretched along x by this factor.
    pub aspect: f64,
    /// Another seed gives other shapes.
    pub seed: u64,
    /// The number of shapes.
    pub count: usize,
}

impl Default for ShapeSet {
    fn default() -> ShapeSet {
        ShapeSet { family: ShapeFamily::default(), distortion: JITTER, aspect: 1.0, seed: 2010, count: 100 }
    }
}

impl ShapeSet {
    /// The node positions of the shapes, `[count × nodes × dimension]`. Tangled shapes are drawn again.
    ///
    /// # Errors
    /// Nearly every shape is tangled.
    pub fn draw(&self, element: &Element) -> Result<Vec<f64>> {
        let d = element.dimension();
        let shapes = valid(element, self.count, self.seed, |random| {
            let map = match self.family {
                ShapeFamily::Random => affine(d, AFFINE, random),
                ShapeFamily::Distorted => affine(d, 0.0, random),
            };
            let mut shape = Vec::new();
            for at in element.positions.chunks_exact(d) {
                for k in 0..d {
                    let placed = (0..d).map(|l| map[k * d + l] * at[l]).sum::<f64>();
                    let moved = placed + self.distortion * random.symmetric();
                    shape.push(if k == 0 { self.aspect * moved } else { moved });
                }
            }
            shape
        });
        match shapes.len() == self.count {
            true => Ok(shapes.concat()),
            false => Err(Error::new(format!(
                "{}: nearly every {} shape with a distortion of {} tangles",
                element.name,
                self.family.name(),
                self.distortion
            ))),
        }
    }
}

/// The node positions of `count` elements, `[count × nodes × dimension]`: the reference cell under random affine maps,
/// with each node moved by up to 7 % of its size. Tangled shapes are drawn again.
///
/// # Errors
/// Nearly every shape is tangled.
pub fn random_shapes(element: &Element, count: usize, seed: u64) -> Result<Vec<f64>> {
    ShapeSet { count, seed, ..ShapeSet::default() }.draw(element)
}

/// The node positions, `[nodes × dimension]`, of up to `count` elements with straight edges, far from tangled; fewer if
/// most shapes are tangled.
pub fn straight_shapes(element: &Element, count: usize, seed: u64) -> Vec<Vec<f64>> {
    let d = element.dimension();
    valid(element, count, seed, |random| {
        // The determinant of such a map is at least 1/2 in the plane and 1/4 in space.
        let map = affine(d, 0.25, random);
        let terms = element.cell.straight_terms();
        let bent: Vec<f64> = (0..d * terms.len()).map(|_| 0.1 * random.symmetric()).collect();
        let place = |at: &[f64], k: usize| {
            let straight: f64 = (0..d).map(|l| map[k * d + l] * at[l]).sum();
            let product = |e: &[i32]| at.iter().zip(e).map(|(x, e)| x.powi(*e)).product::<f64>();
            straight + terms.iter().enumerate().map(|(i, e)| bent[k * terms.len() + i] * product(e)).sum::<f64>()
        };
        let nodes = element.positions.chunks_exact(d);
        nodes.flat_map(|at| (0..d).map(|k| place(at, k)).collect::<Vec<_>>()).collect()
    })
}

/// The identity plus random entries of up to `size`, `[dimension × dimension]`.
fn affine(dimension: usize, size: f64, random: &mut Random) -> Vec<f64> {
    // Row by row the diagonal of a matrix is at the multiples of its order plus one.
    let identity = |i: usize| f64::from(u8::from(i.is_multiple_of(dimension + 1)));
    (0..dimension * dimension).map(|i| identity(i) + size * random.symmetric()).collect()
}

/// The first `count` shapes that are not tangled, among at most a hundred times as many.
fn valid(element: &Element, count: usize, seed: u64, mut draw: impl FnMut(&mut Random) -> Vec<f64>) -> Vec<Vec<f64>> {
    let mut random = Random::new(seed);
    let mut geometry = Geometry::new(&element.tabulation);
    let mut shapes = Vec::with_capacity(count);
    // An element that tangles nearly always must not draw for ever.
    for _ in 0..100 * count {
        let shape = draw(&mut random);
        if geometry.set(&element.tabulation, &shape).is_ok() {
            shapes.push(shape);
        }
        if shapes.len() == count {
            break;
        }
    }
    shapes
}
