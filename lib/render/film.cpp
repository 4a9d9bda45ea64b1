#include "render/film.h"

#include <algorithm>
#include <array>
#include <sstream>

#include "render/passes.h"

namespace gonio::render {
namespace {

constexpr std::array<const char*, 3> rgb_suffix = {"R", "G", "B"};

std::vector<std::string> layer(const std::string& name) {
  std::vector<std::string> channels;
  for (const char* suffix : rgb_suffix) channels.push_back(name.empty() ? suffix : name + "." + suffix);
  return channels;
}

bool is_spectral(const std::string& plane) {
  return plane.find(' ') != std::string::npos && plane.starts_with('S');
}

// Fills one channel after the other.
class Sheet {
 public:
  Sheet(int width_px, int height_px) : image_(width_px, height_px, {}) {}
  void claim(const std::string& channel) { image_.channels.push_back(channel); }
  void claim(const std::vector<std::string>& channels) {
    for (const std::string& channel : channels) claim(channel);
  }
  void spread() { image_.data.resize(image_.pixels() * image_.channels.size()); }
  void begin(std::size_t pixel) { out_ = image_.data.data() + pixel * image_.channels.size(); }
  void put(double v) { *out_++ = static_cast<float>(v); }
  void put(Rgb v) { put(v.x), put(v.y), put(v.z); }
  void copy(const float* first, std::size_t count) { out_ = std::copy_n(first, count, out_); }
  io::Image take() { return std::move(image_); }

 private:
  io::Image image_;
  float* out_ = nullptr;
};

void put_plane(Sheet& sheet, const std::string& plane, Rgb value) {
  if (!is_spectral(plane)) return sheet.put(value);
  const std::array<double, 3> v = {value.x, value.y, value.z};
  for (std::size_t i = 0; i < plane_channels(plane).size(); ++i) sheet.put(v[i]);
}

bool from_sums(const std::string& channel) {
  return channel == "mask.A" || channel.starts_with("visibility.");
}

// Depth, positions, normals, ids and distances: channels of the geometry.
bool is_geometry(const std::string& channel) {
  static const std::array<const char*, 5> layers = {"position.", "normal.", "distance.", "depth.", "back_normal."};
  return channel == "id" || std::ranges::any_of(layers, [&](const char* l) { return channel.starts_with(l); });
}

}  // namespace

std::vector<std::string> plane_channels(const std::string& plane) {
  if (!is_spectral(plane)) return layer(plane);
  std::vector<std::string> channels;
  std::istringstream words(plane);
  for (std::string word; words >> word;)
    if (word != "-") channels.push_back(word);
  return channels;
}

io::Image develop(const PassSums& sums, const io::Image& geometry) {
  const PictureIdentity& what = sums.identity();
  const bool with_geometry = !geometry.channels.empty();
  Sheet sheet(what.width_px, what.height_px);
  for (const std::string& plane : what.planes) {
    sheet.claim(plane_channels(plane));
    if (keeps_variance(plane)) sheet.claim(layer(plane.empty() ? "variance" : "variance." + plane));
  }
  if (with_geometry) {
    sheet.claim(geometry.channels);
    for (const std::string& light : what.lights) sheet.claim("visibility." + light);
    sheet.claim("mask.A");
  }
  sheet.spread();
  for (std::size_t pixel = 0; pixel < sums.pixels(); ++pixel) {
    sheet.begin(pixel);
    for (std::size_t plane = 0; plane < what.planes.size(); ++plane) {
      put_plane(sheet, what.planes[plane], sums.mean(pixel, plane));
      if (keeps_variance(what.planes[plane])) sheet.put(sums.variance(pixel, plane));
    }
    if (!with_geometry) continue;
    sheet.copy(geometry.data.data() + pixel * geometry.channels.size(), geometry.channels.size());
    for (std::size_t light = 0; light < what.lights.size(); ++light) sheet.put(sums.seen(pixel, light));
    sheet.put(sums.met(pixel));
  }
  return sheet.take();
}

io::Image geometry_of(const io::Image& picture) {
  std::vector<std::size_t> places;
  io::Image image(picture.width, picture.height, {});
  for (std::size_t c = 0; c < picture.channels.size(); ++c)
    if (is_geometry(picture.channels[c]) && !from_sums(picture.channels[c])) {
      places.push_back(c);
      image.channels.push_back(picture.channels[c]);
    }
  image.data.reserve(picture.pixels() * places.size());
  for (std::size_t pixel = 0; pixel < picture.pixels(); ++pixel)
    for (const std::size_t c : places) image.data.push_back(picture.data[pixel * picture.channels.size() + c]);
  return image;
}

}  // namespace gonio::render
