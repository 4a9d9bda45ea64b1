// The manifest's photographs of mirror balls, as surroundings and lights in the manifest.
#pragma once
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "probe/ball_outline.h"
#include "probe/bright_lights.h"
#include "probe/unwrap.h"

namespace gonio::probe {

// What the light is scaled to: a photograph of the manifest, and the white tile that it shows (name in `goniometer`);
// empty: the ball itself.
struct ScaleWish {
  std::size_t image = 0;
  std::string tile{};
};

struct ProbeRequest {
  std::vector<std::size_t> images{};  // places in document.images
  // Without perspective: no camera is asked for. The world's axes are then x along the view, y to the left, z up, its
  // origin behind the middle of the picture, and a ball whose radius is not known has one of a metre.
  bool parallel = false;
  double radius_m = 0;
  std::size_t balls = 1;
  std::optional<Circle> circle{};
  std::vector<std::filesystem::path> silhouettes{};  // none, one for all images, or one for each
  UnwrapWish unwrap{};
  std::optional<LightWish> lights{};  // left out: all stays in the picture
  std::optional<ScaleWish> scale{};
  bool each = false;  // every photograph has lights of its own, and there is no picture of all
  std::string name = "probe";
  std::function<std::filesystem::path(const std::string& name)> output_path{};
  std::function<void(const std::filesystem::path&)> note_input{};
};

// Cameras, pictures and masks are there and fit together; no pixel is looked at. Error(data | no_input).
void check_probe(const manifest::Document& document, const ProbeRequest& request);

// Writes NAME.exr, the surroundings, and NAME-weight.exr, NAME-balls.csv, NAME-lights.csv and, where views share lamps
// enough for explain, NAME-highlights.csv and NAME-reflected.csv, tables of the models probe and probe-radiance; enters
// the environment NAME, the light NAME (model lat-long) that refers to it, and what `lights` finds, NAME-1, NAME-2, ...
// With `each`: lights alone, NAME-IMAGE-1,
// ..., which become those of the image. What was found is logged.
void probe_document(manifest::Document& document, const ProbeRequest& request);

}  // namespace gonio::probe
