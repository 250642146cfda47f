//! The scene of the page in the language of the `woodcock` program.

use crate::view::{Controls, FIELD_OF_VIEW};
use crate::volume::{Placed, Source, Volume};

/// What the page shows, as a scene. The name of a file is to be put in by hand.
pub(crate) fn scene(controls: &Controls, volume: &Volume) -> String {
    let Controls {
        width,
        height,
        albedo,
        g,
        ..
    } = controls;
    let (eye, sun) = (controls.eye(), controls.sunwards());
    let list = |[r, g, b]: [f32; 3]| format!("[ {r} {g} {b} ]");
    let (irradiance, radiance) = (list(controls.irradiance()), list(controls.radiance()));
    let mut text = format!(
        "LookAt {} {} {}  0 0 0  0 1 0\n\
         Camera \"perspective\" \"float fov\" {FIELD_OF_VIEW}\n\
         Film \"rgb\" \"integer xresolution\" {width} \"integer yresolution\" {height}\n\
         Sampler \"independent\" \"integer pixelsamples\" 256\n\
         Integrator \"volpath\"\n\
         WorldBegin\n\
         LightSource \"infinite\" \"rgb L\" {radiance}\n\
         LightSource \"distant\" \"point3 from\" [ {} {} {} ] \"point3 to\" [ 0 0 0 ] \"rgb L\" {irradiance}\n\
         AttributeBegin\n",
        eye.x, eye.y, eye.z, sun.x, sun.y, sun.z,
    );
    let medium = |scale: f32| {
        let (absorbed, scattered) = (list([1.0 - albedo; 3]), list([*albedo; 3]));
        format!(
            "MakeNamedMedium \"volume\" \"float g\" {g} \"float scale\" {scale}\n\
             \"rgb sigma_a\" {absorbed} \"rgb sigma_s\" {scattered}\n"
        )
    };
    let radius = match volume {
        Volume::Fog => {
            text += &medium(controls.density);
            text += "\"string type\" \"homogeneous\"";
            1
        }
        Volume::Grid(grid) => {
            let (m, t) = (grid.to_page.matrix3, grid.to_page.translation);
            let [x, y, z] = [m.x_axis.x, m.y_axis.y, m.z_axis.z];
            text += &format!(
                "Transform [ {x} 0 0 0  0 {y} 0 0  0 0 {z} 0  {} {} {} 1 ]\n",
                t.x, t.y, t.z
            );
            text += &medium(grid.record(controls).scale);
            match grid.source {
                Source::Cumulus => listed(grid, &mut text),
                // Pages are not told where files lie.
                Source::File(kind) => {
                    let name = grid.density.name.as_deref();
                    let chosen = name.map(|name| format!(" \"string gridname\" {name:?}"));
                    text += &format!(
                        "\"string type\" \"{kind}\"{}\n# The name of your file:\n\"string filename\" \"volume\"",
                        chosen.unwrap_or_default()
                    );
                }
            }
            4
        }
    };
    text += &format!(
        "\nAttributeEnd\nAttributeBegin\nMaterial \"interface\"\nMediumInterface \"volume\" \"\"\n\
         Shape \"sphere\" \"float radius\" {radius}\nAttributeEnd\n",
    );
    text
}

/// All samples, as cells of a box that has a sample at the centre of each.
fn listed(grid: &Placed, text: &mut String) {
    let density = &grid.density;
    let [nx, ny, nz] = density.dims;
    let corner = |at: [f64; 3]| {
        let corner = density.to_volume.transform_point3(at.into());
        format!("[ {} {} {} ]", corner.x, corner.y, corner.z)
    };
    let near = corner([-0.5; 3]);
    let far = corner(density.dims.map(|n| f64::from(n) - 0.5));
    *text += &format!(
        "\"string type\" \"uniformgrid\" \"integer nx\" {nx} \"integer ny\" {ny} \"integer nz\" {nz}\n\
         \"point3 p0\" {near} \"point3 p1\" {far}\n\"float density\" ["
    );
    for (index, sample) in density.samples.iter().enumerate() {
        *text += if index % 16 == 0 { "\n" } else { " " };
        *text += &sample.to_string();
    }
    *text += " ]";
}
