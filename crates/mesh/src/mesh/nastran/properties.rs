//! Materials, and the properties that give them to elements.

use super::card::Card;
use crate::mesh::annotations::{Annotations, Section};
use crate::mesh::lines::{real, whole};
use std::collections::{BTreeMap, HashMap};

/// Young's modulus, Poisson's ratio and the density of a material.
type Constants = [Option<f64>; 3];

/// The number of a material, a thickness and an area.
type Property = (Option<u64>, Option<f64>, Option<f64>);

/// The materials and properties of a file. A field that is no number says nothing: it is of no use for a mesh.
#[derive(Default)]
pub(super) struct Properties {
    materials: HashMap<u64, Constants>,
    properties: BTreeMap<u64, Property>,
}

impl Properties {
    /// Reads the card of a material or of a property.
    pub fn read(&mut self, card: &Card) {
        let number = |index: usize| real(card.field(index)).filter(|x| *x != 0.0);
        let Some(own) = whole(card.field(0)) else { return };
        let material = whole(card.field(1));
        match card.name.as_str() {
            "MAT1" => {
                // Of the two moduli and Poisson's ratio one may be blank.
                let (young, shear, poisson) = (number(1), number(2), real(card.field(3)));
                let of_shear = young.zip(shear).map(|(young, shear)| young / (2.0 * shear) - 1.0);
                let young = young.or(shear.zip(poisson).map(|(shear, poisson)| 2.0 * shear * (1.0 + poisson)));
                self.materials.insert(own, [young, poisson.or(of_shear), number(4)]);
            }
            "PSOLID" => _ = self.properties.insert(own, (material, None, None)),
            "PSHELL" => _ = self.properties.insert(own, (material, number(2), None)),
            "PROD" | "PBAR" | "PBEAM" => _ = self.properties.insert(own, (material, None, number(2))),
            _ => {}
        }
    }

    /// Adds the properties of these elements to what the file says.
    pub fn annotate(self, annotations: &mut Annotations, is_used: impl Fn(u64) -> bool) {
        for (number, (material, thickness, area)) in self.properties.into_iter().filter(|(number, _)| is_used(*number))
        {
            let constants = material.and_then(|material| self.materials.get(&material));
            let [young, poisson, density] = constants.copied().unwrap_or_default();
            annotations.sections.push(Section {
                group: format!("pid={number}"),
                young,
                poisson,
                density,
                thickness,
                area,
            });
        }
    }
}
