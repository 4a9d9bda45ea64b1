// What the manifest says of a pattern and its images, checked and put together. Private to contrast measure.
#pragma once
#include <array>
#include <optional>
#include <string>
#include <vector>

#include "contrast/measure/measure.h"

namespace gonio::contrast {

struct InputView {
  std::size_t image = 0;            // place in document.images
  std::string id, place;            // for messages
  std::vector<std::string> lights;  // that were on
  int placement = 0;
  std::optional<camera::CameraModel> camera;
  std::optional<CameraPose> pose;  // with it the sample's pose places the pattern; else marks of this image do
  std::vector<PlacedMark> marks;
  std::string no_outline;  // why the corners of a view without marks were not found
  double full_scale = 0;
  std::optional<ViewMap> map;
  CornerCovariance spread{};  // of the corners in the picture
};
struct Input {
  std::string name, place;  // of the pattern: id, place in the manifest
  CellPattern pattern;
  bool data_matrix = false;
  std::array<std::string, 2> placement;
  std::array<std::optional<SamplePose>, 2> pose;
  std::vector<InputView> views;  // whose map is known
  std::vector<std::string> notes, dropped;
};

Input read_input(const manifest::Document& document, const std::string& name, const std::vector<CornerMark>& marks,
                 const MeasureOptions& options);

// The picture of a view as linear grey: Y, or the luminance of R, G and B.
GreyView read_view(const manifest::Document& document, const InputView& view, const MeasureOptions& options);

}  // namespace gonio::contrast
