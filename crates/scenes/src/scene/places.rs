//! The values of quantities in the cells of a mesh: numbers, expressions, and data of files at their middles.

use super::anisotropic::{AnisotropicLaw, Axis};
use super::distribution::{DataEntry, Distribution, Source};
use super::in_memory::InMemory;
use crate::error::{Error, Result};
use crate::material::Anisotropy;
use crate::mesh::{CellIndex, Holder, Interpolation, Mesh, SampleReading, Samples};
use crate::model::cell_means;
use crate::quantity::Quantity;
use crate::symbolic::{Program, Scope};
use std::cell::{OnceCell, RefCell};
use std::path::{Path, PathBuf};
use std::sync::Arc;

pub(super) use crate::mesh::Accepted;

/// The distance from the nearest place of the data, relative to the extent of the mesh, up to which a cell has values.
// Data of the same body end within a cell or two of its surface. Those of another place, axis or unit are farther away.
const FARTHEST: f64 = 0.1;
/// The ratio of the extents of data and body from which on they have another unit: units of length differ by ten at least, and data in the cells
/// of a body extend less far than it does.
const MOST_RATIO: f64 = 9.0;
/// The distance of points that are the same, relative to the extent of the mesh, as for displacements.
const SAME: f64 = 1e-6;

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

/// The middles of the cells of a mesh.
pub(super) struct Places<'a> {
    mesh: &'a Mesh,
    folder: &'a Path,
    /// What names of files mean before files.
    memory: &'a InMemory,
    /// The file of the mesh and its scale: data of the same file have it as well.
    own: Option<(PathBuf, f64)>,
    /// What was left out of the data.
    remarks: RefCell<Vec<String>>,
    /// The centroids, by block, `[cells × dimension]`.
    centroids: OnceCell<Vec<Vec<f64>>>,
    /// The largest extent of the mesh, m.
    extent: f64,
}

impl<'a> Places<'a> {
    /// The places of a mesh; files are relative to the folder, unless their names are of what is in memory.
    pub(super) fn new(mesh: &'a Mesh, (folder, memory): (&'a Path, &'a InMemory)) -> Places<'a> {
        let extent = mesh.longest_side();
        let (own, remarks) = Default::default();
        Places { mesh, folder, memory, own, remarks, centroids: OnceCell::new(), extent }
    }

    /// With the file of the mesh and its scale.
    pub(super) fn beside(self, own: Option<(PathBuf, f64)>) -> Self {
        Places { own, ..self }
    }

    /// What was left out of the data, one sentence each.
    pub(super) fn remarks(&self) -> Vec<String> {
        self.remarks.borrow().clone()
    }

    fn at(&self, cell: CellIndex) -> &[f64] {
        let d = self.mesh.dimension;
        let centroids = self.centroids.get_or_init(|| cell_means(self.mesh, &self.mesh.points));
        &centroids[cell.block][cell.cell * d..(cell.cell + 1) * d]
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
        self.accepted_values(distribution, cells, Accepted::ANY)
    }

    /// The values of a quantity in these cells, of which those in a file must be accepted.
    pub(super) fn accepted_values(
        &self,
        distribution: &Distribution,
        cells: &[CellIndex],
        accepted: Accepted,
    ) -> Result<Values> {
        let values = match &distribution.source {
            Source::Number(value) => return Ok(Values::Uniform(value * distribution.factor)),
            Source::Expression(text) => self.of_expression(text, cells)?,
            Source::Data(data) => self.of_data(data, cells, accepted)?,
        };
        Ok(Values::Each(values.into_iter().map(|value| value * distribution.factor).collect()))
    }

    /// The law of each cell in its axes; one if all have the same.
    pub(super) fn laws(
        &self,
        law: &AnisotropicLaw,
        axes: &[Axis],
        cells: &[CellIndex],
    ) -> Result<Vec<Arc<Anisotropy>>> {
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
            Axis::Data(data) if self.memory.has(&data.file) => {
                let rows = self.in_memory(data, cells, 3).map_err(|e| e.under(key))?;
                Ok(rows.iter().map(|v| [v[0], v[1], v[2]]).collect())
            }
            Axis::Data(data) => {
                let values = self
                    .samples(data, 3, Accepted::ANY)
                    .and_then(|samples| self.sampled(data, &samples, Interpolation::Nearest, cells));
                let values = values.map_err(|e| e.placed(|e| e.under(key)))?;
                Ok(values.iter().map(|v| [v[0], v[1], v[2]]).collect())
            }
        }
    }

    fn of_expression(&self, text: &str, cells: &[CellIndex]) -> Result<Vec<f64>> {
        let expression = Scope::of_place(3).with_units(&[Quantity::Pressure, Quantity::Density]).expression(text)?;
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

    /// The numbers of an array in memory.
    fn in_memory(&self, data: &DataEntry, cells: &[CellIndex], components: usize) -> Result<Vec<&'a [f64]>> {
        let values = self.memory.values(&data.file);
        values
            .ok_or_else(|| Error::expected("file", "an array of values", "a mesh"))?
            .of_cells(self.mesh, cells, components)
    }

    fn of_data(&self, data: &DataEntry, cells: &[CellIndex], accepted: Accepted) -> Result<Vec<f64>> {
        if self.memory.has(&data.file) {
            return Ok(self.in_memory(data, cells, 1)?.into_iter().map(|values| values[0]).collect());
        }
        let samples = self.samples(data, 1, accepted)?;
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

    fn samples(&self, data: &DataEntry, components: usize, accepted: Accepted) -> Result<Samples> {
        let path = self.folder.join(&data.file);
        let reading = SampleReading {
            array: data.array.as_deref(),
            unit: data.unit.as_deref(),
            scale: self.scale(data),
            components,
            missing: data.missing,
            accepted,
        };
        let samples = Samples::read(&path, &reading)?;
        if samples.left_out > 0 {
            let missing = data.missing.unwrap_or_default();
            let places = if samples.left_out == 1 { "place of" } else { "places of" };
            let remark = format!(
                "{} {places} {} without a value ({missing}) were left out",
                samples.left_out,
                data.file.display()
            );
            self.remarks.borrow_mut().push(remark);
        }
        let (own, body) = (samples.extent(), self.extent);
        // Data of a small part are told by their distance from the cells.
        if own > MOST_RATIO * body {
            let found =
                format!("{own:.3e} m with a scale of {:?} m per unit, for a body of {body:.3e} m", reading.scale);
            return Err(Error::expected("scale", "places about as far apart as the body is long", found).in_file(&path));
        }
        Ok(samples)
    }

    /// Metres per unit of the data: that of the mesh, if they are in its file and say nothing else.
    fn scale(&self, data: &DataEntry) -> f64 {
        let of_mesh = self.own.as_ref().filter(|(file, _)| *file == self.folder.join(&data.file));
        data.scale.or(of_mesh.map(|(_, scale)| *scale)).unwrap_or(1.0)
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
        // Places of a coarse table are farther apart than a tenth of the body, and between them there is no gap.
        let farthest = (FARTHEST * self.extent).max(samples.spacing());
        let value = |&cell: &CellIndex| {
            let away = samples.distance(self.at(cell));
            if away > farthest || samples.outside(self.at(cell)) > FARTHEST * self.extent {
                let found = format!(
                    "{} {away:.3e} m from the nearest; is the scale {:?} m per unit right?",
                    self.name(cell),
                    self.scale(data)
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
    // The axis that is farthest from the direction, so that their cross product is far from zero.
    let least = (0..3).fold(0, |best, k| if a[k].abs() < a[best].abs() { k } else { best });
    std::array::from_fn(|k| if k == least { 1.0 } else { 0.0 })
}
