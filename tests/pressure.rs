//! Pressures on faces, at rest and on faces that move; and cavities that are filled to a given volume.

use crate::kit::{json, outcome, ran, refusal};
use crate::shapes::bodies::{grid, mapped, patch, sphere, vtk_text};
use crate::shapes::statics::support_at;
use crate::shapes::{Random, distorted, elements, single};
use springfit_bodies::model::{
    Action, Body, Cavity, Component, Elastic, PressedFaces, Support, displaced, finite_elements, nodal_forces,
};
use springfit_bodies::solve::{Applied, Ending, Newton, System};
use springfit_element::element::Element;
use springfit_element::material::{CellMap, Energy, Material, State};
use springfit_foundation::symbolic::Scope;
use springfit_mesh::mesh::{CellBlock, CellIndex, Mesh, Selection};
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::Arc;

fn at(condition: &str) -> Selection {
    Selection::Where(Scope::new(&["x", "y", "z"]).predicate(condition).unwrap())
}

fn pressed(mesh: &Mesh, part: &Selection, pressure: f64) -> PressedFaces {
    PressedFaces::new(mesh, part, &Component::Constant(pressure), &CellMap::Uniform(1.0)).unwrap()
}

/// The sum of the forces and of their moments, and the largest force times the size of the body.
fn resultants(forces: &[f64], x: &[f64], d: usize) -> (Vec<f64>, f64) {
    let mut sums: Vec<f64> = (0..d).map(|k| forces.iter().skip(k).step_by(d).sum()).collect();
    for i in 0..d {
        for j in 0..i {
            let pairs = forces.chunks_exact(d).zip(x.chunks_exact(d));
            sums.push(pairs.map(|(f, x)| x[j] * f[i] - x[i] * f[j]).sum());
        }
    }
    (sums, forces.iter().fold(0.0, |most: f64, f| most.max(f.abs())))
}

/// Closed bodies with bent faces: forces and moments of a uniform pressure balance, and `f·x = −p d V` of a closed surface.
#[test]
fn a_uniform_pressure_on_a_closed_body_is_in_balance() {
    let mut tested = 0;
    for element in elements().iter().filter(|element| element.dimension() > 1) {
        let (d, mut random) = (element.dimension(), Random(17));
        for _ in 0..4 {
            let mesh = single(element, &distorted(element, &mut random));
            let faces = pressed(&mesh, &Selection::Everything, 2.0);
            let forces = nodal_forces(&mesh, &Selection::Everything, &Action::Pressure(Component::Constant(2.0)), 1.0);
            let forces = forces.unwrap();
            assert_eq!(forces, faces.forces(&mesh.points));
            let (sums, size) = resultants(&forces, &mesh.points, d);
            // The functions of a pentagon are no polynomials inside, but linear along its sides.
            assert!(sums.iter().all(|sum| sum.abs() < 1e-12 * size), "{}: {sums:?}", element.name);
            let unit = nodal_forces(&mesh, &Selection::Everything, &Action::body(&vec![1.0; d]), 1.0).unwrap();
            let volume: f64 = unit.iter().step_by(d).sum();
            let found: f64 = forces.iter().zip(&mesh.points).map(|(f, x)| f * x).sum();
            let error = (found / (-2.0 * d as f64 * volume) - 1.0).abs();
            assert!(error < 1e-11, "{}: {error:e}", element.name);
            tested += 1;
        }
    }
    assert!(tested >= 60, "{tested}");
}

/// The tangent against central differences on some faces of each element; it is symmetric on a closed surface, and the work along a straight
/// way is that of a fine sum.
#[test]
fn the_tangent_of_a_pressure_is_that_of_differences() {
    for element in elements().iter().filter(|element| element.dimension() > 1) {
        let (d, mut random) = (element.dimension(), Random(5));
        let rest = distorted(element, &mut random);
        let mesh = single(element, &rest);
        let varying = Scope::new(&["x", "y", "z"]).expression("3 + x - 2*y").unwrap();
        let open = Component::Varying(varying);
        for (pressure, is_closed) in [(open, false), (Component::Constant(1.5), true)] {
            let faces = PressedFaces::new(&mesh, &Selection::Everything, &pressure, &CellMap::Uniform(0.7)).unwrap();
            let x: Vec<f64> = rest.iter().map(|x| 1.2 * x + 0.1 * random.next()).collect();
            let n = x.len();
            let mut tangent = vec![0.0; n * n];
            faces.tangent(&x).iter().for_each(|entry| tangent[entry.row * n + entry.col] += entry.val);
            let size = tangent.iter().fold(0.0, |most: f64, t| most.max(t.abs()));
            for j in 0..n {
                let moved = |h: f64| {
                    let mut x = x.clone();
                    x[j] += h;
                    faces.forces(&x)
                };
                let (ahead, behind) = (moved(1e-5), moved(-1e-5));
                for i in 0..n {
                    let slope = (ahead[i] - behind[i]) / 2e-5;
                    let (own, other) = (tangent[i * n + j], tangent[j * n + i]);
                    // The forces are at most quadratic: the difference has rounding errors alone.
                    assert!((slope - own).abs() < 1e-9 * size, "{}: {slope} {own}", element.name);
                    assert!(!is_closed || (own - other).abs() < 1e-12 * size, "{}: {own} {other}", element.name);
                }
            }
            let way: Vec<f64> = x.iter().map(|_| random.next()).collect();
            let steps = 2000;
            let sum: f64 = (0..steps)
                .map(|i| {
                    let t = (i as f64 + 0.5) / steps as f64;
                    let there: Vec<f64> = x.iter().zip(&way).map(|(x, u)| x + t * u).collect();
                    faces.forces(&there).iter().zip(&way).map(|(f, u)| f * u).sum::<f64>() / steps as f64
                })
                .sum();
            let work = faces.work(&x, &way);
            let scale = faces.forces(&x).iter().zip(&way).map(|(f, u)| (f * u).abs()).sum::<f64>();
            assert!((work - sum).abs() < 1e-6 * scale, "{}: {work} {sum}", element.name);
            assert_eq!(d, mesh.dimension);
        }
    }
}

fn solved(mesh: &Mesh, material: Material, support: &Support, forces: &[f64]) -> Vec<f64> {
    let system = System::new(&finite_elements(mesh, material.moduli()), support).unwrap();
    let factor = system.cholesky().unwrap().expect("the body is held");
    let (u, residual) = system.solve(&factor, forces);
    assert!(residual < 1e-10, "{residual:e}");
    u
}

/// The error of displacements relative to their size, root mean square.
fn error(mesh: &Mesh, u: &[f64], exact: impl Fn(&[f64]) -> Vec<f64>) -> f64 {
    let wanted: Vec<f64> = mesh.points.chunks_exact(mesh.dimension).flat_map(exact).collect();
    let square = |v: &mut dyn Iterator<Item = f64>| v.map(|v| v * v).sum::<f64>();
    (square(&mut u.iter().zip(&wanted).map(|(u, w)| u - w)) / square(&mut wanted.iter().copied())).sqrt()
}

/// The order of the functions of an element.
fn order(name: &str) -> i32 {
    if ["tri3", "quad4", "tet4", "hex8", "wedge6"].contains(&name) { 1 } else { 2 }
}

/// Errors on two meshes, the finer with half the size: they fall as `h^(p + 1)`.
fn assert_converges(name: &str, errors: [f64; 2]) {
    let rate = (errors[0] / errors[1]).log2();
    assert!(rate > f64::from(order(name)) + 1.0 - 0.25, "{name}: {errors:?}, rate {rate:.2}");
    assert!(errors[1] < if order(name) == 1 { 1.5e-2 } else { 1e-3 }, "{name}: {errors:?}");
}

/// A quarter of a thick ring in plane strain under a pressure inside (Lamé 1852).
#[test]
fn a_thick_ring_is_that_of_lame() {
    let (inner, outer, young, poisson, p) = (1.0, 2.0, 1e4, 0.3, 50.0);
    let exact = |x: &[f64]| {
        let r = x[0].hypot(x[1]);
        let b = outer * outer;
        let own = (1.0 + poisson) / young * p * inner * inner / (b - inner * inner);
        let u = own * ((1.0 - 2.0 * poisson) * r + b / r);
        vec![u * x[0] / r, u * x[1] / r]
    };
    for name in ["tri3", "quad4", "tri6", "quad8", "quad9"] {
        let errors = [4, 8].map(|n| {
            let mesh = mapped(grid(name, &[1.0, 1.0], &[n, 2 * n]), |x| {
                let (r, turn) = (inner + (outer - inner) * x[0], FRAC_PI_2 * x[1]);
                vec![r * turn.cos(), r * turn.sin()]
            });
            let mut support = Support::free(&mesh);
            for (group, axis) in [("ymin", 1), ("ymax", 0)] {
                support.fix(&Selection::Group(group.into()).points(&mesh).unwrap(), &[axis], 2);
            }
            let material = Material::new(young, poisson, State::PlaneStrain { thickness: 1.0 }).unwrap();
            let action = Action::Pressure(Component::Constant(p));
            let forces = nodal_forces(&mesh, &Selection::Group("xmin".into()), &action, 1.0).unwrap();
            error(&mesh, &solved(&mesh, material, &support, &forces), exact)
        });
        assert_converges(name, errors);
    }
}

/// A part of a thick sphere under a pressure inside (Lamé 1852), which moves as the whole sphere does where it is cut out of it.
#[test]
fn a_thick_sphere_is_that_of_lame() {
    let (inner, outer, young, poisson, p) = (1.0f64, 2.0f64, 1e4, 0.3, 50.0);
    let exact = |x: &[f64]| {
        let r = (x[0] * x[0] + x[1] * x[1] + x[2] * x[2]).sqrt();
        let own = p * inner.powi(3) / (young * (outer.powi(3) - inner.powi(3)));
        let u = own * ((1.0 - 2.0 * poisson) * r + (1.0 + poisson) * outer.powi(3) / (2.0 * r * r));
        x.iter().map(|x| u * x / r).collect::<Vec<f64>>()
    };
    for name in ["tet4", "hex8", "wedge6", "tet10", "hex20", "hex27"] {
        let levels = if order(name) == 1 { [8, 16] } else { [3, 6] };
        let errors = levels.map(|n| {
            let mesh = mapped(grid(name, &[1.0, 1.0, 1.0], &[n, n, n]), patch(inner, outer));
            let mut support = Support::free(&mesh);
            for group in ["xmin", "xmax", "ymin", "ymax"] {
                for point in Selection::Group(group.into()).points(&mesh).unwrap() {
                    let u = exact(mesh.point(point));
                    (0..3).for_each(|k| support.prescribed[3 * point + k] = Some(u[k]));
                }
            }
            let action = Action::Pressure(Component::Constant(p));
            let forces = nodal_forces(&mesh, &Selection::Group("zmin".into()), &action, 1.0).unwrap();
            let material = Material::new(young, poisson, State::Solid).unwrap();
            error(&mesh, &solved(&mesh, material, &support, &forces), exact)
        });
        assert_converges(name, errors);
    }
}

/// Holds six displacements that are zero by symmetry, at points on the axes.
fn held_by_symmetry(mesh: &Mesh, radius: f64) -> Support {
    let mut support = Support::free(mesh);
    for axis in 0..3 {
        let on_axis =
            |p: &usize| (0..3).all(|k| (mesh.point(*p)[k] - if k == axis { radius } else { 0.0 }).abs() < 1e-9);
        let point = (0..mesh.point_count()).find(on_axis).expect("a point is on each axis");
        support.fix(&[point], &[(axis + 1) % 3, (axis + 2) % 3], 3);
    }
    support
}

/// All sides of a body under the same pressure, of any shape: `F = λ I` with the stress `σ = −p I`, so that by the law's energy `W(λ)`
/// `dW/dλ = −3 p λ²`. A load that does not follow would give another stretch.
#[test]
fn a_body_in_a_fluid_shrinks_evenly() {
    let material = Material::new(1e4, 0.3, State::Solid).unwrap();
    let (lambda, mu) = (1e4 * 0.3 / (1.3 * 0.4), 1e4 / 2.6);
    let p = 4e3;
    // W = 3/2 μ (λ² − 1) − 3 μ ln λ + 9/2 Λ ln² λ
    let lack = |l: f64| 3.0 * mu * (l - 1.0 / l) + 9.0 * lambda * l.ln() / l + 3.0 * p * l * l;
    let (mut low, mut high) = (0.3f64, 1.0f64);
    for _ in 0..80 {
        let middle = (low + high) / 2.0;
        if lack(middle) > 0.0 { high = middle } else { low = middle }
    }
    for name in ["tet4", "hex8", "tet10"] {
        let mut random = Random(3);
        let mut mesh = grid(name, &[1.0, 1.0, 1.0], &[2, 2, 2]);
        // The rule of the stiffness is not exact on bent cells, of which the uniform stress is then not in balance.
        match name {
            "tet10" => mesh = mapped(mesh, |x| vec![x[0] + 0.3 * x[1], x[1] - 0.2 * x[2], 1.2 * x[2] + 0.1 * x[0]]),
            _ => mesh.points.iter_mut().for_each(|x| *x += 0.02 * random.next()),
        }
        let mut support = Support::free(&mesh);
        let first = mesh.point(0).to_vec();
        // The motions of a rigid body are held by one point and what its shrinking leaves of the displacements of two others.
        let scale = low - 1.0;
        let moved = |mesh: &Mesh, p: usize, k: usize| scale * (mesh.point(p)[k] - first[k]);
        for (point, axes) in [(0, &[0, 1, 2][..]), (1, &[1, 2]), (mesh.point_count() - 1, &[1])] {
            for &k in axes {
                support.prescribed[3 * point + k] = Some(moved(&mesh, point, k));
            }
        }
        let faces = pressed(&mesh, &Selection::Everything, p);
        let forces = faces.forces(&mesh.points);
        let laws = (Energy::load("neo-hookean", material).unwrap(), State::Solid).into();
        let body = Body::new(&mesh, &laws);
        let applied = Applied { forces: &forces, pressed: Some(&faces) };
        let found = Newton { steps: 4, ..Newton::default() };
        let found = found.solve(&body, &mesh.points, &support, applied).unwrap();
        assert_eq!(found.ending, Ending::Converged, "{name} {:?}", found.residuals);
        let worst = (0..mesh.points.len()).map(|i| (found.displacement[i] - moved(&mesh, i / 3, i % 3)).abs());
        assert!(worst.fold(0.0, f64::max) < 1e-9, "{name}");
    }
}

/// A plate that is bent by a pressure on one side, whose rim is free: the tangent is not symmetric, and Newton's method still converges at its
/// full order.
#[test]
fn a_pressure_without_a_potential_is_followed() {
    let mesh = grid("hex8", &[4.0, 1.0, 0.5], &[8, 2, 2]);
    let material = Material::new(1e4, 0.3, State::Solid).unwrap();
    let laws = (Energy::load("neo-hookean", material).unwrap(), State::Solid).into();
    let body = Body::new(&mesh, &laws);
    let support = support_at(&mesh, &Selection::Group("xmin".into()).points(&mesh).unwrap());
    let faces = pressed(&mesh, &Selection::Group("zmax".into()), 8.0);
    let forces = faces.forces(&mesh.points);
    let applied = Applied { forces: &forces, pressed: Some(&faces) };
    let found = Newton { steps: 4, ..Newton::default() }.solve(&body, &mesh.points, &support, applied).unwrap();
    assert_eq!(found.ending, Ending::Converged, "{:?}", found.residuals);
    let x = displaced(&mesh.points, &found.displacement);
    let inner = body.respond(&x).unwrap().force;
    let acting = faces.forces(&x);
    let size = acting.iter().fold(0.0, |most: f64, f| most.max(f.abs()));
    for dof in (0..x.len()).filter(|dof| !support.is_fixed(*dof)) {
        assert!((inner[dof] - acting[dof]).abs() < 1e-8 * size);
    }
    // It is bent by more than its thickness, where a force that keeps its direction bends it less than the pressure.
    let dead = Newton { steps: 4, ..Newton::default() }.solve(&body, &mesh.points, &support, &forces).unwrap();
    let tip = |u: &[f64]| u.iter().skip(2).step_by(3).fold(0.0, |most: f64, u| most.max(u.abs()));
    assert!(tip(&found.displacement) > 1.0, "{}", tip(&found.displacement));
    assert!((tip(&found.displacement) / tip(&dead.displacement) - 1.0).abs() > 0.01);
    for residuals in &found.residuals {
        // Once it converges, the number of exact digits doubles from step to step.
        let last: Vec<f64> = residuals.iter().copied().filter(|r| *r < 1e-2).collect();
        assert!(last.len() <= 4, "{residuals:?}");
    }
}

/// The pressure in a thick neo-Hookean ball whose inner radius is stretched by l, and the largest that it passes: of the compressible law by
/// shooting along the radius, `d(R² P_R)/dR = 2 R P_θ` with no stress outside.
fn of_ball(mu: f64, lambda: f64, [inner, outer]: [f64; 2], l: f64) -> f64 {
    // P_R = μ (a − 1/a) + Λ ln J/a and P_θ alike, with the stretches a = r' and b = r/R.
    let stress = |a: f64, b: f64| {
        let j = (a * b * b).ln();
        [mu * (a - 1.0 / a) + lambda * j / a, mu * (b - 1.0 / b) + lambda * j / b]
    };
    let steps = 400;
    let h = (outer - inner) / steps as f64;
    // a' from the equation of equilibrium.
    let slope = |radius: f64, r: f64, a: f64| {
        let b = r / radius;
        let [p, q] = stress(a, b);
        let along = mu * (1.0 + 1.0 / (a * a)) + lambda * (1.0 - (a * b * b).ln()) / (a * a);
        let across = lambda * 2.0 / (a * b);
        [a, (2.0 * (q - p) / radius - across * (a - b) / radius) / along]
    };
    let outside = |a: f64| {
        let (mut r, mut a) = (l * inner, a);
        for i in 0..steps {
            let radius = inner + i as f64 * h;
            let k1 = slope(radius, r, a);
            let k2 = slope(radius + h / 2.0, r + h / 2.0 * k1[0], a + h / 2.0 * k1[1]);
            let k3 = slope(radius + h / 2.0, r + h / 2.0 * k2[0], a + h / 2.0 * k2[1]);
            let k4 = slope(radius + h, r + h * k3[0], a + h * k3[1]);
            r += h / 6.0 * (k1[0] + 2.0 * k2[0] + 2.0 * k3[0] + k4[0]);
            a += h / 6.0 * (k1[1] + 2.0 * k2[1] + 2.0 * k3[1] + k4[1]);
        }
        stress(a, r / outer)[0]
    };
    // Near the stretch that keeps the volume.
    let (mut low, mut high) = (0.3 / (l * l), 1.5 / (l * l));
    for _ in 0..80 {
        let middle = (low + high) / 2.0;
        if outside(middle) > 0.0 { high = middle } else { low = middle }
    }
    -stress(low, l)[0] / (l * l)
}

/// Of an incompressible ball (Beatty, Applied Mechanics Reviews 40, 1987): `p = 2 μ [1/b + 1/(4 b⁴) − 1/a − 1/(4 a⁴)]` with the stretches a
/// inside and b outside.
fn of_incompressible_ball(mu: f64, [inner, outer]: [f64; 2], a: f64) -> f64 {
    let b = (1.0 + (a.powi(3) - 1.0) * (inner / outer).powi(3)).cbrt();
    let part = |l: f64| 1.0 / l + 1.0 / (4.0 * l.powi(4));
    2.0 * mu * (part(b) - part(a))
}

/// A thick ball that is filled far beyond the maximum of its pressure.
#[test]
fn a_ball_is_filled_through_its_maximum() {
    let radii @ [inner, outer] = [1.0, 1.3];
    let mesh = sphere("hex27", inner, outer, [2, 1]);
    let support = held_by_symmetry(&mesh, inner);
    let sides = at("x^2 + y^2 + z^2 < 1.15^2");
    for (poisson, bound) in [(0.3, 0.01), (0.49, 0.015)] {
        let mu = 1e4 / (2.0 * (1.0 + poisson));
        let lambda = 1e4 * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
        let material = Material::new(1e4, poisson, State::Solid).unwrap();
        let laws = (Energy::load("neo-hookean", material).unwrap(), State::Solid).into();
        let body = Body::new(&mesh, &laws);
        let volume = |l: f64| 4.0 / 3.0 * PI * (inner * l).powi(3);
        let stretch = 2.2;
        let cavity = Cavity::new(&mesh, &sides, volume(stretch), &CellMap::Uniform(1.0), &support).unwrap();
        let start = cavity.volume_at(&mesh.points);
        assert!((start / volume(1.0) - 1.0).abs() < 2e-3, "{start}");
        let newton = Newton { steps: 20, ..Newton::default() };
        let found = newton.fill(&body, &mesh.points, &support, &cavity).unwrap();
        assert_eq!(found.ending, Ending::Converged, "{poisson}: {:?} {:?}", found.pressures, found.residuals);
        let end = cavity.volume_at(&displaced(&mesh.points, &found.displacement));
        assert!((end / cavity.volume - 1.0).abs() < 1e-11);
        let (mut most, mut falls) = (0.0f64, false);
        for (i, (pressure, u)) in found.pressures.iter().zip(&found.path).enumerate() {
            let now = cavity.volume_at(&displaced(&mesh.points, u));
            let l = (now / start).cbrt();
            let expected = of_ball(mu, lambda, radii, l);
            assert!((pressure / expected - 1.0).abs() < bound, "{poisson}, step {i}: {l} {pressure} {expected}");
            falls |= *pressure < most;
            most = most.max(*pressure);
        }
        assert!(falls && *found.pressures.last().unwrap() < 0.95 * most, "{poisson}: {:?}", found.pressures);
        if poisson > 0.4 {
            let near = of_incompressible_ball(mu, radii, stretch);
            assert!((of_ball(mu, lambda, radii, stretch) / near - 1.0).abs() < 0.06, "{near}");
        }
    }
}

/// The part of a ball where the coordinates along these axes are positive, held by the planes of symmetry, and its cavity at rest.
fn part_of_ball(name: &str, axes: &[usize]) -> (Mesh, Support) {
    let whole = sphere(name, 1.0, 1.3, [2, 1]);
    let is_in = |cell: &&[usize]| axes.iter().all(|k| cell.iter().map(|&p| whole.point(p)[*k]).sum::<f64>() > 0.0);
    let kept: Vec<&[usize]> = whole.blocks[0].cells().filter(is_in).collect();
    let mut places = std::collections::BTreeMap::new();
    let mut points = Vec::new();
    let connectivity = kept.iter().flat_map(|cell| cell.iter()).map(|&p| {
        *places.entry(p).or_insert_with(|| {
            points.extend(whole.point(p));
            points.len() / 3 - 1
        })
    });
    let block = CellBlock { element: whole.blocks[0].element.clone(), connectivity: connectivity.collect() };
    let mesh = Mesh::of_cells(3, points, vec![block]);
    let mut support = Support::free(&mesh);
    for &axis in axes {
        let points: Vec<usize> = (0..mesh.point_count()).filter(|&p| mesh.point(p)[axis].abs() < 1e-9).collect();
        support.fix(&points, &[axis], 3);
    }
    // The axes without planes would be free.
    for axis in (0..3).filter(|axis| !axes.contains(axis)) {
        let (next, other) = ((axis + 1) % 3, (axis + 2) % 3);
        for (k, along) in [(axis, next), (axis, other)] {
            let on_axis =
                |p: &usize| (0..3).all(|j| mesh.point(*p)[j] == 0.0 || j == along) && mesh.point(*p)[along] > 0.0;
            support.fix(&(0..mesh.point_count()).filter(on_axis).collect::<Vec<_>>(), &[k], 3);
        }
    }
    (mesh, support)
}

/// Planes of symmetry close the cavity of an eighth and of a half of a ball: the share of the volume, and the pressures of the whole ball at each of
/// its volumes, through the maximum. The forces of 1 Pa are the gradient of the volume in points that stay in the planes.
#[test]
fn planes_of_symmetry_close_a_cavity() {
    let material = Material::new(1e4, 0.3, State::Solid).unwrap();
    let laws = (Energy::load("neo-hookean", material).unwrap(), State::Solid).into();
    let sides = at("x^2 + y^2 + z^2 < 1.15^2");
    let newton = Newton { steps: 8, ..Newton::default() };
    let uniform = CellMap::Uniform(1.0);
    for name in ["hex8", "hex20"] {
        let whole = sphere(name, 1.0, 1.3, [2, 1]);
        let held = held_by_symmetry(&whole, 1.0);
        let cavity = Cavity::new(&whole, &sides, 20.0, &uniform, &held).unwrap();
        let start = cavity.volume_at(&whole.points);
        let expected = newton.fill(&Body::new(&whole, &laws), &whole.points, &held, &cavity).unwrap();
        assert_eq!(expected.ending, Ending::Converged);
        for (axes, share) in [(&[0, 1, 2][..], 8.0), (&[2][..], 2.0)] {
            let (mesh, support) = part_of_ball(name, axes);
            let open = Cavity::new(&mesh, &sides, 20.0 / share, &uniform, &Support::free(&mesh)).unwrap_err();
            assert!(open.to_string().contains("edges that only one side has"), "{open}");
            let cavity = Cavity::new(&mesh, &sides, 20.0 / share, &uniform, &support).unwrap();
            assert!((share * cavity.volume_at(&mesh.points) / start - 1.0).abs() < 1e-12);
            let found = newton.fill(&Body::new(&mesh, &laws), &mesh.points, &support, &cavity).unwrap();
            assert_eq!(found.ending, Ending::Converged, "{name} {axes:?}");
            for (found, expected) in found.pressures.iter().zip(&expected.pressures) {
                assert!((found / expected - 1.0).abs() < 1e-8, "{name} {axes:?}: {found} {expected}");
            }
            let mut random = Random(7);
            let way: Vec<f64> =
                support.prescribed.iter().map(|held| if held.is_some() { 0.0 } else { random.next() }).collect();
            let at =
                |t: f64| cavity.volume_at(&mesh.points.iter().zip(&way).map(|(x, u)| x + t * u).collect::<Vec<_>>());
            let slope: f64 = cavity.sides.forces(&mesh.points).iter().zip(&way).map(|(f, u)| f * u).sum();
            let difference = (8.0 * (at(1e-3) - at(-1e-3)) - (at(2e-3) - at(-2e-3))) / 12e-3;
            assert!((slope / difference - 1.0).abs() < 1e-9, "{name} {axes:?}: {slope} {difference}");
        }
    }
}

/// A tube between two planes in which its ends are held has the volume between them; one that is held elsewhere, or of which an end moves, is open.
#[test]
fn a_tube_ends_in_planes() {
    for shift in [0.0, 1e3] {
        let block = mapped(grid("hex8", &[3.0, 3.0, 2.0], &[3, 3, 2]), |x| vec![x[0] + shift, x[1], x[2] + shift]);
        let is_wall = |cell: &&[usize]| {
            let middle = |k: usize| cell.iter().map(|&p| block.point(p)[k]).sum::<f64>() / 8.0;
            (middle(0) - shift - 1.5).abs() > 0.5 || (middle(1) - 1.5).abs() > 0.5
        };
        let connectivity = block.blocks[0].cells().filter(is_wall).flatten().copied().collect();
        let element = block.blocks[0].element.clone();
        let mesh = Mesh::of_cells(3, block.points.clone(), vec![CellBlock { element, connectivity }]);
        let inner = format!("abs(x - {shift} - 1.5) < 0.6 && abs(y - 1.5) < 0.6");
        let (inner, uniform) = (at(&inner), CellMap::Uniform(1.0));
        let at_end = |k: f64, p: &usize| mesh.point(*p)[2] == shift + k;
        let ends = |k: f64| (0..mesh.point_count()).filter(|p| at_end(k, p)).collect::<Vec<_>>();
        let mut support = support_at(&mesh, &ends(0.0));
        let open = |support: &Support| Cavity::new(&mesh, &inner, 3.0, &uniform, support).unwrap_err().to_string();
        assert!(open(&support).contains("8 edges that only one side has"), "{}", open(&support));
        support.fix(&ends(2.0), &[2], 3);
        let cavity = Cavity::new(&mesh, &inner, 3.0, &uniform, &support).unwrap();
        assert!((cavity.volume_at(&mesh.points) - 2.0).abs() < 1e-9, "{shift}");
        support.prescribed[3 * ends(2.0)[5] + 2] = Some(0.1);
        assert!(open(&support).contains("8 edges"), "{}", open(&support));
    }
}

/// A thin balloon, a closed surface of triangles in space, under a pressure inside that follows it: `p = 2 μ h/R (1/l − 1/l⁷)` of an incompressible
/// one at the stretch l (Green and Adkins 1960).
#[test]
fn a_thin_balloon_is_blown_up() {
    let solid = sphere("hex8", 0.5, 1.0, [8, 1]);
    let mut connectivity = Vec::new();
    for side in solid.surface_faces() {
        if side.iter().all(|&p| solid.point(p).iter().map(|x| x * x).sum::<f64>() > 0.9) {
            connectivity.extend([side[0], side[1], side[2], side[0], side[2], side[3]]);
        }
    }
    let used: Vec<usize> = (0..solid.point_count()).filter(|p| connectivity.contains(p)).collect();
    connectivity.iter_mut().for_each(|p| *p = used.binary_search(p).unwrap());
    let points = used.iter().flat_map(|&p| solid.point(p).to_vec()).collect();
    let element = Arc::new(Element::load("tri3").unwrap().in_space(3));
    let mesh = Mesh::of_cells(3, points, vec![CellBlock { element, connectivity }]);
    let (young, poisson, thickness) = (1e6, 0.4999, 1e-3);
    let material = Material::new(young, poisson, State::PlaneStress { thickness }).unwrap();
    let laws = (Energy::load("neo-hookean", material).unwrap(), material.state()).into();
    let body = Body::new(&mesh, &laws);
    assert!(body.bent().is_none());
    let support = held_by_symmetry(&mesh, 1.0);
    let mu = young / (2.0 * (1.0 + poisson));
    let pressure = |l: f64| 2.0 * mu * thickness * (1.0 / l - l.powi(-7));
    // The largest pressure is at 1.38.
    for stretch in [1.05, 1.15, 1.25] {
        // Against the outward normal a pressure from outside is positive.
        let faces = pressed(&mesh, &Selection::Everything, -pressure(stretch));
        let forces = faces.forces(&mesh.points);
        let applied = Applied { forces: &forces, pressed: Some(&faces) };
        let found = Newton { steps: 4, ..Newton::default() }.solve(&body, &mesh.points, &support, applied).unwrap();
        assert_eq!(found.ending, Ending::Converged, "{stretch}: {:?}", found.residuals);
        let x = displaced(&mesh.points, &found.displacement);
        let radii: Vec<f64> = x.chunks_exact(3).map(|x| x.iter().map(|x| x * x).sum::<f64>().sqrt()).collect();
        let mean = radii.iter().sum::<f64>() / radii.len() as f64;
        assert!((mean / stretch - 1.0).abs() < 0.01, "{stretch}: {mean}");
        assert!(radii.iter().all(|r| (r / mean - 1.0).abs() < 0.02), "{stretch}");
    }
}

/// A closed surface in space, whose cells a file numbers in any order: the pressure acts inwards on each, and a sheet with one side is refused.
#[test]
fn cells_of_a_surface_are_pressed_from_outside() {
    let solid = grid("hex8", &[1.0, 2.0, 1.5], &[2, 3, 2]);
    let mut random = Random(8);
    let element = Arc::new(Element::load("quad4").unwrap().in_space(3));
    let mut connectivity = Vec::new();
    for side in Selection::Everything.sides(&solid).unwrap() {
        let corners = solid.blocks[0].element.cell.sides()[side.side].corners;
        let mut nodes: Vec<usize> = corners.iter().map(|&a| solid.cell_nodes(side.cell)[a]).collect();
        if random.next() > 0.0 {
            nodes.reverse();
        }
        connectivity.extend(nodes);
    }
    let mesh = Mesh::of_cells(3, solid.points.clone(), vec![CellBlock { element, connectivity }]);
    let forces = pressed(&mesh, &Selection::Everything, 3.0).forces(&mesh.points);
    let wanted = pressed(&solid, &Selection::Everything, 3.0).forces(&solid.points);
    let worst = forces.iter().zip(&wanted).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst < 1e-13, "{worst:e}");

    let strip = |ends: [usize; 2]| {
        let element = Arc::new(Element::load("quad4").unwrap().in_space(3));
        let points = (0..5).flat_map(|i| [[i as f64, 0.0, 0.0], [i as f64, 1.0, 0.3 * i as f64]]).flatten().collect();
        let mut connectivity: Vec<usize> = (0..4).flat_map(|i| [2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1]).collect();
        connectivity.extend([8, ends[0], ends[1], 9]);
        let cells: Vec<CellIndex> = (0..5).map(|cell| CellIndex { block: 0, cell }).collect();
        Mesh::of_cells(3, points, vec![CellBlock { element, connectivity }]).turned(&cells)
    };
    assert!(strip([0, 1]).is_ok());
    let error = strip([1, 0]).unwrap_err().to_string();
    assert!(error.contains("a surface with two sides") && error.contains("Möbius"), "{error}");
}

/// Each is one line that names the place.
#[test]
fn wrong_pressures_are_refused() {
    let cube = "mesh = { box = { element = \"hex8\", size = [1, 1, 1], cells = [2, 2, 2] } }\n\
                fix = [{ group = \"zmin\" }]\nfit = [{ objective = \"frobenius\" }]\n";
    let linear = "material = { young = 1e4, poisson = 0.3 }\n";
    let law = "material = { young = 1e4, poisson = 0.3, law = \"neo-hookean\" }\n";
    for (material, load, wanted) in [
        (linear, "where = \"x > 0.4 && x < 0.6 && z > 0.4 && z < 0.6\", pressure = 1", "has no sides"),
        (linear, "group = \"zmax\", pressure = \"1 kN\"", "(units: Pa, kPa, MPa"),
        (linear, "group = \"zmax\", pressure = \"0.5 kpa\"", "(units: Pa, kPa, MPa"),
        (linear, "group = \"zmax\", pressure = \"high\"", "expected a pressure such as 1000"),
        (linear, "group = \"zmax\", pressure = [1, 0, 0]", "expected a pressure such as 1000"),
        (linear, "group = \"zmax\", pressure = \"1/(x - 0.5)\"", "is not finite"),
        (linear, "group = \"zmax\", pressure = 1e40", "at most 1e30 Pa"),
        (linear, "group = \"zmin\", pressure = 1", "acts on nothing that can move"),
        (linear, "pressure = 1", "\"group\" or \"where\""),
        (linear, "group = \"zmax\", pressure = 1, traction = [0, 0, 1]", "loads that act together"),
        (linear, "where = \"z > -1\", volume = 2", "the sides of a cavity inside the body"),
        (law, "group = \"zmax\", volume = 2", "8 edges that only one side has, the first at"),
        (law, "group = \"zmax\", volume = \"2 m\"", "a volume such as 3e-5"),
        (law, "group = \"zmax\", volume = -2", "a positive number of m³"),
    ] {
        let text = format!("{cube}{material}load = [{{ {load} }}]\n");
        let error = refusal(&text);
        assert!(error.contains(wanted) && error.contains("scene.toml") && !error.contains('\n'), "{load}: {error}");
    }
    let ring = "mesh = { box = { element = \"quad4\", size = [1, 1], cells = [3, 3] } }\n\
                fix = [{ group = \"ymin\" }]\nfit = [{ objective = \"exact\" }]\n\
                material = { young = 1e4, poisson = 0.3, plane = \"strain\", thickness = 1 }\n";
    let error = refusal(&format!("{ring}load = [{{ group = \"ymax\", pressure = \"z\" }}]\n"));
    assert!(error.contains("load[0].pressure: expected an expression of x and y"), "{error}");
}

/// On a side between two cells a pressure has no direction, and an inclusion is no cavity, whatever the order of the cells.
#[test]
fn sides_inside_a_body_are_refused() {
    let mesh = grid("hex8", &[3.0, 3.0, 3.0], &[3, 3, 3]);
    let inner = at("x > 0.9 && x < 2.1 && y > 0.9 && y < 2.1 && z > 0.9 && z < 2.1").points(&mesh).unwrap();
    let mut turned = mesh.clone();
    let cells: Vec<Vec<usize>> = turned.blocks[0].cells().map(<[usize]>::to_vec).collect();
    turned.blocks[0].connectivity = cells.into_iter().rev().flatten().collect();
    for mut mesh in [mesh, turned] {
        let middle = mesh.cell_indices().find(|cell| mesh.cell_nodes(*cell).iter().all(|p| inner.contains(p))).unwrap();
        let element = mesh.blocks[0].element.clone();
        let sides = element.sides().iter().map(|side| {
            let mut side: Vec<usize> = side.nodes.iter().map(|&a| mesh.cell_nodes(middle)[a]).collect();
            side.sort_unstable();
            side
        });
        let group = springfit_mesh::mesh::Group { points: inner.clone(), sides: sides.collect(), ..Default::default() };
        mesh.groups.insert("inner".into(), group);
        let part = Selection::Group("inner".into());
        let pressure = Component::Constant(1.0);
        let error = PressedFaces::new(&mesh, &part, &pressure, &CellMap::Uniform(1.0)).unwrap_err().to_string();
        assert!(error.contains("6 of 6 inside it, with cells on both sides"), "{error}");
        let error =
            Cavity::new(&mesh, &part, 2.0, &CellMap::Uniform(1.0), &Support::free(&mesh)).unwrap_err().to_string();
        assert!(error.contains("with cells on both sides"), "{error}");
    }
}

/// A cavity that is filled to the volume that it has at rest needs no pressure.
#[test]
fn a_cavity_at_its_own_volume_stays() {
    let mesh = sphere("hex8", 1.0, 1.3, [2, 1]);
    let material = Material::new(1e4, 0.3, State::Solid).unwrap();
    let laws = (Energy::load("neo-hookean", material).unwrap(), State::Solid).into();
    let body = Body::new(&mesh, &laws);
    let sides = at("x^2 + y^2 + z^2 < 1.15^2");
    let held = held_by_symmetry(&mesh, 1.0);
    let start = Cavity::new(&mesh, &sides, 1.0, &CellMap::Uniform(1.0), &held).unwrap().volume_at(&mesh.points);
    for growth in [1.0, 1.0 + 1e-12, 1.0 + 1e-9, 1.0 - 1e-9, 1.0 + 1e-6] {
        let cavity = Cavity::new(&mesh, &sides, growth * start, &CellMap::Uniform(1.0), &held).unwrap();
        let found = Newton::default().fill(&body, &mesh.points, &held, &cavity).unwrap();
        assert_eq!(found.ending, Ending::Converged, "{growth}: {:?}", found.residuals);
        assert!(found.pressures[0].abs() < 1e5 * (growth - 1.0).abs() + 1e-6, "{growth}: {:?}", found.pressures);
    }
}

/// Parts of a closed surface are turned as the whole is.
#[test]
fn parts_of_a_surface_add_up_to_it() {
    let solid = sphere("hex8", 0.5, 1.0, [2, 1]);
    let mut random = Random(12);
    let element = Arc::new(Element::load("quad4").unwrap().in_space(3));
    let mut connectivity = Vec::new();
    let is_outside = |side: &Vec<usize>| side.iter().all(|&p| solid.point(p).iter().map(|x| x * x).sum::<f64>() > 0.9);
    for mut side in solid.surface_faces().into_iter().filter(is_outside) {
        if random.next() > 0.3 {
            side.reverse();
        }
        connectivity.extend(side);
    }
    let mesh = Mesh::of_cells(3, solid.points.clone(), vec![CellBlock { element, connectivity }]);
    let whole = pressed(&mesh, &Selection::Everything, 1.0).forces(&mesh.points);
    let parts = [at("z > 0.0"), at("z < 0.0")].map(|part| pressed(&mesh, &part, 1.0).forces(&mesh.points));
    for dof in 0..whole.len() {
        assert!((parts[0][dof] + parts[1][dof] - whole[dof]).abs() < 1e-14);
    }
}

/// A sum of a pressure and a force follows in part; without a law a pressure keeps the directions that it has at rest.
#[test]
fn pressures_of_a_scene_follow_where_there_is_a_law() {
    let scene = |law: &str, loads: &str| {
        outcome(&format!(
            "mesh = {{ box = {{ element = \"hex8\", size = [3, 1, 1], cells = [6, 2, 2] }} }}\nfix = [{{ group = \"xmin\" }}]\n\
             material = {{ young = 1e4, poisson = 0.3{law} }}\nfit = [{{ objective = \"exact\" }}]\nload = [{loads}]\n"
        ))
    };
    let loads = "{ name = \"p\", group = \"zmax\", pressure = \"120 Pa\" }, { name = \"t\", group = \"zmax\", traction = [0, 0, -120] }, \
                 { name = \"side\", group = \"ymax\", traction = [0, 5, 0] }, { name = \"both\", sum = [\"p\", \"side\"] }";
    let linear = scene("", loads);
    let worst = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max);
    assert!(worst(&linear.loads[0].fem, &linear.loads[1].fem) < 1e-12);
    let large = scene(", law = \"neo-hookean\"", loads);
    assert!(large.loads.iter().all(|load| load.is_reached()));
    // The exact network has the energy of the finite elements only where the law is its own: it follows as they do in the linear limit.
    assert!(worst(&large.loads[0].fem, &large.loads[1].fem) > 1e-3);
    // Under both it moves aside as under the side load alone, and down as under the pressure, to the part that bending changes.
    let tip = |load: usize, axis: usize| {
        let all = large.loads[load].fem.iter().skip(axis).step_by(3);
        all.fold(0.0, |most: f64, u| if u.abs() > most.abs() { *u } else { most })
    };
    assert!((tip(3, 2) / tip(0, 2) - 1.0).abs() < 0.1 && (tip(3, 1) / tip(2, 1) - 1.0).abs() < 0.3);
}

/// A scene of a ball in a file: the cavity is filled, the pressures of all models are printed, and the report has them.
#[test]
fn a_scene_fills_a_cavity() {
    let folder = tempfile::tempdir().unwrap();
    let mesh = sphere("hex8", 1.0, 1.3, [3, 1]);
    let cells: Vec<_> = mesh.blocks[0].cells().map(|nodes| (12, nodes.to_vec())).collect();
    std::fs::write(folder.path().join("ball.vtk"), vtk_text(&mesh.points, &cells)).unwrap();
    let mesh = "mesh = { file = \"ball.vtk\" }\n";
    let scene = |volume: &str| {
        format!(
            "{mesh}material = {{ young = 1e4, poisson = 0.3, law = \"neo-hookean\" }}\nnewton = {{ steps = 8 }}\n\
             fit = [{{ objective = \"exact\" }}]\n[[load]]\nname = \"filled\"\nwhere = \"x^2 + y^2 + z^2 < 1.3225\"\nvolume = {volume}\n\
             [[fix]]\nwhere = \"x > 1.2\"\n"
        )
    };
    let run = |text: &str| {
        std::fs::write(folder.path().join("ball.toml"), text).unwrap();
        ran(folder.path(), &["run", "ball.toml", "--out", "out"])
    };
    let (code, said) = run(&scene("\"30 m^3\""));
    assert_eq!(code, Some(0), "{said}");
    assert!(said.contains("Pressure in the cavity under filled: ") && said.contains("Pa, after "), "{said}");
    assert!(said.contains("(finite elements); ") && said.contains("(exact)."), "{said}");
    let report = json(&folder.path().join("out/report.json"));
    let followed = &report["loads_followed"][0];
    assert!(followed["pressure"].as_f64().unwrap() < followed["pressure_passed"].as_f64().unwrap(), "{followed}");
    let (code, said) = run(&scene("30").replace(", law = \"neo-hookean\"", "").replace("newton = { steps = 8 }\n", ""));
    assert_eq!(code, Some(2), "{said}");
    assert!(said.contains("load[0].volume: expected a material with a law"), "{said}");
}
