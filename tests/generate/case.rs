//! Elements with objectives, and the numbers of the library for random cells of each.

use crate::shapes::{Random, distorted, elements, materials};
use springfit_element::element::Element;
use springfit_element::material::{Material, Moduli};
use springfit_element::springs::{Force, Springs};
use springfit_element::stiffness::Geometry;
use springfit_fit::fit::published::{self, Method};
use springfit_fit::fit::{CellFits, ExactFit, Fit, Objective, VolumeSprings, condition, fit_cells, fit_exact};
use springfit_foundation::error::Result;
use springfit_generate::generate::{Program, Recipe, language};
use std::ops::Range;
use std::path::Path;
use std::sync::Arc;

/// An element with an objective.
pub struct Case {
    pub element: Arc<Element>,
    pub recipe: Recipe,
    pub springs: Springs,
    pub program: Arc<Program>,
    pub samples: Vec<Sample>,
}

/// A cell at rest and deformed, and what the library says of it.
#[derive(Clone)]
pub struct Sample {
    pub x: Vec<f64>,
    pub deformed: Vec<f64>,
    pub moduli: [f64; 2],
    pub constants: Vec<f64>,
    pub rests: Vec<f64>,
    pub energy: f64,
    /// The sum of the magnitudes of the energies of its springs.
    pub energies: f64,
    pub forces: Vec<f64>,
}

impl Sample {
    pub fn with(&self, x: Vec<f64>, moduli: [f64; 2]) -> Sample {
        Sample { x, moduli, ..self.clone() }
    }
}

/// The objectives of the tests, with their options.
const RECIPES: [(&str, Option<&str>, Option<f64>); 14] = [
    ("exact", None, None),
    ("exact", Some("cells"), None),
    ("offdiag", None, None),
    ("frobenius", None, None),
    ("modal", None, None),
    ("modal", None, Some(0.7)),
    ("van-gelder", None, None),
    ("van-gelder-simple", None, None),
    ("lloyd", None, None),
    ("lloyd-preserving", None, None),
    ("baudet", None, None),
    ("baudet-corrected", None, None),
    ("delingette-quadratic", None, None),
    ("delingette-biquadratic", None, None),
];

/// Elements of users: other kinds of springs, and a volumetric rule of its own.
const OWN: [&str; 3] = ["hex8_selective", "tet4_coupled", "tri3_coupled"];

/// The cases of all elements, with and without their optional groups, that pass the filter.
pub fn every(wanted: impl Fn(&Case) -> bool) -> Vec<Case> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR")).join("examples/elements");
    let own = OWN.map(|name| Element::load(folder.join(format!("{name}.toml")).to_str().unwrap()).unwrap());
    let mut random = Random(24);
    let mut cases = Vec::new();
    for element in elements().into_iter().chain(own) {
        let element = Arc::new(element);
        let all: Vec<String> = element.springs.iter().map(|group| group.name.clone()).collect();
        let optional = element.springs.iter().any(|group| group.optional);
        for (objective, volume, higher) in RECIPES {
            for groups in [None, Some(&all[..])] {
                let recipe = Recipe::named(objective, volume, higher).unwrap();
                let has_groups = matches!(recipe, Recipe::Frobenius(_)) && optional && higher.is_none();
                if groups.is_some() && !has_groups {
                    continue;
                }
                // Some combinations do not determine the springs.
                let Ok(program) = Program::new(&element, groups, recipe) else { continue };
                let springs = match recipe {
                    Recipe::Exact(volume) => exact(&element, &element.positions, material(&element), volume).0,
                    Recipe::Frobenius(_) => Springs::select(&element, groups).unwrap(),
                    Recipe::Published(method) => {
                        let fits = of_method(method, &element, &element.positions, materials(element.dimension())[3]);
                        fits.unwrap().springs
                    }
                };
                let (element, program) = (element.clone(), Arc::new(program));
                let mut case = Case { element, recipe, springs, program, samples: Vec::new() };
                if wanted(&case) {
                    case.samples = (0..3).filter_map(|_| case.sample(&mut random)).collect();
                    cases.push(case);
                }
            }
        }
    }
    cases
}

fn material(element: &Element) -> Material {
    materials(element.dimension())[2]
}

fn of_method(method: Method, element: &Element, x: &[f64], material: Material) -> Result<CellFits> {
    let connectivity: Vec<usize> = (0..element.nodes()).collect();
    published::fit(method, element, &Springs::select(element, None)?, x, &connectivity, material)
}

type Numbers = (Springs, Vec<f64>, Vec<f64>);

/// The springs of an exact network, their constants, and `k L₀` of those on contents.
fn exact(element: &Element, x: &[f64], material: Material, volume: VolumeSprings) -> Numbers {
    let connectivity: Vec<usize> = (0..element.nodes()).collect();
    let fit = ExactFit { volume, ..ExactFit::default() };
    let fits = fit_exact(element, x, &connectivity, material, &fit, &mut |_| {}).unwrap();
    (fits.springs, fits.constants, fits.parameters)
}

impl Case {
    /// What the names of its functions begin with.
    pub fn prefix(&self) -> String {
        self.program.prefix.clone()
    }

    /// The name of its file: with the place of the case, because groups and numbers are not part of the prefix.
    pub fn text(&self, name: &str) -> Option<String> {
        self.program.print(language(name).unwrap()).ok()
    }

    /// Whether springs measure other things than lengths beside lengths.
    pub fn is_mixed(&self) -> bool {
        !self.springs.functions().is_empty()
    }

    /// Constants of one unit: the length springs, and each of the others.
    pub fn ranges(&self, length: usize) -> Vec<Range<usize>> {
        if length != self.springs.len() {
            return std::iter::once(0..length).collect();
        }
        let lengths = self.springs.pairs().len();
        let contents = lengths..lengths + self.springs.points().len();
        let others = contents.end..length;
        let ranges = [0..lengths, contents].into_iter().chain(others.map(|s| s..s + 1));
        ranges.filter(|range| !range.is_empty()).collect()
    }

    /// What rounding may leave of its normal equations: a rounding error for each of the unknowns, times the condition.
    pub fn rounding(&self, sample: &Sample) -> f64 {
        let moduli = Moduli { lambda: sample.moduli[0], mu: sample.moduli[1] };
        let condition = match self.recipe {
            // Sums of lengths beside these lengths are nearly dependent; their condition is not known to the library.
            Recipe::Frobenius(_) if self.is_mixed() => 1e5,
            Recipe::Frobenius(weight) => condition(weight, &self.element, &self.springs, &sample.x, &moduli).unwrap(),
            Recipe::Exact(_) | Recipe::Published(_) => 1.0,
        };
        self.springs.len() as f64 * f64::EPSILON * condition
    }

    fn sample(&self, random: &mut Random) -> Option<Sample> {
        let (element, d) = (&self.element, self.element.dimension());
        // Those of high order tangle easily.
        let is_upright = |x: &Vec<f64>| Geometry::new(&element.tabulation).set(&element.tabulation, x).is_ok();
        let x = std::iter::repeat_with(|| distorted(element, random)).find(is_upright)?;
        let materials = materials(d);
        let pick = (random.next().abs() * materials.len() as f64) as usize % materials.len();
        let material = match self.recipe {
            // Below a ratio it has no springs.
            Recipe::Published(Method::LloydPreserving) => materials[3],
            _ => materials[pick],
        };
        let moduli = material.moduli();
        let connectivity: Vec<usize> = (0..element.nodes()).collect();
        let (constants, parameters, force) = match self.recipe {
            Recipe::Exact(volume) => {
                let (_, constants, parameters) = exact(element, &x, material, volume);
                (constants, parameters, Force::Exact { content: None })
            }
            Recipe::Published(method) => {
                (of_method(method, element, &x, material).unwrap().constants, Vec::new(), Force::Linear)
            }
            Recipe::Frobenius(weight) => {
                let fit = Fit::new(Objective::Frobenius(weight));
                let fits = fit_cells(element, &self.springs, &x, &connectivity, moduli, &fit, &mut |_| {}).unwrap();
                if fits.deficient > 0 {
                    return None;
                }
                (fits.constants, Vec::new(), Force::Linear)
            }
        };
        let deformed: Vec<f64> = x.iter().map(|x| x + 0.1 * random.next()).collect();
        let mut sample = Sample {
            deformed,
            moduli: [moduli.lambda, moduli.mu],
            rests: vec![0.0; constants.len()],
            energy: 0.0,
            energies: 0.0,
            forces: vec![0.0; x.len()],
            constants,
            x,
        };
        let places = force.places(&self.springs);
        for (s, (nodes, measure)) in self.springs.measures(element).into_iter().enumerate() {
            let at = |x: &[f64]| nodes.iter().flat_map(|a| x[a * d..(a + 1) * d].to_vec()).collect::<Vec<f64>>();
            let k = sample.constants[s];
            let given = &parameters[places[s].min(parameters.len())..places[s + 1].min(parameters.len())];
            let rest = match (&force, given) {
                (Force::Linear, _) => measure.value(&at(&sample.x), d),
                (_, [pull]) if k != 0.0 => pull / k,
                (_, [_]) => measure.value(&at(&sample.x), d),
                _ => 0.0,
            };
            let c = measure.value(&at(&sample.deformed), d);
            let energy = k / 2.0 * (c - rest) * (c - rest);
            sample.rests[s] = rest;
            sample.energy += energy;
            sample.energies += energy.abs();
            let gradient = measure.gradient(&at(&sample.deformed), d);
            for (i, a) in nodes.iter().enumerate() {
                (0..d).for_each(|l| sample.forces[a * d + l] -= k * (c - rest) * gradient[i * d + l]);
            }
        }
        Some(sample)
    }
}
