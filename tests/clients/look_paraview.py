"""ParaView shows results: in the reader that it takes by itself, in its other two of XDMF and in that of VTKHDF. Arrays, cells and
times are those that `perilat export` tells, and a picture has colours. Argument: the folder with the results."""
import sys

from paraview import servermanager, simple
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkIOImage import vtkPNGReader

from exported import END, FRAMES, SPECIMENS, Frame, comparable


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
