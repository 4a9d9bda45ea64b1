// scripts/proofs/calib-corners: corners in supersampled photographs against the truth, over boards, lenses, sizes of
// squares and blurs; and whole calibrations from photographs, whose focal lengths must lie within their intervals.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "base/atomic_file.h"
#include "camera/corner_detection.h"
#include "camera/synthetic_board.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"

namespace gonio::camera {
namespace {

constexpr double required_bias_px = 0.02;
constexpr int least_corners = 30;

struct Case {
  const char* name;
  BoardKind kind;
  bool legacy;
};

double worst_bias(const Case& what) {
  constexpr int width = 640, height = 480;
  constexpr double f = 700;
  const Lens lenses[] = {{f, f, 319.5, 239.5},
                         {f, f, 319.5, 239.5, -0.28},
                         {f, f, 319.5, 239.5, -0.45, 0.1, 0.001, -0.002, 0.02, -0.02, 0.1, 0.01}};
  double worst = 0;
  for (std::size_t l = 0; l < 3; ++l) {
    for (const double square_px : {20.0, 45.0, 100.0}) {
      for (const double blur_px : {0.5, 1.0, 1.5}) {
        const int columns = square_px < 30   ? 13
                            : square_px < 60 ? 8
                                             : 4,
                  rows = square_px < 30   ? 10
                         : square_px < 60 ? 6
                                          : 4;
        Board board{what.kind, columns, rows - rows % 2 + 1, 0.03, 0, "", {}};
        if (what.kind == BoardKind::charuco) {
          board.marker_m = 0.022;
          board.dictionary = square_px < 30 ? "4X4_1000" : "5X5_1000";
          board.legacy = what.legacy;
        }
        Vec2 sum;
        int n = 0;
        for (const Vec3 turn : {Vec3{0.03, -0.02, 0.05}, Vec3{0.5, 0.25, -0.4}, Vec3{-0.35, 0.55, 0.9}}) {
          const BoardPose pose = pose_at(board, turn, f * 0.03 / square_px * (square_px > 60 ? 1.25 : 1));
          const io::Image picture = photograph(board, lenses[l], pose, width, height, {blur_px, 0.01, 8, 5});
          for (const Corner& corner : detect_board(picture, board, {}).corners) {
            const Vec2 at = board.corner_m(corner.id);
            sum = sum + corner.pixel - lenses[l].pixel(pose * Vec3{at.x, at.y, 0});
            ++n;
          }
        }
        if (n < least_corners) {  // too few to know a mean to hundredths of a pixel
          std::printf("corners, %s: lens %zu, squares of %.0f px, blur %.1f px: %d corners found, not judged\n",
                      what.name, l, square_px, blur_px, n);
          continue;
        }
        worst = std::max({worst, std::abs(sum.x / n), std::abs(sum.y / n)});
      }
    }
  }
  return worst;
}

// Twenty photographs through the program itself: by how many of its sigmas the focal length is off.
double focal_error_sigmas(std::uint64_t seed, const std::string& folder) {
  constexpr int width = 640, height = 480;
  const Lens lens{640, 642, 322.3, 236.8, -0.2, 0.08, 0.0005, -0.0004, 0};
  const Board board{BoardKind::charuco, 10, 7, 0.025, 0.018, "4X4_100", {}};
  Random random(seed);
  std::string command =
      GONIO_BIN "/calib-charuco --log-level error --charuco 11x8 --square 25mm --marker 18mm --dictionary 4X4_100";
  for (int view = 0; view < 20; ++view) {
    const double tilt = random.uniform(0.1, 0.7), azimuth = random.uniform(0, 6.283);
    const BoardPose pose =
        pose_at(board, {tilt * std::cos(azimuth), tilt * std::sin(azimuth), random.uniform(-0.5, 0.5)},
                random.uniform(0.3, 0.45), {random.uniform(-0.3, 0.3), random.uniform(-0.3, 0.3)});
    const std::string file = folder + "/v" + std::to_string(view) + ".png";
    io::write_picture(
        file, photograph(board, lens, pose, width, height, {0.8, 0.01, 6, seed * 100 + static_cast<unsigned>(view)}));
    command += " " + file;
  }
  const std::string out = folder + "/camera.json";
  if (std::system((command + " >" + out).c_str()) < 0) return 1e9;
  const manifest::Document document = manifest::read_document(out, {.allow_outside = true});
  const manifest::Camera& camera = document.cameras.begin()->second;
  return (camera.fx_px.scalar() - lens.fx) / camera.sigma.at("fx_px").at(0);
}

bool prove(int repeats) {
  bool good = true;
  for (const Case& what : {Case{"checkerboard", BoardKind::checkerboard, false},
                           Case{"ChArUco, current layout", BoardKind::charuco, false},
                           Case{"ChArUco, legacy layout", BoardKind::charuco, true}}) {
    const double worst = worst_bias(what);
    std::printf("corner bias, %s: measured %.4f px required < %.2f px\n", what.name, worst, required_bias_px);
    good = good && worst < required_bias_px;
  }
  std::string folder = "/tmp/gonio-prove-XXXXXX";
  if (::mkdtemp(folder.data()) == nullptr) return false;
  double sum = 0, largest = 0;
  for (int k = 0; k < repeats; ++k) {
    const double z = focal_error_sigmas(static_cast<std::uint64_t>(k) + 1, folder);
    sum += z * z;
    largest = std::max(largest, std::abs(z));
  }
  std::filesystem::remove_all(folder);
  // Chance leaves the largest of a handful of normal numbers below 3.5 in more than 99 % of cases.
  std::printf(
      "focal length from 20 photographs, %d times: measured %.2f sigmas rms, %.2f at most, required < 3.5 at most\n",
      repeats, std::sqrt(sum / repeats), largest);
  return good && largest < 3.5;
}

}  // namespace
}  // namespace gonio::camera

int main(int argc, char** argv) {
  return gonio::camera::prove(argc > 1 ? std::atoi(argv[1]) : 5) ? 0 : 1;
}
