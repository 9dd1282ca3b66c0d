//! Whether a scene that gives the reference solution is of the same body, material, supports and loads.

use crate::analysis::metrics::resultant;
use crate::error::{Error, Result};
use crate::material::MaterialMap;
use crate::mesh::Mesh;
use crate::model::{Support, masses};
use crate::springs::norm;
use springfit_scenes::{Scene, applied_cases};

/// Contents that differ by less than this share are equal up to rounding. Coordinates in files have six digits or more.
const ROUNDING: f64 = 1e-6;
/// Bodies whose sizes differ by less than this share may be one curved body with cells of other shapes.
// A polygon of eight sides lacks 10 % of the area of its circle.
const CURVED: f64 = 0.1;

/// A scene on its mesh.
struct Placed<'a> {
    scene: &'a Scene,
    mesh: Mesh,
    material: MaterialMap,
}

impl<'a> Placed<'a> {
    fn of(scene: &'a Scene) -> Result<Placed<'a>> {
        let mesh = scene.build_mesh()?;
        let material = scene.material_of(&mesh)?;
        Ok(Placed { scene, mesh, material })
    }

    /// The sizes of the box around the body, and its content.
    fn sizes(&self) -> Vec<(String, f64)> {
        let lengths = self.mesh.extent().into_iter().zip(["x", "y", "z"]);
        let content = masses(&self.mesh, 1.0, 1.0).iter().sum();
        let what = ["", "length", "area", "volume"][self.mesh.cell_dimension()];
        lengths.map(|(x, axis)| (format!("extent along {axis}, m"), x)).chain([(what.into(), content)]).collect()
    }

    /// The numbers of the material, if all cells have the same.
    fn constants(&self) -> Vec<(&'static str, f64)> {
        let own = self.material.uniform().map(|own| [("young, Pa", own.young()), ("poisson", own.poisson())]);
        let thickness = self.material.thicknesses().uniform().map(|thickness| ("thickness or area", *thickness));
        own.into_iter().flatten().chain(thickness).collect()
    }
}

/// Checks that `reference` is of the same body, material, supports and loads as `scene`. Returns how sizes differ that may be
/// those of one curved body.
///
/// # Errors
/// They differ, or one of the scenes cannot be built. The error names what differs and is one of `reference`.
pub fn same_problem(scene: &Scene, reference: &Scene) -> Result<Option<String>> {
    let (own, other) = (Placed::of(scene)?, Placed::of(reference)?);
    let fault = |key: &str, expected: String, found: String| {
        Err(reference.placed(Error::expected(key, format!("{expected} as in {}", scene.path().display()), found)))
    };
    if own.mesh.dimension != other.mesh.dimension {
        let words = |mesh: &Mesh| format!("{} coordinates", mesh.dimension);
        return fault("mesh", words(&own.mesh), words(&other.mesh));
    }
    let are_boxes = scene.mesh().generated.is_some() && reference.mesh().generated.is_some();
    let (mut least, mut words) = (0.0, None);
    for ((what, a), (_, b)) in own.sizes().into_iter().zip(other.sizes()) {
        // Two sizes of zero agree.
        let share = (a - b).abs() / a.abs().max(b.abs()).max(f64::MIN_POSITIVE);
        if share > if are_boxes { ROUNDING } else { CURVED } {
            return fault("mesh", format!("{what}: {a:.6e}"), format!("{b:.6e}"));
        }
        if share > ROUNDING && share > least {
            (least, words) = (share, Some(format!("{what}: {a:.6e} beside {b:.6e} of the reference")));
        }
    }
    if scene.law() != reference.law() {
        let name = |law: Option<&str>| law.map_or("no law".into(), |law| format!("law \"{law}\""));
        return fault("material", name(scene.law()), name(reference.law()));
    }
    if own.material.state() != other.material.state() && own.constants().len() == other.constants().len() {
        let state = |own: &Placed| format!("{:?}", own.material.state());
        return fault("material", state(&own), state(&other));
    }
    for ((what, a), (_, b)) in own.constants().into_iter().zip(other.constants()) {
        if (a - b).abs() > ROUNDING * a.abs().max(b.abs()) {
            return fault("material", format!("{what}: {a:?}"), format!("{b:?}"));
        }
    }
    // The areas of curved bodies differ about as their volumes do.
    same_conditions(&own, &other, ROUNDING + 3.0 * least, fault)?;
    Ok(words)
}

fn same_conditions(
    own: &Placed,
    other: &Placed,
    tolerance: f64,
    fault: impl Fn(&str, String, String) -> Result<Option<String>>,
) -> Result<()> {
    let d = own.mesh.dimension;
    let (held, cases) = applied_cases(own.scene, &own.mesh, &own.material)?;
    let (other_held, other_cases) = applied_cases(other.scene, &other.mesh, &other.material)?;
    let axes = |support: &Support| -> Vec<&str> {
        let is_held = |k: &usize| support.prescribed.iter().skip(*k).step_by(d).any(Option::is_some);
        (0..d).filter(is_held).map(|k| ["x", "y", "z"][k]).collect()
    };
    let differs = |a: f64, b: f64, scale: f64| (a - b).abs() > tolerance * scale;
    let size = own.mesh.longest_side();
    if axes(&held) != axes(&other_held) {
        let words = |support: &Support| format!("points held along {}", axes(support).join(", "));
        fault("fix", words(&held), words(&other_held))?;
    }
    for k in 0..d {
        let [a, b] = [(&held, &own.mesh), (&other_held, &other.mesh)].map(|(held, mesh)| span(held, mesh, k));
        if a.iter().zip(&b).any(|(a, b)| (a - b).abs() > CURVED * size) {
            let axis = ["x", "y", "z"][k];
            let words = |span: &[f64]| {
                format!("points held along {axis} from ({}) to ({}) m", listed(&span[..d]), listed(&span[d..]))
            };
            fault("fix", words(&a), words(&b))?;
        }
    }
    for case in &cases {
        let Some(known) = other_cases.iter().find(|known| known.name == case.name) else { continue };
        let [a, b] = [&case.forces, &known.forces].map(|forces| resultant(forces, d));
        let absolute = |forces: &[f64]| forces.iter().map(|f| f.abs()).sum::<f64>();
        // Totals of forces that cancel each other are rounding.
        let scale = norm(&a).max(norm(&b)).max(1e-6 * absolute(&case.forces).max(absolute(&known.forces)));
        if a.iter().zip(&b).any(|(a, b)| differs(*a, *b, scale)) {
            let words = |total: &[f64]| format!("a total force of ({}) N under \"{}\"", listed(total), case.name);
            fault("load", words(&a), words(&b))?;
        }
        let [a, b] = [&case.support, &known.support].map(|support| moved(support, d));
        let scale = a.iter().chain(&b).fold(0.0, |largest: f64, u| largest.max(u.abs()));
        if a.iter().zip(&b).any(|(a, b)| differs(*a, *b, scale)) {
            let words = |moved: &[f64]| format!("displacements of up to ({}) m under \"{}\"", listed(moved), case.name);
            fault("load", words(&a), words(&b))?;
        }
    }
    Ok(())
}

fn listed(values: &[f64]) -> String {
    values.iter().map(|value| format!("{value:.6e}")).collect::<Vec<_>>().join(", ")
}

/// The least, then the largest coordinates of the points that are held along an axis.
fn span(held: &Support, mesh: &Mesh, axis: usize) -> Vec<f64> {
    let d = mesh.dimension;
    let mut span = [vec![f64::INFINITY; d], vec![f64::NEG_INFINITY; d]].concat();
    for point in (0..mesh.point_count()).filter(|point| held.prescribed[point * d + axis].is_some()) {
        for (k, x) in mesh.point(point).iter().enumerate() {
            (span[k], span[d + k]) = (span[k].min(*x), span[d + k].max(*x));
        }
    }
    span
}

/// The largest prescribed displacement along each axis, with its sign, m.
fn moved(support: &Support, d: usize) -> Vec<f64> {
    let along = |k: usize| support.prescribed.iter().skip(k).step_by(d).flatten().copied();
    (0..d).map(|k| along(k).fold(0.0, |largest: f64, u| if u.abs() > largest.abs() { u } else { largest })).collect()
}
