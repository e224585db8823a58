#!/usr/bin/env python3
"""Renders a scene file of Spherule with Cycles, once per seed, and prints the times as lines of JSON.

It runs in a Python that can import `bpy`, Blender as a module. Spheres are points of point clouds, which Cycles intersects as exact
spheres, but only from outside; and it does not sample emissive points as lights. So glass spheres are meshes of triangles with
smooth normals, and emissive ones are Blender's lamps, which neither cast shadows nor reflect. Plastic and rough metal are similar to
Spherule's, not equal. With --exact, such scenes are refused; what remains is diffuse spheres and smooth mirrors of constant
reflectance with light only from the environment. Images are written to --folder as SEED.pfm.
"""

import contextlib
import json
import math
import os
import sys
import time

import bpy
import numpy as np
from mathutils import Matrix, Vector

from scene_file import Unsupported, internal_reflectance, read_scene, render_arguments, rgb, write_pfm

# Half the edge of the square that represents the ground, in the scene's unit.
GROUND = 1e4
# Longest paths that Cycles allows.
BOUNCES = 1024
# Subdivisions of an icosahedron in place of a glass sphere: 20 480 triangles, about 130 edges around.
SUBDIVISIONS = 6


def main():
    parser = render_arguments(__doc__)
    parser.add_argument("--exact", action="store_true", help="refuse what Cycles represents only approximately")
    parser.add_argument("--prefilter", choices=["ACCURATE", "FAST"], help="denoise, with albedo and normals filtered so")
    parser.add_argument("--map-scale", type=int, default=1, help="resolution of the sky's importance, of its own [default: 1]")
    parser.add_argument("--adaptive", action="store_true", help="sample adaptively, with --spp as the maximum")
    options = parser.parse_args()
    try:
        build(read_scene(options.scene), options)
    except Unsupported as error:
        sys.exit(f"Cycles cannot represent {options.scene.name}: {error}")
    for seed in options.seeds:
        bpy.context.scene.cycles.seed = seed
        bpy.context.scene.render.filepath = str(options.folder / f"{seed}.exr")
        cpu, start = time.process_time(), time.perf_counter()
        with silence():
            bpy.ops.render.render(write_still=True)
        written = time.time()
        wall, cpu = time.perf_counter() - start, time.process_time() - cpu
        convert(options.folder / f"{seed}.exr", options.folder / f"{seed}.pfm")
        print(json.dumps({"seed": seed, "cpu": cpu, "wall": wall, "written": written}), flush=True)


@contextlib.contextmanager
def silence():
    """Discards what Blender prints to standard output."""
    sys.stdout.flush()
    kept = os.dup(1)
    with open(os.devnull, "w") as nothing:
        os.dup2(nothing.fileno(), 1)
        yield
    os.dup2(kept, 1)
    os.close(kept)


def convert(exr, pfm):
    """Converts an image that Blender wrote; its first row is at the bottom in memory."""
    image = bpy.data.images.load(str(exr))
    width, height = image.size
    values = np.empty(width * height * 4, dtype=np.float32)
    image.pixels.foreach_get(values)
    bpy.data.images.remove(image)
    write_pfm(pfm, values.reshape(height, width, 4)[::-1, :, :3])


def build(scene, options):
    """Builds a scene in Blender's current one."""
    target = bpy.context.scene
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    if options.exact:
        check_exact(scene)
    set_camera(target, scene.table["camera"])
    set_world(target, scene, options.map_scale)
    set_render(target, scene, options)
    materials = {name: shader(name, material) for name, material in scene.materials.items() if material["kind"] != "emitter"}
    for name, spheres in scene.spheres.items():
        material = scene.materials[name]
        if material["kind"] == "emitter":
            for i, (center, radius) in enumerate(zip(spheres.centers.tolist(), spheres.radii.tolist())):
                add(target, f"{name}-{i}", lamp(material, center, radius))
        else:
            add(target, name, points(name, spheres, materials[name], solid=material["kind"] == "dielectric"))
    for i, light in enumerate(scene.table.get("light", [])):
        add(target, f"light-{i}", other_lamp(light))
    if "ground" in scene.table:
        add(target, "ground", ground(scene.table["ground"], materials))


def check_exact(scene):
    """Raises `Unsupported` for what Cycles represents only approximately."""
    if scene.table.get("light"):
        raise Unsupported("lights other than the environment")
    for material in scene.materials.values():
        kind, smooth = material["kind"], material.get("roughness", 0) == 0
        if kind != "lambertian" and not (kind == "conductor" and smooth and material.get("fresnel") == "constant"):
            raise Unsupported(f"a material of kind {kind} with these parameters")


def add(target, name, thing):
    thing.name = name
    target.collection.objects.link(thing)


def set_camera(target, table):
    camera = bpy.data.cameras.new("camera")
    camera.sensor_fit = "VERTICAL"
    camera.angle = math.radians(table.get("fov", 40))
    camera.clip_start, camera.clip_end = 1e-3, 1e7
    eye = Vector(table["eye"])
    back = (eye - Vector(table["target"])).normalized()
    right = Vector(table.get("up", [0, 1, 0])).cross(back).normalized()
    frame = Matrix((right, back.cross(right), back)).transposed().to_4x4()
    thing = bpy.data.objects.new("camera", camera)
    thing.matrix_world = Matrix.Translation(eye) @ frame
    target.collection.objects.link(thing)
    target.camera = thing


def set_world(target, scene, map_scale):
    """Sets the environment. Its importance map has the picture's resolution, as by default in Cycles, or a multiple of it."""
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    tree = world.node_tree
    background = tree.nodes["Background"]
    if scene.picture is None:
        background.inputs["Color"].default_value = (*scene.sky, 1)
    else:
        height, width, _ = scene.picture.shape
        image = bpy.data.images.new("picture", width, height, float_buffer=True, is_data=True)
        values = np.ones((height, width, 4), dtype=np.float32)
        # Rows are from below; the columns of Spherule's picture begin half a turn away.
        values[:, :, :3] = np.roll(scene.picture[::-1], width // 2, axis=1)
        image.pixels.foreach_set(values.ravel())
        image.pack()
        texture = tree.nodes.new("ShaderNodeTexEnvironment")
        texture.image = image
        texture.interpolation = "Linear"
        direction = tree.nodes.new("ShaderNodeTexCoord")
        # Turns y, which is up here, to z.
        turn = tree.nodes.new("ShaderNodeMapping")
        turn.vector_type = "POINT"
        turn.inputs["Rotation"].default_value = (math.pi / 2, 0, 0)
        tree.links.new(direction.outputs["Generated"], turn.inputs["Vector"])
        tree.links.new(turn.outputs["Vector"], texture.inputs["Vector"])
        tree.links.new(texture.outputs["Color"], background.inputs["Color"])
        world.cycles.sampling_method = "MANUAL"
        world.cycles.sample_map_resolution = map_scale * width
    target.world = world


def set_render(target, scene, options):
    """Sets what makes Cycles exact: no clamping or blurred caustics, and box-filtered pixels; and denoising, if it is chosen."""
    render, cycles = target.render, target.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = scene.size
    render.resolution_percentage = 100
    render.threads_mode, render.threads = "FIXED", options.threads
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    cycles.device = "CPU"
    cycles.samples = options.spp
    cycles.use_adaptive_sampling, cycles.use_denoising = options.adaptive, bool(options.prefilter)
    if options.prefilter:
        cycles.denoiser, cycles.denoising_use_gpu = "OPENIMAGEDENOISE", False
        cycles.denoising_input_passes, cycles.denoising_prefilter = "RGB_ALBEDO_NORMAL", options.prefilter
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = 0
    depth = scene.table["render"].get("depth", "unlimited")
    limit = BOUNCES if depth == "unlimited" else depth
    for key in ("max", "diffuse", "glossy", "transmission"):
        setattr(cycles, f"{key}_bounces", limit)


def shader(name, material):
    """Returns a material."""
    kind, color = material["kind"], rgb(material.get("color", 1 if material["kind"] == "dielectric" else 0.7))
    result = bpy.data.materials.new(name)
    result.use_nodes = True
    tree = result.node_tree
    tree.nodes.clear()
    if kind == "lambertian":
        node = closure(tree, "Diffuse", color)
    elif kind == "conductor":
        node = metal(tree, material, color)
    elif kind == "dielectric":
        node = closure(tree, "Glass", color, Roughness=0, IOR=material.get("ior", 1.5))
    elif kind == "plastic":
        node = plastic(tree, color, float(material.get("ior", 1.5)))
    elif kind == "reflective":
        diffuse = closure(tree, "Diffuse", [material.get("diffuse", 0.5) * x for x in color])
        mirror = closure(tree, "Anisotropic", [material.get("mirror", 0.5) * x for x in color], Roughness=0)
        node = combined(tree, "Add", diffuse, mirror)
    else:
        raise Unsupported(f"a material of kind {kind}")
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return result


def closure(tree, name, color=None, **values):
    """Returns a node of a BSDF."""
    node = tree.nodes.new(f"ShaderNodeBsdf{name}")
    if color is not None:
        values["Color"] = (*color, 1)
    for key, value in values.items():
        node.inputs[key].default_value = value
    return node


def combined(tree, name, first, second):
    """Returns a node that adds or mixes two BSDFs."""
    node = tree.nodes.new(f"ShaderNode{name}Shader")
    # The last two inputs are shaders.
    tree.links.new(first.outputs[0], node.inputs[len(node.inputs) - 2])
    tree.links.new(second.outputs[0], node.inputs[len(node.inputs) - 1])
    return node


def metal(tree, material, color):
    """Returns the BSDF of a metal. Blender's roughness is the root of the width of GGX."""
    roughness = math.sqrt(material.get("roughness", 0))
    if "eta" in material:
        node = closure(tree, "Metallic", Roughness=roughness)
        # Before this, the node has no such inputs.
        node.fresnel_type = "PHYSICAL_CONDUCTOR"
        node.inputs["IOR"].default_value, node.inputs["Extinction"].default_value = rgb(material["eta"]), rgb(material["k"])
        return node
    if material.get("fresnel") == "constant":
        return closure(tree, "Anisotropic", color, Roughness=roughness)
    # An edge of white makes it Schlick's approximation.
    return closure(tree, "Metallic", Roughness=roughness, **{"Base Color": (*color, 1), "Edge Tint": (1, 1, 1, 1)})


def plastic(tree, color, ior):
    """Returns a diffuse BSDF and a mirror, mixed by Fresnel's equations.

    The light that the coat lets in is as much as on the average over all directions, and what leaves the base is reflected back
    down as often as in Spherule.
    """
    inside = internal_reflectance(ior)
    fresnel = tree.nodes.new("ShaderNodeFresnel")
    fresnel.inputs["IOR"].default_value = ior
    diffuse = closure(tree, "Diffuse", [x * (1 - inside) / (1 - x * inside) for x in color])
    node = combined(tree, "Mix", diffuse, closure(tree, "Anisotropic", [1] * 3, Roughness=0))
    tree.links.new(fresnel.outputs[0], node.inputs[0])
    return node


def lamp(material, center, radius):
    """Returns a lamp in place of an emissive sphere."""
    if any(rgb(material.get("albedo", 0))):
        raise Unsupported("emissive spheres that reflect")
    return point([4 * math.pi * (math.pi * radius**2) * x for x in rgb(material["radiance"])], center, radius)


def other_lamp(light):
    """Returns a lamp in place of a light that is not a sphere."""
    if light["kind"] == "point" and light.get("falloff", "square") == "square":
        return point([4 * math.pi * x for x in rgb(light["intensity"])], light["position"], 0)
    if light["kind"] == "sun":
        angle = math.radians(light.get("angular_radius", 0.27))
        result = colored("SUN", rgb(light["irradiance"]))
        result.data.angle = 2 * angle
        # Lamps shine down their axis z.
        result.matrix_world = Vector(light["direction"]).to_track_quat("Z", "Y").to_matrix().to_4x4()
        return result
    raise Unsupported("points of light without falloff")


def point(power, center, radius):
    """Returns a lamp that is a sphere of equal radiance or a point, by its power."""
    result = colored("POINT", power)
    result.data.shadow_soft_size = radius
    result.data.use_soft_falloff = False
    result.location = center
    return result


def colored(kind, color):
    """Returns a lamp that is visible in the image."""
    data = bpy.data.lights.new("lamp", kind)
    data.energy = max(*color, 1e-30)
    data.color = [x / data.energy for x in color]
    result = bpy.data.objects.new("lamp", data)
    result.visible_camera = True
    return result


def points(name, spheres, material, solid):
    """Returns spheres: a mesh's vertices, of which geometry nodes make a point cloud, or solids of triangles."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(spheres.radii))
    mesh.vertices.foreach_set("co", spheres.centers.astype(np.float32).ravel())
    mesh.attributes.new("size", "FLOAT", "POINT").data.foreach_set("value", spheres.radii.astype(np.float32))
    mesh.update()
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    radius = tree.nodes.new("GeometryNodeInputNamedAttribute")
    radius.data_type = "FLOAT"
    radius.inputs["Name"].default_value = "size"
    paint = tree.nodes.new("GeometryNodeSetMaterial")
    paint.inputs["Material"].default_value = material
    if solid:
        ball = tree.nodes.new("GeometryNodeMeshIcoSphere")
        ball.inputs["Subdivisions"].default_value = SUBDIVISIONS
        smooth = tree.nodes.new("GeometryNodeSetShadeSmooth")
        instances = tree.nodes.new("GeometryNodeInstanceOnPoints")
        tree.links.new(ball.outputs["Mesh"], smooth.inputs[0])
        tree.links.new(smooth.outputs[0], paint.inputs["Geometry"])
        tree.links.new(start.outputs[0], instances.inputs["Points"])
        tree.links.new(paint.outputs[0], instances.inputs["Instance"])
        tree.links.new(radius.outputs[0], instances.inputs["Scale"])
        tree.links.new(instances.outputs[0], end.inputs[0])
    else:
        convert = tree.nodes.new("GeometryNodeMeshToPoints")
        tree.links.new(start.outputs[0], convert.inputs["Mesh"])
        tree.links.new(radius.outputs[0], convert.inputs["Radius"])
        tree.links.new(convert.outputs[0], paint.inputs["Geometry"])
        tree.links.new(paint.outputs[0], end.inputs[0])
    thing = bpy.data.objects.new(name, mesh)
    thing.modifiers.new("points", "NODES").node_group = tree
    return thing


def ground(table, materials):
    """Returns a large square in place of the ground."""
    normal = Vector(table.get("normal", [0, 1, 0])).normalized()
    right = normal.orthogonal().normalized()
    forward = normal.cross(right)
    center = normal * table.get("height", 0)
    corners = [center + GROUND * (x * right + y * forward) for x, y in ((-1, -1), (1, -1), (1, 1), (-1, 1))]
    mesh = bpy.data.meshes.new("ground")
    mesh.from_pydata([tuple(corner) for corner in corners], [], [(0, 1, 2, 3)])
    mesh.materials.append(materials[table["material"]])
    return bpy.data.objects.new("ground", mesh)


if __name__ == "__main__":
    main()
