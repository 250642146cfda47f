"""The scenes of `scenes/*.pbrt` as Mitsuba 3 describes them, written from their meaning, not translated by a program.

Import only after `mitsuba.set_variant`. Numbers that are data (grids, meshes) are read from the files that woodcock
reads; pictures are written for both from one formula, each in the layout of its renderer.
"""

import math
import re
from pathlib import Path

import mitsuba as mi
import numpy as np

import masking

HERE = Path(__file__).resolve().parent / "scenes"
T = mi.ScalarTransform4f
SIZE = 64


# What several scenes share.


def camera(origin, target, fov, medium=None):
    film = {
        "type": "hdrfilm",
        "width": SIZE,
        "height": SIZE,
        "pixel_format": "rgb",
        "component_format": "float32",
        "rfilter": {"type": "box"},
    }
    sensor = {
        "type": "perspective",
        "fov": fov,
        "to_world": T().look_at(origin=origin, target=target, up=[0, 1, 0]),
        "near_clip": 1e-3,
        "film": film,
        "sampler": {"type": "independent"},
    }
    if medium:
        sensor["medium"] = {"type": "ref", "id": medium}
    return sensor


def scene(sensor, volumetric=False, depth=-1, **parts):
    kind = "volpath" if volumetric else "path"
    integrator = {"type": kind, "max_depth": depth, "rr_depth": 32}
    return {"type": "scene", "integrator": integrator, "sensor": sensor, **parts}


def rgb(*values):
    return {"type": "rgb", "value": list(values)}


def diffuse(*reflectance):
    # pbrt's is two-sided.
    return {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": rgb(*reflectance)}}


def parallelogram(corner, along_u, along_v):
    """u runs along the first edge, v along the second; the normal is their cross product."""
    corner, u, v = (np.array(x, float) for x in (corner, along_u, along_v))
    normal = np.cross(u, v)
    columns = [u / 2, v / 2, normal / np.linalg.norm(normal), corner + (u + v) / 2]
    matrix = np.vstack([np.column_stack(columns), [0, 0, 0, 1]])
    return {"type": "rectangle", "to_world": T(matrix.tolist())}


def ball(center, radius, **parts):
    return {"type": "sphere", "center": center, "radius": radius, **parts}


def fog(scattering, absorption, g):
    """A homogeneous medium, grey in extinction or not."""
    s, a = np.array(scattering, float), np.array(absorption, float)
    return {
        "type": "homogeneous",
        "sigma_t": rgb(*((s + a) / (s + a).max())),
        "albedo": rgb(*(s / (s + a))),
        "scale": float((s + a).max()),
        "phase": {"type": "hg", "g": g},
    }


def constant(*radiance):
    return {"type": "constant", "radiance": rgb(*radiance)}


def sun(direction_from, *irradiance):
    return {
        "type": "directional",
        "direction": [-x for x in direction_from],
        "irradiance": rgb(*irradiance),
    }


def floor(y=0.0):
    return {**parallelogram([-3, y, -3], [0, 0, 6], [6, 0, 0]), "bsdf": diffuse(0.6, 0.5, 0.4)}


def disk_lamp():
    return {
        "type": "disk",
        "to_world": T().translate([1.2, 3, -0.8]) @ T().rotate([1, 0, 0], 90) @ T().scale(0.8),
        "bsdf": {"type": "diffuse", "reflectance": rgb(0, 0, 0)},
        "emitter": {"type": "area", "radiance": rgb(6, 5, 4)},
    }


def on_a_floor(**parts):
    return {"sky": constant(0.3, 0.4, 0.5), "lamp": disk_lamp(), "floor": floor(), **parts}


def cube(to_world, medium):
    return {"type": "cube", "to_world": to_world, "bsdf": {"type": "null"}, "interior": medium}


# The scenes.


def room():
    grey, red, green = diffuse(0.7, 0.7, 0.7), diffuse(0.7, 0.15, 0.1), diffuse(0.1, 0.6, 0.15)
    x, y, z = [2, 0, 0], [0, 2, 0], [0, 0, 2]
    return {
        "floor": {**parallelogram([-1, -1, -1], z, x), "bsdf": grey},
        "ceiling": {**parallelogram([-1, 1, -1], x, z), "bsdf": grey},
        "back": {**parallelogram([-1, -1, 1], y, x), "bsdf": grey},
        "front": {**parallelogram([-1, -1, -1], x, y), "bsdf": grey},
        "left": {**parallelogram([-1, -1, -1], y, z), "bsdf": red},
        "right": {**parallelogram([1, -1, -1], z, y), "bsdf": green},
        "ball": ball([-0.35, -0.55, 0.3], 0.45, bsdf=diffuse(0.5, 0.5, 0.8)),
        "lamp": {
            **parallelogram([-0.4, 0.8, -0.4], [0.8, 0, 0], [0, 0, 0.8]),
            "bsdf": diffuse(0.2, 0.2, 0.2),
            "emitter": {"type": "area", "radiance": rgb(9, 8, 7)},
        },
    }


def box():
    return scene(camera([0, 0, -0.9], [0, -0.1, 0], 80), **room())


def box_fog():
    # The walls are opaque: all that light can reach is fog, so there are no faces.
    medium = {**fog([0.45] * 3, [0.05] * 3, 0.4), "id": "air"}
    sensor = camera([0, 0, -0.9], [0, -0.1, 0], 80, medium="air")
    return scene(sensor, volumetric=True, air=medium, **room())


def floor_camera():
    return camera([0, 2, -4], [0, 0.6, 0], 45)


def glass():
    matter = {"type": "dielectric", "int_ior": 1.5, "ext_ior": 1.0}
    return scene(floor_camera(), **on_a_floor(ball=ball([0, 0.9, 0], 0.8, bsdf=matter)))


def rough_glass():
    matter = {
        "type": "roughdielectric",
        "distribution": "ggx",
        "alpha": 0.7,
        "int_ior": 1.5,
        "ext_ior": 1.0,
    }
    matter = masking.correlated(matter, 0.7, 0.7)
    return scene(floor_camera(), **on_a_floor(ball=ball([0, 0.9, 0], 0.8, bsdf=matter)))


def metal(eta, k, alpha_u=None, alpha_v=None):
    indices = {"eta": rgb(*eta), "k": rgb(*k)}
    if alpha_u is None:
        return {"type": "conductor", **indices}
    rough = {
        "type": "roughconductor",
        "distribution": "ggx",
        "alpha_u": alpha_u,
        "alpha_v": alpha_v,
        **indices,
    }
    return masking.correlated(rough, alpha_u, alpha_v)


COPPERY = ([0.2, 0.92, 1.1], [3.9, 2.45, 2.14])


def rough_metal():
    plate = parallelogram([0.1, 0.1, 0], [1.6, 0, -0.4], [0, 1.4, 0.4])
    return scene(
        floor_camera(),
        sky=constant(0.3, 0.4, 0.5),
        sun=sun([1, 2, -1.5], 2, 1.8, 1.5),
        floor=floor(),
        ball=ball([-0.8, 0.8, 0], 0.7, bsdf={"type": "twosided", "bsdf": metal(*COPPERY, 0.8, 0.8)}),
        plate={
            **plate,
            "bsdf": {"type": "twosided", "bsdf": metal([1.5, 0.9, 0.6], [7.5, 6.5, 5.5], 0.2, 0.7)},
        },
    )


def point_fog():
    medium = {**fog([0.9] * 3, [0.1] * 3, 0.3), "id": "air"}
    ref = {"type": "ref", "id": "air"}
    null = {"type": "null"}
    return scene(
        camera([0, 1.5, -5], [0, -0.1, 0], 45),
        volumetric=True,
        air=medium,
        light={"type": "point", "position": [0.2, 0.1, 0], "intensity": rgb(9, 8, 6)},
        outer=ball([0, 0, 0], 1.4, bsdf=null, interior=ref),
        hollow=ball([0, 0, 0], 0.6, bsdf=null, exterior=ref),
        floor=floor(-1.6),
    )


def spot_fog():
    # Without a penumbra: pbrt's is a smoothstep of the cosine, Mitsuba's linear in the angle.
    spot = {
        "type": "spot",
        "to_world": T().look_at(origin=[0.8, 3, -0.3], target=[0, 0, 0], up=[0, 0, 1]),
        "intensity": rgb(30, 27, 20),
        "cutoff_angle": 18.0,
        "beam_width": 18.0,
    }
    return scene(
        camera([0, 1.5, -6], [0, -0.1, 0], 40),
        volumetric=True,
        light=spot,
        fog=cube(T(), fog([0.7] * 3, [0.1] * 3, 0.5)),
        floor=floor(-1.5),
    )


def sun_cube():
    return scene(
        camera([2.5, 2, -5], [0, 0, 0], 40),
        volumetric=True,
        sun=sun([1.5, 2, 2.5], 3, 3, 3),
        fog=cube(T().rotate([0, 1, 0], 20), fog([3.9, 3.8, 3.6], [0.1, 0.2, 0.4], 0.8)),
    )


def grid_sky():
    text = (HERE / "grid-sky.pbrt").read_text()
    numbers = re.search(r'"float density" \[([^\]]*)\]', text)[1].split()
    density = np.array(numbers, np.float32).reshape(4, 5, 6)
    # pbrt's grids are zero outside, Mitsuba's repeat their edge: a rim of zeros makes them the same.
    density = np.pad(density, 1)
    half = np.array([1.2, 1.0, 0.8])
    rim = 2 * half / [6, 5, 4]
    turn = T().rotate([0, 1, 0], 30)
    low, size = -half - rim, 2 * (half + rim)
    grid = {
        "type": "gridvolume",
        "grid": mi.VolumeGrid(density[..., None]),
        "to_world": turn @ T().translate(low.tolist()) @ T().scale(size.tolist()),
        "filter_type": "trilinear",
        "wrap_mode": "clamp",
    }
    medium = {
        "type": "heterogeneous",
        "sigma_t": grid,
        "albedo": rgb(0.95, 0.85, 0.7),
        "scale": 6.0,
        "phase": {"type": "hg", "g": -0.3},
    }
    return scene(
        camera([0.5, 1, -4.5], [0, 0, 0], 40),
        volumetric=True,
        sky=constant(0.8, 0.9, 1),
        smoke=cube(turn @ T().scale(half.tolist()), medium),
    )


def colour_smoke():
    medium = fog([1.2, 1.5, 1.8], [0.1, 0.3, 0.6], 0.5)
    return scene(
        camera([0, 0.5, -4], [0, 0, 0], 40),
        volumetric=True,
        sky=constant(0.3, 0.4, 0.5),
        sun=sun([1, 2, -1.5], 3, 2.8, 2.5),
        smoke=ball([0, 0, 0], 1.1, bsdf={"type": "null"}, interior=medium),
    )


def radiance_of_the_sky(x, y, z):
    """Smooth, coloured, with a bright spot that is in no plane of symmetry."""
    spot = np.exp(8 * (x * 0.48 + y * 0.6 - z * 0.64 - 1))
    base = [0.35 + 0.2 * y, 0.4 + 0.15 * x, 0.5 - 0.2 * z]
    return np.stack([b + s * spot for b, s in zip(base, (5, 4, 3))], -1).astype(np.float32)


def sky_for_mitsuba(height=1024):
    """Rows from +y to -y, the first and the last *on* the poles; columns from -z over +x, their centres at halves."""
    width = 2 * height
    theta = np.pi * np.arange(height) / (height - 1)
    phi = 2 * np.pi * (np.arange(width) + 0.5) / width
    t, p = np.meshgrid(theta, phi, indexing="ij")
    return radiance_of_the_sky(np.sin(t) * np.sin(p), np.cos(t), -np.sin(t) * np.cos(p))


def sky_for_woodcock(height=1024):
    """Rows from the light's +z to its -z, columns from +x over +y, all centres at halves.

    The scene turns the light by -90 degrees about x: its (x, y, z) is the world's (x, z, -y).
    """
    width = 2 * height
    theta = np.pi * (np.arange(height) + 0.5) / height
    phi = 2 * np.pi * (np.arange(width) + 0.5) / width
    t, p = np.meshgrid(theta, phi, indexing="ij")
    return radiance_of_the_sky(np.sin(t) * np.cos(p), np.cos(t), -np.sin(t) * np.sin(p))


def picture_sky():
    return scene(
        camera([0, 0.5, -5], [0, 0, 0], 40),
        sky={"type": "envmap", "bitmap": mi.Bitmap(sky_for_mitsuba())},
        metal=ball([-0.85, 0, 0], 0.8, bsdf=metal(*COPPERY)),
        white=ball([0.85, 0, 0], 0.8, bsdf=diffuse(0.8, 0.8, 0.8)),
    )


def milk_glass():
    sphere = ball(
        [0, 0.9, 0],
        0.8,
        bsdf={"type": "dielectric", "int_ior": 1.4, "ext_ior": 1.0},
        interior=fog([2.7, 2.85, 2.94], [0.3, 0.15, 0.06], 0.6),
    )
    return scene(floor_camera(), volumetric=True, **on_a_floor(ball=sphere))


def pane():
    glass_pane = parallelogram([-1, 0.1, -1], [2.2, 0, 0.8], [0, 1.4, 0])
    glass_pane["bsdf"] = {"type": "thindielectric", "int_ior": 1.5, "ext_ior": 1.0}
    wall = parallelogram([-1.5, 0, 1], [3, 0, 0], [0, 1.8, 0])
    wall["bsdf"] = diffuse(0.2, 0.4, 0.7)
    return scene(camera([0, 1.5, -4], [0, 0.8, 0], 45), **on_a_floor(pane=glass_pane, wall=wall))


def tiles():
    """A picture of 6 x 4 colours, its first row on top."""
    values = np.random.default_rng(5).random((4, 6, 3)) * 0.8 + 0.1
    return values.astype(np.float32)


def texture():
    # Mitsuba's first row is at v = 0, pbrt's last one is.
    picture = {
        "type": "bitmap",
        "data": mi.TensorXf(np.ascontiguousarray(tiles()[::-1])),
        "raw": True,
        "filter_type": "bilinear",
        "wrap_mode": "repeat",
        "to_uv": T().translate([0.2, 0, 0]) @ T().scale([2, 1.5, 1]),
    }
    plate = parallelogram([-1.2, 0, -0.5], [2.4, 0, 0.8], [0, 1.6, 0.5])
    plate["bsdf"] = {"type": "twosided", "bsdf": {"type": "diffuse", "reflectance": picture}}
    return scene(
        camera([0, 1.5, -4], [0, 0.8, 0], 45),
        sky=constant(0.3, 0.4, 0.5),
        sun=sun([1, 2, -1.5], 2, 1.8, 1.5),
        plate=plate,
    )


def normals():
    # One reflection: Mitsuba's depth counts path edges, the light's included.
    return scene(
        camera([0, 4, -1.5], [0, 0, 0], 36),
        depth=2,
        light={"type": "point", "position": [1.5, 4, 1], "intensity": rgb(30, 28, 25)},
        bumps={"type": "ply", "filename": str(HERE / "bumps.ply"), "bsdf": diffuse(0.6, 0.7, 0.8)},
    )


def triangles(positions, faces):
    mesh = mi.Mesh("mesh", len(positions), len(faces))
    parameters = mi.traverse(mesh)
    parameters["vertex_positions"] = np.ravel(np.array(positions, np.float32))
    parameters["faces"] = np.ravel(np.array(faces, np.uint32))
    parameters.update()
    return mesh


def instances(folder):
    tent = triangles(
        [[0, 1, 0], [-0.6, 0, -0.5], [0, 0, 0.8], [0.6, 0, -0.5]],
        [[0, 1, 2], [0, 2, 3], [0, 3, 1]],
    )
    path = str(Path(folder) / "tent.ply")
    tent.write_ply(path)
    shape = {"type": "ply", "filename": path, "face_normals": True, "bsdf": diffuse(0.7, 0.6, 0.5)}
    group = {"type": "shapegroup", "id": "tent", "shape": shape}

    def placed(to_world):
        return {"type": "instance", "to_world": to_world, "group": {"type": "ref", "id": "tent"}}

    return scene(
        camera([0, 3, -4], [0, 0, 0], 45),
        sky=constant(0.5, 0.6, 0.7),
        tent=group,
        first=placed(T().translate([-1.1, 0, 0.3]) @ T().rotate([0, 1, 0], 40)),
        second=placed(T().scale([-1, 1.4, 1])),
        third=placed(T().translate([1.1, 0.3, 0]) @ T().rotate([0, 0, 1], 50)),
    )


SCENES = {
    function.__name__.replace("_", "-"): function
    for function in (
        glass,
        rough_glass,
        rough_metal,
        point_fog,
        spot_fog,
        sun_cube,
        grid_sky,
        colour_smoke,
        picture_sky,
        milk_glass,
        pane,
        texture,
        normals,
        instances,
        box,
        box_fog,
    )
}

# How many times more samples scenes of much noise take.
NOISY = {"sun-cube": 16, "spot-fog": 8, "point-fog": 4}

# Pictures that a scene's pbrt file names, written beside a copy of it.
PICTURES = {"picture-sky": {"sky.exr": sky_for_woodcock}, "texture": {"tiles.exr": tiles}}
