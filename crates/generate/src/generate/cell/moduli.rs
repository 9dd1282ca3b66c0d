//! The moduli λ and μ in the dimensions of the body from Young's modulus and Poisson's ratio, as code.

use super::{Body, Role, Status, Value};
use crate::generate::code::{Function, Result};

/// What a body is, as far as the moduli depend on it.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum State {
    /// A rod without stress across it.
    Rod,
    /// A plate without stress through its thickness.
    PlaneStress,
    /// A plate without strain through its thickness.
    PlaneStrain,
    /// A solid.
    Solid,
}

impl State {
    /// The states of bodies of a dimension, with the ends of the names of their functions and what they are.
    pub fn of_dimension(dimension: usize) -> &'static [(State, &'static str, &'static str)] {
        match dimension {
            1 => &[(State::Rod, "moduli", "a rod of this cross-section")],
            2 => &[
                (State::PlaneStress, "moduli_plane_stress", "plane stress"),
                (State::PlaneStrain, "moduli_plane_strain", "plane strain"),
            ],
            _ => &[(State::Solid, "moduli", "a solid")],
        }
    }
}

/// The function that writes λ and μ, the latter times the thickness or the cross-section, into an array.
pub fn moduli(name: String, comment: Vec<String>, state: State) -> Function {
    let body = Body::new();
    let (young, poisson) = (body.parameter("young"), body.parameter("poisson"));
    let moduli = body.array("moduli", 2, Role::Output);
    let (zero, one) = (body.number(0.0), body.number(1.0));
    let size = match state {
        State::Rod => Some(body.parameter("area")),
        State::PlaneStress | State::PlaneStrain => Some(body.parameter("thickness")),
        State::Solid => None,
    };
    body.fail_with(Status::Moduli);
    body.guard(&young, &zero);
    body.guard(&poisson, &one.negated());
    // 1/2 is allowed where no volume is preserved.
    let most = match state {
        State::Rod | State::PlaneStress => 0.5 + f64::EPSILON,
        State::PlaneStrain | State::Solid => 0.5,
    };
    body.guard(&body.number(most), &poisson);
    if let Some(size) = &size {
        body.guard(size, &zero);
    }
    let modulus = size.map_or_else(|| young.clone(), |size| &size * &young);
    let two = body.number(2.0);
    let (above, below) = (&one + &poisson, &one - &poisson);
    let [lambda, mu]: [Value; 2] = match state {
        State::Rod => [zero, &modulus / &two],
        State::PlaneStress => [&(&modulus * &poisson) / &(&above * &below), &modulus / &(&two * &above)],
        State::PlaneStrain | State::Solid => {
            let less = &one - &(&two * &poisson);
            [&(&modulus * &poisson) / &(&above * &less), &modulus / &(&two * &above)]
        }
    };
    // The guard asks for a number below the largest one: neither an infinite one nor NaN passes.
    body.guard(&body.number(f64::MAX), &(&lambda.select(&body.number(0.0), &lambda, &lambda.negated()) + &mu));
    body.store(moduli, 0, &lambda);
    body.store(moduli, 1, &mu);
    body.finish(name, comment, Result::Status)
}
