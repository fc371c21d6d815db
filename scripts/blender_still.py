"""A still of an exported animation, rendered by Blender's Cycles.

    blender_still.py HAIR.abc SOLIDS.abc FRAME OUT.png [WIDTH HEIGHT SAMPLES]

HAIR and SOLIDS are what `wetcurl export RUN.h5 -o HAIR.abc --for blender --solids SOLIDS.abc` writes. Needs Blender as
the Python module bpy.
"""
import math
import os
import sys

import bpy
from mathutils import Vector

hair_file, solids_file, frame, picture = sys.argv[1:5]
width, height, samples = [int(n) for n in sys.argv[5:8]] or [720, 900, 64]

bpy.ops.wm.read_factory_settings(use_empty=True)
scene = bpy.context.scene
for path in (solids_file, hair_file):
    bpy.ops.wm.alembic_import(filepath=os.path.abspath(path), set_frame_range=True)
scene.frame_set(int(frame) + 1)  # frame 0 of a run is frame 1 of its files


def material(name, make):
    it = bpy.data.materials.new(name)
    it.use_nodes = True
    nodes = it.node_tree.nodes
    nodes.clear()
    out = nodes.new("ShaderNodeOutputMaterial")
    shader = make(nodes)
    it.node_tree.links.new(shader.outputs[0], out.inputs["Surface"])
    return it


def of_hair(nodes):
    shader = nodes.new("ShaderNodeBsdfHairPrincipled")
    shader.parametrization = "MELANIN"
    shader.inputs["Melanin"].default_value = 0.85
    shader.inputs["Roughness"].default_value = 0.2
    return shader


def of_skin(nodes):
    shader = nodes.new("ShaderNodeBsdfPrincipled")
    shader.inputs["Base Color"].default_value = (0.35, 0.3, 0.27, 1)
    shader.inputs["Roughness"].default_value = 0.6
    return shader


hair_material, skin = material("hair", of_hair), material("skin", of_skin)
corners = []
for thing in scene.objects:
    if thing.type in ("CURVES", "MESH", "CURVE"):
        thing.data.materials.clear()
        thing.data.materials.append(hair_material if thing.type != "MESH" else skin)
        if thing.type != "MESH":
            corners += [thing.matrix_world @ Vector(c) for c in thing.bound_box]
if not corners:
    sys.exit(f"{hair_file}: no curves")
low = Vector([min(c[k] for c in corners) for k in range(3)])
high = Vector([max(c[k] for c in corners) for k in range(3)])
middle, size = (low + high) / 2, (high - low).length


def aimed(thing, place):
    thing.location = place
    thing.rotation_euler = (middle - Vector(place)).to_track_quat("-Z", "Y").to_euler()
    scene.collection.objects.link(thing)
    return thing


def around(yaw, up, distance):
    """Seen from the front, which in Blender is -y."""
    a = math.radians(yaw)
    return middle + size * Vector((distance * math.sin(a), -distance * math.cos(a), up))


camera = aimed(bpy.data.objects.new("camera", bpy.data.cameras.new("camera")), around(28, 0.1, 2.2))
camera.data.lens = 75
scene.camera = camera
for yaw, up, watts, side in ((70, 1.2, 40, 0.5), (-60, 0.6, 12, 1.0), (180, 1.0, 30, 0.6)):
    light = bpy.data.lights.new("light", "AREA")
    light.energy, light.size = watts * size * size * 4, side * size
    aimed(bpy.data.objects.new("light", light), around(yaw, up, 1.6))
scene.world = bpy.data.worlds.new("world")
scene.world.use_nodes = True
scene.world.node_tree.nodes["Background"].inputs["Color"].default_value = (0.6, 0.62, 0.66, 1)
scene.world.node_tree.nodes["Background"].inputs["Strength"].default_value = 0.5

scene.render.engine = "CYCLES"
scene.cycles.device, scene.cycles.samples = "CPU", samples
scene.cycles.use_denoising = False
scene.render.resolution_x, scene.render.resolution_y = width, height
scene.render.filepath = os.path.abspath(picture)
bpy.ops.render.render(write_still=True)
print("curves", sum(len(t.data.curves) for t in scene.objects if t.type == "CURVES"))
