#!/usr/bin/env python3
"""Renders a scene file of Spherule with Cycles, once per seed, and prints the times as lines of JSON.

It runs in a Python that can import `bpy`, Blender as a module. Spheres are points of point clouds, which Cycles intersects as exact
spheres, but only from outside; and it does not sample emissive points as lights. So scenes may have diffuse spheres and smooth
mirrors of constant reflectance, a diffuse ground, and light only from the environment. Images are written to --folder as SEED.pfm.
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

from scene_file import Unsupported, read_scene, render_arguments, rgb, write_pfm

# Half the edge of the square that represents the ground, in the scene's unit.
GROUND = 1e4
# Longest paths that Cycles allows.
BOUNCES = 1024


def main():
    parser = render_arguments(__doc__)
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
        wall, cpu = time.perf_counter() - start, time.process_time() - cpu
        convert(options.folder / f"{seed}.exr", options.folder / f"{seed}.pfm")
        print(json.dumps({"seed": seed, "cpu": cpu, "wall": wall}), flush=True)


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
    if scene.table.get("light"):
        raise Unsupported("lights other than the environment")
    set_camera(target, scene.table["camera"])
    set_world(target, scene)
    set_render(target, scene, options)
    materials = {name: shader(name, material) for name, material in scene.materials.items()}
    for name, spheres in scene.spheres.items():
        add(target, name, points(name, spheres, materials[name]))
    if "ground" in scene.table:
        add(target, "ground", ground(scene.table["ground"], materials))


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


def set_world(target, scene):
    """Sets the environment; its importance map has the picture's resolution."""
    world = bpy.data.worlds.new("world")
    world.use_nodes = True
    tree = world.node_tree
    background = tree.nodes["Background"]
    if scene.picture is None:
        background.inputs["Color"].default_value = (*rgb(scene.table.get("environment", {}).get("color", 1)), 1)
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
        world.cycles.sample_map_resolution = width
    target.world = world


def set_render(target, scene, options):
    """Sets what makes Cycles exact: no clamping, adaptive sampling, denoising or blurred caustics, and box-filtered pixels."""
    render, cycles = target.render, target.cycles
    render.engine = "CYCLES"
    render.resolution_x, render.resolution_y = scene.size
    render.resolution_percentage = 100
    render.threads_mode, render.threads = "FIXED", options.threads
    render.image_settings.file_format = "OPEN_EXR"
    render.image_settings.color_depth = "32"
    cycles.device = "CPU"
    cycles.samples = options.spp
    cycles.use_adaptive_sampling = cycles.use_denoising = False
    cycles.pixel_filter_type, cycles.filter_width = "BOX", 1
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.blur_glossy = 0
    depth = scene.table["render"].get("depth", "unlimited")
    limit = BOUNCES if depth == "unlimited" else depth
    for key in ("max", "diffuse", "glossy", "transmission"):
        setattr(cycles, f"{key}_bounces", limit)


def shader(name, material):
    """Returns a material."""
    kind, color = material["kind"], (*rgb(material.get("color", 0.7)), 1)
    result = bpy.data.materials.new(name)
    result.use_nodes = True
    tree = result.node_tree
    tree.nodes.clear()
    if kind == "lambertian":
        node = tree.nodes.new("ShaderNodeBsdfDiffuse")
    elif kind == "conductor" and material.get("fresnel") == "constant" and material.get("roughness", 0) == 0:
        node = tree.nodes.new("ShaderNodeBsdfAnisotropic")
        node.inputs["Roughness"].default_value = 0
    else:
        raise Unsupported(f"a material of kind {kind} with these parameters")
    node.inputs["Color"].default_value = color
    output = tree.nodes.new("ShaderNodeOutputMaterial")
    tree.links.new(node.outputs[0], output.inputs["Surface"])
    return result


def points(name, spheres, material):
    """Returns a point cloud, made of a mesh's vertices by geometry nodes."""
    mesh = bpy.data.meshes.new(name)
    mesh.vertices.add(len(spheres.radii))
    mesh.vertices.foreach_set("co", spheres.centers.astype(np.float32).ravel())
    mesh.attributes.new("size", "FLOAT", "POINT").data.foreach_set("value", spheres.radii.astype(np.float32))
    mesh.update()
    tree = bpy.data.node_groups.new(name, "GeometryNodeTree")
    for direction in ("INPUT", "OUTPUT"):
        tree.interface.new_socket("Geometry", in_out=direction, socket_type="NodeSocketGeometry")
    start, end = tree.nodes.new("NodeGroupInput"), tree.nodes.new("NodeGroupOutput")
    convert = tree.nodes.new("GeometryNodeMeshToPoints")
    radius = tree.nodes.new("GeometryNodeInputNamedAttribute")
    radius.data_type = "FLOAT"
    radius.inputs["Name"].default_value = "size"
    paint = tree.nodes.new("GeometryNodeSetMaterial")
    paint.inputs["Material"].default_value = material
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
