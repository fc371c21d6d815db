"""USD text of scene_file_tool beside usd-core and tinyusdz.

    usda_with_others.py SCENE_FILE_TOOL FOLDER
"""
import json
import math
import os
import random

import tinyusdz
from pxr import Gf, Sdf, Usd, UsdGeom, Vt

from scene_files import check, finish, folder, read, run


def agree(a, b, tolerance, what):
    """Numbers, nested alike, to a tolerance that is relative above 1."""
    flat_a, flat_b = flat(a), flat(b)
    if len(flat_a) != len(flat_b):
        return check(False, f"{what}: {len(flat_a)} numbers, expected {len(flat_b)}")
    if not flat_a:
        return None
    worst = max(abs(x - y) / max(1, abs(y)) for x, y in zip(flat_a, flat_b))
    return check(worst <= tolerance, f"{what}: off by {worst:.3g}, allowed {tolerance}")


def flat(x):
    try:
        return [n for part in x for n in flat(part)]
    except TypeError:
        return [float(x)]


def path_of(name):
    return os.path.join(folder, name)


# ---- what we write, as usd-core reads it

counts = [5, 3, 8]
frames = range(1001, 1005)


def strand_points(frame):
    f = frame - 1001
    return [(0.01 * s + 0.001 * f, 0.2 - 0.01 * i, 0.003 * math.sin(i + 0.1 * f))
            for s, n in enumerate(counts) for i in range(n)]


def check_ours(up, metres):
    name = path_of(f"ours_{up}.usda")
    done = run("strands", name, up, str(metres))
    check(done.returncode == 0, f"write: {done.stderr}")
    stage = Usd.Stage.Open(name)
    check(stage is not None, "usd-core opens it")
    check(UsdGeom.GetStageUpAxis(stage) == up.upper(), "upAxis")
    check(stage.HasAuthoredMetadata("upAxis") and stage.HasAuthoredMetadata("metersPerUnit"), "said, not a fallback")
    check(UsdGeom.GetStageMetersPerUnit(stage) == metres, "metersPerUnit")
    check((stage.GetStartTimeCode(), stage.GetEndTimeCode()) == (1001, 1004), "start and end")
    check(stage.GetTimeCodesPerSecond() == 25 and stage.GetFramesPerSecond() == 25, "codes a second")
    check(stage.GetDefaultPrim().GetPath() == "/hair", "default prim")

    curves = UsdGeom.BasisCurves.Get(stage, "/hair/strands")
    check(curves.GetTypeAttr().Get() == "linear" and curves.GetWrapAttr().Get() == "nonperiodic", "type and wrap")
    check(list(curves.GetCurveVertexCountsAttr().Get()) == counts, "counts")
    check(curves.GetPointsAttr().GetTimeSamples() == list(frames), "times of points")
    for frame in frames:
        agree(curves.GetPointsAttr().Get(frame), strand_points(frame), 1e-6, f"points at {frame}")
        agree(curves.GetVelocitiesAttr().Get(frame), [(0.025, 0, frame - 1001)] * 16, 1e-6, f"velocities at {frame}")
        # Curves are as wide as their widest point wherever they are.
        found, computed = curves.GetExtentAttr().Get(frame), UsdGeom.Boundable.ComputeExtentFromPlugins(curves, frame)
        agree(found, computed, 1e-6, f"extent at {frame}")
    widths = [1e-4 - 1e-5 * i for n in counts for i in range(n)]
    agree(curves.GetWidthsAttr().Get(), widths, 1e-9, "widths")
    check(curves.GetWidthsInterpolation() == "vertex", "interpolation of widths")
    api = UsdGeom.PrimvarsAPI(curves)
    for primvar, interpolation, value in (("groom_id", "uniform", [100, 101, 102]),
                                          ("groom_root_uv", "uniform", [(0, 0.5), (0.25, 0.5), (0.5, 0.5)]),
                                          ("wetness", "vertex", [0.25] * 16)):
        found = api.GetPrimvar(primvar)
        check(found.GetInterpolation() == interpolation, f"interpolation of {primvar}")
        agree(found.Get(1003), value, 0, primvar)

    still, moving = (UsdGeom.Mesh.Get(stage, f"/head/{which}") for which in ("scalp", "jaw"))
    corners = [(k, k * k, 0.5) for k in range(5)]
    check(not still.GetPointsAttr().ValueMightBeTimeVarying(), "what does not move has one value")
    agree(still.GetPointsAttr().Get(), corners, 0, "points of the still mesh")
    agree(moving.GetPointsAttr().Get(1003), [(x, y, z + 2) for x, y, z in corners], 0, "points of the moving mesh")
    check(list(moving.GetFaceVertexIndicesAttr().Get()) == [0, 1, 2, 3, 0, 1, 4], "corners")
    check(moving.GetSubdivisionSchemeAttr().Get() == "none", "no subdivision")
    check(UsdGeom.Mesh.ValidateTopology(moving.GetFaceVertexIndicesAttr().Get(), moving.GetFaceVertexCountsAttr().Get(),
                                        5)[0], "topology")
    validate(stage)

    # To the bit: what usd-core would write from this stage is the same scene for us.
    again = path_of("again.usda")
    stage.Export(again)
    ours, theirs = (read(n) for n in (name, again))
    check(ours == theirs, "usd-core writes what it read, and it reads back to the bit")


def validate(stage):
    try:
        from pxr import UsdValidation
    except ImportError:
        return print("UsdValidation is not in this usd-core")
    names = [v.GetMetadata().name for v in UsdValidation.ValidationRegistry().GetOrLoadAllValidators()]
    chosen = UsdValidation.ValidationRegistry().GetOrLoadValidatorsByName(names)
    errors = UsdValidation.ValidationContext(chosen).Validate(stage)
    for error in errors:
        check(False, f"validation: {error.GetMessage()}")
    return print(f"validated by {len(chosen)} validators, {len(errors)} errors")


def check_tinyusdz():
    ours, theirs = path_of("ours_y.usda"), path_of("tinyusdz.usda")
    stage = tinyusdz.load(ours)
    for path, kind in (("/hair/strands", "BasisCurves"), ("/head/scalp", "Mesh"), ("/head/jaw", "Mesh")):
        found = stage.get_prim_at_path(path)
        check(found is not None and found.type_name == kind, f"tinyusdz finds {path}, {kind}")
    text = stage.export_to_string()
    check("primvars:wetness.timeSamples" in text and "velocities.timeSamples" in text, "tinyusdz keeps all samples")
    with open(theirs, "w") as out:
        out.write(text)
    check(read(ours) == read(theirs),
          "tinyusdz writes what it read, and it reads back to the bit")


# ---- what usd-core writes, as we read it

choice = random.Random(7)


def number(size=2):
    return choice.uniform(-size, size)


def vector(size=2):
    return Gf.Vec3d(number(size), number(size), number(size))


def rotation():
    return Gf.Rotation(Gf.Vec3d(number(), number(), 1), number(180))


def add_ops(xform):
    """Up to four transforms of any kind, some moving, some with pivots that are taken back."""
    orders = ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"]
    for k in range(choice.randrange(5)):
        name, kind = f"n{k}", choice.choice(["translate", "scale", "rotate", "axis", "orient", "matrix"])
        precision = choice.choice([UsdGeom.XformOp.PrecisionFloat, UsdGeom.XformOp.PrecisionDouble])
        to_vector = Gf.Vec3f if precision == UsdGeom.XformOp.PrecisionFloat else Gf.Vec3d
        if kind == "translate":
            op, make = xform.AddTranslateOp(precision, name), lambda: to_vector(vector())
        elif kind == "scale":
            op, make = xform.AddScaleOp(precision, name), lambda: to_vector(vector(0.5)) + to_vector(1)
        elif kind == "rotate":
            add = getattr(xform, f"AddRotate{choice.choice(orders)}Op")
            op, make = add(precision, name), lambda: to_vector(vector(180))
        elif kind == "axis":
            op, make = getattr(xform, f"AddRotate{choice.choice('XYZ')}Op")(precision, name), lambda: number(180)
        elif kind == "orient":
            quat = Gf.Quatf if precision == UsdGeom.XformOp.PrecisionFloat else Gf.Quatd
            op, make = xform.AddOrientOp(precision, name), lambda: quat(rotation().GetQuat())
        else:
            op = xform.AddTransformOp(UsdGeom.XformOp.PrecisionDouble, name)
            make = lambda: Gf.Matrix4d(rotation(), vector())
        if choice.random() < 0.4:
            for time in choice.sample(range(1, 12), 3):
                op.Set(make(), time)
        else:
            op.Set(make())
        if choice.random() < 0.3 and kind != "matrix":
            order = xform.GetOrderedXformOps()
            inverse = UsdGeom.XformOp(op.GetAttr(), True)
            xform.SetXformOpOrder(order + [inverse] if choice.random() < 0.5 else [inverse] + order[:-1])
    if choice.random() < 0.15:
        xform.SetResetXformStack(True)


def points_in_world(gprim, time):
    world = UsdGeom.XformCache(time).GetLocalToWorldTransform(gprim.GetPrim())
    return [world.Transform(Gf.Vec3d(p)) for p in gprim.GetPointsAttr().Get(time)]


def add_points(gprim, count):
    points = lambda: Vt.Vec3fArray([Gf.Vec3f(vector(5)) for _ in range(count)])
    kind = choice.randrange(3)
    if kind != 1:
        gprim.GetPointsAttr().Set(points())
    if kind != 0:
        for time in choice.sample([1, 2, 3.5, 7, 10], 2):
            gprim.GetPointsAttr().Set(points(), time)


def check_theirs(number_of_file):
    name = path_of("theirs.usda")
    stage = Usd.Stage.CreateNew(name)
    codes_a_second = choice.choice([24, 30, 12.5])
    stage.SetTimeCodesPerSecond(codes_a_second)
    UsdGeom.SetStageUpAxis(stage, choice.choice("YZ"))
    UsdGeom.SetStageMetersPerUnit(stage, choice.choice([0.01, 1, 0.0254]))
    path, gprims = "", []
    for depth in range(3):
        path += f"/x{depth}"
        add_ops(UsdGeom.Xform.Define(stage, path))
        mesh = UsdGeom.Mesh.Define(stage, f"{path}/mesh")
        mesh.GetFaceVertexCountsAttr().Set([3, 4])
        mesh.GetFaceVertexIndicesAttr().Set([0, 1, 2, 0, 2, 3, 4])
        add_points(mesh, 5)
        add_ops(mesh)
        gprims.append(mesh)
        curves = UsdGeom.BasisCurves.Define(stage, f"{path}/curves")
        curves.GetTypeAttr().Set(choice.choice(["linear", "cubic"]))
        curves.GetBasisAttr().Set(choice.choice(["bezier", "bspline", "catmullRom"]))
        curves.GetCurveVertexCountsAttr().Set([4, 7])
        add_points(curves, 11)
        curves.GetWidthsAttr().Set([0.5, 0.25])
        curves.SetWidthsInterpolation("uniform")
        add_ops(curves)
        gprims.append(curves)
        Sdf.CreatePrimInLayer(stage.GetRootLayer(), f"{path}/over").specifier = Sdf.SpecifierOver
    stage.GetRootLayer().Save()
    done = run("print", name)
    check(done.returncode == 0, f"file {number_of_file} is read: {done.stderr}")
    if done.returncode:
        return
    found = json.loads(done.stdout)
    check(found["up"] == UsdGeom.GetStageUpAxis(stage).lower(), "up")
    check(found["metres_per_unit"] == UsdGeom.GetStageMetersPerUnit(stage), "metres a unit")
    objects = {o["path"]: o for o in found["meshes"] + found["curves"]}
    check(len(objects) == len(gprims), "all objects are found")
    for gprim in gprims:
        ours = objects[str(gprim.GetPath())]
        for seconds, points in zip(ours["times"], ours["samples"]):
            static = ours["times"] == [0]
            time = Usd.TimeCode.Default() if static else round(seconds * codes_a_second, 6)
            agree(points, points_in_world(gprim, time), 2e-5, f"file {number_of_file}, {gprim.GetPath()} at {time}")
        if "widths" in ours:
            agree(ours["widths"], [0.5] * 4 + [0.25] * 7, 0, "uniform widths")


def check_pinned_and_primvars():
    name = path_of("pinned.usda")
    stage = Usd.Stage.CreateNew(name)
    curves = UsdGeom.BasisCurves.Define(stage, "/c")
    curves.GetBasisAttr().Set("catmullRom")
    curves.GetWrapAttr().Set("pinned")
    curves.GetCurveVertexCountsAttr().Set([2, 3])
    curves.GetPointsAttr().Set([(0, 0, 0), (1, 0, 0), (0, 1, 0), (1, 1, 0), (2, 2, 0)])
    curves.GetWidthsAttr().Set([0.5])
    curves.SetWidthsInterpolation("constant")
    api = UsdGeom.PrimvarsAPI(curves)
    st = api.CreatePrimvar("st", Sdf.ValueTypeNames.TexCoord2fArray, "uniform")
    st.Set([(0.25, 0.5), (0.75, 1)])
    st.SetIndices(Vt.IntArray([1, 0]))
    api.CreatePrimvar("id", Sdf.ValueTypeNames.IntArray, "uniform").Set([8, 9])
    stage.GetRootLayer().Save()
    found = read(name)["curves"][0]
    check(found["counts"] == [4, 5], "pinned curves have two points more")
    agree(found["samples"][0][:4], [(-1, 0, 0), (0, 0, 0), (1, 0, 0), (2, 0, 0)], 1e-6, "of the first")
    check(found["widths"] == [0.5] * 9 and found["ids"] == [8, 9], "widths and ids")
    check(found["root_uv"] == [[0.75, 1], [0.25, 0.5]], "uv of roots")


def check_elsewhere():
    """Binary files, and geometry in other files: an error that says what to run, which then works."""
    theirs = Usd.Stage.Open(path_of("theirs.usda"))
    for ending in ("usdc", "usd"):
        theirs.Export(path_of(f"binary.{ending}"))
        done = run("print", path_of(f"binary.{ending}"))
        check(done.returncode == 1 and "usdcat" in done.stderr, f".{ending}: {done.stderr}")
    referring = Usd.Stage.CreateNew(path_of("referring.usda"))
    referring.DefinePrim("/all").GetReferences().AddReference("./theirs.usda", "/x0")
    referring.GetRootLayer().Save()
    done = run("print", path_of("referring.usda"))
    check(done.returncode == 1 and "usdcat --flatten" in done.stderr, f"references: {done.stderr}")
    referring.Flatten().Export(path_of("flat.usda"))
    done = run("print", path_of("flat.usda"))
    check(done.returncode == 0 and len(json.loads(done.stdout)["meshes"]) == 3, f"flattened: {done.stderr}")


check_ours("y", 1)
check_ours("z", 0.01)
check_tinyusdz()
for k in range(40):
    check_theirs(k)
check_pinned_and_primvars()
check_elsewhere()
print("usd-core", ".".join(map(str, Usd.GetVersion())), "and tinyusdz", tinyusdz.__version__)
finish()
