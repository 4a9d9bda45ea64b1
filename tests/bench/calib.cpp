// scripts/bench calib: the same photographs through calib-charuco and through OpenCV as its tutorials use it.
//
//   bench-calib render FOLDER png|jpg   40 photographs of 8 MP with all that photographs have, of a camera that is known
//   bench-calib plain FOLDER images|opencv   the plain path: where its two threads go; prints fx fy cx cy k1 k2 p1 p2 k3
//   bench-calib recode FOLDER FOLDER png|jpg|tif   the same photographs in another format
//   bench-calib judge MANIFEST|-   how far a camera predicts off in views that were not used: of a manifest, or of
//                                      nine numbers from standard input
//
// Held-out error: the true pixels of corners in 30 other views; the pose is fitted with the judged camera, what remains
// is its error. Root mean square, px.
#include <cmath>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <iostream>
#include <numbers>
#include <opencv2/aruco/charuco.hpp>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgcodecs.hpp>
#include <thread>

#include "../camera/synthetic_board.h"
#include "base/error.h"
#include "camera/intrinsics.h"
#include "manifest/document.h"

namespace gonio::camera {
namespace {

constexpr int width = 3264, height = 2448, pictures = 40, held_out = 30;
const Lens lens{2850, 2853, 1640.7, 1211.3, -0.18, 0.11, 0.0004, -0.0003, -0.02};
const Board board{BoardKind::charuco, 11, 8, 0.03, 0.022, "5X5_100", {}};

BoardPose pose_of(std::uint64_t stream) {
  Random random(2026, stream);
  const double tilt = random.uniform(0, 0.65), azimuth = random.uniform(0, 2 * std::numbers::pi);
  return pose_at(board, {tilt * std::cos(azimuth), tilt * std::sin(azimuth), random.uniform(-0.4, 0.4)},
                 random.uniform(0.42, 0.75), {random.uniform(-0.35, 0.35), random.uniform(-0.35, 0.35)});
}

// A desk with patches of many sizes around the sheet, in the plane of the board.
double desk(Vec2 at) {
  double value = 0.45;
  for (const double cell : {0.11, 0.031, 0.0083}) {
    const auto x = static_cast<std::uint64_t>(std::llround(at.x / cell) + 100000);
    const auto y = static_cast<std::uint64_t>(std::llround(at.y / cell) + 100000);
    const double h = static_cast<double>(split_mix(x * 1000003 + y) >> 11) * 0x1p-53;
    if (h < 0.55) value += (h / 0.55 - 0.5) * 0.6;
  }
  return std::fmin(std::fmax(value, 0.03), 0.95);
}

void render(const std::filesystem::path& folder, const std::string& format, int index) {
  const Pattern pattern(board);
  constexpr double margin_m = 0.015;
  const double right = board.square_columns() * board.square_m, bottom = board.square_rows() * board.square_m;
  const auto seen = [&](Vec2 at) {
    const bool on_sheet =
        at.x > -margin_m && at.y > -margin_m && at.x < right + margin_m && at.y < bottom + margin_m;
    return on_sheet ? pattern.reflectance(at) : desk(at);
  };
  const Exposure exposure{0.9, 0.01, 4, static_cast<std::uint64_t>(index) + 1};
  std::vector<float> picture = expose(seen, lens, pose_of(static_cast<std::uint64_t>(index)), width, height, exposure);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const double r2 = (std::pow(x - lens.cx, 2) + std::pow(y - lens.cy, 2)) / (lens.fx * lens.fx);
      picture[static_cast<std::size_t>(y) * width + x] *= static_cast<float>(1 / ((1 + r2) * (1 + r2)));  // cos^4
    }
  }
  const io::Image image = developed(picture, width, height, exposure);
  cv::Mat codes(height, width, CV_8U);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) codes.at<unsigned char>(y, x) = static_cast<unsigned char>(std::lround(255 * image.at(x, y, 0)));
  }
  char name[32];
  std::snprintf(name, sizeof name, "view%02d.%s", index, format.c_str());
  cv::imwrite((folder / name).string(), codes, {cv::IMWRITE_PNG_COMPRESSION, 3, cv::IMWRITE_JPEG_QUALITY, 95});
}

template <class Body>
void in_two_threads(int count, const Body& body) {
  std::thread other([&] {
    for (int i = 1; i < count; i += 2) body(i);
  });
  for (int i = 0; i < count; i += 2) body(i);
  other.join();
}

int plain(const std::filesystem::path& folder, bool over_images) {
  std::vector<std::string> files;
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().filename().string().starts_with("view")) files.push_back(entry.path().string());
  }
  std::sort(files.begin(), files.end());
  const auto dictionary = cv::aruco::getPredefinedDictionary(cv::aruco::DICT_5X5_100);
  const auto peer_board = cv::aruco::CharucoBoard::create(board.square_columns(), board.square_rows(),
                                                          static_cast<float>(board.square_m),
                                                          static_cast<float>(board.marker_m), dictionary);
  const std::size_t n = files.size();
  std::vector<std::vector<cv::Point2f>> pixels(n);
  std::vector<std::vector<cv::Point3f>> points(n);
  const auto look = [&](int index) {
    const auto i = static_cast<std::size_t>(index);
    const cv::Mat image = cv::imread(files[i], cv::IMREAD_GRAYSCALE);
    std::vector<std::vector<cv::Point2f>> corners;
    std::vector<int> ids, corner_ids;
    cv::aruco::detectMarkers(image, dictionary, corners, ids);
    if (ids.empty()) return;
    cv::aruco::interpolateCornersCharuco(corners, ids, image, peer_board, pixels[i], corner_ids);
    for (const int id : corner_ids) points[i].push_back(peer_board->chessboardCorners[static_cast<std::size_t>(id)]);
  };
  cv::setNumThreads(over_images ? 1 : 2);
  if (over_images) in_two_threads(static_cast<int>(n), look);
  else for (std::size_t i = 0; i < n; ++i) look(static_cast<int>(i));
  cv::setNumThreads(2);
  for (std::size_t i = n; i-- > 0;) {
    if (pixels[i].size() >= 6) continue;
    pixels.erase(pixels.begin() + static_cast<std::ptrdiff_t>(i));
    points.erase(points.begin() + static_cast<std::ptrdiff_t>(i));
  }
  cv::Mat camera, distortion;
  std::vector<cv::Mat> rotations, translations;
  const double rms = cv::calibrateCamera(points, pixels, {width, height}, camera, distortion, rotations, translations);
  std::fprintf(stderr, "plain OpenCV: %zu views, rms %.3f px\n", pixels.size(), rms);
  std::printf("%.12g %.12g %.12g %.12g", camera.at<double>(0, 0), camera.at<double>(1, 1), camera.at<double>(0, 2),
              camera.at<double>(1, 2));
  for (int k = 0; k < 5; ++k) std::printf(" %.12g", distortion.at<double>(k));
  std::printf("\n");
  return 0;
}

int recode(const std::filesystem::path& from, const std::filesystem::path& to, const std::string& format) {
  std::filesystem::create_directories(to);
  for (const auto& entry : std::filesystem::directory_iterator(from)) {
    const cv::Mat codes = cv::imread(entry.path().string(), cv::IMREAD_GRAYSCALE);
    cv::imwrite((to / entry.path().stem()).string() + "." + format, codes,
                {cv::IMWRITE_JPEG_QUALITY, 95, cv::IMWRITE_TIFF_COMPRESSION, 1});
  }
  return 0;
}

std::vector<double> nine_of_manifest(const std::filesystem::path& path) {
  const manifest::Document document = manifest::read_document(path, {.allow_outside = true});
  const Intrinsics found = intrinsics_of(*find_camera(document, names_in(document, "cameras").front()), "cameras");
  std::vector<double> nine{found.fx_px, found.fy_px, found.cx_px, found.cy_px};
  for (const char* name : {"k1", "k2", "p1", "p2", "k3"}) nine.push_back(found.distortion[distortion_index(name, "")]);
  return nine;
}

int judge(const std::string& which) {
  std::vector<double> c(9);
  if (which != "-") c = nine_of_manifest(which);
  else for (double& v : c) std::cin >> v;
  const cv::Matx33d camera(c[0], 0, c[2], 0, c[1], c[3], 0, 0, 1);
  const std::vector<double> distortion(c.begin() + 4, c.end());
  double sum = 0;
  int n = 0;
  for (std::uint64_t view = 0; view < held_out; ++view) {
    const BoardPose pose = pose_of(1000 + view);
    std::vector<cv::Point3d> points;
    std::vector<cv::Point2d> pixels, predicted;
    for (int id = 0; id < board.corners(); ++id) {
      const Vec2 at = board.corner_m(id);
      const Vec2 pixel = lens.pixel(pose * Vec3{at.x, at.y, 0});
      if (pixel.x < 0 || pixel.y < 0 || pixel.x > width - 1 || pixel.y > height - 1) continue;
      points.emplace_back(at.x, at.y, 0);
      pixels.emplace_back(pixel.x, pixel.y);
    }
    cv::Vec3d rotation, translation;
    cv::solvePnP(points, pixels, camera, distortion, rotation, translation);
    cv::solvePnPRefineLM(points, pixels, camera, distortion, rotation, translation);
    cv::projectPoints(points, rotation, translation, camera, distortion, predicted);
    for (std::size_t i = 0; i < pixels.size(); ++i) {
      const cv::Point2d e = predicted[i] - pixels[i];
      sum += e.dot(e);
      ++n;
    }
  }
  std::printf("%.5f\n", std::sqrt(sum / n));
  return 0;
}

}  // namespace
}  // namespace gonio::camera

int main(int argc, char** argv) try {
  using namespace gonio::camera;
  const std::vector<std::string> words(argv, argv + argc);
  if (argc == 4 && words[1] == "render") {
    in_two_threads(pictures, [&](int i) { render(words[2], words[3], i); });
    return 0;
  }
  if (argc == 4 && words[1] == "plain") return plain(words[2], words[3] == "images");
  if (argc == 5 && words[1] == "recode") return recode(words[2], words[3], words[4]);
  if (argc == 3 && words[1] == "judge") return judge(words[2]);
  std::fprintf(stderr, "usage: bench-calib render FOLDER png|jpg | plain FOLDER images|opencv | judge MANIFEST|-\n");
  return 64;
} catch (const gonio::Error& e) {
  std::fprintf(stderr, "bench-calib: %s\n", e.what());
  return 65;
}
