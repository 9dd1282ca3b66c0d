//! The constants of isotropic elasticity, of which any two state the others.

/// A constant of an isotropic material.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Constant {
    Young,
    Poisson,
    Shear,
    Bulk,
    Lambda,
}

impl Constant {
    /// The constant of a key of a material.
    pub fn named(key: &str) -> Option<Constant> {
        Some(match key {
            "young" => Constant::Young,
            "poisson" => Constant::Poisson,
            "shear_modulus" => Constant::Shear,
            "bulk_modulus" => Constant::Bulk,
            "lambda" => Constant::Lambda,
            _ => return None,
        })
    }
}

/// Young's modulus and Poisson's ratio of the material with these two constants. They are not finite where the constants state none: λ is 0
/// for each material with ν = 0.
pub(super) fn young_and_poisson(constants: (Constant, Constant), a: f64, b: f64) -> (f64, f64) {
    use Constant::{Bulk, Lambda, Poisson, Shear, Young};
    let of_shear_and_bulk =
        |mu: f64, k: f64| (9.0 * k * mu / (3.0 * k + mu), (3.0 * k - 2.0 * mu) / (2.0 * (3.0 * k + mu)));
    match constants {
        (Young, Poisson) => (a, b),
        (Young, Shear) => (a, a / (2.0 * b) - 1.0),
        (Young, Bulk) => (a, (3.0 * b - a) / (6.0 * b)),
        // The root of the quadratic equation in ν in the form that does not subtract numbers which are near each other
        // for a small λ.
        (Young, Lambda) => (a, 2.0 * b / (a + b + (a * a + 9.0 * b * b + 2.0 * a * b).sqrt())),
        (Poisson, Shear) => (2.0 * b * (1.0 + a), a),
        (Poisson, Bulk) => (3.0 * b * (1.0 - 2.0 * a), a),
        (Poisson, Lambda) => (b * (1.0 + a) * (1.0 - 2.0 * a) / a, a),
        (Shear, Bulk) => of_shear_and_bulk(a, b),
        (Shear, Lambda) => of_shear_and_bulk(a, b + 2.0 * a / 3.0),
        (Bulk, Lambda) => of_shear_and_bulk(1.5 * (a - b), a),
        // The keys come in the order of the constants, each once.
        (second, first) if second > first => young_and_poisson((first, second), b, a),
        _ => (f64::NAN, f64::NAN),
    }
}
