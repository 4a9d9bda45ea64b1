#include "render/film.h"

#include <algorithm>
#include <cmath>

namespace gonio::render {
namespace {

constexpr int least_replicates = 16, largest_side = 8;

std::vector<std::string> channel_names(const std::vector<std::string>& lights, bool geometry) {
  std::vector<std::string> names = {"R", "G", "B", "variance.R", "variance.G", "variance.B"};
  if (!geometry) return names;
  names.insert(names.end(), {"id", "position.X", "position.Y", "position.Z", "normal.X", "normal.Y", "normal.Z"});
  for (const std::string& light : lights) names.push_back("distance." + light);
  for (const std::string& light : lights) names.push_back("visibility." + light);
  return names;
}

}  // namespace

SamplePlan sample_plan(int spp) {
  SamplePlan plan;
  plan.side = std::clamp(static_cast<int>(std::sqrt(static_cast<double>(spp) / least_replicates)), 1, largest_side);
  const int strata = plan.side * plan.side;
  plan.replicates = std::max(2, (spp + strata - 1) / strata);
  return plan;
}

io::Image develop(int width_px, int height_px, const std::vector<Pixel>& pixels, const std::vector<std::string>& lights,
                  bool geometry) {
  io::Image image(width_px, height_px, channel_names(lights, geometry));
  float* out = image.data.data();
  const auto put = [&](double v) { *out++ = static_cast<float>(v); };
  const auto put_vector = [&](Vec3 v) { put(v.x), put(v.y), put(v.z); };
  for (const Pixel& pixel : pixels) {
    put_vector(pixel.mean);
    put_vector(pixel.variance);
    if (!geometry) continue;
    put(pixel.geometry.id);
    put_vector(pixel.geometry.position_m);
    put_vector(pixel.geometry.normal);
    for (std::size_t i = 0; i < lights.size(); ++i) put(pixel.geometry.distance_m[i]);
    for (std::size_t i = 0; i < lights.size(); ++i) put(pixel.geometry.visibility[i]);
  }
  return image;
}

}  // namespace gonio::render
