// See response_patches.h.
#include "photograph/response_patches.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "base/text.h"
#include "io/codes.h"
#include "io/picture.h"

namespace gonio::photograph {
namespace {

constexpr double full = 255;
constexpr std::size_t most_places = 40000, heights = 32, of_a_height = 24;

struct Place {
  ResponsePatch patch;
  double brightness = 0, rough = 0;  // sum of codes; largest range of codes in an exposure
};

// What a channel reads in 3 x 3 pixels about (x, y).
struct Codes {
  double mean = 0, least = full, most = 0;
};
Codes codes_at(const io::Image& picture, int x, int y, int channel) {
  Codes c;
  for (int dy = -1; dy <= 1; ++dy)
    for (int dx = -1; dx <= 1; ++dx) {
      const double code = full * picture.at(x + dx, y + dy, channel);
      c.mean += code / 9, c.least = std::min(c.least, code), c.most = std::max(c.most, code);
    }
  return c;
}

class Gathering {
 public:
  ResponseData run(const std::vector<ResponseView>& views) {
    for (const ResponseView& view : views) add(view);
    for (std::vector<Place>& places : all_) data_.patches.push_back(chosen(places));
    return std::move(data_);
  }

 private:
  std::size_t time_of(double exposure_s, const std::string& place) {
    if (!(exposure_s > 0 && std::isfinite(exposure_s)))
      throw Error(Exit::data, place, format("is said to be exposed for %g s", exposure_s),
                  "state exposure_s in seconds");
    for (std::size_t k = 0; k < data_.times_s.size(); ++k)
      if (std::abs(data_.times_s[k] / exposure_s - 1) < 1e-6) return k;
    data_.times_s.push_back(exposure_s);
    return data_.times_s.size() - 1;
  }

  io::Image read(const std::filesystem::path& path, std::vector<int>& channels) {
    if (io::code_bits(path) == 0)
      throw Error(Exit::data, path.string(), "holds numbers that are linear already", "pictures of 8 or 16 bits");
    io::Image picture = io::read_picture(path);
    const bool colours = picture.channel("R") >= 0 && picture.channel("G") >= 0 && picture.channel("B") >= 0;
    if (!colours && picture.channel("Y") < 0)
      throw Error(Exit::data, path.string(), "has neither the channels R, G, B nor Y", "photographs");
    const std::vector<std::string> names =
        colours ? std::vector<std::string>{"R", "G", "B"} : std::vector<std::string>{"Y"};
    if (data_.channels.empty()) data_.channels = names, all_.resize(names.size());
    if (data_.channels != names)
      throw Error(Exit::data, path.string(), "has other channels than the first photograph",
                  "photographs of one camera, all of them in colour or none");
    for (const std::string& name : names) channels.push_back(picture.channel(name));
    return picture;
  }

  void add(const ResponseView& view) {
    std::vector<std::vector<Place>> places;
    int width = 0, height = 0, step = 1;
    for (std::size_t k = 0; k < view.pictures.size(); ++k) {
      const std::string& name = view.pictures[k].string();
      const std::size_t time = time_of(view.exposures_s[k], name);
      std::vector<int> channels;
      const io::Image picture = read(view.pictures[k], channels);
      if (k == 0) {
        width = picture.width, height = picture.height;
        step = std::max(3, static_cast<int>(std::sqrt(static_cast<double>(width) * height / most_places)));
        places.resize(channels.size());
      }
      if (picture.width != width || picture.height != height)
        throw Error(Exit::data, name,
                    format("has %d x %d pixels, the view's first photograph %d x %d", picture.width, picture.height,
                           width, height),
                    "exposures of one view from one place");
      for (std::size_t c = 0; c < channels.size(); ++c) {
        std::size_t at = 0;
        for (int y = 1; y + 1 < height; y += step)
          for (int x = 1; x + 1 < width; x += step, ++at) {
            if (k == 0) places[c].emplace_back();
            Place& place = places[c][at];
            const Codes codes = codes_at(picture, x, y, channels[c]);
            place.brightness += codes.mean / static_cast<double>(view.pictures.size());
            if (codes.least < 0.5 || codes.most > full - 0.5) continue;
            place.patch.readings.push_back({time, codes.mean});
            place.rough = std::max(place.rough, codes.most - codes.least);
          }
      }
    }
    for (std::size_t c = 0; c < places.size(); ++c)
      for (Place& place : places[c])
        if (place.patch.readings.size() > 1) all_[c].push_back(std::move(place));
  }

  // The smoothest of each brightness: all codes of all exposures are told alike.
  static std::vector<ResponsePatch> chosen(std::vector<Place>& places) {
    std::ranges::stable_sort(places, {}, &Place::rough);
    std::array<std::size_t, heights> taken{};
    std::vector<ResponsePatch> patches;
    for (Place& place : places) {
      const auto bin = static_cast<std::size_t>(std::clamp(place.brightness / full * heights, 0.0, heights - 1.0));
      if (taken[bin]++ < of_a_height) patches.push_back(std::move(place.patch));
    }
    return patches;
  }

  ResponseData data_;
  std::vector<std::vector<Place>> all_;  // of each channel
};

}  // namespace

ResponseData response_data(const std::vector<ResponseView>& views) {
  return Gathering().run(views);
}

}  // namespace gonio::photograph
