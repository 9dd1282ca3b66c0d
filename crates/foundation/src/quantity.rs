//! Physical quantities as texts, with or without a unit: `10kPa`, `2.5 mm`, `1000`.

use crate::error::{Error, Result};

/// What is measured. A number without a unit is in the SI unit.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Quantity {
    /// A length, in m.
    Length,
    /// An area, in m².
    Area,
    /// A volume, in m³.
    Volume,
    /// A pressure, a modulus or a stress, in Pa.
    Pressure,
    /// A mass density, in kg/m³.
    Density,
    /// A time, in s.
    Time,
    /// The length of one unit of a mesh, in m. A unit alone stands for one of it: `mm` is 0.001 m.
    MeshUnit,
}

/// A unit and its power of ten in the SI unit. The SI unit comes first in each list.
type Unit = (&'static str, i32);

/// Units of length.
const LENGTHS: [Unit; 8] =
    [("m", 0), ("km", 3), ("dm", -1), ("cm", -2), ("mm", -3), ("um", -6), ("µm", -6), ("nm", -9)];
/// Units of area.
const AREAS: [Unit; 8] =
    [("m^2", 0), ("m²", 0), ("cm^2", -4), ("cm²", -4), ("mm^2", -6), ("mm²", -6), ("um^2", -12), ("µm²", -12)];
/// Units of volume.
const VOLUMES: [Unit; 12] = [
    ("m^3", 0),
    ("m³", 0),
    ("dm^3", -3),
    ("dm³", -3),
    ("cm^3", -6),
    ("cm³", -6),
    ("mm^3", -9),
    ("mm³", -9),
    ("ml", -6),
    ("mL", -6),
    ("l", -3),
    ("L", -3),
];
/// Units of pressure.
const PRESSURES: [Unit; 11] = [
    ("Pa", 0),
    ("kPa", 3),
    ("MPa", 6),
    ("GPa", 9),
    ("hPa", 2),
    ("mbar", 2),
    ("bar", 5),
    ("N/m^2", 0),
    ("N/m²", 0),
    ("N/mm^2", 6),
    ("N/mm²", 6),
];
/// Units of density.
const DENSITIES: [Unit; 4] = [("kg/m^3", 0), ("kg/m³", 0), ("g/cm^3", 3), ("g/cm³", 3)];
/// Units of time.
const TIMES: [Unit; 4] = [("s", 0), ("ms", -3), ("us", -6), ("µs", -6)];

impl Quantity {
    /// The first of the units that has this size in the SI unit, such as `mm` for a length of 0.001 m.
    pub fn unit_of(self, size: f64) -> Option<&'static str> {
        // Sizes are read from texts, which may have passed through a product.
        let is_it = |(_, power): &&Unit| (size / 10f64.powi(*power) - 1.0).abs() < 1e-9;
        self.units().iter().find(is_it).map(|(name, _)| *name)
    }

    fn units(self) -> &'static [Unit] {
        match self {
            Quantity::Length | Quantity::MeshUnit => &LENGTHS,
            Quantity::Area => &AREAS,
            Quantity::Volume => &VOLUMES,
            Quantity::Pressure => &PRESSURES,
            Quantity::Density => &DENSITIES,
            Quantity::Time => &TIMES,
        }
    }

    /// An example of a valid text, for error messages.
    pub fn expected(self) -> &'static str {
        match self {
            Quantity::Length => "a length such as 0.005, \"5 mm\" or \"0.5cm\"",
            Quantity::Area => "an area such as 1e-4, \"100 mm^2\" or \"1cm^2\"",
            Quantity::Volume => "a volume such as 3e-5, \"30 ml\" or \"30 cm^3\"",
            Quantity::Pressure => "a pressure such as 10000, \"10 kPa\" or \"0.01MPa\"",
            Quantity::Density => "a density such as 1060, \"1060 kg/m^3\" or \"1.06 g/cm^3\"",
            Quantity::Time => "a time such as 0.005, \"5 ms\" or \"1/60 s\"",
            Quantity::MeshUnit => "the length of one mesh unit such as 0.001, \"mm\" or \"25.4 mm\"",
        }
    }

    /// The value of the text in the SI unit.
    ///
    /// # Errors
    /// The text is not a number followed by nothing or by a unit of this quantity.
    pub fn parse(self, text: &str) -> Result<f64> {
        let trimmed = text.trim();
        if let Some(value) = number(trimmed) {
            return Ok(value);
        }
        let read = |(unit, power): &Unit| {
            let number = trimmed.strip_suffix(unit)?.trim_end();
            let value: f64 = match (self, number) {
                (Quantity::MeshUnit, "") => 1.0,
                _ => self::number(number)?,
            };
            // Dividing by a whole power of ten gives the double that is nearest to the decimal number, as parsing the
            // same number without a unit does.
            let factor = 10f64.powi(power.abs());
            Some(if *power < 0 { value / factor } else { value * factor })
        };
        self.units().iter().find_map(read).ok_or_else(|| {
            let units: Vec<&str> = self.units().iter().map(|(unit, _)| *unit).collect();
            let expected = format!("{} (units: {})", self.expected(), units.join(", "));
            Error::new(format!("expected {expected}, found \"{text}\""))
        })
    }
}

/// A number, or two with a stroke between them, such as `1/60`.
fn number(text: &str) -> Option<f64> {
    match text.split_once('/') {
        Some((above, below)) => {
            let (above, below): (f64, f64) = (above.trim_end().parse().ok()?, below.trim_start().parse().ok()?);
            Some(above / below)
        }
        None => text.parse().ok(),
    }
}
