//! `Camera`, in two steps: its window depends on the film, which may come later.

use glam::DAffine3;

use super::super::film::Film;
use super::super::{Camera, Place, Projection, SceneError, ScreenWindow};
use super::diagnostics::Diagnostics;
use super::directive::At;
use super::param::Type;
use super::params::Params;
use super::reader::Reader;
use super::state::{MediumName, affine};

/// A camera that waits for its film.
#[derive(Debug)]
pub(super) struct CameraDraft {
    pub(super) params: Params,
    pub(super) ty: String,
    pub(super) camera_to_world: DAffine3,
    pub(super) medium: MediumName,
}

impl Reader<'_> {
    pub(super) fn camera(
        &mut self,
        at: &At,
        ty: String,
        place: &Place,
        params: Params,
    ) -> Result<(), SceneError> {
        let names = ["perspective", "orthographic", "realistic", "spherical"];
        let mut ty = ty;
        if !self.known("camera", &ty, place, &names)? {
            ty = "perspective".to_owned();
        } else if ty == "realistic" || ty == "spherical" {
            let message = format!("camera \"{ty}\" is not yet supported");
            self.diagnostics.refuse(
                SceneError::at(place, message).help("supported are perspective and orthographic"),
            )?;
            ty = "perspective".to_owned();
        }
        self.not_moving(&at.place)?;
        let [camera_from_world, camera_to_world] = affine(&self.state.transforms[0], &at.place)?;
        debug_assert!(camera_from_world.is_finite(), "affine returns finite maps");
        let inverse = self.state.transforms.map(|m| m.inverse());
        self.coordinate_systems.insert("camera".to_owned(), inverse);
        self.world.camera = Some(CameraDraft {
            params,
            ty,
            camera_to_world,
            medium: self.state.outside.clone(),
        });
        Ok(())
    }
}

impl CameraDraft {
    /// The camera, now that its film is known; sets the film's exposure.
    pub(super) fn finish(
        &self,
        film: &mut Film,
        diagnostics: &mut Diagnostics,
    ) -> Result<Camera, SceneError> {
        let params = &self.params;
        let any = |name| params.float(name, "a time", |_| true);
        let exposure = any("shutterclose")?.unwrap_or(1.0) - any("shutteropen")?.unwrap_or(0.0);
        if exposure <= 0.0 {
            return Err(SceneError::at(params.place(), "the shutter does not open"));
        }
        film.imaging_ratio *= exposure;
        let positive = |name| params.float(name, "positive", |v| v > 0.0);
        let lens = params.float("lensradius", "0 or more", |v| v >= 0.0)?;
        let focal_distance = positive("focaldistance")?.unwrap_or(1e6);
        let aspect = positive("frameaspectratio")?;
        let aspect = aspect.unwrap_or(f64::from(film.width) / f64::from(film.height));
        let screen_window = match params.four("screenwindow", Type::Float)? {
            None => ScreenWindow::from_aspect(aspect),
            Some(([x_min, x_max, y_min, y_max], place)) => {
                if x_min == x_max || y_min == y_max {
                    let message = "the screen window is empty";
                    return Err(SceneError::at(&place, message).help("the order is x0 x1 y0 y1"));
                }
                ScreenWindow {
                    x_min,
                    x_max,
                    y_min,
                    y_max,
                }
            }
        };
        let projection = if self.ty == "orthographic" {
            Projection::Orthographic
        } else {
            let range = "between 0 and 180 degrees";
            let fov = params.float("fov", range, |v| v > 0.0 && v < 180.0)?;
            let half = params.float("halffov", "below 90 degrees", |v| v < 90.0)?;
            let fov = half
                .filter(|h| *h > 0.0)
                .map_or(fov.unwrap_or(90.0), |h| 2.0 * h);
            Projection::Perspective { fov }
        };
        params.finish(diagnostics)?;
        Ok(Camera {
            projection,
            screen_window,
            lens_radius: lens.unwrap_or(0.0),
            focal_distance,
            camera_to_world: self.camera_to_world,
            place: Some(params.place().clone()),
        })
    }
}
