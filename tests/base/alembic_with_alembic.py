"""Alembic's own library reads the file of scene_file_tool, and scene_file_tool reads files of that library.

    alembic_with_alembic.py SCENE_FILE_TOOL FOLDER
"""
import math
import sys

import imath
from alembic3d.Abc import *
from alembic3d.AbcCoreAbstract import *
from alembic3d.AbcGeom import *

from scene_files import check, finish, folder, near, read, run


def numbers(array):
    return [list(x) if hasattr(x, "__len__") else x for x in array]


def at(sample):
    """Of the frames of scene_file_tool's shot. A number alone would be a time."""
    return ISampleSelector((3 + sample) / 25)


def we_write():
    path = folder + "/ours.abc"
    if run("write", path).returncode:
        sys.exit("scene_file_tool cannot write " + path)
    ours = read(path)
    strands, mesh = ours["curves"][0], ours["meshes"][0]
    frames = len(strands["times"])
    archive = IArchive(path)
    top = archive.getTop()
    check([o.getName() for o in top.children] == ["hair", "body"], "objects stand at their paths")
    hair = IXform(top, "hair")
    check(hair.getSchema().isConstantIdentity(), "the transform above is at rest")

    curves = ICurves(hair, "strands").getSchema()
    sampling = curves.getTimeSampling()
    check(curves.getNumSamples() == frames == 5, "one sample a frame")
    check(near([sampling.getSampleTime(k) for k in range(frames)], strands["times"], 1e-12), "times of samples")
    check(near(strands["times"], [(3 + k) / 25 for k in range(frames)], 1e-12), "times are frames over frames a second")
    check(sampling.getTimeSamplingType().isUniform(), "uniform time sampling")
    check(curves.getTopologyVariance() == MeshTopologyVariance.kHomogenousTopology, "the topology stays")
    for k in (0, 2, 4):
        sample = curves.getValue(at(k))
        points = numbers(sample.getPositions())
        check(near(points, strands["samples"][k]), f"positions of frame {k}")
        check(numbers(sample.getCurvesNumVertices()) == strands["counts"], f"counts of frame {k}")
        check(sample.getType() == CurveType.kLinear and sample.getBasis() == BasisType.kNoBasis
              and sample.getWrap() == CurvePeriodicity.kNonPeriodic, f"linear, of no basis, open: frame {k}")
        bounds = sample.getSelfBounds()
        check(near(list(bounds.min()), [min(p[i] for p in points) for i in range(3)])
              and near(list(bounds.max()), [max(p[i] for p in points) for i in range(3)]), f"bounds of frame {k}")
    velocities = [numbers(curves.getValue(at(k)).getVelocities()) for k in range(frames)]
    # Central differences of x = a sin(3t), 1/25 s apart: wrong by a 27 / 6 / 625 = 0.014 where a is at most 2.1.
    differences = [[(b[i] - a[i]) * 12.5 for i in range(3)]
                   for a, b in zip(strands["samples"][1], strands["samples"][3])]
    check(max(abs(x) for v in velocities[2] for x in v) > 1 and near(velocities[2], differences, 0.03),
          "velocities are a second")
    widths = curves.getWidthsParam()
    check(widths.getScope() == GeometryScope.kVertexScope and widths.isConstant(), "widths are of points, and stay")
    check(near(numbers(widths.getExpandedValue(at(0)).getVals()), strands["widths"]), "widths")

    parameters = curves.getArbGeomParams()
    uniform, vertex = GeometryScope.kUniformScope, GeometryScope.kVertexScope
    for name, kind, scope, expected in (
            ("groom_id", IInt32GeomParam, uniform, strands["ids"]),
            ("groom_group_id", IInt32GeomParam, uniform, strands["groups"]),
            ("groom_guide", IInt32GeomParam, uniform, strands["is_guide"]),
            ("groom_root_uv", IV2fGeomParam, uniform, strands["root_uv"]),
            ("groom_closest_guides", IV3iGeomParam, uniform, strands["guides"]),
            ("groom_guide_weights", IV3fGeomParam, uniform, strands["weights"])):
        parameter = kind(parameters, name)
        check(parameter.getScope() == scope and near(numbers(parameter.getExpandedValue(at(0)).getVals()), expected),
              name)
    wetness = IFloatGeomParam(parameters, "wetness")
    values = [numbers(wetness.getExpandedValue(at(k)).getVals()) for k in range(frames)]
    check(wetness.getScope() == vertex and len(values[4]) == sum(strands["counts"])
          and near(values[4][1], 1 / 8 + 4 / 16), "wetness, a value a point and frame")

    head = IPolyMesh(IXform(top, "body"), "head").getSchema()
    check(head.getNumSamples() == frames, "one sample of the mesh a frame")
    sample = head.getValue(at(3))
    check(near(numbers(sample.getPositions()), mesh["samples"][3]), "positions of the mesh")
    check(numbers(sample.getFaceCounts()) == mesh["counts"], "faces of the mesh")
    corners, first = [], 0
    for count in mesh["counts"]:
        corners += mesh["corners"][first:first + count][::-1]
        first += count
    check(numbers(sample.getFaceIndices()) == corners, "corners of the mesh, clockwise")
    check(archive.getMaxNumSamplesForTimeSamplingIndex(1) == frames, "the number of samples of the time sampling")

    path = folder + "/unreal.abc"
    run("write", path, "unreal")
    properties = IXform(IArchive(path).getTop(), "hair").getSchema().getUserProperties()
    check(IInt16Property(properties, "groom_version_major").getValue(at(0)) == 1, "groom_version_major")
    check(IInt16Property(properties, "groom_version_minor").getValue(at(0)) == 5, "groom_version_minor")
    check(IStringProperty(properties, "groom_tool").getValue(at(0)).startswith("wetcurl"), "groom_tool")


def array(kind, values):
    out = kind(len(values))
    for k, value in enumerate(values):
        out[k] = value
    return out


def vectors(values):
    return array(imath.V3fArray, [imath.V3f(*v) for v in values])


def times_of(cycle, times):
    vector = TimeVector()
    vector[:] = times
    return TimeSampling(TimeSamplingType(len(times), cycle) if cycle else TimeSamplingType(AcyclicFlag.kAcyclic),
                        vector)


def curves_at(parent, name, sampling, samples, counts, kind=CurveType.kLinear, basis=BasisType.kNoBasis, widths=None,
              scope=None):
    """`samples`: points of each, or (points, counts)."""
    out = OCurves(parent, name, Argument(sampling))
    for sample in samples:
        points, now = sample if isinstance(sample, tuple) else (sample, counts)
        # The library keeps no copies: names hold the arrays until the sample is written.
        positions, numbers_of_points = vectors(points), array(imath.IntArray, now)
        values = array(imath.FloatArray, widths or [])
        width = OFloatGeomParamSample(values, scope) if widths else OFloatGeomParamSample()
        written = OCurvesSchemaSample(positions, numbers_of_points, kind, CurvePeriodicity.kNonPeriodic, width,
                                      OV2fGeomParamSample(), ON3fGeomParamSample(), basis)
        out.getSchema().set(written)
    return out


def mesh_at(parent, name, sampling, samples):
    out = OPolyMesh(parent, name, Argument(sampling))
    for points in samples:
        positions, corners, counts = vectors(points), array(imath.IntArray, [0, 1, 2]), array(imath.IntArray, [3])
        sample = OPolyMeshSchemaSample(positions, corners, counts)
        out.getSchema().set(sample)
    return out


def transform_at(parent, name, sampling, samples, inherits=True):
    """`samples`: lists of (operation, values)."""
    out = OXform(parent, name, Argument(sampling))
    matrices = []
    for operations in samples:
        sample = XformSample()
        for kind, values in operations:
            operation = XformOp(getattr(XformOperationType, f"k{kind}Operation"), 0)
            if kind == "Matrix":
                sample.addOp(operation, imath.M44d(*values))
            elif kind == "Rotate":
                sample.addOp(operation, imath.V3d(*values[:3]), values[3])
            elif len(values) == 1:
                sample.addOp(operation, values[0])
            else:
                sample.addOp(operation, imath.V3d(*values))
        sample.setInheritsXforms(inherits)
        out.getSchema().set(sample)
        matrices.append(sample.getMatrix())
    return out, matrices


def placed(points, *matrices):
    """`matrices`: from the innermost outwards."""
    out = []
    for p in points:
        v = imath.V3d(*p)
        for m in matrices:
            v = v * m
        out.append(list(v))
    return out


strand = [(0, 0, 0), (0, -1, 0), (0, -2, 0.5), (0.25, -3, 0.5)]
triangle = [(0, 0, 0), (1, 0, 0), (0, 1, 0)]


def moved(points, by):
    return [(x + by, y, z) for x, y, z in points]


def they_write():
    path = folder + "/theirs.abc"
    archive = OArchive(path)
    top = archive.getTop()
    uneven = archive.addTimeSampling(times_of(0, [0.1, 0.25, 0.9]))
    even = archive.addTimeSampling(TimeSampling(1 / 24, 2 / 24))
    shutter = archive.addTimeSampling(times_of(1 / 24, [0.0, 0.01]))

    samples = [moved(strand, by) for by in (0, 1, 5)]
    curves_at(top, "uneven", uneven, samples, [4], widths=[0.1, 0.2, 0.3, 0.4], scope=GeometryScope.kVertexScope)
    curves_at(top, "shutter", shutter, samples, [2, 2], widths=[0.1, 0.2], scope=GeometryScope.kUniformScope)
    curves_at(top, "cubic", even, samples, [4], CurveType.kCubic, BasisType.kBsplineBasis, widths=[0.5],
              scope=GeometryScope.kConstantScope)
    curves_at(top, "paused", even, [samples[k] for k in (0, 0, 1, 1, 1, 2, 2)], [4])

    turn = [[("Translate", (k, 0, 0)), ("Rotate", (0, 1, 1, 30 * k)), ("Scale", (1, 2, 0.5 + k))] for k in range(3)]
    outer, outer_matrices = transform_at(top, "outer", even, turn)
    still = [[("RotateX", (20,)), ("RotateY", (-40,)), ("RotateZ", (70,)),
              ("Matrix", (1, 0.5, 0, 0, 0, 1, 0, 0, 0.25, 0, 1, 0, 3, 2, 1, 1))]]
    inner, inner_matrices = transform_at(outer, "inner", 0, still)
    mesh_at(inner, "rigid", 0, [triangle])
    mesh_at(inner, "both", even, [moved(triangle, by) for by in (0, 1, 5)])
    free, free_matrices = transform_at(outer, "free", 0, [[("Translate", (0, 7, 0))]], inherits=False)
    curves_at(free, "strands", 0, [strand], [4])
    hidden = mesh_at(top, "hidden", 0, [triangle])
    CreateVisibilityProperty(hidden, 0).setValue(0)
    # What is below a hidden object is hidden, unless it says that it is shown; what appears later is shown.
    group, _ = transform_at(top, "group", 0, [[("Translate", (0, 0, 0))]])
    CreateVisibilityProperty(group, 0).setValue(0)
    curves_at(group, "below", 0, [strand], [4])
    CreateVisibilityProperty(mesh_at(group, "shown", 0, [triangle]), 0).setValue(1)
    later = CreateVisibilityProperty(mesh_at(top, "later", 0, [triangle]), even)
    for value in (0, 0, 1):
        later.setValue(value)
    mirror, _ = transform_at(top, "mirror", 0, [[("Scale", (-1, 1, 1))]])
    mesh_at(mirror, "mesh", 0, [triangle])
    # Samples of a mesh lie between those of the transform above it.
    finer, _ = transform_at(top, "finer", even, [[("Translate", (0, 6 * k, 0))] for k in range(3)])
    mesh_at(finer, "mesh", archive.addTimeSampling(TimeSampling(1 / 48, 2 / 24)), [moved(triangle, k) for k in range(5)])
    del archive, top, outer, inner, free, hidden, mirror, finer, group, later

    theirs = read(path)
    curves = {o["path"]: o for o in theirs["curves"]}
    meshes = {o["path"]: o for o in theirs["meshes"]}
    check(sorted(curves) == ["/cubic", "/group/below", "/outer/free/strands", "/paused", "/shutter", "/uneven"],
          "all curves are read")
    check(sorted(meshes) == ["/finer/mesh", "/group/shown", "/hidden", "/later", "/mirror/mesh", "/outer/inner/both",
                              "/outer/inner/rigid"], "all meshes are read")
    check(sorted(o["path"] for o in theirs["curves"] + theirs["meshes"] if o["hidden"]) == ["/group/below", "/hidden"],
          "what the file hides is marked")
    o = curves["/uneven"]
    check(near(o["times"], [0.1, 0.25, 0.9], 1e-12), "times of an acyclic sampling")
    check(near(o["samples"], samples) and o["basis"] == "linear", "linear curves")
    check(near(o["widths"], [0.1, 0.2, 0.3, 0.4]), "widths of points")
    o = curves["/shutter"]
    check(near(o["times"], [0, 0.01, 1 / 24], 1e-12), "times of a cyclic sampling")
    check(near(o["widths"], [0.1, 0.1, 0.2, 0.2]) and o["counts"] == [2, 2], "widths of strands")
    o = curves["/cubic"]
    check(near(o["samples"], samples) and o["basis"] == "b_spline", "cubic curves")
    check(near(o["times"], [2 / 24, 3 / 24, 4 / 24], 1e-12), "times of a uniform sampling")
    check(near(o["widths"], [0.5] * 4), "one width for all")
    check(near(curves["/paused"]["samples"], [samples[k] for k in (0, 0, 1, 1, 1, 2, 2)]), "samples that repeat")
    o = curves["/outer/free/strands"]
    check(near(o["samples"], [placed(strand, free_matrices[0])] * len(o["samples"])),
          "a transform that does not inherit stands alone")
    o = meshes["/outer/inner/rigid"]
    expected = [placed(triangle, inner_matrices[0], m) for m in outer_matrices]
    check(near(o["times"], [2 / 24, 3 / 24, 4 / 24], 1e-12), "a rigid object moves when its transforms do")
    check(near(o["samples"], expected) and not near(expected[0], expected[1], 0.5), "transforms above a rigid object")
    expected = [placed(moved(triangle, by), inner_matrices[0], m) for by, m in zip((0, 1, 5), outer_matrices)]
    check(near(meshes["/outer/inner/both"]["samples"], expected), "transforms above a mesh that changes")
    check(near(meshes["/hidden"]["samples"], [triangle]), "hidden objects can be read")
    # The library lists corners clockwise.
    check(meshes["/hidden"]["corners"] == [2, 1, 0], "corners are turned round")
    check(meshes["/mirror/mesh"]["corners"] == [0, 1, 2], "but not those that a transform mirrors")
    o = meshes["/finer/mesh"]
    check(near(o["times"], [(4 + k) / 48 for k in range(5)], 1e-12), "times of both")
    check(near(o["samples"], [[(x + k, y + 3 * k, z) for x, y, z in triangle] for k in range(5)]),
          "a transform between its samples")

    for name, samples in (("points", [strand, (strand[:3], [3])]), ("counts", [(strand, [2, 2]), (strand, [1, 3])])):
        path = f"{folder}/{name}.abc"
        archive = OArchive(path)
        sampling = archive.addTimeSampling(TimeSampling(1 / 24, 0))
        curves_at(archive.getTop(), "strands", sampling, samples, [4])
        del archive
        done = run("print", path)
        check(done.returncode == 1 and "/strands" in done.stderr and "topology" in done.stderr,
              f"other {name} in a later sample are refused: {done.stderr.strip()}")


def they_write_many():
    """As programs do that make an object of each strand."""
    path = folder + "/many.abc"
    archive = OArchive(path)
    group, _ = transform_at(archive.getTop(), "group", 0, [[("Translate", (0, 0, 1))]])
    for k in range(300):
        curves_at(group, f"curve{k}", 0, [moved(strand, k)], [4])
    del archive, group
    many = read(path)["curves"]
    check(len(many) == 300, "300 objects of one strand")
    check(all(near(o["samples"][0], [(x + int(o["path"][12:]), y, z + 1) for x, y, z in strand]) for o in many),
          "where they stand")


def they_write_other_numbers():
    """Numbers of types that AbcGeom does not ask for, and values by index."""
    path = folder + "/numbers.abc"
    archive = OArchive(path)
    metadata = MetaData()
    metadata.set("schema", "AbcGeom_Curve_v2")
    said = Argument(metadata)
    thing = OObject(archive.getTop(), "wide", said)
    geometry = OCompoundProperty(thing.getProperties(), ".geom", said)
    points = array(imath.V3dArray, [imath.V3d(*v) for v in strand])
    OP3dArrayProperty(geometry, "P").setValue(points)
    counts = array(imath.ShortArray, [2, 2])
    OInt16ArrayProperty(geometry, "nVertices").setValue(counts)
    linear = array(imath.UnsignedCharArray, [1, 0, 0, 0])
    OUcharArrayProperty(geometry, "curveBasisAndType").setValue(linear)
    parameters = OCompoundProperty(geometry, ".arbGeomParams")
    ids = array(imath.UnsignedCharArray, [7, 200])
    OUcharArrayProperty(parameters, "groom_id").setValue(ids)
    values = array(imath.V2fArray, [imath.V2f(0.25, 0.5), imath.V2f(0.75, 1)])
    indices = array(imath.UnsignedIntArray, [1, 0])
    sample = OV2fGeomParamSample(values, indices, GeometryScope.kUniformScope)
    OV2fGeomParam(parameters, "groom_root_uv", True, GeometryScope.kUniformScope, 1).set(sample)
    del archive, thing, geometry, parameters
    o = read(path)["curves"][0]
    check(near(o["samples"], [strand]), "positions in double precision")
    check(o["counts"] == [2, 2] and o["ids"] == [7, 200], "whole numbers of one and two bytes")
    check(near(o["root_uv"], [[0.75, 1], [0.25, 0.5]]), "values by index")


we_write()
they_write()
they_write_other_numbers()
they_write_many()
finish()
