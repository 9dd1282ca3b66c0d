//! General searches that may switch springs off.

use crate::shapes::{geometry, loaded};
use nalgebra::DMatrix;
use springfit_element::element::Element;
use springfit_element::material::{Material, Moduli};
use springfit_element::springs::Springs;
use springfit_fit::fit::{Fit, Objective, Search, Solver, Topology, Weight, fit_element};

const SEARCHES: [Search; 2] = [Search::ParticleSwarm, Search::SimulatedAnnealing];
const FROBENIUS: Objective = Objective::Frobenius(Weight::None);

/// The quadrilateral with a spring that measures the length of a diagonal once more; every spring is a group of its own.
fn doubled() -> Element {
    let text = include_str!("../elements/quad4.toml");
    let (head, rest) = text.split_once("[[springs]]").unwrap();
    let formats = &rest[rest.find("[formats]").unwrap()..];
    let length =
        |(i, pair): (usize, &str)| format!("[[springs]]\ngroup = \"{i}\"\nkind = \"length\"\nnodes = [{pair}]\n");
    let pairs = ["[0, 1]", "[1, 2]", "[2, 3]", "[3, 0]", "[0, 2]", "[1, 3]"];
    let lengths: String = pairs.into_iter().enumerate().map(length).collect();
    let measure = "sqrt((x1 - x0)^2 + (y1 - y0)^2)";
    let twin = format!("[[springs]]\ngroup = \"6\"\nkind = \"measure\"\nmeasure = \"{measure}\"\nnodes = [[0, 2]]\n");
    Element::parse(&format!("{head}{lengths}{twin}{formats}")).unwrap()
}

/// A quadrilateral without symmetry, and what measures a fit of it.
struct Body {
    element: Element,
    springs: Springs,
    x: Vec<f64>,
    moduli: Moduli,
    stiffness: DMatrix<f64>,
    gradients: Vec<f64>,
}

impl Body {
    fn new() -> Body {
        let element = doubled();
        let springs = Springs::select(&element, None).unwrap();
        let x = vec![0.0, 0.0, 1.1, 0.1, 1.0, 0.9, -0.1, 1.0];
        let moduli = Material::for_body(2, 1.0, 0.3, None, None).unwrap().moduli();
        let geometry = geometry(&element, &x);
        let mut gradients = Vec::new();
        springs.gradients(&x, &geometry, &mut gradients);
        let stiffness = geometry.stiffness(moduli);
        Body { element, springs, x, moduli, stiffness, gradients }
    }

    fn fit(&self, springs: &Springs, fit: &Fit) -> Vec<f64> {
        fit_element(&self.element, springs, &self.x, self.moduli, fit).unwrap()
    }

    fn search(&self, method: Search, iterations: u64, topology: Option<Topology>) -> Vec<f64> {
        let solver = Solver::General { method, iterations, topology };
        self.fit(&self.springs, &Fit { solver, ..Fit::new(FROBENIUS) })
    }

    /// `‖R − K‖_F`.
    fn error(&self, constants: &[f64]) -> f64 {
        let mut rest = self.stiffness.clone();
        for (g, k) in self.gradients.chunks_exact(self.x.len()).zip(constants) {
            let g = DMatrix::from_column_slice(self.x.len(), 1, g);
            rest -= &g * g.transpose() * *k;
        }
        rest.norm()
    }

    /// Of constants all alike, with the trace of R, which every search starts from.
    fn start(&self) -> f64 {
        let alike = self.stiffness.trace() / (2 * self.springs.len()) as f64;
        self.error(&vec![alike; self.springs.len()])
    }

    /// With what the springs cost that are on.
    fn cost(&self, constants: &[f64], sparsity: f64) -> f64 {
        let on = constants.iter().filter(|k| **k != 0.0).count();
        self.error(constants) + sparsity * self.start() * on as f64
    }

    /// The least cost of all sets of springs, each with its best constants.
    fn least(&self, sparsity: f64) -> f64 {
        let mut least = self.stiffness.norm();
        for set in 1..1 << self.springs.len() {
            let chosen: Vec<usize> = (0..self.springs.len()).filter(|s| set >> s & 1 == 1).collect();
            let names: Vec<String> = chosen.iter().map(usize::to_string).collect();
            let springs = Springs::select(&self.element, Some(&names)).unwrap();
            let mut constants = vec![0.0; self.springs.len()];
            for (s, k) in chosen.iter().zip(self.fit(&springs, &Fit::new(FROBENIUS))) {
                constants[*s] = k;
            }
            least = least.min(self.error(&constants) + sparsity * self.start() * chosen.len() as f64);
        }
        least
    }
}

/// One of two springs between the same nodes is redundant: it goes where it costs enough. Swarms find the best of all 128 sets of
/// springs, annealing one that is not far from it.
#[test]
fn redundant_springs_are_switched_off() {
    let body = Body::new();
    for sparsity in [0.0, 0.02, 0.05, 0.2] {
        let (least, start) = (body.least(sparsity), body.start() * (1.0 + 7.0 * sparsity));
        for method in SEARCHES {
            let k = body.search(method, 10_000, Some(Topology { sparsity }));
            let lost = (body.cost(&k, sparsity) - least) / (start - least);
            println!("{method:?} {sparsity}: {lost:.1e}");
            let most = if method == Search::ParticleSwarm { 1e-6 } else { 0.2 };
            assert!(lost > -1e-9 && lost < most, "{method:?} {sparsity}: {lost} {k:?}");
            assert!(sparsity < 0.2 || k[4] == 0.0 || k[6] == 0.0, "{method:?} {sparsity}: {k:?}");
        }
    }
}

/// However few the iterations, nothing is worse than the start; and one search finds the same again.
#[test]
fn searches_begin_no_lower_and_repeat() {
    let body = Body::new();
    for (method, iterations) in SEARCHES.into_iter().flat_map(|method| [1, 3, 450].map(|n| (method, n))) {
        for topology in [None, Some(Topology::default()), Some(Topology { sparsity: 0.1 })] {
            let sparsity = topology.map_or(0.0, |topology| topology.sparsity);
            let k = body.search(method, iterations, topology);
            let start = body.start() * (1.0 + 7.0 * sparsity);
            assert!(body.cost(&k, sparsity) <= start * (1.0 + 1e-12), "{method:?} {iterations} {topology:?}");
            assert!(topology.is_some() || !k.contains(&0.0), "{method:?} {iterations}: {k:?}");
            assert_eq!(k, body.search(method, iterations, topology));
        }
    }
}

/// Of a cube's springs, one constant to a group, those along the diagonals of the faces stand without the others: they are left, as
/// stiff as a fit of them alone makes them.
#[test]
fn groups_go_as_a_whole() {
    let element = loaded("hex8");
    let springs = Springs::select(&element, None).unwrap();
    let faces = Springs::select(&element, Some(&["face diagonal".into()])).unwrap();
    let moduli = Material::for_body(3, 1.0, 0.3, None, None).unwrap().moduli();
    let tied = Fit { tied: true, ..Fit::new(FROBENIUS) };
    let of = |springs: &Springs, fit: &Fit| fit_element(&element, springs, &element.positions, moduli, fit).unwrap();
    let wanted = of(&faces, &tied)[0];
    for (method, accuracy) in SEARCHES.into_iter().zip([1e-6, 1e-2]) {
        let solver = Solver::General { method, iterations: 2000, topology: Some(Topology { sparsity: 0.06 }) };
        let found = of(&springs, &Fit { solver, ..tied });
        for (k, &group) in found.iter().zip(springs.groups()) {
            match springs.names()[group].as_str() {
                "face diagonal" => assert!((k / wanted - 1.0).abs() < accuracy, "{method:?}: {k} for {wanted}"),
                other => assert_eq!(*k, 0.0, "{method:?}: {other}"),
            }
        }
    }
}

#[test]
fn what_cannot_be_searched_is_told() {
    let body = Body::new();
    let told = |method: Search, sparsity: f64| {
        let solver = Solver::General { method, iterations: 10, topology: Some(Topology { sparsity }) };
        let fit = Fit { solver, ..Fit::new(FROBENIUS) };
        fit_element(&body.element, &body.springs, &body.x, body.moduli, &fit).unwrap_err().to_string()
    };
    let message = told(Search::NelderMead, 0.0);
    assert!(message.starts_with("topology: ") && message.contains("\"nelder-mead\""), "{message}");
    for sparsity in [-0.1, 1.1, f64::NAN, f64::INFINITY] {
        let expected = format!("sparsity: expected a share from 0 to 1, found {sparsity}");
        assert_eq!(told(Search::ParticleSwarm, sparsity), expected);
    }
}
