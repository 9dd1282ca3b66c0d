//! Made loads at large deformation, each as large as it takes to stretch the body.
//!
//! Theory: page *Whole-object fits* of the book.

use super::body::WholeBody;
use super::held::Held;
use super::made_loads::MadeLoads;
use super::recipe::{STRETCH, WholeRecipe};
use super::targets::Loads;
use crate::error::{Error, ErrorKind, Result};
use crate::model::Body;
use crate::progress::{Event, Progress};
use crate::whole::{Stretched, StretchedLoads};
use std::sync::Arc;

/// Added to the seed for each further draw of a load.
const ANEW: u64 = 1_000_003;

impl WholeBody<'_> {
    /// What is known of made loads before any is made; `None` at small deformation or without such loads.
    pub(super) fn made_loads(&self, recipe: &WholeRecipe) -> Option<MadeLoads> {
        let stretch = recipe.stretch.unwrap_or(STRETCH);
        let is_asked = self.newton.is_some() && recipe.has_made_loads();
        is_asked.then(|| MadeLoads { stretch, ..MadeLoads::default() })
    }

    /// The loads that stretch the body, or the finer one, so far.
    ///
    /// # Errors
    /// The support does not hold the body, or it has an equilibrium under none of them; the error has the key `key`.
    pub(super) fn stretched(
        &self,
        key: &str,
        held: &Held,
        (make, seed): (&Loads, u64),
        stretch: f64,
        name: String,
        progress: &mut Progress,
    ) -> Result<Arc<StretchedLoads>> {
        let draw = |draw: u64| seed.wrapping_add(ANEW.wrapping_mul(draw));
        self.check_held(key, &held.support)?;
        let found = match (self.fine, &held.fine, self.laws, self.newton) {
            (Some(fine), Some(support), ..) => {
                let make = |again: u64| make(fine.mesh(), support, draw(again));
                fine.stretched(name, support, &make, stretch, progress)?
            }
            (_, _, Some(laws), Some(newton)) => {
                progress(Event::stage("made loads", 0, 1));
                let model = Body::new(self.mesh, laws);
                let body = Stretched { model: &model, mesh: self.mesh, newton, stretch };
                Arc::new(body.loads(&held.support, &|again| make(self.mesh, &held.support, draw(again)))?)
            }
            _ => Arc::default(),
        };
        if found.loads.is_empty() {
            let expected = format!("loads under which the body has an equilibrium at half of the stretch {stretch}");
            let found = format!("none of {} ({key}), held at {}", found.out.len(), held.words());
            return Err(Error::expected("stretch", expected, found).of_kind(ErrorKind::Infeasible));
        }
        Ok(found)
    }
}
