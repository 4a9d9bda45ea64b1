// A tilted plane under a Gray code, two cameras of 9 MP that look ahead side by side (so that OpenCV's structured_light
// module, which finds disparities along rows, measures the same): the other side of scripts/bench structured-light.
//   bench-structured-light make FOLDER         left/0.png to right/45.png, rig.json
//   bench-structured-light errors FOLDER PLY   prints the root mean square distance from the plane, mm, and of how many
//   bench-structured-light opencv FOLDER       the same of OpenCV's own path, and before it its seconds
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/structured_light.hpp>

#include "base/atomic_file.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/text.h"
#include "io/codes.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/projection.h"
#include "scan/sequence.h"
#include "stats/intervals.h"

namespace {

using namespace gonio;

constexpr int width = 3488, height = 2616, frames = 46;
constexpr double f_px = 4000, base_m = 0.12, distance_m = 0.9, tilt = 0.1, projector_f_px = 2200;
constexpr scan::Axis both[] = {scan::Axis::column, scan::Axis::row};

// The plane z = distance + tilt x; cameras at x = -base / 2 and base / 2, the projector in the middle.
double depth_at(int side, double x) {
  const double a = (x - 0.5 * (width - 1)) / f_px, at = (side - 0.5) * base_m;
  return (distance_m + tilt * at) / (1 - tilt * a);
}
double off_plane(Vec3 p) {
  return (distance_m + tilt * p.x - p.z) / std::sqrt(1 + tilt * tilt);
}

void make(const std::filesystem::path& folder) {
  const scan::Sequence sequence = scan::gray_sequence(1920, 1080, both);
  for (int side = 0; side < 2; ++side) {
    const auto into = folder / (side == 0 ? "left" : "right");
    make_folder(into);
    parallel_for(0, frames, [&](std::size_t f) {
      Random random(static_cast<std::uint64_t>(side), f);
      io::Image picture(width, height, {"Y"});
      for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x) {
          const double z = depth_at(side, x), a = (x - 0.5 * (width - 1)) / f_px, b = (y - 0.5 * (height - 1)) / f_px,
                       at = (side - 0.5) * base_m + a * z;
          const int u = static_cast<int>(std::lround(projector_f_px * at / z + 959.5)),
                    v = static_cast<int>(std::lround(projector_f_px * b + 539.5));
          const bool lit = u >= 0 && v >= 0 && u < 1920 && v < 1080;
          const double light = 0.06 + (lit ? 0.7 * scan::light_at(sequence, f, u, v) : 0);
          picture.at(x, y, 0) = static_cast<float>(std::clamp(light + 0.008 * random.normal(), 0.0, 1.0));
        }
      io::write_png(into / format("%zu.png", f), picture, 8);
    });
  }
  manifest::Document d = manifest::parse_document(
      format(
          R"({"gonio": 1, "cameras": {"left": {"width_px": %d, "height_px": %d, "fx_px": %g, "fy_px": %g, "cx_px": %g,
        "cy_px": %g}, "right": {"width_px": %d, "height_px": %d, "fx_px": %g, "fy_px": %g, "cx_px": %g, "cy_px": %g}},
        "rigs": {"rig": {"cameras": [{"camera": "left", "rig_from_camera": {"rotation": [1, 0, 0, 0], "translation_m":
        [%g, 0, 0]}}, {"camera": "right", "rig_from_camera": {"rotation": [1, 0, 0, 0], "translation_m": [%g, 0, 0]}}]}}})",
          width, height, f_px, f_px, 0.5 * (width - 1), 0.5 * (height - 1), width, height, f_px, f_px,
          0.5 * (width - 1), 0.5 * (height - 1), -base_m / 2, base_m / 2),
      "rig", folder);
  d.projections["gray"] = scan::projection_of(sequence);
  write_file(folder / "rig.json", manifest::print_document(d, folder));
}

// Those beyond 20 mm are no measurement of the plane and are counted apart.
void print_errors(const std::vector<Vec3>& points) {
  double squares = 0;
  std::size_t near = 0;
  for (const Vec3 p : points)
    if (std::abs(off_plane(p)) < 0.02) squares += off_plane(p) * off_plane(p), ++near;
  std::printf("%.4f %zu %zu\n", 1e3 * std::sqrt(squares / static_cast<double>(near)), near, points.size() - near);
}

void opencv(const std::filesystem::path& folder) {
  cv::setNumThreads(2);
  const auto start = std::chrono::steady_clock::now();
  cv::structured_light::GrayCodePattern::Params size;
  size.width = 1920, size.height = 1080;
  const auto pattern = cv::structured_light::GrayCodePattern::create(size);
  pattern->setWhiteThreshold(5), pattern->setBlackThreshold(40);
  std::vector<std::vector<cv::Mat>> shown(2);
  std::vector<cv::Mat> white(2), black(2);
  for (std::size_t c = 0; c < 2; ++c)
    for (int f = 0; f < frames; ++f) {
      const cv::Mat read = cv::imread((folder / (c == 0 ? "left" : "right") / format("%d.png", f)).string(), 0);
      if (f < 44)
        shown[c].push_back(read);
      else
        (f == 44 ? white : black)[c] = read;
    }
  cv::Mat disparity;
  pattern->decode(shown, disparity, black, white, cv::structured_light::DECODE_3D_UNDERWORLD);
  const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  std::vector<Vec3> points;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const double d = std::abs(disparity.at<double>(y, x));
      if (!(d > 1)) continue;
      const double z = f_px * base_m / d;
      points.push_back({(x - 0.5 * (width - 1)) / f_px * z - base_m / 2, (y - 0.5 * (height - 1)) / f_px * z, z});
    }
  std::printf("%.3f ", seconds);
  print_errors(points);
}

}  // namespace

int main(int count, char** words) {
  const std::string what = count > 2 ? words[1] : "";
  if (what == "make")
    make(words[2]);
  else if (what == "errors" && count > 3)
    print_errors(io::read_ply(words[3]).positions_m);
  else if (what == "opencv")
    opencv(words[2]);
  else
    return std::fprintf(stderr, "usage: bench-structured-light make FOLDER | errors FOLDER PLY | opencv FOLDER\n"), 64;
  return 0;
}
