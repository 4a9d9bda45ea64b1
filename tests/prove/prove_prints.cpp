// scripts/proofs/print-hemisphere: a hemisphere is sliced for the thesis's printer without a structure and with noise
// of three amplitudes, printed in simulation, and rendered; how long is its highlight for its width?
//
// The highlight lies on a slope of 30 degrees, light and eye 25 degrees to either side of the normal there. Steps of
// layers run around the pole: they turn normals up and down the slope, and draw the highlight out along it. The figure:
// standard deviation of the light above a fifth of the peak along the slope, over that across it, as seen, divided by
// the same of the sphere itself. 1: no step is seen.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <filesystem>
#include <string>
#include <vector>

#include "base/atomic_file.h"
#include "base/text.h"
#include "geom/vector.h"
#include "io/picture.h"
#include "process.h"

namespace {

using namespace gonio;
namespace fs = std::filesystem;

constexpr double radius_mm = 1.6, slope = 30 * pi / 180, half = 25 * pi / 180, away_m = 0.3;
constexpr int picture_px = 240;

std::string hemisphere_obj() {
  constexpr int around = 256, down = 64;
  std::string text = format("v 0 0 %.9g\n", radius_mm);
  for (int j = 1; j <= down; ++j)
    for (int i = 0; i < around; ++i) {
      const double t = pi / 2 * j / down, p = 2 * pi * i / around;
      text += format("v %.9g %.9g %.9g\n", radius_mm * std::sin(t) * std::cos(p), radius_mm * std::sin(t) * std::sin(p),
                     j < down ? radius_mm * std::cos(t) : 0);
    }
  text += "v 0 0 0\n";
  const auto at = [](int j, int i) { return 2 + (j - 1) * around + i % around; };
  for (int i = 0; i < around; ++i) text += format("f 1 %d %d\n", at(1, i), at(1, i + 1));
  for (int j = 1; j < down; ++j)
    for (int i = 0; i < around; ++i)
      text += format("f %d %d %d %d\n", at(j, i), at(j + 1, i), at(j + 1, i + 1), at(j, i + 1));
  for (int i = 0; i < around; ++i) text += format("f %d %d %d\n", down * around + 2, at(down, i + 1), at(down, i));
  return text;
}

const char* printer = R"({"gonio": 1, "prints": {"thesis": {"pixel_m": [1.508e-5, 1.508e-5], "width_px": 2560,
  "height_px": 1600, "layer_m": 1.8e-5, "growth": {"alpha_m": 1.771e-5, "beta_m": 1.024e-5, "gamma": -0.01},
  "bleed": {"sigma_m": 6e-6}, "overcure_m": 1.024e-5}}})";

// A camera that looks along z = target - eye, x across the slope.
std::string matrix(Vec3 eye, Vec3 target) {
  const Vec3 z = (target - eye) / norm(target - eye), n{std::sin(slope), 0, std::cos(slope)};
  const Vec3 side = cross(n, cross({0, 0, 1}, n)), along = (side - z * dot(side, z)) / norm(side - z * dot(side, z));
  const Vec3 y = along * -1.0, x = cross(y, z);
  return format("[[%.12g,%.12g,%.12g,%.12g],[%.12g,%.12g,%.12g,%.12g],[%.12g,%.12g,%.12g,%.12g],[0,0,0,1]]", x.x, y.x,
                z.x, eye.x, x.y, y.y, z.y, eye.y, x.z, y.z, z.z, eye.z);
}

std::string scene(const std::string& ply) {
  const Vec3 n{std::sin(slope), 0, std::cos(slope)}, side{0, 1, 0};
  const Vec3 target = n * (radius_mm * 1e-3), eye = target + (n * std::cos(half) + side * std::sin(half)) * away_m;
  const Vec3 light = n * std::cos(half) - side * std::sin(half);
  const double f = picture_px * away_m / (1.5 * radius_mm * 1e-3), c = (picture_px - 1) / 2.0;
  return format(
      R"({"gonio": 1, "files": {"m": {"path": "%s"}},
 "cameras": {"c": {"model": "pinhole", "width_px": %d, "height_px": %d, "fx_px": %.9g, "fy_px": %.9g,
                   "cx_px": %g, "cy_px": %g}},
 "meshes": {"m": {"file": "m"}}, "surfaces": {"s": {"model": "beckmann-conductor", "alpha": 0.12, "eta": 1.5, "k": 4}},
 "lights": {"l": {"model": "directional", "towards": [%.9g, %.9g, %.9g], "watt_per_m2": 1}},
 "objects": [{"id": "o", "mesh": "m", "surface": "s"}],
 "images": [{"id": "i", "camera": "c", "light": "l", "world_from_camera": {"matrix": %s}}]})",
      ply.c_str(), picture_px, picture_px, f, f, c, c, light.x, light.y, light.z, matrix(eye, target).c_str());
}

void must(const tests::Ended& ended, const char* what) {
  if (ended.status == 0) return;
  std::fprintf(stderr, "%s: %s\n", what, ended.err.c_str());
  std::exit(1);
}

struct Highlight {
  double along = 0, across = 0, peak = 0;
};
Highlight highlight_of(const fs::path& exr) {
  const io::Image image = io::read_picture(exr);
  // The peak of the picture as an eye sees it that does not see single facets: means over 9 x 9 pixels.
  const auto mean = [&](int x, int y) {
    double sum = 0;
    for (int j = -4; j <= 4; ++j)
      for (int i = -4; i <= 4; ++i)
        sum += static_cast<double>(
            image.at(std::clamp(x + i, 0, image.width - 1), std::clamp(y + j, 0, image.height - 1), 1));
    return sum / 81;
  };
  std::vector<double> light(image.pixels());
  double peak = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x)
      peak = std::max(peak, light[static_cast<std::size_t>(y * image.width + x)] = mean(x, y));
  double n = 0, sx = 0, sy = 0, sxx = 0, syy = 0;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const double w = std::max(0.0, light[static_cast<std::size_t>(y * image.width + x)] - peak / 5);
      n += w, sx += w * x, sy += w * y, sxx += w * x * x, syy += w * y * y;
    }
  return {std::sqrt(syy / n - sy * sy / (n * n)), std::sqrt(sxx / n - sx * sx / (n * n)), peak};
}

Highlight rendered(const fs::path& folder, const std::string& ply, const std::string& name) {
  write_file(folder / (name + ".json"), scene(ply));
  must(tests::run({"render", name + ".json", "--spp", "64", "--out", name, "--force", "-o", name + "-r.json"}, folder),
       "render");
  for (const auto& entry : fs::directory_iterator(folder / name))
    if (entry.path().extension() == ".exr") return highlight_of(entry.path());
  std::fprintf(stderr, "render wrote no picture\n");
  std::exit(1);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 64;
  const fs::path folder = argv[1];
  fs::create_directories(folder);
  write_file(folder / "hemisphere.obj", hemisphere_obj());
  write_file(folder / "printer.json", printer);
  std::string plain = printer;
  const std::size_t growth = plain.find("\"growth\""), bleed = plain.find("\"bleed\"");
  write_file(folder / "plain.json", plain.erase(growth, bleed - growth));
  struct Row {
    const char *name, *structure;
  };
  std::vector<double> ratios, peaks;
  double own = 0, brightest = 0;
  std::printf("structure        greys         along / px   across / px   anisotropy   peak\n");
  for (const char* greys : {"by-growth", "in-proportion"})
    for (const Row& row :
         {Row{"none", ""}, Row{"A=0.625", "noise:amplitude=0.625,frequency=32"},
          Row{"A=2", "noise:amplitude=2,frequency=32"}, Row{"A=3", "noise:amplitude=3,frequency=32"}}) {
      const std::string name = std::string(row.name) + "-" + greys;
      const bool known = std::string(greys) == "by-growth";
      tests::Process::Words words{"dlp-slice",     "hemisphere.obj",
                                  "--unit",        "mm",
                                  "--printer",     known ? "printer.json" : "plain.json",
                                  "--out",         "print-" + name,
                                  "--force",       "--log-level",
                                  "error",         "-o",
                                  name + "-s.json"};
      if (*row.structure) words.insert(words.end(), {"--structure", row.structure});
      must(tests::run(words, folder), "dlp-slice");
      must(tests::run({"dlp-slice", "--sent", "print-" + name + "/layers.zip", "--printer", "printer.json", "--points",
                       "2", "--out", "cured-" + name, "--force", "--log-level", "error", "-o", name + "-p.json"},
                      folder),
           "dlp-slice --sent");
      if (own == 0) {
        const Highlight sphere = rendered(folder, "print-" + name + "/hemisphere.ply", "sphere");
        own = sphere.along / sphere.across, brightest = sphere.peak;
        std::printf("%-16s %-13s %10.1f %12.1f %12.2f %8.2f\n", "the sphere", "", sphere.along, sphere.across, 1.0,
                    1.0);
      }
      const Highlight h = rendered(folder, "cured-" + name + "/predicted.ply", name);
      ratios.push_back(h.along / h.across / own), peaks.push_back(h.peak / brightest);
      std::printf("%-16s %-13s %10.1f %12.1f %12.2f %8.2f\n", row.name, greys, h.along, h.across, ratios.back(),
                  peaks.back());
      std::fflush(stdout);
    }
  const bool nearer = std::abs(ratios[5] - 1) < std::abs(ratios[4] - 1);
  const bool dimmer = peaks[5] > peaks[6] && peaks[6] > peaks[7];
  std::printf(
      "print-hemisphere: greys in proportion: anisotropy of the highlight %.2f without noise, %.2f with A = 0.625 "
      "(nearer to 1 required)%s\n",
      ratios[4], ratios[5], nearer ? "" : ": NOT");
  std::printf("print-hemisphere: the highlight gets dimmer from A = 0.625 to 3: %.2f, %.2f, %.2f%s\n", peaks[5],
              peaks[6], peaks[7], dimmer ? "" : ": NOT");
  std::printf("print-hemisphere: greys by growth: %.2f without noise\n", ratios[0]);
  return nearer && dimmer ? 0 : 1;
}
