// Seeds from a small picture, and labels and their confidence as pictures for a page.
#include <algorithm>
#include <array>
#include <cmath>

#include "base/error.h"
#include "io/picture.h"
#include "reassembly/labels.h"
#include "report/colour_map.h"

namespace gonio::reassembly {
namespace {

// Okabe & Ito 2008, "Color universal design": eight colours that people with any one kind of cone missing tell apart;
// black is left for what has no label.
constexpr std::array<report::Colour, 7> palette{{{0.902f, 0.624f, 0.0f},
                                                 {0.337f, 0.706f, 0.914f},
                                                 {0.0f, 0.620f, 0.451f},
                                                 {0.941f, 0.894f, 0.259f},
                                                 {0.0f, 0.447f, 0.698f},
                                                 {0.835f, 0.369f, 0.0f},
                                                 {0.800f, 0.475f, 0.655f}}};

report::Colour label_colour(std::int32_t label) {
  if (label < 0) return {0, 0, 0};
  const auto index = static_cast<std::size_t>(label);
  report::Colour colour = palette[index % palette.size()];
  const std::size_t turn = index / palette.size() % 3;  // as they are, darker, lighter
  for (float& c : colour) c = turn == 0 ? c : turn == 1 ? 0.5f * c : 0.5f + 0.5f * c;
  return colour;
}

template <class ColourOf>
io::Image drawn(const LabelPicture& labels, const ColourOf& colour_of) {
  io::Image picture(labels.width, labels.height, {"R", "G", "B"});
  for (std::size_t i = 0; i < picture.pixels(); ++i) {
    const report::Colour colour = colour_of(i);
    std::copy(colour.begin(), colour.end(), picture.data.begin() + static_cast<std::ptrdiff_t>(3 * i));
  }
  return picture;
}

}  // namespace

std::vector<std::int32_t> read_seeds(const std::filesystem::path& path, int width, int height, std::size_t materials) {
  const io::Image codes = io::read_picture(path);
  if (codes.pixels() == 0 || width <= 0 || height <= 0) throw Error(Exit::data, path.string(), "has no pixels", "");
  std::vector<std::int32_t> seeds(static_cast<std::size_t>(width) * static_cast<std::size_t>(height));
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const auto from = [](int at, int size, int given) {
        return static_cast<int>(static_cast<std::int64_t>(2 * at + 1) * given / (2 * static_cast<std::int64_t>(size)));
      };
      const float code = 255 * codes.at(from(x, width, codes.width), from(y, height, codes.height), 0);
      const auto whole = static_cast<std::int32_t>(std::lround(code));
      if (!(std::abs(code - static_cast<float>(whole)) < 0.01f) || whole < 0 ||
          static_cast<std::size_t>(whole) > materials)
        throw Error(Exit::data, path.string(),
                    "code " + std::to_string(code) + " at pixel (" + std::to_string(from(x, width, codes.width)) +
                        ", " + std::to_string(from(y, height, codes.height)) + ") names none of the " +
                        std::to_string(materials) + " materials",
                    "8-bit codes: 0 for no seed, n for the n-th material");
      seeds[static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x)] = whole - 1;
    }
  return seeds;
}

io::Image coloured_labels(const LabelPicture& labels) {
  return drawn(labels, [&](std::size_t i) { return label_colour(labels.label[i]); });
}

io::Image coloured_confidence(const LabelPicture& labels) {
  return drawn(labels,
               [&](std::size_t i) { return report::magnitude_colour(static_cast<double>(labels.confidence[i])); });
}

}  // namespace gonio::reassembly
