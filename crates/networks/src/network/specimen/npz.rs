//! Networks as arrays of NumPy: those of springfit, of PhysTwin, and of anyone with the same names.

use super::arrays::{Array, Arrays};
use super::file::{SpecimenFile, SpecimenOptions, place, simplex_mesh};
use crate::engine::Setting;
use crate::error::{Error, ErrorKind, Result};
use crate::material::Plane;
use crate::mesh::Mesh;
use crate::model::{LengthSpring, MeasureSpring, Network, Specimen, Support};
use crate::network::parts::{ContentPart, HingePart, LengthPart, Parts};
use crate::springs::{HINGE_POINTS, distance};
use std::collections::BTreeMap;

/// Names of the constants, the first of which springfit writes.
const CONSTANTS: [&str; 4] = ["k", "constants", "stiffness", "ke"];
/// Names of the lengths at rest.
const REST: [&str; 4] = ["rest", "rest_lengths", "rest_length", "spring_rest_length"];

pub fn read(bytes: &[u8], _: &SpecimenOptions) -> Result<SpecimenFile> {
    let arrays = Arrays::read(bytes)?;
    if arrays.get("spring_Y").is_some() {
        return phystwin(&arrays);
    }
    let (Some((_, points)), Some(_)) = (arrays.first(&["points", "vertices", "x"]), arrays.get("springs")) else {
        let expected =
            "the arrays points, springs and k of a network, or init_vertices, init_springs and spring_Y of PhysTwin";
        return Err(Error::expected("arrays", expected, arrays.names().join(", ")).of_kind(ErrorKind::Syntax));
    };
    let is_plane = is_plane(&arrays, points);
    let (points, d) = places_in_space("points", points, is_plane)?;
    let (ends, _) = arrays.places("springs", &[2])?.unwrap_or_default();
    let (name, _) = arrays.first(&CONSTANTS).ok_or_else(|| {
        Error::expected("k", format!("the constants of the springs, as one of {}", CONSTANTS.join(", ")), "none")
    })?;
    let constants = arrays.list(name, ends.len() / 2)?.unwrap_or_default();
    let rest = match arrays.first(&REST) {
        Some((name, _)) => arrays.list(name, ends.len() / 2)?,
        None => None,
    };
    let lengths = lengths(&points, d, &ends, &constants, rest.as_deref())?;
    let mut network = Network { dimension: d, lengths, others: Vec::new() };
    network.others = others(&arrays, d, points.len() / d)?;
    let count = points.len() / d;
    let specimen = Specimen {
        masses: masses(&arrays, "masses", count)?,
        mesh: mesh(&arrays, &points, d)?,
        support: support(&arrays, count, d)?,
        loads: loads(&arrays, count, d)?,
        ..Specimen::new(network, points)
    };
    let (state, engine) = (state(&arrays)?, engine(&arrays)?);
    Ok(SpecimenFile { state, engine, ..SpecimenFile::plain(specimen, "arrays of NumPy") })
}

/// The state and the thickness of a plane body or a surface.
fn state(arrays: &Arrays) -> Result<Option<(Plane, f64)>> {
    let Some(thickness) = arrays.list("thickness", 1)? else { return Ok(None) };
    if !(thickness[0] > 0.0 && thickness[0].is_finite()) {
        return Err(Error::expected("thickness", "a length above zero, m", thickness[0]));
    }
    let plane = arrays.text("plane").map_or(Ok(Plane::Stress), Plane::named)?;
    Ok(Some((plane, thickness[0])))
}

/// The settings of the engine to which the constants belong.
fn engine(arrays: &Arrays) -> Result<Option<Setting>> {
    let read = |text: &str| serde_json::from_str(text);
    let wrong = |e| Error::expected("engine", "the settings of an engine in JSON", e);
    arrays.text("engine").map(read).transpose().map_err(wrong)
}

/// In the plane z is zero, and what are tetrahedra in space are triangles.
fn is_plane(arrays: &Arrays, points: &Array) -> bool {
    let corners = ["tets", "volumes"].iter().find_map(|name| arrays.get(name)).and_then(|array| array.shape.get(1));
    let is_flat = points.shape.get(1) == Some(&3) && points.values.iter().skip(2).step_by(3).all(|z| *z == 0.0);
    points.shape.get(1) == Some(&2) || corners == Some(&3) || (corners.is_none() && is_flat)
}

/// Positions `[points × dimension]`, m.
fn places_in_space(key: &str, array: &Array, is_plane: bool) -> Result<(Vec<f64>, usize)> {
    let &[_, width @ 1..=3] = &array.shape[..] else {
        let expected = "an array of shape (points, 3), or (points, 2) in the plane";
        return Err(Error::expected(key, expected, format!("one of shape {:?}", array.shape)));
    };
    let d = if is_plane { width.min(2) } else { width };
    Ok((array.values.chunks_exact(width).flat_map(|x| &x[..d]).copied().collect(), d))
}

fn lengths(
    points: &[f64],
    d: usize,
    ends: &[i64],
    constants: &[f64],
    rest: Option<&[f64]>,
) -> Result<Vec<LengthSpring>> {
    let spring = |(s, pair): (usize, &[i64; 2])| {
        let [i, j] = *pair;
        let key = format!("springs[{s}]");
        let [i, j] = [place(&key, i, 0, points.len() / d)?, place(&key, j, 0, points.len() / d)?];
        if i == j {
            return Err(Error::expected(key, "two points", format!("point {i} twice")));
        }
        let at = |p: usize| &points[p * d..(p + 1) * d];
        let rest = rest.map_or_else(|| distance(at(i), at(j)), |rest| rest[s]);
        Ok(LengthSpring { points: [i.min(j), i.max(j)], constant: constants[s], rest })
    };
    ends.as_chunks::<2>().0.iter().enumerate().map(spring).collect()
}

/// Springs on the contents of simplices and on turns.
fn others(arrays: &Arrays, d: usize, count: usize) -> Result<Vec<MeasureSpring>> {
    let mut parts = Parts::default();
    let content = |points: Vec<usize>, constant, rest| ContentPart { points: points.into(), constant, rest };
    listed(arrays, ["volumes", "k_volume", "rest_volume"], d + 1, count, |points, constant, rest| {
        parts.contents.push(content(points, constant, rest));
    })?;
    if d == 3 {
        listed(arrays, ["areas", "k_area", "rest_area"], 3, count, |points, constant, rest| {
            parts.contents.push(content(points, constant, rest));
        })?;
        listed(arrays, ["hinges", "k_hinge", "rest_hinge"], HINGE_POINTS, count, |points, constant, rest| {
            let points = std::array::from_fn(|place| points[place]);
            parts.hinges.push(HingePart { points, constant, rest });
        })?;
    }
    Ok(parts.network(d).others)
}

/// Takes the springs of three arrays: points, of which each spring has `width`, constants and rest measures. Without the first there are none.
fn listed(
    arrays: &Arrays,
    [places, constants, rest]: [&str; 3],
    width: usize,
    count: usize,
    mut take: impl FnMut(Vec<usize>, f64, f64),
) -> Result<()> {
    let Some((nodes, width)) = arrays.places(places, &[width])? else { return Ok(()) };
    let size = nodes.len() / width;
    let of_springs = |name: &str| arrays.list(name, size)?.ok_or_else(|| Error::expected(name, "an array", "none"));
    let (constants, rest) = (of_springs(constants)?, of_springs(rest)?);
    for (s, nodes) in nodes.chunks_exact(width).enumerate() {
        let key = format!("{places}[{s}]");
        let points = nodes.iter().map(|&p| place(&key, p, 0, count)).collect::<Result<Vec<_>>>()?;
        if let Some(twice) = (0..width).find(|&i| points[..i].contains(&points[i])) {
            return Err(Error::expected(key, "different points", format!("point {} twice", points[twice])));
        }
        take(points, constants[s], rest[s]);
    }
    Ok(())
}

fn masses(arrays: &Arrays, name: &str, count: usize) -> Result<Option<Vec<f64>>> {
    let is_empty = arrays.get(name).is_none_or(|array| array.values.is_empty());
    if is_empty { Ok(None) } else { arrays.list(name, count) }
}

/// The cells of the array `tets`, if they have all points.
fn mesh(arrays: &Arrays, points: &[f64], d: usize) -> Result<Option<Mesh>> {
    if d < 2 || arrays.get("tets").is_none_or(|array| array.values.is_empty()) {
        return Ok(None);
    }
    let (nodes, _) = arrays.places("tets", &[d + 1])?.unwrap_or_default();
    let nodes = nodes.iter().map(|&p| place("tets", p, 0, points.len() / d)).collect::<Result<Vec<usize>>>()?;
    simplex_mesh(points, d, nodes)
}

fn support(arrays: &Arrays, count: usize, d: usize) -> Result<Option<Support>> {
    let Some(held) = arrays.get("held").filter(|array| !array.values.is_empty()) else { return Ok(None) };
    let [rows, width] = held.shape[..] else { return Ok(None) };
    if rows != count || width < d {
        let expected = format!("an array of shape ({count}, 3)");
        return Err(Error::expected("held", expected, format!("one of shape {:?}", held.shape)));
    }
    let rows = held.values.chunks_exact(width).flat_map(|row| &row[..d]);
    let prescribed: Vec<Option<f64>> = rows.map(|u| (!u.is_nan()).then_some(0.0)).collect();
    Ok(prescribed.iter().any(Option::is_some).then_some(Support { prescribed }))
}

fn loads(arrays: &Arrays, count: usize, d: usize) -> Result<Vec<Vec<f64>>> {
    let (Some(of), Some(points), Some(forces)) =
        (arrays.get("load_of"), arrays.get("load_points"), arrays.get("load_forces"))
    else {
        return Ok(Vec::new());
    };
    if points.values.len() != of.values.len() || forces.values.len() != 3 * of.values.len() {
        let expected = format!("{} points and as many forces of three numbers", of.values.len());
        return Err(Error::expected("load_points", expected, points.values.len()));
    }
    let mut loads: BTreeMap<i64, Vec<f64>> = BTreeMap::new();
    for ((of, point), force) in of.values.iter().zip(&points.values).zip(forces.values.chunks_exact(3)) {
        let point = place("load_points", *point as i64, 0, count)?;
        let all = loads.entry(*of as i64).or_insert_with(|| vec![0.0; count * d]);
        all[point * d..][..d].iter_mut().zip(force).for_each(|(all, own)| *all += own);
    }
    Ok(loads.into_values().filter(|load| load.iter().any(|f| *f != 0.0)).collect())
}

/// PhysTwin: a spring pulls with `exp(Y) (l/L − 1)`, so that `k = exp(Y)/L`. Stiffnesses below `spring_Y_min` are left out, and those
/// above `spring_Y_max` are cut, as its simulator does.
fn phystwin(arrays: &Arrays) -> Result<SpecimenFile> {
    let missing = |name: &str| Error::expected(name, "an array, as PhysTwin has it", "none").of_kind(ErrorKind::Syntax);
    let vertices = arrays.get("init_vertices").ok_or_else(|| missing("init_vertices"))?;
    let (points, d) = places_in_space("init_vertices", vertices, false)?;
    let count = points.len() / d;
    let (ends, _) = arrays.places("init_springs", &[2])?.ok_or_else(|| missing("init_springs"))?;
    let size = ends.len() / 2;
    let logarithms = arrays.list("spring_Y", size)?.ok_or_else(|| missing("spring_Y"))?;
    let rest = arrays.list("init_rest_lengths", size)?.ok_or_else(|| missing("init_rest_lengths"))?;
    if let Some(s) = rest.iter().position(|rest| !(*rest > 0.0 && rest.is_finite())) {
        return Err(Error::expected(format!("init_rest_lengths[{s}]"), "a length above zero, m", rest[s]));
    }
    let scalar = |name: &str| arrays.get(name).and_then(|array| array.values.first().copied());
    let least = scalar("spring_Y_min").unwrap_or(0.0);
    let most = scalar("spring_Y_max").unwrap_or(f64::INFINITY);
    let (mut parts, mut left_out, mut cut) = (Parts::default(), 0, 0);
    for (s, pair) in ends.as_chunks::<2>().0.iter().enumerate() {
        let stiffness = logarithms[s].exp();
        if !(stiffness > least) {
            left_out += 1;
            continue;
        }
        cut += usize::from(stiffness > most);
        let key = format!("init_springs[{s}]");
        let [i, j] = [place(&key, pair[0], 0, count)?, place(&key, pair[1], 0, count)?];
        if i == j {
            return Err(Error::expected(key, "two points", format!("point {i} twice")));
        }
        let points = [i.min(j), i.max(j)];
        parts.lengths.push(LengthPart { points, constant: stiffness.min(most) / rest[s], rest: rest[s], damper: 0.0 });
    }
    let mut notes = Vec::new();
    let objects = match scalar("num_object_points") {
        None => count,
        Some(n) if n.fract() == 0.0 && (0.0..=count as f64).contains(&n) => n as usize,
        Some(n) => {
            return Err(Error::expected("num_object_points", format!("a number of points from 0 to {count}"), n));
        }
    };
    if left_out > 0 {
        notes.push(format!(
            "{left_out} springs are below spring_Y_min = {least}, and are left out as PhysTwin leaves them out"
        ));
    }
    if cut > 0 {
        notes.push(format!("{cut} springs are above spring_Y_max = {most}, and are cut as PhysTwin cuts them"));
    }
    if objects < count {
        notes.push(format!("{} points after the first {objects} are controllers, and are held", count - objects));
    }
    let prescribed = (0..count * d).map(|dof| (dof / d >= objects).then_some(0.0)).collect();
    let specimen = Specimen {
        masses: masses(arrays, "init_masses", count)?,
        support: (objects < count).then_some(Support { prescribed }),
        ..Specimen::new(parts.network(d), points)
    };
    Ok(SpecimenFile { notes, ..SpecimenFile::plain(specimen, "PhysTwin, arrays of NumPy") })
}
