"""The sections of a scene as typed dicts: the keys, values and checks are those of scene files.

``scenes/README.md`` of the program's source describes every key.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from os import PathLike
from typing import Literal, TypedDict, Union

Vector = Sequence[float]
#: Linear RGB, one number for gray, or a string in sRGB: ``"#rrggbb"`` or the name of a CSS color.
Color = Union[str, float, Sequence[float]]
Position = Literal["top-left", "top", "top-right", "left", "right", "bottom-left", "bottom", "bottom-right"]
ColorMap = Literal[
    "viridis", "cividis", "inferno", "magma", "plasma", "turbo", "coolwarm",
    "viridis_r", "cividis_r", "inferno_r", "magma_r", "plasma_r", "turbo_r", "coolwarm_r",
]  # fmt: skip
LayerName = Literal["albedo", "normal", "depth", "coverage", "id", "variance", "samples"]
Model = Literal["space-filling", "ball-and-stick", "licorice"]
Preset = Literal["figure", "chalk", "studio", "cloudy", "glossy", "depthcue", "outline", "ghost", "x-ray"]
Side = Literal["auto", "iso", "x", "y", "z", "-x", "-y", "-z"]
UpAxis = Literal["x", "y", "z", "-x", "-y", "-z"]
ArrowCenter = Literal["tail", "middle", "head"]
SliceMode = Literal["remove", "caps", "hide"]
Outside = Literal["molecules", "whole", "none", "halves"]


class Render(TypedDict, total=False):
    """``[render]``: size, samples, stop conditions and algorithms."""

    size: Sequence[int] | str
    spp: int
    until_error: float
    time: float
    denoise: Literal["auto", "on", "off"]
    depth: int | Literal["unlimited"]
    seed: int
    integrator: Literal["path", "whitted", "ao"]
    light_choice: Literal["tree", "power", "uniform"]
    shadow_samples: int
    ao_distance: float | Literal["inf"]
    caustics: bool
    sampler: Literal["sobol", "stratified", "independent"]
    filter: Literal["box", "gaussian", "blackman-harris"]
    roulette: float | Literal["none", "throughput"]
    dpi: int
    exposure: float
    tone: Literal["linear", "filmic"]


class Camera(TypedDict, total=False):
    """``[camera]``. Of a scene of particles, keys that are not given stay those of the view."""

    projection: Literal["perspective", "orthographic"]
    fov: float
    height: float
    eye: Vector
    target: Vector
    fit: bool
    direction: Vector
    margin: float
    center: Vector
    radius: float
    up: Vector
    aperture: float
    focus: float
    near: float
    insets: Sequence[float]
    zoom: float


class Look(TypedDict, total=False):
    """``[look]``: background, depth cue, outlines and cell."""

    background: Color
    depth_cue: bool
    outline: bool
    cell: Sequence[Vector]


class _ColorBar(TypedDict):
    range: Sequence[float]


class ColorBar(_ColorBar, total=False):
    """``[color_bar]``, for colors that were made elsewhere."""

    log: bool
    map: Literal["viridis", "cividis", "inferno", "magma", "plasma", "turbo", "coolwarm"] | str
    reversed: bool
    label: str
    position: Position


class _Legend(TypedDict):
    entries: Sequence[Sequence[Color]]


class Legend(_Legend, total=False):
    """``[legend]``: colors with their names."""

    omitted: int
    label: str
    position: Position


class Axes(TypedDict, total=False):
    """``[axes]``: arrows that show directions."""

    directions: Sequence[Vector]
    names: Sequence[str]
    position: Position


class ScaleBar(TypedDict, total=False):
    """``[scale_bar]``: a line with its length."""

    length: float
    unit: str
    position: Position


class _Label(TypedDict):
    text: str


class Label(_Label, total=False):
    """``[[label]]``: text in the picture."""

    position: Position
    at: Vector


class _Measure(TypedDict):
    points: Sequence[Vector]


class Measure(_Measure, total=False):
    """``[[measure]]``: lines between points, with their distance or angle."""

    unit: str


class Lettering(TypedDict, total=False):
    """``[lettering]``: size and color of letters."""

    size: float | str
    color: Color


class Environment(TypedDict, total=False):
    """``[environment]``: light from outside the scene."""

    kind: Literal["constant", "gradient", "picture"]
    color: Color
    bottom: Color
    top: Color
    up: Vector
    file: str | PathLike[str]
    rotation: float
    scale: float
    illuminates: bool


class Ground(TypedDict, total=False):
    """``[ground]``: an infinite plane."""

    normal: Vector
    height: float
    material: str


class _Slice(TypedDict):
    normal: Vector


class Slice(_Slice, total=False):
    """``[[slice]]``: a half space that is cut away."""

    distance: float
    mode: SliceMode


class _Light(TypedDict):
    kind: Literal["sun", "point"]


class Light(_Light, total=False):
    """``[[light]]``: a sun or a point."""

    direction: Vector
    irradiance: Color
    angular_radius: float
    position: Vector
    intensity: Color
    falloff: Literal["square", "none"]


class _Material(TypedDict):
    kind: Literal["lambertian", "conductor", "dielectric", "plastic", "reflective", "emitter"]


class Material(_Material, total=False):
    """``[material.NAME]``."""

    color: Color
    fresnel: Literal["schlick", "constant"]
    eta: Color
    k: Color
    roughness: float
    ior: float
    diffuse: float
    mirror: float
    radiance: Color
    albedo: Color
    opacity: float


class _Sphere(TypedDict):
    center: Vector
    radius: float


class Sphere(_Sphere, total=False):
    """``[[sphere]]``."""

    material: str
    color: Color


class _Ellipsoid(TypedDict):
    center: Vector
    semi_axes: Vector


class Ellipsoid(_Ellipsoid, total=False):
    """``[[ellipsoid]]``: ``orientation`` is a quaternion, its real part first."""

    orientation: Sequence[float]
    material: str
    color: Color


class _Cone(TypedDict):
    apex: Vector
    base: Vector
    radius: float


class Cone(_Cone, total=False):
    """``[[cone]]``: ``base`` is the center of the flat base."""

    material: str
    color: Color


class _Triangle(TypedDict):
    a: Vector
    b: Vector
    c: Vector


class Triangle(_Triangle, total=False):
    """``[[triangle]]``: flat, between three corners, seen from both sides. Many of them are an array: ``triangles=``."""

    material: str
    color: Color


class _Mesh(TypedDict):
    path: str | PathLike[str]


class Mesh(_Mesh, total=False):
    """``[[mesh]]``: the faces of a PLY file."""

    material: str
    color: Color
    scale: float


class _Stick(TypedDict):
    to: Vector
    radius: float


class Stick(_Stick, total=False):
    """``[[stick]]``: a cylinder with round ends. ``from``, a keyword of Python, is written as ``{"from": ...}``."""

    material: str
    color: Color
    colors: Sequence[Color]


class _Generate(TypedDict):
    kind: Literal["grid", "field", "volume", "lattice", "sphereflake", "weekend"]


class Generate(_Generate, total=False):
    """``[[generate]]``: generated spheres."""

    seed: int
    count: int
    spacing: float
    size: float
    radius: float | Sequence[float]
    jitter: float
    level: int
    colors: bool
    mix: Sequence[float]
    material: str


class _File(TypedDict):
    path: str | PathLike[str]


class File(_File, total=False):
    """``[[file]]``: spheres from a particle file."""

    format: str
    topology: str | PathLike[str]
    material: str
    radius: float
    scale: float


class _Style(TypedDict):
    """The required key of ``[[style]]``."""

    select: str


class Style(_Style, total=False):
    """``[[style]]``: the look of some particles of the files of ``[[file]]``."""

    model: Model
    color: str
    map: str
    range: Sequence[float]
    log: bool
    radius: float
    scale: float
    bonds: bool
    bond_radius: float
    opacity: float
    polyhedra: str
    polyhedra_opacity: float
    material: Literal["lambertian", "plastic", "metal", "glass", "mirror", "emitter"]
    visible: bool


class TypeStyle(TypedDict, total=False):
    """The style of a type of particles, which overrides all else; as the program's ``--type``."""

    radius: float
    color: Color
    material: Literal["lambertian", "plastic", "metal", "glass", "mirror", "emitter"]
    opacity: float


class Sections(TypedDict, total=False):
    """The sections of a scene file."""

    title: str
    render: Render
    camera: Camera
    look: Look
    legend: Legend | Position | bool
    axes: Axes | str | bool
    scale_bar: ScaleBar | str | float | bool
    label: str | Sequence[str | Label]
    measure: str | Sequence[str | Measure]
    lettering: Lettering
    environment: Environment
    ground: Ground
    slice: Sequence[Slice]
    light: Sequence[Light]
    material: Mapping[str, Material]
    sphere: Sequence[Sphere]
    stick: Sequence[Stick]
    ellipsoid: Sequence[Ellipsoid]
    cone: Sequence[Cone]
    triangle: Sequence[Triangle]
    mesh: Sequence[Mesh]
    generate: Sequence[Generate]
    file: Sequence[File]
    style: Sequence[Style]
