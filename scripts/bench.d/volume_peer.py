# VTK's side of `scripts/bench volume`: flying edges, then quadric decimation to the other side's number of triangles.
#   volume_peer.py FILE THRESHOLD TRIANGLES [MESH] -> seconds of reading, of flying edges, of decimation; triangles of
#   either; MiB at the peak after flying edges and at the end. Two threads, as far as VTK's filters have them.
# MESH: the decimated one is written there (raw doubles and 32-bit indices, after a line with their counts).
import resource
import sys
import time

import numpy as np
from vtkmodules.util.numpy_support import vtk_to_numpy
from vtkmodules.vtkCommonCore import vtkSMPTools
from vtkmodules.vtkFiltersCore import vtkFlyingEdges3D, vtkQuadricDecimation
from vtkmodules.vtkIOImage import vtkNrrdReader


def peak():
    return resource.getrusage(resource.RUSAGE_SELF).ru_maxrss / 1024


file, threshold, wanted = sys.argv[1], float(sys.argv[2]), int(sys.argv[3])
vtkSMPTools.Initialize(2)
begun = time.perf_counter()
reader = vtkNrrdReader()
reader.SetFileName(file)
reader.Update()
read = time.perf_counter()
surface = vtkFlyingEdges3D()
surface.SetInputConnection(reader.GetOutputPort())
surface.SetValue(0, threshold)
surface.ComputeNormalsOn()
surface.ComputeScalarsOff()
surface.Update()
contoured = time.perf_counter()
count, peak_contoured = surface.GetOutput().GetNumberOfPolys(), peak()
decimated = vtkQuadricDecimation()
decimated.SetInputConnection(surface.GetOutputPort())
decimated.SetTargetReduction(max(0.0, 1 - wanted / count))
decimated.Update()
done = time.perf_counter()
mesh = decimated.GetOutput()
print("%.3f %.3f %.3f %d %d %.1f %.1f" % (read - begun, contoured - read, done - contoured, count, mesh.GetNumberOfPolys(),
                                          peak_contoured, peak()))
if len(sys.argv) > 4:
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype("<f8")
    triangles = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).astype("<u4")
    with open(sys.argv[4], "wb") as out:
        out.write(b"%d %d\n" % (len(points), len(triangles) // 3))
        out.write(points.tobytes())
        out.write(triangles.tobytes())
