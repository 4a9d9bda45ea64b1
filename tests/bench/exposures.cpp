// Eleven exposures of 9 MP of 16 bit as one picture of radiance, beside OpenCV's 8-bit path (8 bit of each frame, its
// demosaicing, createMergeDebevec with a linear response) on the same files: the other side of scripts/bench exposures.
//   bench-exposures make FOLDER [SIDE]   a simulated sensor's frames, wall_1ms.png to wall_1024ms.png
//   bench-exposures own FOLDER           prints seconds: frames in memory to radiance; files to developed picture
//   bench-exposures opencv FOLDER OUT    the same of OpenCV, and with the picture written to OUT (.hdr)
//   bench-exposures peer FOLDER OUT      the frames without black as OUT/wall_1ms.ppm ..., and OUT/list.hdrgen
//   bench-exposures errors FOLDER [EXR]  prints errors against the light that was simulated, by tens of light: gonio's,
//                                        OpenCV's, EXR's
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <functional>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/photo.hpp>

#include "base/atomic_file.h"
#include "base/parallel.h"
#include "base/random.h"
#include "base/text.h"
#include "io/codes.h"
#include "io/picture.h"
#include "photograph/exposure_merge.h"
#include "photograph/frame_store.h"
#include "photograph/raw_view.h"
#include "stats/intervals.h"

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

// Light over three decades, smooth, as RGGB: codes per second.
double rate_at(int x, int y) {
  return std::pow(10.0, 4.5 + 1.5 * std::sin(x / 300.0) * std::cos(y / 370.0)) * (1 + 0.3 * ((x & 1) + (y & 1)));
}

// With shot noise and read noise.
void make(const std::filesystem::path& folder, int side) {
  make_folder(folder);
  parallel_for(0, frames, [&](std::size_t k) {
    Random random(k + 1);
    io::Image frame(side, side, {"Y"});
    for (int y = 0; y < side; ++y)
      for (int x = 0; x < side; ++x) {
        const double mean = rate_at(x, y) * exposure_of(static_cast<int>(k)),
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

photograph::RawRecipe recipe_of_frames() {
  photograph::RawRecipe recipe;
  recipe.stated.mosaic = "RGGB", recipe.stated.black = black;
  recipe.noise = manifest::Noise{electrons_per_code, read_codes};
  return recipe;
}

// Frames that lie in memory, and what merges them.
struct InMemory {
  photograph::FrameStore store;
  photograph::MergeRequest request;
  explicit InMemory(const std::filesystem::path& folder) : store(stored(folder), std::size_t{1} << 30) {
    request.width = store.head(0).width, request.height = store.head(0).height;
    request.read = [this](std::size_t k) { return photograph::RawPlane{store.codes(k), {}}; };
    request.read_rows = [this](std::size_t k, int first, int rows, photograph::RawPlane& into) {
      store.rows(k, first, rows, into.codes);
    };
    request.noise = *recipe_of_frames().noise;
    request.full_scale = store.head(0).full_scale, request.floor = store.head(0).floor;
    for (int k = 0; k < frames; ++k) request.exposures_s.push_back(exposure_of(k));
  }
  static std::vector<photograph::StoredFrame> stored(const std::filesystem::path& folder) {
    std::vector<photograph::StoredFrame> all;
    for (const auto& path : view_of(folder).frames) all.push_back({path, recipe_of_frames().stated});
    return all;
  }
};

int own(const std::filesystem::path& folder) {
  auto start = Clock::now();
  photograph::develop_view(view_of(folder), recipe_of_frames());
  const double whole = seconds_since(start);
  const InMemory frames_there(folder);
  start = Clock::now();
  photograph::merge_exposures(frames_there.request);
  std::printf("%.3f %.3f\n", seconds_since(start), whole);
  return 0;
}

// A frame without black, 1 where it is full.
cv::Mat without_black(const std::filesystem::path& folder, int k) {
  cv::Mat linear;
  cv::imread(file_of(folder, k).string(), cv::IMREAD_UNCHANGED)
      .convertTo(linear, CV_64F, 1 / (full - black), -black / (full - black));
  return cv::max(linear, 0.0);
}

// In colour, as OpenEXR's makers and HDR programs take pictures; all colours are alike.
int peer(const std::filesystem::path& folder, const std::filesystem::path& out) {
  make_folder(out);
  std::string list;
  for (int k = 0; k < frames; ++k) {
    cv::Mat codes, colours;
    without_black(folder, k).convertTo(codes, CV_16U, full);
    cv::merge(std::vector<cv::Mat>{codes, codes, codes}, colours);
    const std::filesystem::path file = out / format("wall_%dms.ppm", 1 << k);
    cv::imwrite(file.string(), colours);
    list += format("%s %.17g 8 100 0\n", file.c_str(), 1 / exposure_of(k));
  }
  write_file(out / "list.hdrgen", list);
  return 0;
}

cv::Mat merged_by_opencv(const std::filesystem::path& folder) {
  std::vector<cv::Mat> pictures;
  std::vector<float> times;
  for (int k = 0; k < frames; ++k) {
    cv::Mat codes, colours;
    without_black(folder, k).convertTo(codes, CV_8U, 255);
    cv::merge(std::vector<cv::Mat>{codes, codes, codes}, colours);
    pictures.push_back(colours), times.push_back(static_cast<float>(exposure_of(k)));
  }
  cv::Mat radiance;
  cv::createMergeDebevec()->process(pictures, radiance, times);
  return radiance;
}

// Departures from the truth, over it, after the factor that fits best: root mean squares by tens of light.
void print_errors(const char* name, const std::function<double(int, int)>& merged, int width, int height) {
  std::vector<double> ratios;
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) ratios.push_back(merged(x, y) / rate_at(x, y));
  const double factor = stats::median(ratios);
  double sums[3] = {}, counts[3] = {}, off[3] = {};
  for (int y = 0, i = 0; y < height; ++y)
    for (int x = 0; x < width; ++x, ++i) {
      const int decade = std::clamp(static_cast<int>(std::log10(rate_at(x, y)) - 3), 0, 2);
      const double error = ratios[static_cast<std::size_t>(i)] / factor - 1;
      sums[decade] += error * error, off[decade] += error, ++counts[decade];
    }
  std::printf("%-22s", name);
  for (int d = 0; d < 3; ++d)
    std::printf("  %8.4f %% (%+.4f)", 100 * std::sqrt(sums[d] / counts[d]), 100 * off[d] / counts[d]);
  std::printf("\n");
}

int errors(const std::filesystem::path& folder, const std::string& exr) {
  InMemory there(folder);
  const int width = there.request.width, height = there.request.height;
  const auto print = [&](const char* name, const auto& merged) { print_errors(name, merged, width, height); };
  const auto print_own = [&](const char* name) {
    const photograph::MergedPlane m = photograph::merge_exposures(there.request);
    print(name, [&](int x, int y) { return double{m.rate[static_cast<std::size_t>(y * width + x)]}; });
  };
  std::printf("root mean square of relative errors (mean) at 10^3 to 10^4, to 10^5 and beyond, codes per second\n");
  print_own("gonio");
  there.request.blooming_px = 0;
  print_own("gonio, --blooming 0");
  const cv::Mat radiance = merged_by_opencv(folder);
  print("OpenCV, 8 bit", [&](int x, int y) { return double{radiance.at<cv::Vec3f>(y, x)[1]}; });
  if (exr.empty()) return 0;
  const io::Image picture = io::read_picture(exr);
  const int green = picture.channel("G");
  print("pfshdrcalibrate", [&](int x, int y) { return double{picture.at(x, y, green)}; });
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
  if (what == "peer" && count > 3) return peer(words[2], words[3]);
  if (what == "errors") return errors(words[2], count > 3 ? words[3] : "");
  std::fprintf(stderr,
               "usage: bench-exposures make FOLDER [SIDE] | own FOLDER | opencv FOLDER OUT | peer FOLDER OUT | errors "
               "FOLDER [EXR]\n");
  return 64;
}
