//! What a scene asks of a body, before anything is solved.

use crate::analysis::locking::{Locking, TooStiff};
use crate::analysis::moduli::moduli_of_body;
use crate::error::{Error, Result};
use crate::material::{EnergyMap, MaterialMap};
use crate::mesh::Mesh;
use crate::model::{Deformation, Support};
use crate::study::forecast::Forecast;
use springfit_scenes::{
    Case, Controls, Event, FitOutcome, Gauged, Progress, Scene, Standard, TimePlan, judge_by_quadratic_elements,
    judge_sheet, load_cases,
};

/// The body of a scene with its material, its support and its loads.
pub(super) struct Posed<'a> {
    pub scene: &'a Scene,
    pub mesh: Mesh,
    pub material: MaterialMap,
    /// The support of the `[[fix]]` entries.
    pub support: Support,
    /// The loads, each under its own support.
    pub cases: Vec<Case>,
    /// The energies of the laws, at large deformation; until they are solved.
    pub energy: Option<EnergyMap>,
    pub gauged: Option<Gauged>,
    /// What is asked for over time.
    pub plan: TimePlan,
    /// What must be known of the solution that errors are relative to, one sentence each.
    pub of_reference: Vec<String>,
}

impl<'a> Posed<'a> {
    /// Reads all inputs, and says what is expected to take long.
    ///
    /// # Errors
    /// An input is wrong.
    pub fn of(scene: &'a Scene, controls: &Controls, progress: &mut Progress) -> Result<Posed<'a>> {
        let mesh = scene.build_mesh()?;
        let material = scene.material_of(&mesh)?;
        drawable(scene, &mesh)?;
        let (support, cases) = load_cases(scene, &mesh, &material)?;
        let energy = scene.laws(&mesh, &material)?;
        if controls.announce
            && let Some(words) = Forecast::of_body(scene, &mesh, &material, &cases, energy.as_ref())?.announcement()
        {
            progress(Event::Note(&words));
        }
        let gauged = scene.gauge().map(|gauge| Gauged::new(scene, gauge, &mesh, &cases)).transpose()?;
        let held = held_points(&mesh, &support, &cases);
        let plan = TimePlan::of(scene, &mesh, (&material, energy.as_ref()), &support, held)?;
        let of_reference = Vec::new();
        Ok(Posed { scene, mesh, material, support, cases, energy, gauged, plan, of_reference })
    }

    /// The error in the scene's file, unless it names another place.
    pub fn in_scene(&self, error: Error) -> Error {
        error.placed(|e| e.in_file(self.scene.path()))
    }

    /// Whether each point is held in all directions under every load; without loads, by `[[fix]]`.
    pub fn held_points(&self) -> Vec<bool> {
        held_points(&self.mesh, &self.support, &self.cases)
    }

    /// Makes errors relative to quadratic elements where the cells of the mesh are too stiff in these deformations, one for each load, and the scene
    /// does not say what errors are relative to.
    pub fn judge_by_quadratic_elements(
        &mut self,
        too_stiff: TooStiff,
        deformations: &[Option<Deformation>],
        progress: &mut Progress,
    ) {
        if self.scene.reference().is_none() {
            let cells = (too_stiff, deformations);
            let notes = judge_by_quadratic_elements(self.scene, &self.mesh, &mut self.cases, cells, progress);
            self.of_reference.extend(notes);
            self.tell_of_stiff_targets();
        }
        if let TooStiff::Locks(locking) = too_stiff {
            self.tell_of_finer_locking(locking);
        }
    }

    /// Says that cells of higher order may be too stiff as well, where nothing finer says by how much.
    pub fn tell_of_higher_order(&mut self) {
        let found = Locking::of_higher_order(&self.mesh, &self.material).filter(|_| self.scene.reference().is_none());
        if let Some(Locking { poisson, .. }) = found {
            self.of_reference.push(format!(
                "at nu = {poisson} cells of higher order are too stiff on coarse meshes as well, and errors are relative to them: [reference] with refine = 1 \
                 compares with halved cells"
            ));
        }
    }

    /// Says that the triangles of a sheet that bends are too large for its loads.
    pub fn judge_sheet<'b>(&mut self, displacements: impl Iterator<Item = &'b Vec<f64>>, progress: &mut Progress) {
        self.of_reference.extend(judge_sheet(self.scene, &self.mesh, &self.cases, displacements, progress));
    }

    /// Says that fits to the whole object have seen cells that are too stiff, where what they are compared with is not.
    fn tell_of_stiff_targets(&mut self) {
        let whole = self.scene.fits().iter().filter(|fit| fit.recipe.whole().is_some());
        let fits: Vec<&str> = whole.map(|fit| &*fit.name).collect();
        if !fits.is_empty() && self.cases.iter().any(|case| case.finer.is_some()) {
            self.of_reference.push(format!(
                "{}: fitted to the finite elements of the mesh, which are too stiff, and compared with quadratic elements here; from = \"quadratic\" in \
                 [reference] fits to these",
                fits.join(", ")
            ));
        }
    }

    /// Says that a finer body of the same cells locks as they do.
    fn tell_of_finer_locking(&mut self, Locking { poisson, .. }: Locking) {
        let Some(entry) = self.scene.reference() else { return };
        let is_finer = entry.standard() == Standard::FinerBody && !entry.is_of_cells() && entry.mesh.is_none();
        if is_finer {
            self.of_reference.push(format!(
                "at nu = {poisson} linear cells lock, and those of the finer body with them: errors are relative to what is still too stiff; from = \
                 \"quadratic\" in [reference] does not lock"
            ));
        }
    }

    /// Says that the finite elements which errors at large deformation are relative to lock.
    pub fn tell_of_locking(&mut self, locking: Locking) {
        if self.scene.reference().is_some_and(|entry| !entry.is_of_cells()) {
            self.tell_of_finer_locking(locking);
            return;
        }
        self.of_reference.push(format!(
            "at nu = {} linear cells lock: errors at large deformation are relative to the finite elements of the mesh, which are too stiff",
            locking.poisson
        ));
    }

    /// The moduli of each network as a whole, if the scene asks for them.
    ///
    /// # Errors
    /// The equations of a network do not fit into memory.
    pub fn measure_moduli(&self, fits: &mut [FitOutcome], progress: &mut Progress) -> Result<()> {
        if !self.scene.output().moduli {
            return Ok(());
        }
        let count = fits.len();
        for (done, fit) in fits.iter_mut().enumerate() {
            progress(Event::stage("moduli", done, count));
            fit.network.check_size()?;
            let found = moduli_of_body(&self.mesh, &fit.network.stiffness(&self.mesh.points))?;
            fit.moduli = found.map(|moduli| moduli.of_solid(self.material.state()));
            if fit.moduli.is_none() {
                let problem = "the whole network has no moduli: some strain meets no resistance, no point is inside the body, or other cells are attached to it";
                progress(Event::Note(&format!("{}: {problem}", fit.fit.name)));
            }
        }
        Ok(())
    }
}

/// Whether each point is held in all directions under every load; without loads, by `[[fix]]`.
fn held_points(mesh: &Mesh, support: &Support, cases: &[Case]) -> Vec<bool> {
    let d = mesh.dimension;
    let holds = |support: &Support, point: usize| (point * d..(point + 1) * d).all(|dof| support.is_fixed(dof));
    let held = |point| match cases {
        [] => holds(support, point),
        cases => cases.iter().all(|case| holds(&case.support, point)),
    };
    (0..mesh.point_count()).map(held).collect()
}

/// Checked before the work starts, not after it.
fn drawable(scene: &Scene, mesh: &Mesh) -> Result<()> {
    match mesh.blocks.iter().find(|b| scene.output().vtu && b.element.formats.vtk.is_none()) {
        Some(block) => {
            let expected = "elements that name their VTK type in [formats]";
            Err(Error::expected("output.vtu", expected, &block.element.name).in_file(scene.path()))
        }
        None => Ok(()),
    }
}
