// A tomograph: X-rays of a spectrum through a phantom onto a detector, view by view, and the volume that filtered
// back-projection makes of them. Written apart from everything that looks at volumes: it makes what they are tested on.
//
// Frames: the volume's index (i, j, k) is at ((i, j, k) - (size - 1) / 2) * voxel_m of the phantom's frame; the
// rotation axis is z. A view at angle a turns the phantom by a about z; rays run along +y, detector columns along x,
// rows along z, with pixels of one voxel (at the axis, for a cone). A pixel's reading is the mean of the intensity over
// its area, then everything that an imperfection does to it, then minus its logarithm.
//
// Parallel beam: every slice is reconstructed by itself, exactly but for sampling (Kak & Slaney 1988, chapter 3.3).
// Cone beam: Feldkamp, Davis & Kress 1984, exact in the middle slice alone.
#pragma once
#include <array>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "ct/phantom.h"
#include "io/volume.h"

namespace gonio::ct {

// Absent: perfect. Names and what their amplitude means:
//   scale           voxel size told too large by this share
//   beam-hardening  share of it that is left in the readings; absent: all of it. 0: readings linearised for the first
//                   part's material
//   cupping         the volume times 1 + amplitude (r^2 / R^2 - 1/2), R the circle's radius: a gain that falls inwards
//   scatter         of T ln(1/T) (singly scattered photons go with what the primary beam lost), spread over an eighth
//   of
//                   the field, added to the transmission T
//   ring            sd of the detector pixels' gains, as a share
//   streak          transmission below this cannot be told from it (a detector's floor, so that rays through dense
//                   parts read too little)
//   blur            sd of the detector's point spread, pixels
//   focal-spot      sd of the focal spot's shadow on the rotation axis, pixels (it grows towards the source)
//   axis-tilt       of the rotation axis against the detector's columns, rad
//   axis-offset     of the rotation axis against the detector's middle, pixels
//   drift           of the source's output from the first to the last view, as a share
using Imperfections = std::map<std::string, double>;

struct Scanner {
  std::size_t voxels = 128;  // along i and j
  std::size_t slices = 0;    // along k; 0: as many as voxels
  double voxel_m = 1e-4;
  std::size_t views = 0;             // over half a turn (parallel) or a turn (cone); 0: pi/2 and pi times the voxels
  double source_m = 0;               // distance of the source from the axis; 0: parallel beam
  std::array<int, 2> samples{2, 2};  // of a pixel, along its row and its column
  Spectrum spectrum = tube(120);
  double photons = 0;  // counted by a pixel in the open beam in one view; 0: no noise
  bool hann = false;   // window on the ramp, else Ram-Lak
  Imperfections imperfections{};
  std::uint64_t seed = 1;

  std::size_t slice_count() const { return slices > 0 ? slices : voxels; }
  std::size_t view_count() const;
  double amplitude(const std::string& name, double absent = 0) const;
};

// Minus the logarithm of the transmission: values[(view * columns + column) * rows + row].
struct Projections {
  std::size_t views = 0, columns = 0, rows = 0;
  std::vector<float> values;
  const float* column(std::size_t view, std::size_t u) const { return values.data() + (view * columns + u) * rows; }
};
Projections projections(const Phantom& phantom, const Scanner& scanner);
io::VolumeData reconstructed(const Projections& projections, const Scanner& scanner);  // attenuation in 1/m, as f32

// The volume as told: spacing and origin as the scanner says them, which is wrong where its scale is.
io::VolumeData scan(const Phantom& phantom, const Scanner& scanner);

// Where an index truly is in the phantom's frame.
Vec3 place_of(const Scanner& scanner, double i, double j, double k);
// As a detector's software stores it: codes round(gain * value + offset), clamped to the type. Head: type, slope and
// intercept stay 1 and 0, as with most files.
io::VolumeData stored_as(const io::VolumeData& volume, io::VoxelType type, double gain, double offset);

}  // namespace gonio::ct
