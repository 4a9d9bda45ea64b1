# VTK's side of `scripts/bench volume`: flying edges, then quadric decimation to the other side's number of triangles (or
# none, where there are no more). Two threads, as far as VTK's filters have them.
#   volume_peer.py FILE THRESHOLD TRIANGLES [MESH] -> seconds and seconds of processor time of reading and flying edges, the
#   same with the decimation, triangles of flying edges and at the end, MiB at the peak after flying edges and at the end,
#   MiB of Python and VTK before any work
# MESH: the last mesh is written there: a line with the counts of vertices and triangles, doubles, 32-bit indices.
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
base = peak()
begun, used = time.perf_counter(), time.process_time()
reader = vtkNrrdReader()
reader.SetFileName(file)
reader.Update()
surface = vtkFlyingEdges3D()
surface.SetInputConnection(reader.GetOutputPort())
surface.SetValue(0, threshold)
surface.ComputeNormalsOn()
surface.ComputeScalarsOff()
surface.Update()
contoured, contoured_used = time.perf_counter() - begun, time.process_time() - used
count, peak_contoured = surface.GetOutput().GetNumberOfPolys(), peak()
decimated = vtkQuadricDecimation()
decimated.SetInputConnection(surface.GetOutputPort())
decimated.SetTargetReduction(max(0.0, 1 - wanted / count))
decimated.Update()
done, done_used = time.perf_counter() - begun, time.process_time() - used
mesh = decimated.GetOutput()
print("%.3f %.3f %.3f %.3f %d %d %.1f %.1f %.1f" % (contoured, contoured_used, done, done_used, count, mesh.GetNumberOfPolys(),
                                                    peak_contoured, peak(), base))
if len(sys.argv) > 4:
    points = vtk_to_numpy(mesh.GetPoints().GetData()).astype("<f8")
    triangles = vtk_to_numpy(mesh.GetPolys().GetConnectivityArray()).astype("<u4")
    with open(sys.argv[4], "wb") as out:
        out.write(b"%d %d\n" % (len(points), len(triangles) // 3))
        out.write(points.tobytes())
        out.write(triangles.tobytes())
