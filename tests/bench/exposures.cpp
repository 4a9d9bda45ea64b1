// Eleven exposures of 9 MP of 16 bit as one picture of radiance, beside OpenCV's 8-bit path (8 bit of each frame, its
// demosaicing, createMergeDebevec with a linear response) on the same files: the other side of scripts/bench exposures.
//   bench-exposures make FOLDER [SIDE]   a simulated sensor's frames, wall_1ms.png to wall_1024ms.png
//   bench-exposures own FOLDER           prints seconds: frames in memory to radiance; files to developed picture
//   bench-exposures opencv FOLDER OUT    the same of OpenCV, and with the picture written to OUT (.hdr)
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>

#include "base/atomic_file.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/text.h"
#include "io/codes.h"
#include "photograph/exposure_merge.h"
#include "photograph/frame_store.h"
#include "photograph/raw_view.h"

namespace {

using namespace gonio;
using Clock = std::chrono::steady_clock;

constexpr int frames = 11;
constexpr double black = 1024, full = 65535, electrons_per_code = 1, read_codes = 3;

double seconds_since(Clock::time_point start) {
  return std::chrono::duration<double>(Clock::now() - start).count();
}

std::filesystem::path file_of(const std::filesystem::path& folder, int k) {
  return folder / format("wall_%dms.png", 1 << k);
}
double exposure_of(int k) {
  return 1e-3 * (1 << k);
}

// Light over three decades, smooth, as RGGB; shot noise and read noise.
void make(const std::filesystem::path& folder, int side) {
  make_folder(folder);
  parallel_for(0, frames, [&](std::size_t k) {
    Random random(k + 1);
    io::Image frame(side, side, {"Y"});
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double rate =
            std::pow(10.0, 4.5 + 1.5 * std::sin(x / 300.0) * std::cos(y / 370.0)) * (1 + 0.3 * ((x & 1) + (y & 1)));
        const double mean = rate * exposure_of(static_cast<int>(k)),
                     sigma = std::sqrt(mean / electrons_per_code + read_codes * read_codes);
        frame.at(x, y, 0) = static_cast<float>((black + mean + sigma * random.normal()) / full);
      }
    io::write_png(file_of(folder, static_cast<int>(k)), frame, 16);
  });
}

photograph::RawView view_of(const std::filesystem::path& folder) {
  photograph::RawView view{"wall", {}, {}};
  for (int k = 0; k < frames; ++k)
    view.frames.push_back(file_of(folder, k)), view.exposures_s.push_back(exposure_of(k));
  return view;
}

int own(const std::filesystem::path& folder) {
  const photograph::RawView view = view_of(folder);
  photograph::RawRecipe recipe;
  recipe.stated.mosaic = "RGGB", recipe.stated.black = black;
  recipe.noise = manifest::Noise{electrons_per_code, read_codes};
  auto start = Clock::now();
  photograph::develop_view(view, recipe);
  const double whole = seconds_since(start);
  std::vector<photograph::StoredFrame> stored;
  for (const auto& path : view.frames) stored.push_back({path, recipe.stated});
  const photograph::FrameStore store(std::move(stored), std::size_t{1} << 30);
  photograph::MergeRequest request;
  request.width = store.head(0).width, request.height = store.head(0).height;
  request.read = [&](std::size_t k) { return photograph::RawPlane{store.codes(k), {}}; };
  request.read_rows = [&](std::size_t k, int first, int rows, photograph::RawPlane& into) {
    store.rows(k, first, rows, into.codes);
  };
  request.noise = *recipe.noise, request.full_scale = store.head(0).full_scale, request.floor = store.head(0).floor;
  for (int k = 0; k < frames; ++k) request.exposures_s.push_back(exposure_of(k));
  start = Clock::now();
  photograph::merge_exposures(request);
  std::printf("%.3f %.3f\n", seconds_since(start), whole);
  return 0;
}

int opencv(const std::filesystem::path& folder, const std::string& out) {
  cv::setNumThreads(2);
  const auto start = Clock::now();
  std::vector<cv::Mat> pictures;
  std::vector<float> times;
  for (int k = 0; k < frames; ++k) {
    cv::Mat eight, colours;
    cv::imread(file_of(folder, k).string(), cv::IMREAD_UNCHANGED).convertTo(eight, CV_8U, 255 / full);
    cv::cvtColor(eight, colours, cv::COLOR_BayerBG2BGR);  // OpenCV's name for RGGB
    pictures.push_back(colours), times.push_back(static_cast<float>(exposure_of(k)));
  }
  const auto merging = Clock::now();
  cv::Mat radiance;
  cv::createMergeDebevec()->process(pictures, radiance, times);
  const double merge = seconds_since(merging), whole = seconds_since(start);
  cv::imwrite(out, radiance);
  std::printf("%.3f %.3f %.3f\n", merge, whole, seconds_since(start));
  return 0;
}

}  // namespace

int main(int count, char** words) {
  const std::string what = count > 2 ? words[1] : "";
  set_threads(2);
  if (what == "make") return make(words[2], count > 3 ? std::atoi(words[3]) : 3000), 0;
  if (what == "own") return own(words[2]);
  if (what == "opencv" && count > 3) return opencv(words[2], words[3]);
  std::fprintf(stderr, "usage: bench-exposures make FOLDER [SIDE] | own FOLDER | opencv FOLDER OUT\n");
  return 64;
}
