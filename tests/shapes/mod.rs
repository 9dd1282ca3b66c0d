//! Random shapes and materials of every shipped element.

pub mod bodies;
pub mod relaxing;
pub mod statics;

use nalgebra::{DMatrix, DVector};
use springfit_element::element::{Element, SHIPPED};
use springfit_element::material::{Material, Plane};
use springfit_element::stiffness::Geometry;
use springfit_mesh::mesh::{CellBlock, Mesh};
use std::sync::{Arc, LazyLock, OnceLock};

/// A repeatable source of numbers in [-1, 1].
pub struct Random(pub u64);

impl Random {
    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        self.0
    }

    pub fn next(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1u64 << 52) as f64 - 1.0
    }

    /// A whole number below a count.
    pub fn below(&mut self, count: usize) -> usize {
        (self.bits() >> 33) as usize % count
    }
}

/// An element; one that is shipped is read and proved once for all tests.
pub fn loaded(name: &str) -> Arc<Element> {
    static KNOWN: LazyLock<Vec<OnceLock<Arc<Element>>>> = LazyLock::new(|| vec![OnceLock::new(); SHIPPED.len()]);
    let load = || Arc::new(Element::load(name).unwrap());
    match SHIPPED.iter().position(|file| file.name == name) {
        Some(place) => KNOWN[place].get_or_init(load).clone(),
        None => load(),
    }
}

pub fn elements() -> Vec<Element> {
    SHIPPED.iter().map(|file| Element::clone(&loaded(file.name))).collect()
}

/// Reference positions under a random affine map of positive determinant, each node moved by up to 5 % of the size.
pub fn distorted(element: &Element, random: &mut Random) -> Vec<f64> {
    let d = element.dimension();
    loop {
        let map = DMatrix::from_fn(d, d, |i, j| f64::from(u8::from(i == j)) + 0.4 * random.next());
        if map.determinant() < 0.3 {
            continue;
        }
        let place = |at: &[f64]| (&map * DVector::from_column_slice(at)).as_slice().to_vec();
        let mut x: Vec<f64> = element.positions.chunks_exact(d).flat_map(place).collect();
        x.iter_mut().for_each(|x| *x += 0.05 * random.next());
        return x;
    }
}

/// A random shape whose Jacobian is positive at all points.
pub fn valid(element: &Element, random: &mut Random) -> Vec<f64> {
    let is_valid = |x: &Vec<f64>| Geometry::new(&element.tabulation).set(&element.tabulation, x).is_ok();
    std::iter::repeat_with(|| distorted(element, random)).find(is_valid).unwrap()
}

/// The geometry of an element with its nodes at `x`.
pub fn geometry(element: &Element, x: &[f64]) -> Geometry {
    let mut geometry = Geometry::new(&element.tabulation);
    geometry.set(&element.tabulation, x).unwrap();
    geometry
}

/// A mesh of one cell.
pub fn single(element: &Element, x: &[f64]) -> Mesh {
    let block = CellBlock { element: Arc::new(element.clone()), connectivity: (0..element.nodes()).collect() };
    Mesh::of_cells(element.space(), x.to_vec(), vec![block])
}

/// The file of a shipped element with springs on the angles between its edges at every corner beside its own.
pub fn text_with_angles(name: &str) -> String {
    let file = SHIPPED.iter().find(|file| file.name == name).unwrap();
    format!("{}\n[[springs]]\ngroup = \"angle\"\nkind = \"angle\"\nnodes = \"complete\"\n", file.text)
}

/// A shipped element to which springs are added on the angles between its edges at every corner.
pub fn with_angles(name: &str) -> Element {
    Element::parse(&text_with_angles(name)).unwrap()
}

pub fn materials(dimension: usize) -> Vec<Material> {
    let planes = if dimension == 2 { vec![Some(Plane::Stress), Some(Plane::Strain)] } else { vec![None] };
    let ratios = [-0.6, 0.0, 0.3, 0.45];
    let each = |plane: &Option<Plane>| ratios.map(|nu| Material::for_body(dimension, 1e4, nu, *plane, None).unwrap());
    planes.iter().flat_map(each).collect()
}

/// Translations and infinitesimal rotations, `[motions][nodes × dimension]`.
pub fn rigid_motions(x: &[f64], d: usize) -> Vec<Vec<f64>> {
    let field = |f: &dyn Fn(&[f64], usize) -> f64| -> Vec<f64> {
        x.chunks_exact(d).flat_map(|x| (0..d).map(|k| f(x, k)).collect::<Vec<_>>()).collect()
    };
    let mut motions: Vec<Vec<f64>> = (0..d).map(|e| field(&|_, k| f64::from(u8::from(k == e)))).collect();
    for i in 0..d {
        for j in 0..i {
            let turn = |x: &[f64], k: usize| {
                if k == i {
                    x[j]
                } else if k == j {
                    -x[i]
                } else {
                    0.0
                }
            };
            motions.push(field(&turn));
        }
    }
    motions
}
