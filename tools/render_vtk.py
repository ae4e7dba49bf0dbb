# SPDX-License-Identifier: GPL-3.0-or-later
"""Renders a surface by VTK into an image, without a window on the screen."""
import numpy as np
import vtk
from vtk.util.numpy_support import (numpy_to_vtk, numpy_to_vtkIdTypeArray,
                                    vtk_to_numpy)

WIDTH = 1400  # pixels


def render(triangles, colours, view):
    """Pixels [ny][nx][4], the lowest first, of triangles [n][3][3] with colours
    [n][3][3] of 0 to 255 at their corners, as a View (heap.py) sees them."""
    renderer = vtk.vtkRenderer()
    renderer.AddActor(actor_of(triangles, colours))
    renderer.SetBackground(1, 1, 1)
    renderer.AutomaticLightCreationOff()
    renderer.AddLight(light_of(view))
    aim(renderer.GetActiveCamera(), view)
    renderer.ResetCameraClippingRange()
    window = vtk.vtkRenderWindow()
    window.SetOffScreenRendering(True)
    window.SetMultiSamples(8)
    window.SetAlphaBitPlanes(True)
    window.SetSize(WIDTH, int(round(WIDTH / view.aspect())))
    window.AddRenderer(renderer)
    window.Render()
    pixels = grab(window)
    window.Finalize()
    return pixels


def actor_of(triangles, colours):
    """The triangles as one smooth body."""
    count = len(triangles)
    points = vtk.vtkPoints()
    points.SetData(numpy_to_vtk(triangles.reshape(-1, 3), deep=True))
    table = np.c_[np.full(count, 3), np.arange(3 * count).reshape(-1, 3)]
    cells = vtk.vtkCellArray()
    cells.SetCells(count, numpy_to_vtkIdTypeArray(
        table.astype(np.int64).ravel(), deep=True))
    data = vtk.vtkPolyData()
    data.SetPoints(points)
    data.SetPolys(cells)
    data.GetPointData().SetScalars(numpy_to_vtk(
        colours.reshape(-1, 3).astype(np.uint8), deep=True))
    clean = vtk.vtkCleanPolyData()
    clean.SetInputData(data)
    smooth = vtk.vtkWindowedSincPolyDataFilter()
    smooth.SetInputConnection(clean.GetOutputPort())
    smooth.SetNumberOfIterations(8)
    smooth.SetPassBand(0.3)
    normal = vtk.vtkPolyDataNormals()
    normal.SetInputConnection(smooth.GetOutputPort())
    normal.SetFeatureAngle(60)
    mapper = vtk.vtkPolyDataMapper()
    mapper.SetInputConnection(normal.GetOutputPort())
    actor = vtk.vtkActor()
    actor.SetMapper(mapper)
    actor.GetProperty().SetAmbient(0.5)
    actor.GetProperty().SetDiffuse(0.55)
    return actor


def light_of(view):
    light = vtk.vtkLight()
    light.SetLightTypeToSceneLight()
    light.SetPosition(*view.light())
    light.SetFocalPoint(0, 0, 0)
    light.SetPositional(False)
    return light


def aim(camera, view):
    centre = 0.5 * (view.low + view.high)
    focus = centre[0] * view.right + centre[1] * view.up
    far = 10 * float(np.linalg.norm(view.high - view.low))
    camera.SetParallelProjection(True)
    camera.SetFocalPoint(*focus)
    camera.SetPosition(*(focus + far * view.towards))
    camera.SetViewUp(*view.up)
    camera.SetParallelScale(0.5 * float((view.high - view.low)[1]))


def grab(window):
    image = vtk.vtkWindowToImageFilter()
    image.SetInput(window)
    image.SetInputBufferTypeToRGBA()
    image.ReadFrontBufferOff()
    image.Update()
    nx, ny, _ = image.GetOutput().GetDimensions()
    values = image.GetOutput().GetPointData().GetScalars()
    return vtk_to_numpy(values).reshape(ny, nx, 4).copy()
