//! Hyperelastic materials: the energy per volume at rest, as an expression in the invariants of the deformation.
//!
//! Theory: pages *Stiffness and the reduced space* and *Exact networks and patches* of the book.

use super::{Material, Moduli};
use crate::error::{Error, ErrorKind, Result};
use crate::file;
use crate::named::unknown;
use crate::symbolic::{Compiled, Program, Scope};
use nalgebra::Vector3;
use schemars::{JsonSchema, schema_for};
use serde::ser::SerializeStruct;
use serde::{Deserialize, Serialize, Serializer};
use springfit_shipped::MATERIALS;
use std::collections::BTreeMap;
use std::path::Path;
use std::sync::Arc;

/// The variables of an energy, besides the moduli and its own parameters.
const INVARIANTS: [&str; 7] = ["I1", "I2", "J", "I4", "l1", "l2", "l3"];
/// The index of `I4`, the squared stretch of the fibres.
const FIBRES: usize = 3;
/// The constants that follow from Young's modulus and Poisson's ratio.
const MODULI: [&str; 5] = ["young", "poisson", "lambda", "mu", "kappa"];

#[derive(Debug, Deserialize, JsonSchema)]
#[serde(deny_unknown_fields)]
struct Definition {
    /// The name is a short one, which errors show.
    name: String,
    /// The title is a headline.
    title: String,
    /// The energy is published there.
    source: Option<String>,
    /// Fibres have this direction at rest; its length does not matter.
    fibre: Option<[f64; 3]>,
    /// These parameters of the energy have these values, which a scene may replace.
    #[serde(default)]
    parameters: BTreeMap<String, f64>,
    /// Parts of expressions have these names; each may use those before it.
    #[serde(default, rename = "let")]
    #[schemars(with = "BTreeMap<String, String>")]
    definitions: toml::Table,
    /// The energy per volume at rest, in J/m³, is an expression of `I1`, `I2`, `J`, `I4`, or of the principal stretches `l1`, `l2`, `l3`.
    /// It may use `young`, `poisson`, `lambda`, `mu`, `kappa` and the parameters.
    energy: String,
}

/// The JSON Schema of material files.
pub fn schema() -> serde_json::Value {
    schema_for!(Definition).to_value()
}

/// The energy `W(F)` per volume at rest of one material, in J/m³. Copies share the formula.
#[derive(Debug, Clone)]
pub struct Energy {
    pub(super) formula: Arc<Formula>,
    pub(super) fibre: Option<Vector3<f64>>,
    /// The values of the moduli and parameters.
    pub(super) constants: Vec<f64>,
}

/// What energies of one law have in common.
#[derive(Debug)]
pub(super) struct Formula {
    name: String,
    title: String,
    source: Option<String>,
    /// The names of the numbers beside the moduli.
    parameters: Vec<String>,
    /// A function of the invariants, then of the moduli, then of the parameters.
    pub(super) expression: Compiled,
    /// The derivatives in the invariants.
    pub(super) slopes: Vec<Program>,
    pub(super) by_stretches: bool,
}

impl Serialize for Energy {
    /// Writes what a list of energies tells of one.
    fn serialize<S: Serializer>(&self, to: S) -> std::result::Result<S::Ok, S::Error> {
        let mut keys = to.serialize_struct("Energy", 5)?;
        keys.serialize_field("name", self.name())?;
        keys.serialize_field("title", self.title())?;
        keys.serialize_field("parameters", &self.parameters().collect::<BTreeMap<_, _>>())?;
        keys.serialize_field("fibres", &self.has_fibres())?;
        keys.serialize_field("source", &self.source())?;
        keys.end()
    }
}

/// The values of [`MODULI`].
fn moduli_of(material: Material) -> [f64; 5] {
    let (young, poisson) = (material.young(), material.poisson());
    // An energy is that of the solid in every state, because the stretches across planes and rods are searched for with
    // it. Its λ is therefore not that of plane stress.
    let lambda = young * poisson / ((1.0 + poisson) * (1.0 - 2.0 * poisson));
    let mu = young / (2.0 * (1.0 + poisson));
    [young, poisson, lambda, mu, lambda + 2.0 / 3.0 * mu]
}

impl Energy {
    /// The shipped energy with this name, or the energy in the file at this path, with the moduli of `material`.
    ///
    /// # Errors
    /// There is no such energy, its file is wrong, or at rest it has stress or another stiffness than `material`.
    pub fn load(name_or_path: &str, material: Material) -> Result<Energy> {
        Energy::in_file(name_or_path, |text| Energy::parse(text, material))
    }

    /// Reads the shipped energy with this name, or the energy in the file at this path, with the parameters of the file and moduli of 1 Pa
    /// and 0.3. [`Energy::of`] gives it the moduli of a material, and proves it at rest.
    ///
    /// # Errors
    /// There is no such energy, or its file is wrong.
    pub fn read(name_or_path: &str) -> Result<Energy> {
        let material = Material::for_body(3, 1.0, 0.3, None, None)?;
        Energy::in_file(name_or_path, |text| Energy::of_text(text, material).map_err(|e| file::on_line_of_key(e, text)))
    }

    fn in_file(name_or_path: &str, parse: impl FnOnce(&str) -> Result<Energy>) -> Result<Energy> {
        if name_or_path.ends_with(".toml") {
            let path = Path::new(name_or_path);
            return parse(&file::read_text(path)?).map_err(|e| e.in_file(path));
        }
        match MATERIALS.iter().find(|(name, _)| *name == name_or_path) {
            Some((name, text)) => parse(text).map_err(|e| e.in_file(Path::new(&format!("materials/{name}.toml")))),
            None => {
                let names: Vec<_> = MATERIALS.iter().map(|(name, _)| *name).collect();
                let expected = format!("one of {}, or a path that ends in .toml", names.join(", "));
                Err(unknown(expected, names, name_or_path).at_key("energy"))
            }
        }
    }

    /// The shipped energies, with moduli of 1 Pa and 0.3.
    ///
    /// # Errors
    /// None for the files that are shipped: all are tested.
    pub fn shipped() -> Result<Vec<Energy>> {
        let material = Material::for_body(3, 1.0, 0.3, None, None)?;
        MATERIALS.iter().map(|(name, _)| Energy::load(name, material)).collect()
    }

    /// Whether it has a direction of fibres.
    pub fn has_fibres(&self) -> bool {
        self.fibre.is_some()
    }

    /// Parses the text of a material file and proves that at rest the body is free of stress and has the stiffness of `material`, to
    /// which fibres may add.
    ///
    /// # Errors
    /// The text is wrong. The error names the line and the key, what was expected and what was found.
    pub fn parse(text: &str, material: Material) -> Result<Energy> {
        let proved = |energy: Energy| energy.check_rest().map(|()| energy);
        Energy::of_text(text, material).and_then(proved).map_err(|e| file::on_line_of_key(e, text))
    }

    fn of_text(text: &str, material: Material) -> Result<Energy> {
        let definition: Definition = file::parse_toml(text)?;
        let names: Vec<&str> =
            INVARIANTS.iter().chain(&MODULI).copied().chain(definition.parameters.keys().map(String::as_str)).collect();
        // Parameters are variables; they are defined here only to learn whether their names are new ones.
        let mut check = Scope::new(&[INVARIANTS.as_slice(), MODULI.as_slice()].concat());
        for (name, value) in &definition.parameters {
            let key = format!("parameters.{name}");
            if !value.is_finite() {
                return Err(Error::expected(key, "a finite number", value));
            }
            check.define(name, "0").map_err(|e| e.at_key(key))?;
        }
        let mut scope = Scope::new(&names);
        for (name, value) in &definition.definitions {
            let key = format!("let.{name}");
            let text =
                value.as_str().ok_or_else(|| Error::expected(&key, "an expression in quotes", value.type_str()))?;
            scope.define(name, text).map_err(|e| e.under(key))?;
        }
        let expression = scope.expression(&definition.energy).map_err(|e| e.under("energy"))?;
        let fibre = definition.fibre.map(Vector3::from);
        if fibre.is_some_and(|a| !(a.norm() > 0.0 && a.norm().is_finite())) {
            return Err(Error::expected("fibre", "a direction", format!("{:?}", definition.fibre.unwrap_or_default())));
        }
        let uses = |range: std::ops::Range<usize>| range.clone().any(|v| expression.uses(v));
        if uses(3..4) && fibre.is_none() {
            return Err(Error::expected("fibre", "the direction of the fibres that I4 belongs to", "none"));
        }
        if uses(3..4) && uses(4..7) {
            return Err(Error::at("energy", "expected either I4 or principal stretches, found both"));
        }
        let formula = Formula {
            name: definition.name,
            title: definition.title,
            source: definition.source,
            by_stretches: uses(4..7),
            slopes: (0..INVARIANTS.len()).map(|v| Program::of(&expression.derivative(v))).collect(),
            expression: expression.into(),
            parameters: definition.parameters.keys().cloned().collect(),
        };
        let constants = moduli_of(material).into_iter().chain(definition.parameters.into_values()).collect();
        Ok(Energy { formula: Arc::new(formula), fibre: fibre.map(|a| a.normalize()), constants })
    }

    /// Gives the energy the moduli of another material, other values of some parameters, and fibres in another direction.
    ///
    /// # Errors
    /// The energy has no such parameter, a value is not finite, it has no fibres or their direction is zero, or with these values it has
    /// stress at rest or another stiffness than `material`.
    pub fn of(&self, material: Material, parameters: &[(&str, f64)], fibre: Option<[f64; 3]>) -> Result<Energy> {
        let mut constants = self.constants.clone();
        constants[..MODULI.len()].copy_from_slice(&moduli_of(material));
        for &(name, value) in parameters {
            let place = self.parameter(name)?;
            if !value.is_finite() {
                return Err(Error::expected(format!("parameters.{name}"), "a finite number", value));
            }
            constants[place] = value;
        }
        let mut energy = Energy { constants, ..self.clone() };
        if let Some(direction) = fibre {
            let a = Vector3::from(direction);
            if !self.has_fibres() {
                let expected = format!("a law with fibres: \"{}\" has none", self.name());
                return Err(Error::expected("fibre", expected, format!("{direction:?}")));
            }
            if !(a.norm() > 0.0 && a.norm().is_finite()) {
                return Err(Error::expected("fibre", "a direction", format!("{direction:?}")));
            }
            energy.fibre = Some(a.normalize());
        }
        energy.check_rest()?;
        Ok(energy)
    }

    /// The place of a parameter among the constants.
    fn parameter(&self, name: &str) -> Result<usize> {
        let names = &self.formula.parameters;
        let expected = || match &names[..] {
            [] => format!("none: the law \"{}\" has no parameters", self.name()),
            _ => format!("one of {}", names.join(", ")),
        };
        let place = names.iter().position(|known| known == name).map(|place| MODULI.len() + place);
        place.ok_or_else(|| unknown(expected(), names.iter().map(String::as_str), name).at_key("parameters"))
    }

    /// Checks that the energy has a parameter with this name.
    ///
    /// # Errors
    /// It has none.
    pub fn check_parameter(&self, name: &str) -> Result<()> {
        self.parameter(name).map(|_| ())
    }

    /// The name in files and options.
    pub fn name(&self) -> &str {
        &self.formula.name
    }

    /// The name in headings.
    pub fn title(&self) -> &str {
        &self.formula.title
    }

    /// Where the energy is published.
    pub fn source(&self) -> Option<&str> {
        self.formula.source.as_deref()
    }

    /// The numbers beside the moduli, with their values.
    pub fn parameters(&self) -> impl Iterator<Item = (&str, f64)> {
        let values = self.constants[MODULI.len()..].iter().copied();
        self.formula.parameters.iter().map(String::as_str).zip(values)
    }

    /// Young's modulus at rest, in Pa.
    pub fn young(&self) -> f64 {
        self.constants[0]
    }

    /// Poisson's ratio at rest.
    pub fn poisson(&self) -> f64 {
        self.constants[1]
    }

    /// The moduli of the solid at rest, in Pa.
    pub fn moduli(&self) -> Moduli {
        Moduli { lambda: self.constants[2], mu: self.constants[3] }
    }

    /// W as a function of `I1`, `I2` and `J` alone, with fibres that are not stretched; `None` for energies of the
    /// principal stretches.
    pub fn of_invariants(&self, invariants: [f64; 3]) -> Option<f64> {
        let [i1, i2, j] = invariants;
        let at: Vec<f64> = [i1, i2, j, 1.0, 1.0, 1.0, 1.0].into_iter().chain(self.constants.iter().copied()).collect();
        (!self.formula.by_stretches).then(|| self.formula.expression.evaluate(&at))
    }

    /// The direction of the fibres at rest, and the force per volume of a spring that measures their stretch c, as an
    /// expression with the parameter `a`: `a ∂W/∂c`, `I4 = c²`. `None` without fibres.
    ///
    /// # Errors
    /// The stress of the fibres depends on more than their stretch; the kind is `Unsupported`.
    pub fn fibre_law(&self) -> Result<Option<(Vector3<f64>, String)>> {
        let Some(direction) = self.fibre else { return Ok(None) };
        let slope = self.formula.expression.derivative(FIBRES);
        if (0..INVARIANTS.len()).any(|v| v != FIBRES && slope.uses(v)) {
            let problem = "the energy of the fibres depends on more than their stretch";
            return Err(Error::at("energy", problem).of_kind(ErrorKind::Unsupported));
        }
        // With all their digits, and in parentheses for their signs.
        let values: Vec<String> = self.constants.iter().map(|value| format!("({value:?})")).collect();
        let names: Vec<&str> = INVARIANTS.iter().map(|_| "(c^2)").chain(values.iter().map(String::as_str)).collect();
        Ok(Some((direction, format!("a*2*c*({})", slope.text(&names)))))
    }
}
