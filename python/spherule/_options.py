"""Keyword arguments of scenes and renders, by name."""

from __future__ import annotations

import difflib
import inspect
from collections.abc import Iterable, Mapping
from typing import TYPE_CHECKING, Any, Literal, get_args

from ._errors import ArgumentError
from .sections import LayerName, Sections

if TYPE_CHECKING:
    from collections.abc import Callable, Sequence
    from typing import Literal

    from ._native import Stop
    from .sections import (
        ArrowCenter,
        Color,
        ColorBar,
        ColorMap,
        Model,
        Outside,
        Position,
        Preset,
        Render,
        Side,
        SliceMode,
        TypeStyle,
        UpAxis,
    )

    class SceneOptions(Sections, total=False):
        """Keyword arguments of scenes: how particles look, and the sections of scene files."""

        radius: Any
        semi_axes: Any
        orientation: Any
        color: Any
        kinds: Any
        values: Any
        materials: Any
        columns: Mapping[str, Any]
        cell: Any
        origin: Any
        periodic: Any
        unit: str
        radius_scale: float
        select: str
        colors: str
        color_by: str
        color_map: ColorMap | Literal["categories"] | Any
        color_range: tuple[float | str, float | str] | Any
        color_title: str
        color_log: bool
        color_bar: bool | Position | ColorBar
        label_of_values: str
        model: Model
        bonds: str
        triangles: Any
        bond_radius: float
        polyhedra: str | Sequence[str]
        polyhedra_opacity: float
        opacity: float | str
        translucent: str
        hide: str
        styles: str | Sequence[str] | Mapping[str, str | Mapping[str, Any]]
        arrows: Any
        arrow_scale: float
        arrow_radius: float
        arrow_color: Color
        arrow_center: ArrowCenter
        types: Mapping[str, TypeStyle]
        preset: Preset
        background: Color
        view: Side | Sequence[float]
        look_at: str | Sequence[float]
        zoom: float
        roll: float
        up: UpAxis
        wrap: bool
        replicate: tuple[int, int, int]
        complete: bool
        outside: Outside
        show_cell: bool
        slices: Sequence[str]
        slice_mode: SliceMode

    class RenderOptions(Render, total=False):
        """Keyword arguments of renders."""

        layers: Literal["all"] | Sequence[LayerName]
        threads: int
        progress: bool | Callable[[float, int, float, float | None], object]
        stop: Stop
        on_interrupt: str

    class AllOptions(SceneOptions, RenderOptions, total=False):
        """Keyword arguments of :func:`spherule.render`."""


#: Arguments of particles.
PARTICLES = frozenset("radius semi_axes orientation color kinds materials columns cell origin periodic unit".split())

#: Arguments that say how particles are drawn.
STYLE = frozenset(
    "values radius_scale select colors color_by color_map color_range color_title color_log color_bar "
    "label_of_values types model bonds bond_radius polyhedra polyhedra_opacity opacity translucent hide styles "
    "arrows arrow_scale arrow_radius arrow_color arrow_center "
    "preset background view look_at zoom roll up wrap replicate complete outside show_cell slices slice_mode triangles".split()
)

#: Sections of scene files; the color bar is one, too, if it is a dict.
SECTIONS = frozenset(Sections.__annotations__)

#: Keys of the section `render`.
RENDER = frozenset(
    "size spp until_error time denoise depth seed integrator light_choice shadow_samples ao_distance caustics sampler "
    "filter roulette dpi exposure tone".split()
)

#: Names of all layers.
LAYERS = get_args(LayerName)

#: Other arguments of renders.
RUN = frozenset("layers threads progress stop on_interrupt".split())


def check(given: Iterable[str], *known: frozenset[str]) -> None:
    """Refuses unknown names, with the nearest known one."""
    names = frozenset().union(*known)
    for name in given:
        if name not in names:
            near = difflib.get_close_matches(name, names, 1)
            raise ArgumentError(f"unknown argument `{name}`" + (f"; did you mean `{near[0]}`?" if near else ""))


def signed(thing: Any, *known: frozenset[str]) -> None:
    """Gives a function or a class, which takes any keywords, a signature with these, so that completion shows them."""
    own = inspect.signature(thing)
    fixed = [one for one in own.parameters.values() if one.kind != one.VAR_KEYWORD]
    taken = {one.name for one in fixed}
    names = sorted(frozenset().union(*known) - taken)
    keywords = [inspect.Parameter(name, inspect.Parameter.KEYWORD_ONLY, default=None) for name in names]
    thing.__signature__ = own.replace(parameters=[*fixed, *keywords])


def part(given: Mapping[str, Any], names: frozenset[str]) -> dict[str, Any]:
    """The arguments with these names that are not None."""
    return {name: value for name, value in given.items() if name in names and value is not None}


def render_table(given: Mapping[str, Any]) -> dict[str, Any]:
    """The settings of a render for the extension module."""
    from . import _toml, _values

    text, keys = _toml.document({"render": part(given, RENDER)})
    layers = given.get("layers", ())
    layers = LAYERS if isinstance(layers, str) and layers == "all" else _values.items("layers", layers, _values.text)
    return {"text": text, "keys": keys.get("render", []), "layers": layers, "threads": threads(given.get("threads"))}


def threads(value: Any) -> int | None:
    """A number of threads; None for as many as the process may use."""
    from . import _values

    return None if value is None else _values.integer("threads", value, 1, 4096)
