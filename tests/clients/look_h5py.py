"""h5py reads what a result tells of itself: how it came about, what each quantity is, times as dimension scales; and the group
/VTKHDF holds, by the rules of its specification, the frames that `perilat export` tells. Argument: the folder with the results."""
import sys

import h5py

from exported import FRAMES, SPECIMENS, Frame, MeshFrame, comparable

VTK_LINE, VTK_QUAD = 3, 9
WORDS = {  # the law's, where it has them
    "plane": "Loss of stiffness that puts the force on the softening curve (eq 3.15). "
             "A bond with omega = 1 is gone in tension and in compression.",
    "space": "damage of the law",
    "irregular": "1: broken",
}
WORDS["bars"] = WORDS["linked"] = WORDS["plane"]


def check_ending(file, specimen):
    told = file.attrs
    assert told["ended"] == "end of the run" and told["status"] == 0, specimen
    assert told["threads"] >= 1 and told["wall_seconds"] > 0 and told["steps"] > 0, specimen
    assert told["compiler"] and "-O3" in told["flags"], specimen


def check_bodies(file, specimen):
    body = file["particles/body"][:]
    bars = {"bars": 36 + 23, "linked": 19}.get(specimen, 0)
    assert (body < 0).sum() == bars and (body[:len(body) - bars] == 0).all(), specimen
    assert ("resolved" in file["particles"]) == (specimen == "irregular"), specimen


def data_sets(group):
    found = []
    group.visititems(lambda name, item: found.append(item) if isinstance(item, h5py.Dataset) else None)
    return found


def check_words(file, specimen):
    for group in ("history", "frames"):
        times = file[group]["time"]
        assert times.attrs["CLASS"] == b"DIMENSION_SCALE", (specimen, group)
        others = [item for item in data_sets(file[group]) if item != times]
        assert others, (specimen, group)
        for item in others + [times]:
            words = item.attrs["long_name"]
            assert isinstance(words, str) and words and item.attrs["units"], (specimen, item.name)
        for item in others:
            assert item.dims[0][0] == times and item.shape[0] == times.shape[0], (specimen, item.name)
    laws = [item for item in file["frames"].values() if isinstance(item, h5py.Group)]
    assert len(laws) == (2 if specimen == "linked" else 1), specimen
    for bonds in laws:
        assert bonds["omega"].attrs["long_name"] == WORDS[specimen], specimen


def grid_of_step(vtk, step, kind=VTK_LINE):
    """One step as VTK reads it: offsets of the step, then parts. A step has one part here, with all arrays."""
    steps = vtk["Steps"]
    assert steps["NumberOfParts"][step] == 1
    part = steps["PartOffsets"][step]
    points, cells, ids = (int(vtk["NumberOf" + what][part]) for what in ("Points", "Cells", "ConnectivityIds"))
    point, cell, first = (int(steps[what + "Offsets"][step].item()) for what in ("Point", "Cell", "ConnectivityId"))
    offsets = vtk["Offsets"][part + cell:part + cell + cells + 1].tolist()
    connectivity = vtk["Connectivity"][first:first + ids].tolist()
    assert len(offsets) == cells + 1 and offsets[0] == 0 and offsets[-1] == ids == len(connectivity)
    assert vtk["Types"].dtype == "u1" and set(vtk["Types"][cell:cell + cells]) == {kind}
    arrays = {}
    for data, count in (("PointData", points), ("CellData", cells)):
        for name, values in vtk[data].items():
            at = int(steps[data + "Offsets"][name][step])
            arrays[data, name] = values[at:at + count].tolist()
            assert len(arrays[data, name]) == count, name
    places = vtk["Points"][point:point + points].tolist()
    return places, [connectivity[a:b] for a, b in zip(offsets, offsets[1:])], arrays


def tuples(rows):
    return list(map(tuple, rows))


def check_vtkhdf(file, specimen, frames):
    vtk = file["VTKHDF"]
    version, kind = vtk.attrs["Version"], vtk.attrs["Type"]
    assert list(version) == [2, 0] and kind == b"UnstructuredGrid", (version, kind)
    assert vtk["Steps"].attrs["NSteps"] == FRAMES and (vtk["Steps/Values"][:] == file["frames/time"][:]).all()
    for step, frame in enumerate(frames):
        places, cells, arrays = grid_of_step(vtk, step)
        assert tuples(places) == frame.places and tuples(cells) == frame.ends, (specimen, step)
        assert tuples(arrays["PointData", "displacement"]) == frame.displacement, (specimen, step)
        assert arrays["PointData", "damage"] == frame.damage, (specimen, step)
        assert comparable(arrays["CellData", "omega"]) == frame.omega, (specimen, step)
    shown = data_sets(vtk["PointData"]) + data_sets(vtk["CellData"]) + data_sets(file["xdmf"]) + [vtk["Points"]]
    assert all(item.is_virtual for item in shown), "no copies"


def check_mesh(file, frames):
    """Tables of the mesh and of its crack; and the grid, whose cells are those that the crack does not cross."""
    mesh, points = file["meshes/plate"], file["cracks/slit/points"]
    assert mesh.attrs["first_particle"] == 0 and mesh.attrs["thickness"] == 0.01
    for item in data_sets(mesh):
        assert item.attrs["long_name"] and item.attrs["units"], item.name
    assert [place + (0.0,) for place in tuples(mesh["nodes"][:].tolist())] == frames[0].places
    assert tuples(mesh["cells"][:].tolist()) == MeshFrame.all_cells() and set(mesh["method"][:]) == {3}
    assert points.attrs["units"] == "m" and points.attrs["long_name"] and points.attrs["mesh"] == "plate"
    assert points.dims[0][0] == file["frames/time"]
    for step, frame in enumerate(frames):
        there = [(x, y, 0.0) for x, y in points[step].tolist() if x == x]
        assert there == frame.crack and all(x != x for x, _ in points[step, len(there):]), step
        places, cells, arrays = grid_of_step(file["VTKHDF"], step, VTK_QUAD)
        assert tuples(places) == frame.places and tuples(cells) == frame.cells, step
        assert tuples(arrays["PointData", "displacement"]) == frame.displacement, step
        assert arrays["PointData", "stress_yy"] == frame.stress, step
    assert len(frames[0].cells) > len(frames[-1].cells) > 400


with h5py.File(f"{sys.argv[1]}/mesh.h5", "r") as opened:
    check_ending(opened, "mesh")
    check_mesh(opened, [MeshFrame(sys.argv[1], frame) for frame in range(FRAMES)])
for specimen in SPECIMENS:
    with h5py.File(f"{sys.argv[1]}/{specimen}.h5", "r") as opened:
        check_ending(opened, specimen)
        check_words(opened, specimen)
        check_bodies(opened, specimen)
        check_vtkhdf(opened, specimen, [Frame(sys.argv[1], specimen, frame) for frame in range(FRAMES)])
    print(f"{specimen}: h5py {h5py.__version__}, HDF5 {h5py.version.hdf5_version}")
