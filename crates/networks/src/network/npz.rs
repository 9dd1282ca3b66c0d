//! Networks as arrays of NumPy: a ZIP file of `.npy` files.

use super::lists::ListedRecord;
use super::parts::{ContentPart, Parts};
use super::record::QUADRILATERAL;
use super::record::{HeldRecord, NetworkRecord, RelaxationRecord};
use crate::error::Result;
use crate::file::write_seekable;
use crate::mesh::Mesh;
use crate::model::Network;
use crate::springs::HINGE_POINTS;
use std::collections::HashMap;
use std::io::{self, BufWriter, Seek, Write};
use std::path::Path;
use zip::ZipWriter;
use zip::write::SimpleFileOptions;

/// Arrays of a network of springs on lengths, on the contents of simplices and on turns, with n points, m springs, c contents, a areas, h hinges and t triangles:
///
/// | array | shape and type | what |
/// |---|---|---|
/// | `points` | n × 3, f64 | m; in the plane z is zero |
/// | `masses` | n, f64 | kg; empty without a density |
/// | `springs`, `k`, `rest`, `damper` | m × 2, i32; m, f64; m, f64; m, f64 | ends; N/m; m; kg/s |
/// | `volumes`, `k_volume`, `rest_volume` | c × 4, i32; c, f64; c, f64 | corners; N/m⁵; m³. In the plane triangles, N/m³ and m² |
/// | `areas`, `k_area`, `rest_area` | a × 3, i32; a, f64; a, f64 | corners; N/m³; m². Triangles in space; absent without them |
/// | `hinges`, `k_hinge`, `rest_hinge` | h × 4, i32; h, f64; h, f64 | the apex of a triangle, the ends of its edge, and the apex beyond it; N·m; rad. Absent without them |
/// | `tets` | i32 | the corners of the cells that are simplices |
/// | `surface` | t × 3, i32 | triangles |
/// | `fixed` | i32 | points that are held in all directions |
/// | `held` | n × 3, f64 | prescribed displacements, m; NaN where a point is free |
/// | `load_names` | l, text | the loads of the scene |
/// | `load_of`, `load_points`, `load_forces` | f, i32; f, i32; f × 3, f64 | each a force on a point: the place of the load, the point, N |
/// | `moved_of`, `moved_points`, `moved` | p, i32; p, i32; p × 3, f64 | each a point that is held under a load in another way than in `held`: the place of the load, the point, m; NaN where it is free |
/// | `gravity` | 3, f64 | m/s²; zero where there is none |
/// | `damping` | f64 | Rayleigh's α, 1/s |
/// | `relaxation_region`, `relaxation_shear`, `relaxation_bulk`, `relaxation_time`, `relaxation_yield` | r, f64 each | the entry of `[[material]]`, NaN of all; shares of the moduli that relax; s; Pa, 0 without. Absent where nothing relaxes |
/// | `plane`, `thickness` | 1, text; f64 | "stress" or "strain"; m, the mean where it varies. Of plane bodies and surfaces |
/// | `engine` | 1, text | the settings of the engine to which the constants belong, as in the JSON file. Absent without them |
/// | `dt_max` | f64 | the longest explicit step, s; NaN without masses |
///
/// # Errors
/// The writer fails.
pub fn network_npz(network: &NetworkRecord, parts: &Parts, to: impl Write + Seek) -> io::Result<()> {
    network_npz_with(network, parts, to, |_| Ok(()))
}

/// Writes the arrays of [`network_npz`], and those that `more` adds to them.
///
/// # Errors
/// The writer fails.
pub fn network_npz_with<W: Write + Seek>(
    network: &NetworkRecord,
    parts: &Parts,
    to: W,
    more: impl FnOnce(&mut ArrayFile<W>) -> io::Result<()>,
) -> io::Result<()> {
    let blocks = || network.cells.iter().filter(|block| block.vtk != Some(QUADRILATERAL));
    let cells = || blocks().flat_map(|block| &block.points).map(Vec::as_slice);
    let mut file = arrays_of(network, cells, parts, to)?;
    more(&mut file)?;
    file.finish().map(drop)
}

/// Writes the arrays of [`network_npz`] from a record whose cells and springs, those of `mesh` and `network`, are made while they are written.
///
/// # Errors
/// The network has springs that the arrays do not hold, or the file cannot be written. The error names the file.
pub fn write_npz(path: &Path, record: &ListedRecord<'_>, mesh: &Mesh, network: &Network) -> Result<()> {
    let parts = Parts::with_room(network).with_springs(record, record.springs.iter());
    let parts = parts.map_err(|e| e.in_file(path))?;
    let blocks = || {
        mesh.blocks
            .iter()
            .filter(|block| block.element.formats.vtk.as_ref().is_none_or(|vtk| vtk.cell_type != QUADRILATERAL))
    };
    let cells = || blocks().flat_map(|block| block.cells());
    write_seekable(path, |to| arrays_of(record, cells, &parts, to)?.finish().map(drop))
}

/// The arrays of [`network_npz`], with `cells` in place of those of the record.
fn arrays_of<'a, S, C, I: Iterator<Item = &'a [usize]>, W: Write + Seek>(
    network: &NetworkRecord<S, C>,
    cells: impl Fn() -> I,
    parts: &Parts,
    to: W,
) -> io::Result<ArrayFile<W>> {
    let d = network.dimension;
    // NaN marks what is free, because zero is a displacement that is held.
    let free = vec![[f64::NAN; 3]; network.points.len()];
    let held = network.held.iter().fold(free, |mut held, given| {
        held[given.point] = prescribed(given);
        held
    });
    let fixed = network.held.iter().filter(|given| given.displacement.iter().all(Option::is_some));
    let simplices = || cells().filter(|points| points.len() == d + 1);
    let corners = d + 1;
    let of_surfaces = || parts.contents.iter().filter(|s| s.points.len() != corners);
    let mut file = ArrayFile::new(to);
    file.real("points", &[network.points.len(), 3], network.points.iter().flat_map(|x| spatial(x)))?;
    let masses = network.masses.iter().flatten();
    file.real("masses", &[masses.clone().count()], masses.copied())?;
    let springs = &parts.lengths;
    file.whole("springs", &[springs.len(), 2], springs.iter().flat_map(|s| s.points))?;
    file.real("k", &[springs.len()], springs.iter().map(|s| s.constant))?;
    file.real("rest", &[springs.len()], springs.iter().map(|s| s.rest))?;
    file.real("damper", &[springs.len()], springs.iter().map(|s| s.damper))?;
    let contents: Vec<&ContentPart> = parts.contents.iter().filter(|s| s.points.len() == corners).collect();
    file.whole("volumes", &[contents.len(), corners], contents.iter().flat_map(|s| s.points.iter().copied()))?;
    file.real("k_volume", &[contents.len()], contents.iter().map(|s| s.constant))?;
    file.real("rest_volume", &[contents.len()], contents.iter().map(|s| s.rest))?;
    if of_surfaces().next().is_some() {
        let count = of_surfaces().count();
        file.whole("areas", &[count, 3], of_surfaces().flat_map(|s| s.points.iter().copied()))?;
        file.real("k_area", &[count], of_surfaces().map(|s| s.constant))?;
        file.real("rest_area", &[count], of_surfaces().map(|s| s.rest))?;
    }
    if !parts.hinges.is_empty() {
        let hinges = &parts.hinges;
        file.whole("hinges", &[hinges.len(), HINGE_POINTS], hinges.iter().flat_map(|s| s.points))?;
        file.real("k_hinge", &[hinges.len()], hinges.iter().map(|s| s.constant))?;
        file.real("rest_hinge", &[hinges.len()], hinges.iter().map(|s| s.rest))?;
    }
    file.whole("tets", &[simplices().count(), corners], simplices().flatten().copied())?;
    file.whole("surface", &[network.surface.len(), 3], network.surface.iter().flatten().copied())?;
    file.whole("fixed", &[fixed.clone().count()], fixed.map(|given| given.point))?;
    file.real("held", &[network.points.len(), 3], held.into_iter().flatten())?;
    loads_of(network, &mut file)?;
    let gravity = network.gravity.as_deref().unwrap_or_default();
    file.real("gravity", &[3], spatial(gravity))?;
    file.real("damping", &[], [network.damping.mass])?;
    let relaxation = network.motion.as_ref().map_or(&[][..], |motion| &motion.relaxation);
    if !relaxation.is_empty() {
        let count = [relaxation.len()];
        let region = |term: &RelaxationRecord| term.region.map_or(f64::NAN, |region| region as f64);
        file.real("relaxation_region", &count, relaxation.iter().map(region))?;
        file.real("relaxation_shear", &count, relaxation.iter().map(|term| term.shear))?;
        file.real("relaxation_bulk", &count, relaxation.iter().map(|term| term.bulk))?;
        file.real("relaxation_time", &count, relaxation.iter().map(|term| term.time))?;
        file.real("relaxation_yield", &count, relaxation.iter().map(|term| term.yield_stress.unwrap_or(0.0)))?;
    }
    if let Some(plane) = &network.plane {
        file.texts("plane", &[plane.state.name()])?;
        file.real("thickness", &[], [plane.thickness])?;
    }
    if let Some(engine) = &network.engine {
        file.texts("engine", &[&serde_json::to_string(engine)?])?;
    }
    file.real("dt_max", &[], [network.largest_step.unwrap_or(f64::NAN)])?;
    Ok(file)
}

/// The coordinates of a vector, with z = 0 in the plane.
fn spatial(x: &[f64]) -> [f64; 3] {
    [0, 1, 2].map(|k| x.get(k).copied().unwrap_or(0.0))
}

/// The displacement of a held point, NaN where it is free; in the plane also along z.
fn prescribed(held: &HeldRecord) -> [f64; 3] {
    [0, 1, 2].map(|k| held.displacement.get(k).copied().flatten().unwrap_or(f64::NAN))
}

/// Writes the loads: forces on points, and the points whose support is another one than without the load.
fn loads_of<S, C>(network: &NetworkRecord<S, C>, file: &mut ArrayFile<impl Write + Seek>) -> io::Result<()> {
    let names: Vec<&str> = network.loads.iter().map(|load| load.name.as_str()).collect();
    file.texts("load_names", &names)?;
    let all = || network.loads.iter().enumerate();
    let forces = || all().flat_map(|(of, load)| load.forces.iter().map(move |force| (of, force)));
    let count = forces().count();
    file.whole("load_of", &[count], forces().map(|(of, _)| of))?;
    file.whole("load_points", &[count], forces().map(|(_, force)| force.point))?;
    file.real("load_forces", &[count, 3], forces().flat_map(|(_, force)| spatial(&force.force)))?;
    let usual: HashMap<usize, &HeldRecord> = network.held.iter().map(|held| (held.point, held)).collect();
    let own = |held: &&HeldRecord| usual.get(&held.point) != Some(held);
    let moved = || all().flat_map(|(of, load)| load.held.iter().filter(own).map(move |held| (of, held)));
    let count = moved().count();
    file.whole("moved_of", &[count], moved().map(|(of, _)| of))?;
    file.whole("moved_points", &[count], moved().map(|(_, held)| held.point))?;
    file.real("moved", &[count, 3], moved().flat_map(|(_, held)| prescribed(held)))
}

/// A file of arrays of NumPy that is being made.
pub struct ArrayFile<W: Write + Seek> {
    file: ZipWriter<W>,
}

impl<W: Write + Seek> ArrayFile<W> {
    /// A file without arrays, which is written while they are added.
    pub fn new(to: W) -> ArrayFile<W> {
        ArrayFile { file: ZipWriter::new(to) }
    }

    /// Adds an array of 64-bit reals.
    ///
    /// # Errors
    /// The file is too large, or the writer fails.
    pub fn real(&mut self, name: &str, shape: &[usize], values: impl IntoIterator<Item = f64>) -> io::Result<()> {
        self.array(name, "<f8", shape, &mut values.into_iter().map(f64::to_le_bytes))
    }

    /// Adds a list of texts, each filled up with zeros to the longest, in UTF-32.
    ///
    /// # Errors
    /// The file is too large, or the writer fails.
    pub fn texts(&mut self, name: &str, texts: &[&str]) -> io::Result<()> {
        let longest = texts.iter().map(|text| text.chars().count()).max().unwrap_or(0).max(1);
        let filled = |text: &&str| -> Vec<u32> {
            text.chars().map(u32::from).chain(std::iter::repeat(0)).take(longest).collect()
        };
        let mut letters = texts.iter().flat_map(filled).map(u32::to_le_bytes);
        self.array(name, &format!("<U{longest}"), &[texts.len()], &mut letters)
    }

    /// Adds an array of 32-bit whole numbers.
    ///
    /// # Errors
    /// The file is too large, or the writer fails.
    pub fn whole(&mut self, name: &str, shape: &[usize], values: impl IntoIterator<Item = usize>) -> io::Result<()> {
        self.array(name, "<i4", shape, &mut values.into_iter().map(|value| (value as i32).to_le_bytes()))
    }

    /// Writes the list of the arrays, and returns what was written to.
    ///
    /// # Errors
    /// The file is too large, or the writer fails.
    pub fn finish(self) -> io::Result<W> {
        Ok(self.file.finish()?)
    }

    /// One file of version 1.0 of the format: a header that is a Python dictionary, padded to 64 bytes, and the numbers.
    fn array<const N: usize>(
        &mut self,
        name: &str,
        kind: &str,
        shape: &[usize],
        // Of no type of its own, so that this is compiled once for all arrays.
        values: &mut dyn Iterator<Item = [u8; N]>,
    ) -> io::Result<()> {
        let sizes: String = shape.iter().map(|size| format!("{size},")).collect();
        let mut header = format!("{{'descr': '{kind}', 'fortran_order': False, 'shape': ({sizes}), }}");
        // The preamble has ten bytes, and the header ends with a new line.
        // NumPy's format asks for a multiple of 64 bytes, so that arrays can be mapped into memory with their
        // alignment.
        header += &" ".repeat(63 - (header.len() + 10) % 64);
        header.push('\n');
        self.file.start_file(
            format!("{name}.npy"),
            SimpleFileOptions::default().compression_method(zip::CompressionMethod::Stored),
        )?;
        self.file.write_all(b"\x93NUMPY\x01\x00")?;
        self.file.write_all(&(header.len() as u16).to_le_bytes())?;
        self.file.write_all(header.as_bytes())?;
        // The file computes a checksum at each call.
        let mut buffer = BufWriter::new(&mut self.file);
        for value in values {
            buffer.write_all(&value)?;
        }
        buffer.flush()
    }
}
