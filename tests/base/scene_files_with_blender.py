"""Blender, as a Python module, imports the file of scene_file_tool, and scene_file_tool reads what Blender exports.

    scene_files_with_blender.py SCENE_FILE_TOOL FOLDER

Alembic and USD text. Blender has z up and metres, its importers and exporters turn and scale what files say.
"""
import bpy

from scene_files import check, finish, folder, near, read, run


def y_up(point):
    """Of z up."""
    x, y, z = point
    return [x, z, -y]


def evaluated(thing):
    return thing.evaluated_get(bpy.context.evaluated_depsgraph_get())


def curve_points(thing):
    return [y_up(thing.matrix_world @ p.position) for p in evaluated(thing).data.points]


def mesh_points(thing):
    return [y_up(thing.matrix_world @ v.co) for v in evaluated(thing).to_mesh().vertices]


def scaled(points, factor):
    return [[factor * x for x in point] for point in points]


def blender_imports(ending, importer, unit):
    """unit: what Blender makes of 1 in the file, which says that it is 0.01 m where its format can."""
    path = f"{folder}/ours.{ending}"
    run("write", path)
    ours = read(path)
    strands, mesh = ours["curves"][0], ours["meshes"][0]
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = 25
    importer(filepath=path, set_frame_range=True)
    hair = [o for o in bpy.data.objects if o.type == "CURVES"]
    heads = [o for o in bpy.data.objects if o.type == "MESH"]
    check(len(hair) == 1 and len(heads) == 1 and len(bpy.data.objects) == 2, f"{ending}: one object of strands and one mesh")
    hair, head = hair[0], heads[0]
    check((scene.frame_start, scene.frame_end) == (3, 7), f"{ending}: the range of frames")
    for sample in (0, 2, 4):
        scene.frame_set(3 + sample)
        data = evaluated(hair).data
        check([c.points_length for c in data.curves] == strands["counts"], f"{ending}: points of strands, frame {3 + sample}")
        check(near(curve_points(hair), scaled(strands["samples"][sample], unit)), f"{ending}: positions, frame {3 + sample}")
        check(near([[p.radius] for p in data.points], [[w / 2] for w in strands["widths"]], 1e-7),
              f"{ending}: radius is half the width, frame {3 + sample}")
        kinds = {a.value for a in data.attributes["curve_type"].data} if "curve_type" in data.attributes else {None}
        check(kinds == {1}, f"{ending}: curves are lines (type 1 in Blender), frame {3 + sample}: {kinds}")
        check(near(mesh_points(head), scaled(mesh["samples"][sample], unit)),
              f"{ending}: positions of the mesh, frame {3 + sample}")
    faces, first = [], 0
    for count in mesh["counts"]:
        faces.append(mesh["corners"][first:first + count])
        first += count

    def turned(face):
        least = face.index(min(face))
        return tuple(face[least:] + face[:least])
    found = [turned(list(p.vertices)) for p in evaluated(head).to_mesh().polygons]
    check(found == [turned(f) for f in faces], f"{ending}: faces of the mesh, counterclockwise from outside")
    check(all(p.normal.dot(p.center) > 0 for p in evaluated(head).to_mesh().polygons if len(p.vertices) == 3),
          f"{ending}: normals point outwards")


def blender_exports(ending, exporter, kinds):
    bpy.ops.wm.read_factory_settings(use_empty=True)
    scene = bpy.context.scene
    scene.render.fps = 24

    def add(name, data, parent=None):
        thing = bpy.data.objects.new(name, data)
        scene.collection.objects.link(thing)
        thing.parent = parent
        return thing

    above = add("above", None)
    for frame, angle in ((1, 0.0), (5, 1.0)):
        above.rotation_euler = (angle, 0.5 * angle, 0)
        above.location = (0, 0, angle)
        above.keyframe_insert("rotation_euler", frame=frame)
        above.keyframe_insert("location", frame=frame)
    curves = bpy.data.hair_curves.new("hair")
    curves.add_curves([4, 5, 6])
    for k, point in enumerate(curves.points):
        point.position = (0.1 * k, 0.01 * k * k, -0.5 * k)
        point.radius = 0.01 * (k + 1)
    hair = add("hair", curves, above)
    mesh = bpy.data.meshes.new("head")
    mesh.from_pydata([(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0.5, 0.5, 1)], [],
                     [(3, 2, 1, 0), (0, 1, 4), (1, 2, 4), (2, 3, 4), (3, 0, 4)])
    head = add("head", mesh, above)
    head.shape_key_add(name="rest")
    lifted = head.shape_key_add(name="lifted")
    lifted.data[4].co = (0.5, 0.5, 3)
    for frame, value in ((1, 0.0), (5, 1.0)):
        lifted.value = value
        lifted.keyframe_insert("value", frame=frame)

    # Catmull-Rom curves of Blender go through all of their points, and so are read as the lines between them.
    for kind in kinds:
        curves.set_types(type=kind)
        path = f"{folder}/{kind}.{ending}"
        exporter(path)
        what = f"of Blender's {kind}.{ending}"
        theirs = read(path)
        check(len(theirs["curves"]) == 1 and len(theirs["meshes"]) == 1, f"objects {what}")
        strands, body = theirs["curves"][0], theirs["meshes"][0]
        check(strands["counts"] == [4, 5, 6] and strands["basis"] == "linear", f"strands {what}")
        check(near([[w] for w in strands["widths"]], [[0.02 * (k + 1)] for k in range(15)], 1e-6),
              f"widths are twice the radius {what}")
        for thing in (strands, body):
            check(near([[t] for t in thing["times"]], [[f / 24] for f in range(1, 6)], 1e-9),
                  f"times {what}, {thing['path']}")
        for sample in (0, 2, 4):
            scene.frame_set(1 + sample)
            check(near(strands["samples"][sample], curve_points(hair)), f"positions of strands {what}, {1 + sample}")
            check(near(body["samples"][sample], mesh_points(head)), f"positions of the mesh {what}, {1 + sample}")
        check(body["counts"] == [4, 3, 3, 3, 3] and not near(body["samples"][0], body["samples"][4], 0.5),
              f"the mesh moves {what}")
        corners = [tuple(p.vertices) for p in mesh.polygons]
        check(body["corners"] == [c for face in corners for c in face], f"corners of the mesh {what}")


print("Blender", bpy.app.version_string)
blender_imports("abc", lambda **options: bpy.ops.wm.alembic_import(as_background_job=False, **options), 1)
blender_imports("usda", bpy.ops.wm.usd_import, 0.01)
blender_exports("abc", lambda path: bpy.ops.wm.alembic_export(filepath=path, start=1, end=5, as_background_job=False),
                ("POLY", "CATMULL_ROM"))
blender_exports("usda", lambda path: bpy.ops.wm.usd_export(filepath=path, export_animation=True, export_shapekeys=False,
                                                           convert_orientation=True), ("POLY",))
finish()
