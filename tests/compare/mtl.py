"""Gives Blender's materials of an OBJ file the reading of MTL that docs/materials.md has: MTL names no physical
quantities, so every program reads it in its own way, and it is renderers that are compared here, not importers."""
import os


def srgb_to_linear(value):
    return value / 12.92 if value <= 0.04045 else ((value + 0.055) / 1.055) ** 2.4


def decoded(words):
    return [srgb_to_linear(min(max(float(word), 0), 1)) for word in words[:3]]


def parse(path):
    """Materials of a library: name to key to words."""
    materials, current = {}, {}
    with open(path, encoding="utf-8", errors="replace") as file:
        for line in file:
            words = line.split()
            if len(words) < 2 or words[0].startswith("#"):
                continue
            if words[0] == "newmtl":
                current = materials.setdefault(" ".join(words[1:]), {})
            else:
                current[words[0].lower()] = words[1:]
    return materials


def libraries(obj):
    folder = os.path.dirname(obj)
    with open(obj, encoding="utf-8", errors="replace") as file:
        for line in file:
            if line.startswith("mtllib"):
                yield os.path.join(folder, line.split(None, 1)[1].strip())


def number(keys, name, missing):
    return float(keys[name][0]) if name in keys else missing


def illumination(keys):
    return int(number(keys, "illum", 2))


def roughness(keys):
    shines = illumination(keys) != 1 and any(float(word) > 0 for word in keys.get("ks", ["0"])[:3])
    exponent = number(keys, "ns", 0)
    return (2 / (exponent + 2)) ** 0.25 if shines and exponent > 0 else 1.0


def set_color(material, node, keys):
    """Kd times the picture, if there is one; a black Kd beside it counts as white."""
    socket = node.inputs["Base Color"]
    color = decoded(keys.get("kd", ["0.8"] * 3))
    if not socket.is_linked:
        socket.default_value = (*color, 1)
        return
    color = color if any(color) else [1, 1, 1]
    picture = socket.links[0].from_socket
    mix = material.node_tree.nodes.new("ShaderNodeVectorMath")
    mix.operation = "MULTIPLY"
    mix.inputs[1].default_value = color
    material.node_tree.links.new(picture, mix.inputs[0])
    material.node_tree.links.new(mix.outputs["Vector"], socket)


def set_alpha(material, node, keys):
    opacity = number(keys, "d", 1 - number(keys, "tr", 0))
    socket = node.inputs["Alpha"]
    picture = node.inputs["Base Color"].links[0].from_node if node.inputs["Base Color"].is_linked else None
    if opacity < 1:
        for link in list(socket.links):
            material.node_tree.links.remove(link)
        socket.default_value = opacity
    elif not socket.is_linked and picture is not None and picture.type == "TEX_IMAGE" and picture.image:
        if picture.image.depth == 32:
            material.node_tree.links.new(picture.outputs["Alpha"], socket)


def show_unlit(material, node):
    """illum 0: the base colour as it is."""
    emission = material.node_tree.nodes.new("ShaderNodeEmission")
    base = node.inputs["Base Color"]
    emission.inputs["Color"].default_value = base.default_value
    for link in base.links:
        material.node_tree.links.new(link.from_socket, emission.inputs["Color"])
    for link in list(node.outputs["BSDF"].links):
        material.node_tree.links.new(emission.outputs["Emission"], link.to_socket)


def apply(material, keys):
    node = next((n for n in material.node_tree.nodes if n.type == "BSDF_PRINCIPLED"), None)
    if node is None:
        return
    set_alpha(material, node, keys)
    set_color(material, node, keys)
    index = number(keys, "ni", 1)
    index = index if index > 1 else 1.5
    values = {
        "Metallic": number(keys, "pm", 0),
        "Roughness": number(keys, "pr", -1),
        "Specular": ((index - 1) / (index + 1)) ** 2 / 0.08,
        "Specular Tint": 0,
        "Transmission": 0,
        "Sheen": number(keys, "ps", 0),
        "Clearcoat": number(keys, "pc", 0),
        "Clearcoat Roughness": number(keys, "pcr", 0),
    }
    values["Roughness"] = values["Roughness"] if values["Roughness"] >= 0 else roughness(keys)
    for name, value in values.items():
        for link in list(node.inputs[name].links):
            material.node_tree.links.remove(link)
        node.inputs[name].default_value = value
    if not node.inputs["Emission"].is_linked:
        node.inputs["Emission"].default_value = (*decoded(keys.get("ke", ["0"] * 3)), 1)
    node.inputs["Emission Strength"].default_value = 1
    if illumination(keys) == 0:
        show_unlit(material, node)


def read_as_we_do(obj, materials):
    known = {}
    for library in libraries(obj):
        if os.path.exists(library):
            known.update(parse(library))
    for material in materials:
        name = material.name if material.name in known else material.name.rsplit(".", 1)[0]
        if name in known and material.use_nodes:
            apply(material, known[name])
