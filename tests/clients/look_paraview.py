"""ParaView shows results: in the reader that it takes by itself, in its other two of XDMF and in that of VTKHDF. Arrays, cells and
times are those that `perilat export` tells, and a picture has colours. Argument: the folder with the results."""
import sys

from paraview import servermanager, simple
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

from exported import END, FRAMES, SPECIMENS, Frame, MeshFrame, comparable


def rows(array):
    values = vtk_to_numpy(array)
    return values.tolist() if values.ndim == 1 else list(map(tuple, values.tolist()))


def check_grid(grid, frame, where):
    assert grid.IsA("vtkUnstructuredGrid"), (where, grid.GetClassName())
    assert rows(grid.GetPoints().GetData()) == frame.places, where
    assert rows(grid.GetPointData().GetArray("displacement")) == frame.displacement, where
    assert rows(grid.GetPointData().GetArray("damage")) == frame.damage, where
    assert comparable(rows(grid.GetCellData().GetArray("omega"))) == frame.omega, where
    ends = rows(grid.GetCells().GetConnectivityArray())
    assert list(zip(ends[::2], ends[1::2])) == frame.ends, where


def grids_of(block):
    """Grids in blocks within blocks."""
    if block.IsA("vtkUnstructuredGrid"):
        return [block]
    parts = block.GetNumberOfPieces() if block.IsA("vtkMultiPieceDataSet") else block.GetNumberOfBlocks()
    get = block.GetPiece if block.IsA("vtkMultiPieceDataSet") else block.GetBlock
    return [grid for k in range(parts) if get(k) for grid in grids_of(get(k))]


def check_cells(grid, frame, where):
    assert rows(grid.GetPoints().GetData()) == frame.places, where
    assert rows(grid.GetPointData().GetArray("displacement")) == frame.displacement, where
    assert rows(grid.GetPointData().GetArray("stress_yy")) == frame.stress, where
    corners = rows(grid.GetCells().GetConnectivityArray())
    assert list(zip(*(corners[k::4] for k in range(4)))) == frame.cells, where


def check_crack(grid, frame, where):
    assert rows(grid.GetPoints().GetData()) == frame.crack and grid.GetNumberOfCells() == 1, where
    assert rows(grid.GetCells().GetConnectivityArray()) == list(range(len(frame.crack))), where


def check_mesh(reader, frames):
    """The cells, then the crack."""
    where = f"mesh, {reader.GetXMLName()}"
    reader.UpdatePipelineInformation()
    times = list(reader.TimestepValues)
    assert len(times) == FRAMES, (where, times)
    for time, frame in zip(times, frames):
        reader.UpdatePipeline(time)
        cells, crack = grids_of(servermanager.Fetch(reader))
        check_cells(cells, frame, f"{where}, {time} s")
        check_crack(crack, frame, f"{where}, {time} s")
    return times


def look_at_mesh(folder):
    frames = [MeshFrame(folder, frame) for frame in range(FRAMES)]
    path = f"{folder}/mesh.xdmf"
    reader = simple.OpenDataFile(path)
    times = check_mesh(reader, frames)
    check_mesh(simple.Xdmf3ReaderT(FileName=[path]), frames)
    check_mesh(simple.XDMFReader(FileNames=[path]), frames)
    check_picture(reader, times[-1], "POINTS", "displacement", f"{folder}/mesh_displacement.png")
    vtkhdf = simple.VTKHDFReader(FileName=f"{folder}/mesh.h5")
    vtkhdf.UpdatePipeline()
    check_cells(servermanager.Fetch(vtkhdf), frames[0], "mesh, VTKHDF")
    print(f"mesh: {len(frames[0].places)} nodes, {len(frames[0].cells)} to {len(frames[-1].cells)} cells, "
          f"{len(frames[-1].crack)} points of the crack")


def check_times(times, where):
    assert len(times) == FRAMES and times[0] == 0 and sorted(times) == times, (where, times)
    assert END <= times[-1] < 1.01 * END, (where, times)


def check_series(reader, specimen, frames):
    where = f"{specimen}, {reader.GetXMLName()}"
    reader.UpdatePipelineInformation()
    times = list(reader.TimestepValues)
    check_times(times, where)
    for time, frame in zip(times, frames):
        reader.UpdatePipeline(time)
        check_grid(servermanager.Fetch(reader), frame, f"{where}, {time} s")
    return times


def coloured_pixels(path):
    """Those in which red, green and blue are far from each other."""
    reader = vtkPNGReader()
    reader.SetFileName(path)
    reader.Update()
    pixels = vtk_to_numpy(reader.GetOutput().GetPointData().GetScalars()).astype(int)[:, :3]
    return (pixels.max(axis=1) - pixels.min(axis=1) > 60).mean()


def check_picture(reader, time, place, field, path):
    view = simple.CreateRenderView()
    view.ViewSize = [400, 300]
    view.OrientationAxesVisibility = 0
    shown = simple.Show(reader, view)
    view.ViewTime = time
    reader.UpdatePipeline(time)
    simple.ColorBy(shown, (place, field))
    shown.RescaleTransferFunctionToDataRange(False)
    shown.LineWidth = 3
    simple.ResetCamera(view)
    simple.SaveScreenshot(path, view)
    part = coloured_pixels(path)
    assert part > 0.1, f"{path}: {part} of the pixels have a colour"
    simple.Delete(view)


def main(folder):
    look_at_mesh(folder)
    for specimen in SPECIMENS:
        frames = [Frame(folder, specimen, frame) for frame in range(FRAMES)]
        assert max(value or 0 for value in frames[-1].omega) > 0.9 and max(frames[-1].displacement) > (1e-4, 0, 0), specimen
        path = f"{folder}/{specimen}.xdmf"
        reader = simple.OpenDataFile(path)
        assert reader.GetXMLName() == "Xdmf3ReaderS", reader.GetXMLName()
        times = check_series(reader, specimen, frames)
        check_series(simple.XDMFReader(FileNames=[path]), specimen, frames)
        check_series(simple.Xdmf3ReaderT(FileName=[path]), specimen, frames)
        check_picture(reader, times[-1], "POINTS", "displacement", f"{folder}/{specimen}_displacement.png")
        check_picture(reader, times[-1], "CELLS", "omega", f"{folder}/{specimen}_omega.png")
        vtkhdf = simple.VTKHDFReader(FileName=f"{folder}/{specimen}.h5")
        vtkhdf.UpdatePipelineInformation()
        steps = list(vtkhdf.TimestepValues)
        if steps:  # VTK 9.3 and later; earlier ones show the first
            check_series(vtkhdf, specimen, frames)
        else:
            vtkhdf.UpdatePipeline()
            check_grid(servermanager.Fetch(vtkhdf), frames[0], f"{specimen}, VTKHDF")
        print(f"{specimen}: {len(frames[0].places)} particles, {len(frames[0].ends)} bonds, {len(times)} times, "
              f"VTKHDF {'all steps' if steps else 'the first step'}")


main(sys.argv[1])
