//! `springfit derive`.

use super::state::State;
use crate::terminal::Terminal;
use clap::Args;
use springfit_element::element::Element;
use springfit_element::material::Plane;
use springfit_element::springs::Springs;
use springfit_fit::fit::{ClosedForm, Weight};
use springfit_foundation::error::{Error, Result};
use springfit_foundation::named::unknown;
use springfit_report::report::Derivation;
use springfit_studies::study::Event;

/// Print the exact closed forms of an element's stiffness and spring constants
#[derive(Args)]
#[command(after_help = EXAMPLES)]
pub struct Derive {
    /// A shipped element's name, or an element file
    element: String,
    /// Lengths a, b, c along the axes as variables, instead of the reference cell
    #[arg(long)]
    sides: bool,
    /// Plane element: stress or strain, for the constants in terms of E and nu [default: stress]
    #[arg(long)]
    plane: Option<State>,
    /// An orthotropic material whose axes are those of the coordinates: constants in terms of the entries C11, C12, ... of its stiffness
    #[arg(long)]
    orthotropic: bool,
    /// Spring groups to use, separated by commas [default: all that are not optional]
    #[arg(long, value_delimiter = ',')]
    springs: Option<Vec<String>>,
    /// exact, frobenius or offdiag [default: all three; with --orthotropic, which has no exact network, the last two]
    #[arg(long)]
    objective: Option<String>,
    /// Print the stiffness matrix as well
    #[arg(long, help_heading = "Output")]
    matrix: bool,
    /// Print LaTeX
    #[arg(long, help_heading = "Output")]
    latex: bool,
}

const EXAMPLES: &str = "\
Examples:
  springfit derive quad4
  springfit derive quad4 --plane strain --sides          # a rectangle with sides a and b
  springfit derive tri3 --objective frobenius --latex
  springfit derive quad4 --orthotropic --sides           # an orthotropic rectangle";

impl Derive {
    pub fn run(&self, terminal: &mut Terminal) -> Result<()> {
        let (exact, weights) = self.forms()?;
        let element = Element::load(&self.element)?;
        let plane = match (element.dimension(), self.plane) {
            (2, plane) => Some(plane.map_or(Plane::Stress, Into::into)),
            (_, Some(_)) => {
                return Err(Error::at("--plane", format!("expected a plane element, found {}", element.name)));
            }
            (_, None) => None,
        };
        let springs = Springs::select(&element, self.springs.as_deref()).map_err(Error::of_option)?;
        terminal.show(Event::stage("closed form", 0, 1));
        let form = if self.orthotropic { ClosedForm::orthotropic } else { ClosedForm::new };
        let form = form(&element, &springs, self.sides)?;
        let fits: Vec<_> = weights.iter().map(|weight| form.fit(*weight)).collect();
        let exact = exact.then(|| form.exact());
        let (exact, matrix) = (exact.as_ref(), self.matrix);
        let derivation = Derivation { element: &element, form: &form, exact, fits: &fits, plane, matrix };
        terminal.print(&if self.latex { derivation.latex() } else { derivation.text() })
    }

    /// Whether the exact network is derived, and the weights of the fits that are.
    fn forms(&self) -> Result<(bool, Vec<Weight>)> {
        match self.objective.as_deref() {
            None => Ok((!self.orthotropic, vec![Weight::None, Weight::OffDiagonal])),
            Some("exact") if self.orthotropic => Err(Error::expected(
                "--objective",
                "frobenius or offdiag: exact networks are those of isotropic materials",
                "exact",
            )),
            Some("exact") => Ok((true, Vec::new())),
            Some("frobenius") => Ok((false, vec![Weight::None])),
            Some("offdiag") => Ok((false, vec![Weight::OffDiagonal])),
            Some(other) => {
                let expected = "exact, frobenius or offdiag; others are solved cell by cell and have no formula here";
                Err(unknown(expected, ["exact", "frobenius", "offdiag"], other).at_key("--objective"))
            }
        }
    }
}
