"""Renders one of our YAML scenes with Blender's Cycles: same models, camera, lights, light from everywhere.

    blender -b -noaudio --python-exit-code 1 -P tests/compare/cycles.py -- SCENE.yaml WxH SAMPLES FOLDER

draws the first viewpoint and writes into FOLDER cycles-limited.png (light as we simulate it: no diffuse bounce, no caustics), cycles-gi.png
(everything), cycles-mask.png (white where the ray through the pixel's middle hits something) and cycles.json
(processor seconds). Needs Debian's blender, python3-numpy (its glTF importer) and python3-yaml.

Units. Both count radiometrically, and 1 is white. A directional light's irradiance is a sun's strength. A point or
spot light of intensity I (irradiance at one metre) is 4 pi I watts of Blender's, a rectangle of intensity I (along
its normal) 4 I watts. Irradiance E from everywhere is a world of radiance E / pi. tests/compare/scenes/units.yaml
proves all of it. What mirrors and glass see past all surfaces is our background, so scenes here have that be the
light from everywhere, too.

Axes. Ours are x right, y up, z towards the viewer; Blender's importers make of that x, -z, y, and so does this.
"""
import json
import math
import os
import sys
import time

import bpy
import numpy
import yaml
from mathutils import Matrix, Vector

sys.path.insert(0, os.path.dirname(os.path.abspath(__file__)))
import mtl  # noqa: E402  (beside this file)

AXES = Matrix(((1, 0, 0, 0), (0, 0, -1, 0), (0, 1, 0, 0), (0, 0, 0, 1)))  # ours to Blender's
numpy.bool = bool  # Blender 3.4's glTF importer asks for it, Debian's numpy has it no more
UNITS = {"mm": 0.001, "cm": 0.01, "m": 1.0, "inch": 0.0254}
BOUNCES = 4  # as our setting `bounces`


def ours(vector):
    return (AXES @ Vector(vector).to_4d()).to_3d()


def placed(model):
    """A model's matrix: unit and up axis, then scale, turns about x, y and z, shift, or a matrix for those three."""
    unit = model.get("unit", "m")
    result = Matrix.Scale(UNITS[unit] if unit in UNITS else float(unit), 4)
    if model.get("up", "y") == "z":
        result = Matrix.Rotation(-math.pi / 2, 4, "X") @ result
    if "matrix" in model:
        numbers = model["matrix"]
        return Matrix((numbers[0:4], numbers[4:8], numbers[8:12], (0, 0, 0, 1))) @ result
    result = Matrix.Scale(model.get("scale", 1), 4) @ result
    for axis, degrees in zip("XYZ", model.get("rotate", (0, 0, 0))):
        result = Matrix.Rotation(math.radians(degrees), 4, axis) @ result
    return Matrix.Translation(model.get("translate", (0, 0, 0))) @ result


def smooth_as_we_do(added):
    """Without normals in the file both make smooth ones with creases at 60 degrees; Blender only when asked."""
    for thing in added:
        if thing.type == "MESH" and not thing.data.has_custom_normals:
            thing.data.polygons.foreach_set("use_smooth", [True] * len(thing.data.polygons))
            thing.data.use_auto_smooth = True
            thing.data.auto_smooth_angle = math.radians(60)


def dress_the_bare(added):
    """glTF's triangles without a material are a rough light grey for us, and Lambert's white for Blender."""
    grey = bpy.data.materials.new("grey")
    grey.use_nodes = True
    principled = grey.node_tree.nodes["Principled BSDF"]
    principled.inputs["Base Color"].default_value = (0.7, 0.7, 0.7, 1)
    principled.inputs["Roughness"].default_value = 0.6
    for thing in added:
        if thing.type == "MESH" and not any(thing.data.materials):
            thing.data.materials.clear()
            thing.data.materials.append(grey)


def add_model(model, folder):
    path = os.path.join(folder, model["file"])
    before, known = set(bpy.data.objects), set(bpy.data.materials)
    if path.lower().endswith((".gltf", ".glb")):
        bpy.ops.import_scene.gltf(filepath=path, convert_lighting_mode="COMPAT")
        plain_lambert(path, set(bpy.data.materials) - known)
    elif path.lower().endswith(".obj"):
        bpy.ops.wm.obj_import(filepath=path, forward_axis="NEGATIVE_Z", up_axis="Y", clamp_size=0)
        mtl.read_as_we_do(path, set(bpy.data.materials) - known)
    else:
        raise SystemExit(f"{path}: only glTF and OBJ are compared")
    added = [thing for thing in bpy.data.objects if thing not in before]
    if path.lower().endswith(".obj"):
        smooth_as_we_do(added)
    dress_the_bare(added)
    move = AXES @ placed(model) @ AXES.inverted()
    for thing in added:
        if thing.parent is None:
            thing.matrix_world = move @ thing.matrix_world
    return added


def plain_lambert(path, materials):
    """A glTF material whose specularFactor is 0 is Lambert's surface for us. Blender's importer reads 1 there, and its
    Principled BSDF has Disney's diffuse term."""
    if not path.endswith(".gltf"):
        return
    with open(path, encoding="utf-8") as file:
        rows = json.load(file).get("materials", ())
    plain = {row.get("name") for row in rows
             if row.get("extensions", {}).get("KHR_materials_specular", {}).get("specularFactor") == 0}
    for material in materials:
        if material.name not in plain:
            continue
        nodes = material.node_tree.nodes
        diffuse = nodes.new("ShaderNodeBsdfDiffuse")
        principled = next(node for node in nodes if node.type == "BSDF_PRINCIPLED")
        diffuse.inputs["Color"].default_value = principled.inputs["Base Color"].default_value
        for link in list(principled.outputs["BSDF"].links):
            material.node_tree.links.new(diffuse.outputs["BSDF"], link.to_socket)


def whole_coat(material, node):
    """A Principled BSDF's clearcoat of 1 reflects a quarter of a real one (Disney's 0.25), glTF's all of it."""
    nodes, links, socket = material.node_tree.nodes, material.node_tree.links, node.inputs["Clearcoat"]
    if not socket.is_linked and socket.default_value == 0:
        return
    four = nodes.new("ShaderNodeMath")
    four.operation = "MULTIPLY"
    four.inputs[0].default_value, four.inputs[1].default_value = socket.default_value, 4
    for link in list(socket.links):
        links.new(link.from_socket, four.inputs[0])
    links.new(four.outputs[0], socket)


def as_gltf_means():
    """Highlights that keep the light of several microfacets, as ours do, and clearcoats of their full strength."""
    for material in bpy.data.materials:
        for node in list(material.node_tree.nodes) if material.use_nodes else ():
            if node.type == "BSDF_PRINCIPLED":
                node.distribution = "MULTI_GGX"
                whole_coat(material, node)


def new_light(kind, energy, row):
    data = bpy.data.lights.new(kind, kind)
    color = Vector(row.get("color", (1, 1, 1)))
    data.color = color
    data.energy = energy * row.get("intensity", 1)
    thing = bpy.data.objects.new(kind, data)
    thing.visible_camera = False
    bpy.context.scene.collection.objects.link(thing)
    return thing, data


def along(thing, direction, place=(0, 0, 0)):
    """Blender's lights shine along their -z."""
    turn = ours(direction).to_track_quat("-Z", "Y").to_matrix().to_4x4()
    thing.matrix_world = Matrix.Translation(ours(place)) @ turn


def shade_cone(data, inner, outer):
    """A point light that is ((cos a - cos outer) / (cos inner - cos outer))^2, clamped, about its -z, as glTF has
    spots: Blender's own fall off by another curve, over more of the cone."""
    data.use_nodes = True
    nodes, links = data.node_tree.nodes, data.node_tree.links

    def computed(operation, first, second, clamp=False):
        node = nodes.new("ShaderNodeMath")
        node.operation, node.use_clamp = operation, clamp
        links.new(first, node.inputs[0])
        node.inputs[1].default_value = second
        return node.outputs[0]

    separate = nodes.new("ShaderNodeSeparateXYZ")
    links.new(nodes.new("ShaderNodeTexCoord").outputs["Normal"], separate.inputs[0])
    cosine = computed("MULTIPLY", separate.outputs["Z"], -1)
    share = computed("MULTIPLY", computed("SUBTRACT", cosine, outer), 1 / (inner - outer), clamp=True)
    links.new(computed("POWER", share, 2), nodes["Emission"].inputs["Strength"])


def add_light(row):
    if "directional" in row:
        thing, data = new_light("SUN", 1, row)
        data.angle = math.radians(row.get("angle", 0))
        along(thing, row["directional"])
    elif "point" in row:
        thing, data = new_light("POINT", 4 * math.pi, row)
        data.shadow_soft_size = row.get("radius", 0)
        thing.location = ours(row["point"])
    elif "spot" in row:
        thing, data = new_light("POINT", 4 * math.pi, row)
        data.shadow_soft_size = row.get("radius", 0)
        along(thing, row["direction"], row["spot"])
        shade_cone(data, *(math.cos(math.radians(angle)) for angle in row.get("cone", (0, 45))))
    else:
        thing, data = new_light("AREA", 4, row)
        width, height = ours(row["width"]), ours(row["height"])
        data.shape, data.size, data.size_y = "RECTANGLE", width.length, height.length
        x, y = width.normalized(), -height.normalized()
        turn = Matrix((x, y, x.cross(y))).transposed().to_4x4()
        thing.matrix_world = Matrix.Translation(ours(row["rectangle"])) @ turn


def world_node(kind, **sockets):
    node = bpy.context.scene.world.node_tree.nodes.new(kind)
    for name, value in sockets.items():
        node.inputs[name].default_value = value
    return node


def add_world(text, folder):
    world = bpy.data.worlds.new("world")
    bpy.context.scene.world = world
    world.use_nodes = True
    links = world.node_tree.links
    background = world.node_tree.nodes["Background"]
    environment = text.get("environment")
    if not environment:
        ambient = [value / math.pi for value in text.get("ambient", (0, 0, 0))]
        if any(abs(a - b) > 1e-3 for a, b in zip(ambient, text["background"])):
            raise SystemExit("a scene to compare needs a background of ambient / pi")
        background.inputs["Color"].default_value = (*ambient, 1)
        return
    picture = world_node("ShaderNodeTexEnvironment")
    picture.image = bpy.data.images.load(os.path.join(folder, environment["file"]))
    turn = world_node("ShaderNodeMapping", Rotation=(0, 0, math.radians(environment.get("rotation", 0) - 90)))
    links.new(world_node("ShaderNodeTexCoord").outputs["Generated"], turn.inputs["Vector"])
    links.new(turn.outputs["Vector"], picture.inputs["Vector"])
    links.new(picture.outputs["Color"], background.inputs["Color"])
    background.inputs["Strength"].default_value = environment.get("intensity", 1)


def add_camera(view, width, height):
    data = bpy.data.cameras.new("camera")
    camera = bpy.data.objects.new("camera", data)
    bpy.context.scene.collection.objects.link(camera)
    eye, at, up = ours(view["eye"]), ours(view["look_at"]), ours(view.get("up", (0, 1, 0)))
    back = (eye - at).normalized()
    right = up.cross(back).normalized()
    turn = Matrix((right, back.cross(right), back)).transposed().to_4x4()
    camera.matrix_world = Matrix.Translation(eye) @ turn
    data.sensor_fit = "VERTICAL"
    data.angle = math.radians(view.get("fov", 45))
    data.clip_start = (eye - at).length * 1e-3
    data.clip_end = (eye - at).length * 1e4
    scene = bpy.context.scene
    scene.camera = camera
    scene.render.resolution_x, scene.render.resolution_y = width, height
    scene.render.resolution_percentage = 100


def set_up(samples):
    scene = bpy.context.scene
    scene.render.engine = "CYCLES"
    scene.render.threads_mode = "FIXED"
    scene.render.threads = 2
    scene.view_settings.view_transform = "Standard"
    scene.view_settings.look = "None"
    scene.render.dither_intensity = 0
    scene.render.image_settings.file_format = "PNG"
    scene.render.image_settings.color_mode = "RGB"
    scene.render.image_settings.compression = 90
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.samples = samples
    cycles.use_adaptive_sampling = True
    cycles.adaptive_threshold = 0.01
    cycles.use_denoising = False  # Debian's Cycles has no denoiser
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 1
    cycles.sample_clamp_direct = 0
    cycles.sample_clamp_indirect = 10
    cycles.blur_glossy = 0
    cycles.seed = 1


def bounces(diffuse, others, caustics):
    cycles = bpy.context.scene.cycles
    cycles.max_bounces = max(diffuse, others)
    cycles.diffuse_bounces = diffuse
    cycles.glossy_bounces = cycles.transmission_bounces = others
    cycles.transparent_max_bounces = 32
    cycles.caustics_reflective = cycles.caustics_refractive = caustics


def render(path):
    began = time.process_time()
    bpy.context.scene.render.filepath = path
    bpy.ops.render.render(write_still=True)
    return time.process_time() - began


def render_mask(path):
    """Alpha of one ray through each pixel's middle."""
    scene = bpy.context.scene
    bounces(0, 0, False)
    scene.render.film_transparent = True
    scene.cycles.filter_width = 0.01
    scene.cycles.samples = 1
    scene.render.image_settings.color_mode = "RGBA"
    scene.use_nodes = True
    nodes, links = scene.node_tree.nodes, scene.node_tree.links
    nodes.clear()
    layers, out = nodes.new("CompositorNodeRLayers"), nodes.new("CompositorNodeComposite")
    opaque = nodes.new("CompositorNodeMath")
    opaque.operation = "GREATER_THAN"
    opaque.inputs[1].default_value = 0.98
    links.new(layers.outputs["Alpha"], opaque.inputs[0])
    links.new(opaque.outputs[0], out.inputs["Image"])
    scene.render.image_settings.color_mode = "RGB"
    render(path)


def main():
    path, size, samples, out = sys.argv[sys.argv.index("--") + 1:]
    width, height = (int(part) for part in size.split("x"))
    with open(path, encoding="utf-8") as file:
        text = yaml.safe_load(file)
    folder = os.path.dirname(os.path.abspath(path))
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.ops.preferences.addon_enable(module="io_scene_gltf2")
    for model in text["models"]:
        added = add_model(model, folder)
        for thing in added:
            if thing.type == "LIGHT" and "lights" in text:
                bpy.data.objects.remove(thing)
    as_gltf_means()
    for row in text.get("lights", ()):
        add_light(row)
    add_world(text, folder)
    add_camera(text["viewpoints"][0], width, height)
    set_up(int(samples))
    seconds = {}
    bounces(0, BOUNCES, False)
    seconds["limited"] = render(os.path.join(out, "cycles-limited.png"))
    bounces(8, 12, True)
    seconds["gi"] = render(os.path.join(out, "cycles-gi.png"))
    render_mask(os.path.join(out, "cycles-mask.png"))
    with open(os.path.join(out, "cycles.json"), "w", encoding="utf-8") as file:
        json.dump({"seconds": seconds, "samples": int(samples)}, file)


main()
