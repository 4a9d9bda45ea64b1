// From the manifest's images to balls in pictures. For probe_document.cpp.
#pragma once
#include <string>
#include <vector>

#include "probe/probe_document.h"

namespace gonio::probe {

struct LoadedView {
  std::size_t image = 0;  // place in document.images
  io::Image picture;      // R, G, B or Y
  io::Image variance;     // of the same channels, where the file has it
  std::vector<std::uint8_t> counts, clipped;
  std::optional<camera::CameraModel> camera;  // nothing: without perspective
  OutlineView outlines;                       // of parallel views: as far_camera() sees them
};
// The picture with its mask, camera and pose, without outlines.
LoadedView read_view(const manifest::Document& document, std::size_t image, const ProbeRequest& request);
// Pictures read, outlines found.
LoadedView load_view(const manifest::Document& document, std::size_t image, const ProbeRequest& request);

struct BallViews {
  std::vector<BallView> views;
  std::vector<std::size_t> image_of_view, ball_of_view;
  std::vector<reassembly::Outline> outline_of_view;
  std::vector<FoundBall> balls;  // of parallel views: one for each view, its covariance that of the two coordinates
  Vec3 middle_m{};               // of the balls
};
BallViews ball_views(const std::vector<LoadedView>& loaded, const ProbeRequest& request, const std::string& place);

}  // namespace gonio::probe
