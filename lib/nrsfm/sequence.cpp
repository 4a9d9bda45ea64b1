// See sequence.h.
#include "nrsfm/sequence.h"

#include <cmath>

#include "base/error.h"

namespace gonio::nrsfm {
namespace {

std::string size_text(Eigen::Index rows, Eigen::Index columns) {
  return std::to_string(rows) + " x " + std::to_string(columns);
}

void check_size(const char* what, Eigen::Index rows, Eigen::Index columns, Eigen::Index wanted_rows,
                Eigen::Index wanted_columns, const std::string& place) {
  if (rows != wanted_rows || columns != wanted_columns)
    throw Error(Exit::data, place,
                std::string(what) + " is " + size_text(rows, columns) + " where the tracks make it " +
                    size_text(wanted_rows, wanted_columns));
}

}  // namespace

Shapes in_cameras(const Shapes& object_shapes, const std::vector<CameraFromObject>& cameras) {
  const Eigen::Index frames = object_shapes.rows() / 3;
  if (static_cast<Eigen::Index>(cameras.size()) != frames)
    throw Error(
        Exit::data, "cameras",
        "are " + std::to_string(cameras.size()) + " where the shapes have " + std::to_string(frames) + " frames",
        "store R and T of every frame");
  Shapes out(object_shapes.rows(), object_shapes.cols());
  for (Eigen::Index f = 0; f < frames; ++f) {
    const CameraFromObject& camera = cameras[static_cast<std::size_t>(f)];
    shape_of(out, f) = (camera.rotation * shape_of(object_shapes, f)).colwise() + camera.translation;
  }
  return out;
}

void check(const Sequence& sequence, const std::string& place) {
  const Eigen::Index frames = sequence.frames(), points = sequence.points();
  if (sequence.tracks.rows() % 2 != 0)
    throw Error(Exit::data, place,
                "has " + std::to_string(sequence.tracks.rows()) + " rows of tracks, two a frame are needed");
  if (frames < 2) throw Error(Exit::data, place, "has " + std::to_string(frames) + " frames, 2 is the least");
  if (points < 4) throw Error(Exit::data, place, "has " + std::to_string(points) + " points, 4 is the least");
  check_size("visible", sequence.visible.rows(), sequence.visible.cols(), frames, points, place);
  if (sequence.truth)
    check_size("the truth", sequence.truth->rows(), sequence.truth->cols(), 3 * frames, points, place);
  if (!sequence.cameras.empty() && static_cast<Eigen::Index>(sequence.cameras.size()) != frames)
    throw Error(
        Exit::data, place,
        "has " + std::to_string(sequence.cameras.size()) + " cameras for " + std::to_string(frames) + " frames");
  for (Eigen::Index f = 0; f < frames; ++f)
    for (Eigen::Index p = 0; p < points; ++p)
      if (sequence.visible(f, p) && !sequence.tracks.block<2, 1>(2 * f, p).allFinite())
        throw Error(Exit::data, place,
                    "says that point " + std::to_string(p) + " is visible in frame " + std::to_string(f) +
                        " and has no finite track there",
                    "write NaN tracks only where the visibility is 0");
}

}  // namespace gonio::nrsfm
