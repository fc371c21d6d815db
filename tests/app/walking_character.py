"""A character with hair to the shoulders, made in Blender: it walks, turns its head and breathes, and the shot cuts.

    walking_character.py make FOLDER [STRANDS]     # body.abc, rest.obj, groom.abc, scene.toml
    walking_character.py check FOLDER              # hair.abc, which wetcurl exported, against the body as Blender has it

All arrays are in metres, y up, as files have them; Blender itself has z up.
"""
import math
import random
import sys

import bpy
import numpy as np
from mathutils import Matrix, Quaternion, Vector
from mathutils.bvhtree import BVHTree

FRAMES, CUT = 96, 48            # of the scene: 0 to 95, and the first one after the cut
STRANDS = int(sys.argv[3]) if len(sys.argv) > 3 else 150
POINTS, LENGTH = 40, 0.3

# Parts: ends [m], z up, facing -y, with a radius each; and the bone that moves the skin around them.
JOINTS = {
    "pelvis": ((0, 0, 0.94), (0, 0, 1.08)), "spine": ((0, 0, 1.08), (0, 0, 1.24)), "chest": ((0, 0, 1.24), (0, 0, 1.42)),
    "neck": ((0, 0.01, 1.42), (0, 0.01, 1.53)), "head": ((0, 0, 1.53), (0, 0, 1.75)),
    "arm.L": ((0.17, 0, 1.40), (0.25, 0.01, 1.13)), "hand.L": ((0.25, 0.01, 1.13), (0.27, -0.04, 0.86)),
    "leg.L": ((0.09, 0, 0.92), (0.10, 0, 0.50)), "foot.L": ((0.10, 0, 0.50), (0.10, 0.02, 0.09)),
    "arm.R": ((-0.17, 0, 1.40), (-0.25, 0.01, 1.13)), "hand.R": ((-0.25, 0.01, 1.13), (-0.27, -0.04, 0.86)),
    "leg.R": ((-0.09, 0, 0.92), (-0.10, 0, 0.50)), "foot.R": ((-0.10, 0, 0.50), (-0.10, 0.02, 0.09)),
}
PARENT = {"spine": "pelvis", "chest": "spine", "neck": "chest", "head": "neck"}
for side in "LR":
    PARENT |= {f"arm.{side}": "chest", f"hand.{side}": f"arm.{side}", f"leg.{side}": "pelvis",
               f"foot.{side}": f"leg.{side}"}
SHAPES = [((-0.08, 0, 0.97), (0.08, 0, 0.97), 0.12, 0.12), ((-0.05, 0, 1.10), (0.05, 0, 1.10), 0.11, 0.11),
          ((-0.08, 0, 1.28), (0.08, 0, 1.28), 0.11, 0.11), ((-0.15, 0, 1.39), (0.15, 0, 1.39), 0.065, 0.065),
          ((0, 0.01, 1.38), (0, 0.01, 1.56), 0.058, 0.055), ((0, 0.01, 1.64), (0, 0.02, 1.67), 0.095, 0.095),
          ((0, -0.03, 1.58), (0, -0.03, 1.60), 0.065, 0.065)]
for x in (-1, 1):
    SHAPES += [((0.18 * x, 0, 1.39), (0.25 * x, 0.01, 1.13), 0.055, 0.045),
               ((0.25 * x, 0.01, 1.13), (0.27 * x, -0.04, 0.84), 0.042, 0.035),
               ((0.09 * x, 0, 0.92), (0.10 * x, 0, 0.50), 0.09, 0.06),
               ((0.10 * x, 0, 0.50), (0.10 * x, 0.02, 0.06), 0.06, 0.045)]


def y_up(points):
    """(point, 3), z up, as Blender's exporters turn them."""
    p = np.asarray(points, dtype=np.float64)
    return np.stack([p[:, 0], p[:, 2], -p[:, 1]], axis=1)


def body_mesh():
    """One closed skin around all shapes: capsules, joined by voxels and smoothed."""
    import bmesh
    shapes = bmesh.new()
    for a, b, ra, rb in SHAPES:
        a, b = Vector(a), Vector(b)
        turn = (b - a).to_track_quat("Z", "Y").to_matrix().to_4x4()
        bmesh.ops.create_cone(shapes, cap_ends=True, segments=24, radius1=ra, radius2=rb, depth=(b - a).length,
                              matrix=Matrix.Translation((a + b) / 2) @ turn)
        for centre, radius in ((a, ra), (b, rb)):
            bmesh.ops.create_uvsphere(shapes, u_segments=24, v_segments=16, radius=radius,
                                      matrix=Matrix.Translation(centre))
    mesh = bpy.data.meshes.new("shapes")
    shapes.to_mesh(mesh)
    thing = bpy.data.objects.new("shapes", mesh)
    bpy.context.scene.collection.objects.link(thing)
    remesh = thing.modifiers.new("remesh", "REMESH")
    remesh.mode, remesh.voxel_size = "VOXEL", 0.012
    smooth = thing.modifiers.new("smooth", "SMOOTH")
    smooth.iterations = 8
    skin = bpy.data.meshes.new_from_object(thing.evaluated_get(bpy.context.evaluated_depsgraph_get()))
    bpy.data.objects.remove(thing)
    skin.name = "skin"
    return skin


def bind(body, rig):
    """Weights of the skin by its distance from each bone."""
    points = np.array([v.co for v in body.data.vertices])
    near = {}
    for name, (a, b) in JOINTS.items():
        a, b = np.array(a), np.array(b)
        along = np.clip((points - a) @ (b - a) / ((b - a) @ (b - a)), 0, 1)
        near[name] = np.linalg.norm(points - (a + along[:, None] * (b - a)), axis=1)
    weights = {name: (distance + 0.03) ** -6.0 for name, distance in near.items()}
    total = sum(weights.values())
    for name in JOINTS:
        group = body.vertex_groups.new(name=name)
        for v, weight in enumerate(weights[name] / total):
            if weight > 1e-4:
                group.add([v], float(weight), "REPLACE")
    body.modifiers.new("armature", "ARMATURE").object = rig


def make_rig():
    rig = bpy.data.objects.new("rig", bpy.data.armatures.new("rig"))
    bpy.context.scene.collection.objects.link(rig)
    bpy.context.view_layer.objects.active = rig
    bpy.ops.object.mode_set(mode="EDIT")
    for name, (a, b) in JOINTS.items():
        bone = rig.data.edit_bones.new(name)
        bone.head, bone.tail = a, b
    for child, parent in PARENT.items():
        rig.data.edit_bones[child].parent = rig.data.edit_bones[parent]
    bpy.ops.object.mode_set(mode="POSE")
    for bone in rig.pose.bones:
        bone.rotation_mode = "QUATERNION"
    return rig


def animate(rig, way):
    """Frame f of the scene is frame f + 1 of Blender. The whole stands under `way`, an empty that is moved."""
    def turn(name, frame, *turns):
        bone, whole = rig.pose.bones[name], Quaternion()
        own = bone.bone.matrix_local.to_quaternion()
        for axis, angle in turns:
            whole = Quaternion(axis, angle) @ whole
        bone.rotation_quaternion = own.inverted() @ whole @ own
        bone.keyframe_insert("rotation_quaternion", frame=frame)
    x, y, z = Vector((1, 0, 0)), Vector((0, 1, 0)), Vector((0, 0, 1))
    for f in range(FRAMES):
        t, frame, after = f / 24, f + 1, f >= CUT
        step = 2 * math.pi * t / 1.1
        way.location = (6 - 1.2 * (t - CUT / 24) if after else 0, 9 if after else -1.2 * t, 0.02 * math.cos(2 * step))
        way.rotation_euler = (0, 0, -math.pi / 2 if after else 0)
        way.keyframe_insert("location", frame=frame), way.keyframe_insert("rotation_euler", frame=frame)
        for side, sign in (("L", 1), ("R", -1)):
            turn(f"leg.{side}", frame, (x, 0.45 * sign * math.sin(step)))
            turn(f"foot.{side}", frame, (x, 0.35 * (1 - sign * math.cos(step))))
            turn(f"arm.{side}", frame, (x, -0.4 * sign * math.sin(step)))
            turn(f"hand.{side}", frame, (x, -0.3))
        turn("spine", frame, (z, 0.08 * math.sin(step)), (x, 0.04))
        turn("neck", frame, (z, 0.3 * math.sin(2.6 * t)), (x, 0.1 * math.sin(2 * step)))
        turn("head", frame, (z, 0.6 * math.sin(2.6 * t)), (x, 0.2 * math.sin(1.7 * t)),
             (y, 0.12 * math.sin(3 * t)))
        chest = rig.pose.bones["chest"]
        chest.scale = Vector((1, 1, 1)) * (1 + 0.015 * math.sin(2 * math.pi * t / 3))
        chest.keyframe_insert("scale", frame=frame)
    # A cut has nothing between its frames.
    for thing in (rig, way):
        for curve in curves_of(thing):
            for key in curve.keyframe_points:
                key.interpolation = "CONSTANT"


def curves_of(thing):
    return [c for layer in thing.animation_data.action.layers for strip in layer.strips for bag in strip.channelbags
            for c in bag.fcurves]


def triangles_of(mesh):
    mesh.calc_loop_triangles()
    return np.array([t.vertices for t in mesh.loop_triangles])


def tree_of(points, triangles):
    return BVHTree.FromPolygons([Vector(p) for p in points], triangles.tolist())


def groom(points, triangles):
    """Roots as (triangle, barycentric), and strands that leave the scalp, fall, and lie on the skin."""
    rng = random.Random(7)
    tree = tree_of(points, triangles)
    a, b, c = (points[triangles[:, k]] for k in range(3))
    area = np.linalg.norm(np.cross(b - a, c - a), axis=1)
    way = (a + b + c) / 3 - np.array([0, 1.655, -0.015])           # from the middle of the skull
    way /= np.maximum(np.linalg.norm(way, axis=1, keepdims=True), 1e-9)
    hairy = ((a + b + c)[:, 1] / 3 > 1.58) & (way[:, 1] > -0.35) & ~((way[:, 2] > 0.35) & (way[:, 1] < 0.55))
    chosen = rng.choices(range(len(triangles)), weights=(area * hairy).tolist(), k=STRANDS)
    roots, strands = [], []
    for t in chosen:
        u, v = sorted((rng.random(), rng.random()))
        weight = np.array([u, v - u, 1 - v])
        x = Vector(weight @ points[triangles[t]])
        out = Vector(np.cross(b[t] - a[t], c[t] - a[t])).normalized()
        strand, direction, step = [x.copy()], out.copy(), LENGTH / (POINTS - 1)
        side = out.cross(Vector((0, 1, 0))).normalized()
        for i in range(1, POINTS):
            direction = (direction + 0.22 * Vector((0, -1, 0))).normalized()
            wave = 0.35 * math.sin(2 * math.pi * i * step / 0.06) * min(1, i / 8)
            x = x + step * (direction + wave * side).normalized()
            near, normal, _, distance = tree.find_nearest(x)
            inside = (x - near).dot(normal) < 0
            if i > 1 and (inside or distance < 0.006):
                x = near + 0.006 * normal
                direction = (x - strand[-1]).normalized()
            strand.append(strand[-1] + step * (x - strand[-1]).normalized())
            x = strand[-1]
        roots.append((t, weight))
        strands.append(strand)
    return roots, strands


def make(folder):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = 24
    scene.frame_start, scene.frame_end = 1, FRAMES
    body = bpy.data.objects.new("body", body_mesh())
    way = bpy.data.objects.new("way", None)
    for thing in (body, way):
        scene.collection.objects.link(thing)
    rest, triangles = y_up([v.co for v in body.data.vertices]), triangles_of(body.data)
    rig = make_rig()
    bind(body, rig)
    rig.parent = body.parent = way
    animate(rig, way)
    bpy.ops.object.mode_set(mode="OBJECT")
    for thing in bpy.data.objects:
        thing.select_set(thing is body)
    bpy.ops.wm.alembic_export(filepath=f"{folder}/body.abc", start=1, end=FRAMES, selected=True, uvs=False,
                              normals=False, vcolors=False, as_background_job=False)
    with open(f"{folder}/rest.obj", "w") as file:
        file.writelines("v %.7f %.7f %.7f\n" % tuple(p) for p in rest)
        file.writelines("f %s\n" % " ".join(str(v + 1) for v in face.vertices) for face in body.data.polygons)
    positions = []
    for frame in range(1, FRAMES + 1):
        scene.frame_set(frame)
        seen = body.evaluated_get(bpy.context.evaluated_depsgraph_get())
        mesh = seen.to_mesh()
        positions.append(y_up([seen.matrix_world @ v.co for v in mesh.vertices]))
    roots, strands = groom(rest, triangles)
    np.savez(f"{folder}/body.npz", rest=rest, triangles=triangles, positions=np.array(positions),
             root_triangle=[t for t, _ in roots], root_weight=[w for _, w in roots],
             strands=[[list(x) for x in s] for s in strands])

    bpy.ops.wm.read_factory_settings(use_empty=True)
    curves = bpy.data.hair_curves.new("hair")
    curves.add_curves([POINTS] * STRANDS)
    curves.set_types(type="POLY")
    flat = [x for strand in strands for x in strand]
    for point, x in zip(curves.points, flat):
        point.position, point.radius = (x[0], -x[2], x[1]), 4e-5
    hair = bpy.data.objects.new("hair", curves)
    bpy.context.scene.collection.objects.link(hair)
    bpy.ops.wm.alembic_export(filepath=f"{folder}/groom.abc", start=1, end=1, as_background_job=False)
    with open(f"{folder}/scene.toml", "w") as file:
        file.write(f"""title = "A character that walks, and a cut"
frames = {FRAMES}
fps = 24
[groom]
file = "groom.abc"
units = "m"
particles = {POINTS}
scalp = "body"
[motion]
preroll = 0.5
cuts = [{CUT}]
[integrator]
settle = 0.5
[stretch]
[bend]
[core]
[stiffness]
[wetness]
level = 0.3
[curl]
[cohesion]
[[solid]]
name = "body"
shape = "mesh"
file = "body.abc"
rest = "rest.obj"
units = "m"
""")


class Checks:
    def __init__(self):
        self.failures = 0

    def __call__(self, ok, what):
        print("ok:" if ok else "FAILED:", what)
        self.failures += not ok


def hair_frames(path):
    """(frame, strand, point, 3), y up, as Blender reads them."""
    bpy.ops.wm.read_factory_settings(use_empty=True)
    bpy.context.scene.render.fps = 24
    bpy.ops.wm.alembic_import(filepath=path, as_background_job=False, set_frame_range=True)
    hair = next(o for o in bpy.data.objects if o.type == "CURVES")
    out = []
    for frame in range(1, FRAMES + 1):
        bpy.context.scene.frame_set(frame)
        data = hair.evaluated_get(bpy.context.evaluated_depsgraph_get()).data
        flat = np.empty(3 * len(data.points), dtype=np.float32)
        data.attributes["position"].data.foreach_get("vector", flat)
        out.append(y_up(flat.reshape(-1, 3)).reshape(len(data.curves), -1, 3))
    return np.array(out)


def deepest(tree, points):
    """[m] below the surface, by rays that leave through it an odd number of times."""
    most = 0.0
    for x in points:
        near, normal, _, distance = tree.find_nearest(x, 0.05)
        if near is None or distance <= most or (Vector(x) - near).dot(normal) > 0:
            continue
        crossings, start, way = 0, Vector(x), Vector((0.37, 0.81, 0.45)).normalized()
        while (hit := tree.ray_cast(start, way))[0] is not None:
            crossings, start = crossings + 1, hit[0] + 1e-6 * way
        if crossings % 2:
            most = distance
    return most


def rigid_frame(rest, now):
    """(rotation, shift) of the rigid motion nearest to rest -> now (Kabsch 1976)."""
    a, b = rest - rest.mean(0), now - now.mean(0)
    u, _, vt = np.linalg.svd(a.T @ b)
    turn = vt.T @ np.diag([1, 1, np.sign(np.linalg.det(vt.T @ u.T))]) @ u.T
    return turn, now.mean(0) - turn @ rest.mean(0)


def check(folder):
    check = Checks()
    body = np.load(f"{folder}/body.npz")
    hair = hair_frames(f"{folder}/hair.abc")
    check(hair.shape == (FRAMES, STRANDS, POINTS, 3), f"frames, strands and points of the export: {hair.shape}")
    positions, triangles = body["positions"], body["triangles"]
    skin = np.einsum("sk,fskx->fsx", body["root_weight"], positions[:, triangles[body["root_triangle"]]])
    moved = np.linalg.norm(skin[1:] - skin[:-1], axis=2).max(1)
    check(np.delete(moved, CUT - 1).max() > 0.03 and moved[CUT - 1] > 5, "the character walks, and the shot cuts")
    away = 1000 * np.linalg.norm(hair[:, :, 0] - skin, axis=2).max()
    check(away < 0.1, f"roots are at most {away:.4f} mm from their place on the skin")

    deep = [1000 * deepest(tree_of(positions[f], triangles), hair[f, :, 2:].reshape(-1, 3)) for f in range(FRAMES)]
    check(max(deep) <= 2, f"hair is at most {max(deep):.2f} mm in the body, at frame {np.argmax(deep)}")
    drawn = np.linalg.norm(np.diff(body["strands"], axis=1), axis=2)
    edges = np.linalg.norm(np.diff(hair, axis=2), axis=3) / drawn.mean(1)[None, :, None]
    check(edges.max() <= 1.1, f"edges are at most {edges.max():.3f} times as long as drawn, at frame "
          f"{np.unravel_index(edges.argmax(), edges.shape)[0]}")

    head = body["rest"][:, 1] > 1.6
    tips = []
    for f in range(FRAMES):
        turn, shift = rigid_frame(body["rest"][head], positions[f][head])
        tips.append((hair[f, :, -1] - shift) @ turn)
    spread = [np.linalg.norm((t - t.mean(0))[:, [0, 2]], axis=1).mean() for t in tips]
    check(spread[CUT] < 1.15 * max(spread[:CUT]) and max(spread[CUT:]) < 1.3 * max(spread[:CUT]),
          f"no fan at the cut: tips are {1000 * spread[CUT - 1]:.0f} mm around their middle before it, "
          f"{1000 * spread[CUT]:.0f} after it, at most {1000 * max(spread[CUT:]):.0f} later")
    jump = np.linalg.norm(tips[CUT] - tips[CUT - 1], axis=1)
    # From hair that swings to hair that hangs still; a fan went metres.
    check(np.median(jump) < 0.1 and jump.max() < LENGTH,
          f"at the cut tips go {1000 * np.median(jump):.0f} mm past the head in the median, {1000 * jump.max():.0f} at most")
    later = np.linalg.norm(tips[CUT + 1] - tips[CUT], axis=1).max()
    check(later < 0.1, f"in the frame after it at most {1000 * later:.0f} mm")
    sys.exit(check.failures > 0)


if __name__ == "__main__":
    {"make": make, "check": check}[sys.argv[1]](sys.argv[2])
