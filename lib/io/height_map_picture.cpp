// Pictures as height maps: OpenEXR through io/exr.h, TIFF of 32-bit floats or 16-bit codes through OpenCV.
#include <cstdio>
#include <cstdlib>
#include <opencv2/core.hpp>
#include <opencv2/imgcodecs.hpp>

#include "base/atomic_file.h"
#include "io/exr.h"
#include "io/height_map.h"
#include "io/height_map_checks.h"
#include "io/opencv_codecs.h"
#include "io/raster_header.h"

namespace gonio::io {
namespace {

double step(double given, const std::string& own, const char* axis, const std::string& place) {
  if (given > 0) return checked_step(given, axis, place);
  if (own.empty())
    throw Error(Exit::data, place, std::string("does not say how far its points lie apart along ") + axis,
                "state it: --step 1.6um; in a manifest reliefs/NAME/step_m");
  return checked_step(std::strtod(own.c_str(), nullptr), axis, place);
}

HeightMap of_exr(std::string_view file, const std::string& place, const HeightPicture& p) {
  const std::string bytes(file);
  const ExrAttributes texts = exr_attributes(bytes, place);
  const auto text = [&](const char* name) {
    const auto found = texts.find(name);
    return found == texts.end() ? std::string() : found->second;
  };
  const Image image = decode_exr(bytes, place);
  check_map_size(image.width, image.height, place);
  const int channel = !p.channel.empty()           ? image.channel(p.channel)
                      : image.channels.size() == 1 ? 0
                                                   : image.channel("Z");
  if (channel < 0)
    throw Error(Exit::data, place,
                p.channel.empty() ? "has " + std::to_string(image.channels.size()) + " channels and none named Z"
                                  : "has no channel \"" + p.channel + "\"",
                "name the one that holds the heights: --channel NAME");
  HeightMap map{static_cast<std::size_t>(image.width),
                static_cast<std::size_t>(image.height),
                step(p.step_x_m, text("step_x_m"), "x", place),
                step(p.step_y_m, text("step_y_m"), "y", place),
                {}};
  const double unit = p.unit_m > 0 ? p.unit_m : 1;
  for (int y = 0; y < image.height; ++y)
    for (int x = 0; x < image.width; ++x) {
      const auto z = static_cast<double>(image.at(x, y, channel));
      map.z_m.push_back(std::isfinite(z) ? z * unit : std::nan(""));
    }
  return map;
}

template <class Number>
void take(const cv::Mat& picture, double unit, HeightMap& map) {
  for (int y = 0; y < picture.rows; ++y)
    for (int x = 0; x < picture.cols; ++x) {
      const auto z = static_cast<double>(picture.ptr<Number>(y)[x]);
      map.z_m.push_back(std::isfinite(z) ? z * unit : std::nan(""));
    }
}

HeightMap of_tiff(std::string_view file, const std::string& place, const HeightPicture& p) {
  const std::string bytes(file);
  const RasterHeader header = read_raster_header(bytes, place);
  check_decoded_size(header.width, header.height, sizeof(float), bytes.size(), place);
  check_map_size(static_cast<std::int64_t>(header.width), static_cast<std::int64_t>(header.height), place);
  if (!(p.unit_m > 0))
    throw Error(Exit::data, place, "does not say what its numbers count",
                "state it: --unit um; in a manifest reliefs/NAME/unit_m");
  cv::Mat picture;
  try {
    decode_by_opencv(bytes, cv::IMREAD_UNCHANGED, picture);
  } catch (const cv::Exception&) {
  }
  if (picture.empty()) refuse_map(place, "cannot be decoded");
  if (picture.channels() != 1 || (picture.depth() != CV_32F && picture.depth() != CV_16U && picture.depth() != CV_64F))
    refuse_map(place, "is a TIFF of another kind than one channel of floats or of 16-bit codes");
  HeightMap map{static_cast<std::size_t>(picture.cols),
                static_cast<std::size_t>(picture.rows),
                step(p.step_x_m, "", "x", place),
                step(p.step_y_m, "", "y", place),
                {}};
  if (picture.depth() == CV_32F)
    take<float>(picture, p.unit_m, map);
  else if (picture.depth() == CV_64F)
    take<double>(picture, p.unit_m, map);
  else
    take<std::uint16_t>(picture, p.unit_m, map);
  return map;
}

std::string exactly(double value) {
  char text[32];
  std::snprintf(text, sizeof text, "%.17g", value);
  return text;
}

}  // namespace

HeightMap parse_height_picture(std::string_view file, const std::string& place, const HeightPicture& picture) {
  return file.starts_with("\x76\x2f") ? of_exr(file, place, picture) : of_tiff(file, place, picture);
}

void write_height_picture(const std::filesystem::path& path, const HeightMap& map) {
  Image image(static_cast<int>(map.width), static_cast<int>(map.height), {"Z"});
  for (std::size_t i = 0; i < map.z_m.size(); ++i) image.data[i] = static_cast<float>(map.z_m[i]);
  write_file(path, encode_exr(image, {{"step_x_m", exactly(map.step_x_m)}, {"step_y_m", exactly(map.step_y_m)}}));
}

}  // namespace gonio::io
