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
    /// A force, in N.
    Force,
    /// A moment of forces, in N·m.
    Moment,
    /// An acceleration, in m/s².
    Acceleration,
    /// A force for each volume, in N/m³.
    ForceDensity,
    /// The length of one unit of a mesh, in m. A unit alone stands for one of it: `mm` is 0.001 m.
    MeshUnit,
}

/// A unit, and its size in the SI unit as a number and a power of ten.
///
/// Powers are written `^2` and `^3`, and micro `u`; [`spellings`] has the other ways to write them.
type Unit = (&'static str, f64, i32);

/// Units of length; the SI unit comes first in each list.
const LENGTHS: [Unit; 10] = [
    ("m", 1.0, 0),
    ("km", 1.0, 3),
    ("dm", 1.0, -1),
    ("cm", 1.0, -2),
    ("mm", 1.0, -3),
    ("um", 1.0, -6),
    ("nm", 1.0, -9),
    // An inch is 25.4 mm by definition, and a foot twelve of them.
    ("in", 25.4, -3),
    ("inch", 25.4, -3),
    ("ft", 304.8, -3),
];
/// Units of area.
const AREAS: [Unit; 6] = [
    ("m^2", 1.0, 0),
    ("dm^2", 1.0, -2),
    ("cm^2", 1.0, -4),
    ("mm^2", 1.0, -6),
    ("um^2", 1.0, -12),
    ("in^2", 645.16, -6),
];
/// Units of volume.
const VOLUMES: [Unit; 12] = [
    ("m^3", 1.0, 0),
    ("dm^3", 1.0, -3),
    ("cm^3", 1.0, -6),
    ("mm^3", 1.0, -9),
    ("um^3", 1.0, -18),
    ("cc", 1.0, -6),
    ("ul", 1.0, -9),
    ("uL", 1.0, -9),
    ("ml", 1.0, -6),
    ("mL", 1.0, -6),
    ("l", 1.0, -3),
    ("L", 1.0, -3),
];
/// Units of pressure.
const PRESSURES: [Unit; 17] = [
    ("Pa", 1.0, 0),
    ("kPa", 1.0, 3),
    ("MPa", 1.0, 6),
    ("GPa", 1.0, 9),
    ("hPa", 1.0, 2),
    ("mbar", 1.0, 2),
    ("bar", 1.0, 5),
    ("N/m^2", 1.0, 0),
    ("kN/m^2", 1.0, 3),
    ("N/cm^2", 1.0, 4),
    ("N/mm^2", 1.0, 6),
    ("kN/mm^2", 1.0, 9),
    ("dyn/cm^2", 1.0, -1),
    // Conventional millimetres of mercury and centimetres of water, and pounds per square inch (BIPM; NIST SP 811).
    ("mmHg", 133.322387415, 0),
    ("cmH2O", 98.0665, 0),
    ("psi", 6894.757293168, 0),
    ("ksi", 6894.757293168, 3),
];
/// Units of density.
const DENSITIES: [Unit; 13] = [
    ("kg/m^3", 1.0, 0),
    ("g/cm^3", 1.0, 3),
    ("g/cc", 1.0, 3),
    ("g/ml", 1.0, 3),
    ("g/mL", 1.0, 3),
    ("g/l", 1.0, 0),
    ("g/L", 1.0, 0),
    ("kg/l", 1.0, 3),
    ("kg/L", 1.0, 3),
    ("kg/dm^3", 1.0, 3),
    ("mg/mm^3", 1.0, 3),
    ("t/m^3", 1.0, 3),
    // Programs of finite elements that compute in tonnes, millimetres, seconds and newtons have densities in this unit.
    ("t/mm^3", 1.0, 12),
];
/// Units of time.
// A minute is 6.0 · 10¹ s and an hour 36 · 10² s, so that the factor is a whole power of ten, as for the other units.
const TIMES: [Unit; 6] =
    [("s", 1.0, 0), ("ms", 1.0, -3), ("us", 1.0, -6), ("ns", 1.0, -9), ("min", 6.0, 1), ("h", 36.0, 2)];
/// Units of force.
const FORCES: [Unit; 11] = [
    ("N", 1.0, 0),
    ("kN", 1.0, 3),
    ("MN", 1.0, 6),
    ("mN", 1.0, -3),
    ("uN", 1.0, -6),
    ("nN", 1.0, -9),
    ("pN", 1.0, -12),
    ("dyn", 1.0, -5),
    // Weights of a kilogram, a gram and a pound under standard gravity (NIST SP 811).
    ("kgf", 9.80665, 0),
    ("gf", 9.80665, -3),
    ("lbf", 4.4482216152605, 0),
];
/// Units of moment.
const MOMENTS: [Unit; 8] = [
    ("N m", 1.0, 0),
    ("Nm", 1.0, 0),
    ("kN m", 1.0, 3),
    ("kNm", 1.0, 3),
    ("N mm", 1.0, -3),
    ("Nmm", 1.0, -3),
    ("mN m", 1.0, -3),
    ("uN m", 1.0, -6),
];
/// Units of force for each volume.
const FORCE_DENSITIES: [Unit; 5] =
    [("N/m^3", 1.0, 0), ("kN/m^3", 1.0, 3), ("MN/m^3", 1.0, 6), ("N/cm^3", 1.0, 6), ("N/mm^3", 1.0, 9)];
/// Units of acceleration.
const ACCELERATIONS: [Unit; 4] = [("m/s^2", 1.0, 0), ("cm/s^2", 1.0, -2), ("mm/s^2", 1.0, -3), ("km/s^2", 1.0, 3)];

/// The ways to write a unit: `mm^2`, `mm²`, `mm2`, and `um`, `µm` with either letter that Unicode has for micro.
fn spellings(unit: &str) -> Vec<String> {
    let powers = [unit.to_string(), unit.replace("^2", "²").replace("^3", "³"), unit.replace('^', "")];
    let mut all: Vec<String> = Vec::new();
    for text in powers {
        let of_micro = text.strip_prefix('u').map(|rest| ["µ", "μ"].map(|micro| format!("{micro}{rest}")));
        for text in std::iter::once(text).chain(of_micro.into_iter().flatten()) {
            if !all.contains(&text) {
                all.push(text);
            }
        }
    }
    all
}

impl Quantity {
    /// The first of the units that has this size in the SI unit, such as `mm` for a length of 0.001 m.
    pub fn unit_of(self, size: f64) -> Option<&'static str> {
        // Sizes are read from texts, which may have passed through a product.
        let is_it = |(_, number, power): &&Unit| (size / (number * 10f64.powi(*power)) - 1.0).abs() < 1e-9;
        self.units().iter().find(is_it).map(|(name, ..)| *name)
    }

    /// The longest unit of this quantity with which a text begins, as the number of its bytes, and its size in the SI unit as a number and a
    /// power of ten. Letters and digits do not follow it.
    pub fn unit_at(self, text: &str) -> Option<(usize, f64, i32)> {
        let ends = |spelling: &str| {
            let rest = text.strip_prefix(spelling)?;
            let goes_on = |c: char| c.is_alphanumeric() || matches!(c, '_' | '²' | '³');
            (!rest.starts_with(goes_on)).then_some(spelling.len())
        };
        let units = self.units().iter().filter_map(|(unit, number, power)| {
            let length = spellings(unit).iter().filter_map(|spelling| ends(spelling)).max()?;
            Some((length, *number, *power))
        });
        units.max_by_key(|(length, ..)| *length)
    }

    /// The units, and an example of a valid text.
    fn texts(self) -> (&'static [Unit], &'static str) {
        match self {
            Quantity::Length => (&LENGTHS, "a length such as 0.005, \"5 mm\" or \"0.5cm\""),
            Quantity::Area => (&AREAS, "an area such as 1e-4, \"100 mm^2\" or \"1cm^2\""),
            Quantity::Volume => (&VOLUMES, "a volume such as 3e-5, \"30 ml\" or \"30 cm^3\""),
            Quantity::Pressure => (&PRESSURES, "a pressure such as 10000, \"10 kPa\" or \"0.01MPa\""),
            Quantity::Density => (&DENSITIES, "a density such as 1060, \"1060 kg/m^3\" or \"1.06 g/cm^3\""),
            Quantity::Time => (&TIMES, "a time such as 0.005, \"5 ms\" or \"1/60 s\""),
            Quantity::Force => (&FORCES, "a force such as 0.5, \"0.5 N\" or \"500 mN\""),
            Quantity::Moment => (&MOMENTS, "a moment such as 0.5, \"0.5 N m\" or \"500 N mm\""),
            Quantity::ForceDensity => (&FORCE_DENSITIES, "a force for each volume such as -9810 or \"-9.81 kN/m^3\""),
            Quantity::Acceleration => (&ACCELERATIONS, "an acceleration such as -9.81 or \"-9.81 m/s^2\""),
            Quantity::MeshUnit => (&LENGTHS, "the length of one mesh unit such as 0.001, \"mm\" or \"25.4 mm\""),
        }
    }

    fn units(self) -> &'static [Unit] {
        self.texts().0
    }

    /// The power of a length that a quantity at places is.
    pub fn power_of_length(self) -> Option<u8> {
        match self {
            Quantity::Length | Quantity::MeshUnit => Some(1),
            Quantity::Area => Some(2),
            Quantity::Volume => Some(3),
            Quantity::Pressure
            | Quantity::Density
            | Quantity::Time
            | Quantity::Force
            | Quantity::Moment
            | Quantity::Acceleration
            | Quantity::ForceDensity => None,
        }
    }

    /// An example of a valid text, for error messages.
    pub fn expected(self) -> &'static str {
        self.texts().1
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
        let read = |(unit, size, power): &Unit| {
            // A unit that is the end of a longer one, such as m of mm, leaves a letter with the number, which then is
            // none.
            let value = spellings(unit).iter().find_map(|spelling| {
                let number = trimmed.strip_suffix(spelling.as_str())?.trim_end();
                match (self, number) {
                    (Quantity::MeshUnit, "") => Some(1.0),
                    _ => self::number(number),
                }
            })?;
            // Dividing by a whole power of ten gives the double that is nearest to the decimal number, as parsing the
            // same number without a unit does.
            let (value, factor) = (value * size, 10f64.powi(power.abs()));
            Some(if *power < 0 { value / factor } else { value * factor })
        };
        self.units().iter().find_map(read).ok_or_else(|| {
            let units: Vec<&str> = self.units().iter().map(|(unit, ..)| *unit).collect();
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
