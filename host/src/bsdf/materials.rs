//! The materials of a scene, checked and with their pictures.

use super::frame::Frame;
use super::ggx::Ggx;
use super::{Bsdf, Law};
use crate::scene::{Files, Material, MaterialKind, SceneError};
use crate::surface::Hit;
use crate::texture::{Pictures, Texture};
use crate::volume::Limits;

/// An index as near to one as this refracts and reflects nothing; half vectors would be noise.
const MATCHED: f64 = 1e-8;

/// The materials of a scene, with their pictures.
#[derive(Debug, Default)]
pub struct Materials {
    laws: Vec<Described>,
}

/// A material before a place is known.
#[derive(Debug)]
enum Described {
    Diffuse(Texture),
    Same(Law),
}

impl Materials {
    /// Reads the pictures that materials ask for.
    ///
    /// # Errors
    /// Files that cannot be read, pictures whose values are no reflectance, at the texture's place; indices and
    /// widths out of range, at the material's.
    pub fn new(
        materials: &[Material],
        files: &dyn Files,
        limits: &Limits,
    ) -> Result<Self, SceneError> {
        let mut pictures = Pictures::new(files, *limits);
        let laws = materials
            .iter()
            .map(|material| describe(material, &mut pictures))
            .collect::<Result<_, _>>()?;
        Ok(Self { laws })
    }

    /// The BSDF at a hit; light passes where there is no material.
    pub fn at(&self, hit: &Hit) -> Bsdf {
        let described = hit.material.and_then(|id| self.laws.get(id.0));
        let law = match described {
            Some(Described::Diffuse(texture)) => {
                let reflectance = texture.at(hit.uv).map(|x| x.clamp(0.0, 1.0));
                if reflectance == [0.0; 3] {
                    Law::Black
                } else {
                    Law::Diffuse(reflectance)
                }
            }
            Some(Described::Same(law)) => *law,
            None => Law::Nothing,
        };
        Bsdf {
            frame: Frame::new(hit),
            law,
        }
    }
}

fn describe(material: &Material, pictures: &mut Pictures<'_>) -> Result<Described, SceneError> {
    let check = |name: &str, values: &[f64], valid: fn(f64) -> bool, domain: &str| match values
        .iter()
        .find(|&&x| !(x.is_finite() && valid(x)))
    {
        Some(x) => Err(SceneError::at(
            &material.place,
            format!("{name} is {x}, and must be {domain}"),
        )),
        None => Ok(()),
    };
    let positive = |name, values: &[f64]| check(name, values, |x| x > 0.0, "positive");
    let not_negative = |name, values: &[f64]| check(name, values, |x| x >= 0.0, "at least 0");
    let law = match &material.kind {
        MaterialKind::Diffuse { reflectance } => {
            let texture = Texture::new(reflectance, pictures, &material.place)?;
            texture.check_reflectance(&material.place)?;
            return Ok(Described::Diffuse(texture));
        }
        &MaterialKind::Dielectric { eta, alpha } => {
            positive("the refractive index", &[eta])?;
            not_negative("a roughness", &alpha)?;
            if (eta - 1.0).abs() < MATCHED {
                Law::Nothing
            } else {
                Law::Dielectric(eta, Ggx::new(alpha))
            }
        }
        &MaterialKind::ThinDielectric { eta } => {
            positive("the refractive index", &[eta])?;
            Law::Pane(eta)
        }
        &MaterialKind::Conductor { eta, k, alpha } => {
            not_negative("a refractive index", &eta)?;
            not_negative("an extinction coefficient", &k)?;
            not_negative("a roughness", &alpha)?;
            Law::Conductor(eta, k, Ggx::new(alpha))
        }
    };
    Ok(Described::Same(law))
}
