//! The loads of a scene at large deformation on a finer mesh of its body.

use super::case::Case;
use super::finer_linear::FinerAnswer;
use super::large::{check_embedded, reach, work};
use crate::error::{Error, ErrorKind, Result};
use crate::material::EnergyMap;
use crate::mesh::Mesh;
use crate::model::{Body, Support, check_body};
use crate::progress::{Event, Progress};
use crate::solve::{Ending, Newton};
use crate::whole::{MakeLoads, Stretched, StretchedLoads};

/// The laws of a finer mesh, and how its loads are followed.
pub(super) struct FinerLaws {
    laws: EnergyMap,
    newton: Newton,
}

impl FinerLaws {
    /// # Errors
    /// The cells do not fill their space, or a law does not serve them.
    pub fn of(mesh: &Mesh, laws: EnergyMap, newton: Newton) -> Result<FinerLaws> {
        check_embedded(mesh, &laws)?;
        check_body(mesh)?;
        Ok(FinerLaws { laws, newton })
    }

    /// The answers to all loads.
    ///
    /// # Errors
    /// A load is not reached, or the equations do not fit into memory.
    pub fn answers(&self, mesh: &Mesh, cases: &[Case], progress: &mut Progress) -> Result<Vec<FinerAnswer>> {
        let model = Body::new(mesh, &self.laws);
        let mut all = Vec::new();
        for (done, case) in cases.iter().enumerate() {
            progress(Event::stage("finer body", done, cases.len()));
            let found = reach(&self.newton, &model, mesh, case)?;
            if found.ending != Ending::Converged {
                let expected = "expected loads under which the finer body has an equilibrium";
                let lost = format!("{expected}, found \"{}\", lost at {:.3} of it", case.name, found.load);
                return Err(Error::new(lost).of_kind(ErrorKind::Infeasible));
            }
            let work = work(case, &model, &mesh.points, &found.displacement);
            all.push(FinerAnswer { displacement: found.displacement, work });
        }
        Ok(all)
    }

    /// The loads that stretch the body so far.
    ///
    /// # Errors
    /// The equations do not fit into memory.
    pub fn stretched(&self, mesh: &Mesh, support: &Support, make: &MakeLoads, stretch: f64) -> Result<StretchedLoads> {
        let model = Body::new(mesh, &self.laws);
        Stretched { model: &model, mesh, newton: self.newton, stretch }.loads(support, make)
    }
}
