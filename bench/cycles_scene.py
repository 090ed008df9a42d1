"""Run by Blender for bench/other_renderers and bench/all_orders.

It renders SPEC's scene by Cycles with more and more samples, and times that.

    blender -b --factory-startup --python bench/cycles_scene.py -- SPEC.json

Prints "cycles CPU WALL SAMPLES FILE" for each picture; FILE has its RGB as numpy's float32, top row first. The first
of the samples and a picture before it load the kernels and build the scene, and are not counted: neither has its samples.
"""
import json
import sys
import time

import bpy
import mathutils
import numpy

with open(sys.argv[sys.argv.index("--") + 1], encoding="ascii") as spec_file:
    spec = json.load(spec_file)
scene = bpy.context.scene


def nodes_of(owner):
    owner.use_nodes = True
    owner.node_tree.nodes.clear()
    return owner.node_tree.nodes, owner.node_tree.links


def volume_material(name, is_homogeneous):
    material = bpy.data.materials.new(name)
    nodes, links = nodes_of(material)
    material.cycles.homogeneous_volume = is_homogeneous
    material.cycles.volume_sampling = "MULTIPLE_IMPORTANCE"
    return material, nodes, links, nodes.new("ShaderNodeOutputMaterial").inputs["Volume"]


def colour_and_density(sigma):
    """Cycles multiplies a colour of at most 1 by a density."""
    density = max(max(sigma), 1e-9)
    return [*(s / density for s in sigma), 1], density


def medium_shader(nodes, links, output, medium):
    """Scattering and absorption, each a number for each colour; returns the inputs for their densities, which are constant."""
    scatter, absorb, both = nodes.new("ShaderNodeVolumeScatter"), nodes.new("ShaderNodeVolumeAbsorption"), nodes.new("ShaderNodeAddShader")
    scatter.inputs["Color"].default_value, scatter.inputs["Density"].default_value = colour_and_density(medium["sigma_s"])
    scatter.inputs["Anisotropy"].default_value = medium.get("g", 0)
    colour, density = colour_and_density(medium["sigma_a"])
    absorb.inputs["Color"].default_value = [*(1 - c for c in colour[:3]), 1]
    absorb.inputs["Density"].default_value = density
    if not any(medium["sigma_a"]):
        links.new(scatter.outputs[0], output)
    elif not any(medium["sigma_s"]):
        links.new(absorb.outputs[0], output)
    else:
        links.new(scatter.outputs[0], both.inputs[0])
        links.new(absorb.outputs[0], both.inputs[1])
        links.new(both.outputs[0], output)
    return [shader.inputs["Density"] for shader in (scatter, absorb)]


def add_shape(medium):
    if medium["shape"] == "sphere":
        bpy.ops.mesh.primitive_ico_sphere_add(subdivisions=7, radius=medium["radius"], location=medium["center"])
    else:
        bpy.ops.mesh.primitive_cube_add(size=1, location=medium["center"])
        bpy.context.object.scale = medium["size"]
    material, nodes, links, output = volume_material("shape", True)
    medium_shader(nodes, links, output, medium)
    bpy.context.object.data.materials.append(material)


def add_grid(medium):
    """A VDB file's grid "density", times a coefficient, or as a table of emission (RGB) and absorption (A) over [0, 1]."""
    data = bpy.data.volumes.new("grid")
    data.filepath = medium["file"]
    data.render.step_size = 0  # a voxel, times the scene's rate
    thing = bpy.data.objects.new("grid", data)
    scene.collection.objects.link(thing)
    material, nodes, links, output = volume_material("grid", False)
    value = nodes.new("ShaderNodeAttribute")
    value.attribute_name = "density"

    def link_scaled(source, density, factor):
        """Has a shader's density be a value times a factor."""
        scale = nodes.new("ShaderNodeMath")
        scale.operation = "MULTIPLY"
        scale.inputs[1].default_value = factor
        links.new(source, scale.inputs[0])
        links.new(scale.outputs[0], density)

    if "table" not in medium:
        for density in medium_shader(nodes, links, output, medium):
            link_scaled(value.outputs["Fac"], density, medium["scale"] * density.default_value)
    else:
        ramp = nodes.new("ShaderNodeValToRGB")
        stops = ramp.color_ramp.elements
        stops[0].position, stops[1].position = medium["table"][0][0], medium["table"][-1][0]
        for row in medium["table"][1:-1]:
            stops.new(row[0])
        for stop, row in zip(stops, medium["table"]):
            stop.color = row[1:]
        emit, absorb, both = nodes.new("ShaderNodeEmission"), nodes.new("ShaderNodeVolumeAbsorption"), nodes.new("ShaderNodeAddShader")
        absorb.inputs["Color"].default_value = [0, 0, 0, 1]
        emit.inputs["Strength"].default_value = medium["scale"]
        links.new(value.outputs["Fac"], ramp.inputs[0])
        links.new(ramp.outputs["Color"], emit.inputs["Color"])
        link_scaled(ramp.outputs["Alpha"], absorb.inputs["Density"], medium["scale"])
        links.new(emit.outputs[0], both.inputs[0])
        links.new(absorb.outputs[0], both.inputs[1])
        links.new(both.outputs[0], output)
    data.materials.append(material)


def add_light(light):
    data = bpy.data.lights.new("lamp", "POINT")
    peak = max(light["intensity"])
    data.energy = peak * spec["watts_per_intensity"]
    data.color = [c / peak for c in light["intensity"]]
    data.shadow_soft_size = 0
    data.cycles.max_bounces = spec["bounces"]
    thing = bpy.data.objects.new("lamp", data)
    thing.location = light["position"]
    scene.collection.objects.link(thing)


def add_camera():
    data = bpy.data.cameras.new("camera")
    data.sensor_fit = "VERTICAL"
    data.angle = spec["fov"] * 3.141592653589793 / 180
    data.clip_start, data.clip_end = 1e-3, 1e3
    thing = bpy.data.objects.new("camera", data)
    eye, target, up = (mathutils.Vector(spec[key]) for key in ("eye", "target", "up"))
    back = (eye - target).normalized()
    right = up.cross(back).normalized()
    columns = mathutils.Matrix((right, back.cross(right), back)).transposed().to_4x4()
    thing.matrix_world = mathutils.Matrix.Translation(eye) @ columns
    scene.collection.objects.link(thing)
    scene.camera = thing


def set_up():
    for thing in list(bpy.data.objects):
        bpy.data.objects.remove(thing)
    scene.render.engine = "CYCLES"
    scene.render.resolution_x, scene.render.resolution_y = spec["size"]
    scene.render.resolution_percentage = 100
    scene.render.use_persistent_data = True
    scene.render.image_settings.file_format = "OPEN_EXR"
    scene.render.image_settings.color_depth = "32"
    cycles = scene.cycles
    cycles.device = "CPU"
    cycles.use_denoising = cycles.use_adaptive_sampling = False
    cycles.pixel_filter_type = "BOX"
    cycles.filter_width = 0.01  # points at the pixels' centres, as the truth has
    cycles.max_bounces = cycles.volume_bounces = cycles.diffuse_bounces = spec["bounces"]  # 0: single scattering
    cycles.transparent_max_bounces = 64
    cycles.sample_clamp_direct = cycles.sample_clamp_indirect = 0
    cycles.light_sampling_threshold = 0
    cycles.volume_step_rate = spec["step_rate"]
    cycles.volume_max_steps = 65536
    world = bpy.data.worlds.new("world")
    nodes, links = nodes_of(world)
    back, output = nodes.new("ShaderNodeBackground"), nodes.new("ShaderNodeOutputWorld")
    back.inputs[0].default_value = [*spec["background"], 1]
    links.new(back.outputs[0], output.inputs[0])
    world.cycles.sampling_method = "NONE"
    world.cycles_visibility.scatter = False
    scene.world = world
    for medium in spec["media"]:
        (add_grid if "file" in medium else add_shape)(medium)
    for light in spec["lights"]:
        add_light(light)
    add_camera()


def picture(path):
    bpy.data.images["Render Result"].save_render(path + ".exr")
    image = bpy.data.images.load(path + ".exr")
    image.colorspace_settings.name = "Linear"
    width, height = spec["size"]
    pixels = numpy.array(image.pixels[:], dtype=numpy.float32).reshape(height, width, 4)[::-1, :, :3]
    bpy.data.images.remove(image)
    numpy.save(path, pixels)


set_up()
scene.cycles.samples = 1
bpy.ops.render.render()
for samples in spec["samples"]:
    scene.cycles.samples = samples
    wall, cpu = time.monotonic(), time.process_time()
    bpy.ops.render.render()
    cpu, wall = time.process_time() - cpu, time.monotonic() - wall
    name = f"{spec['out']}_{samples}.npy"
    picture(name)
    if samples == spec["samples"][0]:
        continue
    print(f"cycles {cpu:.4f} {wall:.4f} {samples} {name}", flush=True)
    if cpu > spec["limit_s"]:
        break
