//! The plane state as an option.

use clap::ValueEnum;
use springfit_element::material::Plane;

#[derive(Clone, Copy, ValueEnum)]
pub enum State {
    Stress,
    Strain,
}

impl From<State> for Plane {
    fn from(state: State) -> Plane {
        match state {
            State::Stress => Plane::Stress,
            State::Strain => Plane::Strain,
        }
    }
}
