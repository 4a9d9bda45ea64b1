// See chart_specimen.h.
#include "colour/chart_specimen.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "base/random.h"
#include "geom/mat3_inverse.h"

namespace gonio::colour {
namespace {

constexpr double frame = 0.06, frame_reflectance = 0.035;  // about the patches, of the chart's width; dark

void blur(io::Image& image, double sigma) {
  const int reach = static_cast<int>(std::ceil(3 * sigma));
  std::vector<double> weight;
  double sum = 0;
  for (int k = -reach; k <= reach; ++k) weight.push_back(std::exp(-k * k / (2 * sigma * sigma))), sum += weight.back();
  for (const bool along : {true, false}) {
    const io::Image before = image;
    for (int y = 0; y < image.height; ++y)
      for (int x = 0; x < image.width; ++x)
        for (int c = 0; c < 3; ++c) {
          double v = 0;
          for (int k = -reach; k <= reach; ++k)
            v += weight[static_cast<std::size_t>(k + reach)] *
                 before.at(std::clamp(x + (along ? k : 0), 0, image.width - 1),
                           std::clamp(y + (along ? 0 : k), 0, image.height - 1), c);
          image.at(x, y, c) = static_cast<float>(v / sum);
        }
  }
}

}  // namespace

Rgb read_of(const ChartSpecimen& specimen, const Patch& patch) {
  return specimen.camera_from_xyz * patch.xyz * specimen.exposure;
}

io::Image photograph_of(const Chart& chart, const ChartSpecimen& p, int width, int height) {
  Random random(p.seed);
  const Mat3 chart_from_image = inverse(p.pose.image_from_chart);
  const Rgb dark = p.camera_from_xyz * (optics::white_d50 * frame_reflectance);
  const auto light_at = [&](double x, double y) {
    const Vec3 h = chart_from_image * Vec3{x, y, 1};
    const Vec2 at{h.x / h.z, h.y / h.z};
    const double down = frame / chart.height_over_width;
    if (!(h.z > 0) || at.x < -frame || at.x > 1 + frame || at.y < -down || at.y > 1 + down)
      return p.room ? p.room(x, y) : dark;
    const double light = 1 + dot(p.gradient, at - Vec2{0.5, 0.5});
    for (const Patch& patch : chart.patches)
      if (std::abs(at.x - patch.centre.x) < patch.size.x / 2 && std::abs(at.y - patch.centre.y) < patch.size.y / 2)
        return p.camera_from_xyz * patch.xyz * light;
    return dark * light;
  };
  io::Image image(width, height, {"R", "G", "B"});
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      Rgb sum;
      for (const double dy : {-0.25, 0.25})
        for (const double dx : {-0.25, 0.25}) sum += light_at(x + dx, y + dy) * 0.25;
      for (int c = 0; c < 3; ++c) image.at(x, y, c) = static_cast<float>((sum[c] + p.offset[c]) * p.exposure);
    }
  if (p.blur_px > 0) blur(image, p.blur_px);
  if (p.shot > 0 || p.read > 0)
    for (float& v : image.data)
      v += static_cast<float>(std::sqrt(std::max(0.0, p.shot * v + p.read * p.read)) * random.normal());
  return image;
}

ChartSpecimen example_specimen(const Chart& chart, std::uint64_t seed) {
  ChartSpecimen example;
  const double down = 300 * std::min(1.4, chart.height_over_width / 0.66);
  example.pose = pose_from_corners(
      {Vec2{260, 300 - down / 2}, {690, 330 - down / 2}, {700, 320 + down / 2}, {240, 310 + down / 2}}, "specimen");
  example.gradient = {0.1, -0.04};
  example.offset = example.camera_from_xyz * (optics::white_d50 * 0.01);
  example.shot = 2e-5, example.read = 1e-3, example.blur_px = 0.7, example.seed = seed;
  return example;
}

}  // namespace gonio::colour
