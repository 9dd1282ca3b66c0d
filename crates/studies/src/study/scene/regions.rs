//! The materials of a scene on its mesh: the region of each cell, and the material there.

use super::anisotropic::{AnisotropicLaw, Axis};
use super::distribution::{DataEntry, Distribution, Source};
use super::material::{MaterialEntries, MaterialEntry};
use super::part::Part;
use crate::error::{Error, ErrorKind, Result};
use crate::material::{Anisotropy, CellMap, LinearMaterial, MaterialMap};
use crate::mesh::{CellIndex, Holder, Interpolation, Mesh, Samples};
use crate::model::cell_means;
use crate::range;
use crate::study::body_material::BodyConstants;
use crate::study::extent::extent;
use crate::symbolic::{Program, Scope};
use std::path::Path;
use std::sync::Arc;

/// Positions outside the box around the data, relative to the extent of the mesh, that still have the nearest values.
const OUTSIDE: f64 = 0.1;
/// The distance of points that are the same, relative to the extent of the mesh, as for displacements.
const SAME: f64 = 1e-6;

/// The materials of the cells of a mesh; the keys of errors are those of the scene.
///
/// # Errors
/// A cell is in two regions or in none, a region is empty or unknown, data are wrong or do not cover the mesh, or a value is out of
/// its range in some cell.
pub fn material_map(entries: &MaterialEntries, mesh: &Mesh, folder: &Path) -> Result<MaterialMap> {
    let region = region_of_cells(entries, mesh)?;
    let names = entries.all.iter().map(|entry| if entries.is_list { entry.name() } else { String::new() }).collect();
    let sizes: Vec<usize> = mesh.blocks.iter().map(|block| block.cells().len()).collect();
    let mut cells = vec![Vec::new(); entries.all.len()];
    for (block, own) in region.iter().enumerate() {
        own.iter().enumerate().for_each(|(cell, &region)| cells[region].push(CellIndex { block, cell }));
    }
    let mut materials: Vec<Vec<Option<LinearMaterial>>> = sizes.iter().map(|count| vec![None; *count]).collect();
    let mut densities: Vec<Vec<f64>> = sizes.iter().map(|count| vec![0.0; *count]).collect();
    let places = Places::new(mesh, folder);
    for (i, (entry, cells)) in entries.all.iter().zip(&cells).enumerate() {
        let under = |e: Error| e.placed(|e| e.under(entries.key(i)));
        let values = RegionValues::of(entry, &places, cells).map_err(under)?;
        for (own, &index) in cells.iter().enumerate() {
            let material = values.material(entry, mesh, own).map_err(|e| under(places.named(e, index)))?;
            materials[index.block][index.cell] = Some(material);
            if let Some(density) = &values.density {
                let density = range::positive("density", density.at(own), "kg/m³");
                densities[index.block][index.cell] = density.map_err(|e| under(places.named(e, index)))?;
            }
        }
    }
    let known = |own: Vec<Option<LinearMaterial>>| own.into_iter().flatten().collect();
    let materials = CellMap::of_blocks(materials.into_iter().map(known).collect());
    let density = entries.has_density().then(|| CellMap::of_blocks(densities));
    Ok(MaterialMap::of_regions(materials, names, CellMap::of_blocks(region))?.with_density(density))
}

/// The index of the entry of each cell, by block.
fn region_of_cells(entries: &MaterialEntries, mesh: &Mesh) -> Result<Vec<Vec<usize>>> {
    let mut region: Vec<Vec<Option<usize>>> = mesh.blocks.iter().map(|b| vec![None; b.cells().len()]).collect();
    let (mut rest, mut shared) = (None, Vec::new());
    for (i, entry) in entries.all.iter().enumerate() {
        let under = |e: Error| e.under(entries.key(i));
        let part = entry.part().map_err(under)?;
        if part == Part::Everything {
            rest = Some(i);
            continue;
        }
        let chosen = part.selection(mesh.dimension).and_then(|s| s.cells(mesh)).map_err(under)?;
        if chosen.is_empty() {
            return Err(under(Error::new("has no cells: the selected part of the mesh has none")));
        }
        for cell in chosen {
            match region[cell.block][cell.cell].replace(i) {
                // A file may list a cell of a group twice.
                Some(other) if other != i => shared.push((other, i)),
                _ => {}
            }
        }
    }
    if let Some(&(a, b)) = shared.first() {
        let found = format!("{} in two, such as those of {} and {}", shared.len(), entries.key(a), entries.key(b));
        return Err(Error::expected("material", "every cell in one region", found));
    }
    let left = region.iter().flatten().filter(|region| region.is_none()).count();
    if let (Some(rest), 0) = (rest, left) {
        let problem = "has no cells: the regions with \"group\" or \"where\" have them all";
        return Err(Error::new(problem).under(entries.key(rest)));
    }
    let Some(rest) = rest.or((left == 0).then_some(0)) else {
        let expected = "every cell in a region, or one [[material]] without \"group\" and \"where\" for the rest";
        return Err(Error::expected("material", expected, format!("{left} cells in none")));
    };
    Ok(region.into_iter().map(|own| own.into_iter().map(|region| region.unwrap_or(rest)).collect()).collect())
}

/// The values of a quantity in the cells of a region.
pub(super) enum Values {
    Uniform(f64),
    Each(Vec<f64>),
}

impl Values {
    /// The value of a cell, by its index in the region.
    pub(super) fn at(&self, cell: usize) -> f64 {
        match self {
            Values::Uniform(value) => *value,
            Values::Each(values) => values[cell],
        }
    }
}

/// The values of the quantities of one entry in its cells.
struct RegionValues {
    /// Young's modulus and Poisson's ratio of isotropic materials.
    isotropic: Option<[Values; 2]>,
    /// The law of each cell in its axes; one if all have the same.
    anisotropic: Option<Vec<Arc<Anisotropy>>>,
    thickness: Option<Values>,
    density: Option<Values>,
}

impl RegionValues {
    fn of(entry: &MaterialEntry, places: &Places, cells: &[CellIndex]) -> Result<RegionValues> {
        let of =
            |key: &str, values: &Distribution| places.values(values, cells).map_err(|e| e.placed(|e| e.under(key)));
        let optional = |key: &str, values: &Option<Distribution>| values.as_ref().map(|v| of(key, v)).transpose();
        let anisotropic = entry.anisotropy()?.map(|law| places.laws(&law, &entry.axes()?, cells)).transpose()?;
        let isotropic = match (&entry.young, &entry.poisson) {
            (Some(young), Some(poisson)) => Some([of("young", young)?, of("poisson", poisson)?]),
            _ => None,
        };
        Ok(RegionValues {
            isotropic,
            anisotropic,
            thickness: optional("thickness", &entry.thickness)?,
            density: optional("density", &entry.density)?,
        })
    }

    /// The material of a cell, by its index in the region.
    fn material(&self, entry: &MaterialEntry, mesh: &Mesh, cell: usize) -> Result<LinearMaterial> {
        // The state of an anisotropic material is that of any other.
        let [young, poisson] =
            self.isotropic.as_ref().map_or([1.0, 0.0], |[young, poisson]| [young.at(cell), poisson.at(cell)]);
        let constants = BodyConstants {
            young,
            poisson,
            plane: entry.plane,
            thickness: self.thickness.as_ref().map(|thickness| thickness.at(cell)),
            area: entry.area,
        };
        let material = constants.material(mesh)?;
        let Some(laws) = &self.anisotropic else { return Ok(material.into()) };
        if mesh.cell_dimension() != mesh.dimension || mesh.dimension == 1 {
            let expected = "an isotropic material on surfaces and curves in space and on rods";
            return Err(Error::expected("young", expected, "an anisotropic one").of_kind(ErrorKind::Unsupported));
        }
        let law = laws.get(cell).unwrap_or(&laws[0]).clone();
        Ok(LinearMaterial::Anisotropic(law, material.state()))
    }
}

/// The middles of the cells of a mesh.
pub(super) struct Places<'a> {
    mesh: &'a Mesh,
    folder: &'a Path,
    /// The centroids, by block, `[cells × dimension]`.
    centroids: Vec<Vec<f64>>,
    /// The largest extent of the mesh, m.
    extent: f64,
}

impl Places<'_> {
    pub(super) fn new<'a>(mesh: &'a Mesh, folder: &'a Path) -> Places<'a> {
        let extent = extent(mesh).into_iter().fold(0.0, f64::max);
        Places { mesh, folder, centroids: cell_means(mesh, &mesh.points), extent }
    }

    fn at(&self, cell: CellIndex) -> &[f64] {
        let d = self.mesh.dimension;
        &self.centroids[cell.block][cell.cell * d..(cell.cell + 1) * d]
    }

    /// The error with the cell in which a value is wrong, if the values differ from cell to cell.
    pub(super) fn named(&self, error: Error, cell: CellIndex) -> Error {
        error.followed_by(format!(" in {}", self.name(cell)))
    }

    fn name(&self, cell: CellIndex) -> String {
        format!("{} cell {} at {:?} m", self.mesh.blocks[cell.block].element.name, cell.cell + 1, self.at(cell))
    }

    /// The values of a quantity in these cells.
    pub(super) fn values(&self, distribution: &Distribution, cells: &[CellIndex]) -> Result<Values> {
        let values = match &distribution.source {
            Source::Number(value) => return Ok(Values::Uniform(value * distribution.factor)),
            Source::Expression(text) => self.of_expression(text, cells)?,
            Source::Data(data) => self.of_data(data, cells)?,
        };
        Ok(Values::Each(values.into_iter().map(|value| value * distribution.factor).collect()))
    }

    /// The law of each cell in its axes; one if all have the same.
    fn laws(&self, law: &AnisotropicLaw, axes: &[Axis], cells: &[CellIndex]) -> Result<Vec<Arc<Anisotropy>>> {
        let of =
            |(key, values): (String, &Distribution)| self.values(values, cells).map_err(|e| e.placed(|e| e.under(key)));
        let constants = law.keyed().into_iter().map(of).collect::<Result<Vec<Values>>>()?;
        let axis = |i: usize| axes.get(i).map(|axis| self.vectors(&format!("axes[{i}]"), axis, cells)).transpose();
        let (first, second) = (axis(0)?, axis(1)?);
        let is_same = law.numbers().is_some() && [&first, &second].into_iter().flatten().all(|axis| axis.len() == 1);
        let vector = |axis: &[[f64; 3]], i: usize| *axis.get(i).unwrap_or(&axis[0]);
        let of_cell = |i: usize| {
            let values: Vec<f64> = constants.iter().map(|constant| constant.at(i)).collect();
            let own = law.at(&values)?;
            let Some(first) = &first else { return Ok(own) };
            let a = vector(first, i);
            own.turned([a, second.as_ref().map_or_else(|| across(a), |second| vector(second, i))])
        };
        let named = |e: Error, i: usize| if is_same { e } else { self.named(e, cells[i]) };
        let count = if is_same { 1 } else { cells.len() };
        (0..count).map(|i| of_cell(i).map(Arc::new).map_err(|e| named(e, i))).collect()
    }

    /// The vectors of an axis with this key in each cell; one if all have the same.
    pub(super) fn vectors(&self, key: &str, axis: &Axis, cells: &[CellIndex]) -> Result<Vec<[f64; 3]>> {
        let d = self.mesh.dimension;
        match axis {
            Axis::Vector(components) if (0..3).all(|k| components.iter().all(|component| !component.uses(k))) => {
                Ok(vec![components.each_ref().map(|component| component.evaluate(&[0.0; 3]))])
            }
            Axis::Vector(components) => {
                if d == 2 && components.iter().any(|component| component.uses(2)) {
                    let expected = "expressions of x and y in a plane mesh";
                    return Err(Error::expected(key, expected, "z"));
                }
                let programs = components.each_ref().map(Program::of);
                let vector = |cell: &CellIndex| {
                    let mut x = [0.0; 3];
                    x[..d].copy_from_slice(self.at(*cell));
                    programs.each_ref().map(|program| program.evaluate(&x))
                };
                Ok(cells.iter().map(vector).collect())
            }
            Axis::Data(data) => {
                let values = self
                    .samples(data, 3)
                    .and_then(|samples| self.sampled(data, &samples, Interpolation::Nearest, cells));
                let values = values.map_err(|e| e.placed(|e| e.under(key)))?;
                Ok(values.iter().map(|v| [v[0], v[1], v[2]]).collect())
            }
        }
    }

    fn of_expression(&self, text: &str, cells: &[CellIndex]) -> Result<Vec<f64>> {
        let expression = Scope::new(&["x", "y", "z"]).expression(text)?;
        if self.mesh.dimension == 2 && expression.uses(2) {
            return Err(Error::new("expected an expression of x and y in a plane mesh, found z"));
        }
        let program = Program::of(&expression);
        let value = |&cell: &CellIndex| {
            let mut x = [0.0; 3];
            x[..self.mesh.dimension].copy_from_slice(self.at(cell));
            let value = program.evaluate(&x);
            match value.is_finite() {
                true => Ok(value),
                false => Err(Error::new(format!("expected a finite number, found {value} in {}", self.name(cell)))),
            }
        };
        cells.iter().map(value).collect()
    }

    fn of_data(&self, data: &DataEntry, cells: &[CellIndex]) -> Result<Vec<f64>> {
        let samples = self.samples(data, 1)?;
        let of_points = match samples.holder() {
            Holder::Points => samples.of_points(self.mesh, SAME * self.extent),
            Holder::Cells => None,
        };
        if let (Some(values), None) = (of_points, data.interpolation()?) {
            let means = cell_means(self.mesh, &values);
            return Ok(cells.iter().map(|cell| means[cell.block][cell.cell]).collect());
        }
        let usual = match samples.holder() {
            Holder::Points => Interpolation::Linear,
            Holder::Cells => Interpolation::Nearest,
        };
        Ok(self.sampled(data, &samples, usual, cells)?.into_iter().map(|values| values[0]).collect())
    }

    fn samples(&self, data: &DataEntry, components: usize) -> Result<Samples> {
        Samples::read(&self.folder.join(&data.file), data.array.as_deref(), data.scale, components)
    }

    /// The numbers of the data at the centroid of each cell; `usual` is how they are found if the data do not say so.
    fn sampled(
        &self,
        data: &DataEntry,
        samples: &Samples,
        usual: Interpolation,
        cells: &[CellIndex],
    ) -> Result<Vec<Vec<f64>>> {
        let interpolation = data.interpolation()?.unwrap_or(usual);
        let value = |&cell: &CellIndex| {
            let outside = samples.outside(self.at(cell));
            if outside > OUTSIDE * self.extent {
                let found = format!(
                    "{} {outside:.3e} m outside; is the scale {:?} m per unit right?",
                    self.name(cell),
                    data.scale
                );
                return Err(
                    Error::expected("file", "values around every cell", found).in_file(&self.folder.join(&data.file))
                );
            }
            Ok(samples.at(self.at(cell), interpolation))
        };
        cells.iter().map(value).collect()
    }
}

/// A vector that is not along this one.
fn across(a: [f64; 3]) -> [f64; 3] {
    let least = (0..3).fold(0, |best, k| if a[k].abs() < a[best].abs() { k } else { best });
    std::array::from_fn(|k| if k == least { 1.0 } else { 0.0 })
}
