#include "photograph/linear_picture.h"

#include "base/error.h"
#include "io/codes.h"
#include "io/picture.h"
#include "photograph/response.h"
#include "photograph/saturation.h"

namespace gonio::photograph {
namespace {

std::vector<std::string> colour_names(const io::Image& raw, const std::string& place) {
  if (raw.channel("R") >= 0 && raw.channel("G") >= 0 && raw.channel("B") >= 0) return {"R", "G", "B"};
  if (raw.channel("Y") >= 0) return {"Y"};
  if (raw.channels.size() == 1) return {raw.channels[0]};
  std::string names;
  for (const auto& name : raw.channels) names += (names.empty() ? "" : ", ") + name;
  throw Error(Exit::data, place, "has neither the channels R, G, B nor Y", "it has " + names);
}

io::Image select(const io::Image& raw, const std::vector<std::string>& names, const std::string& prefix) {
  std::vector<std::size_t> from;
  for (const auto& name : names) {
    const int at = raw.channel(prefix + name);
    if (at < 0) return {};
    from.push_back(static_cast<std::size_t>(at));
  }
  io::Image selected(raw.width, raw.height, names.size() == 1 ? std::vector<std::string>{"Y"} : names);
  for (std::size_t i = 0; i < raw.pixels(); ++i)
    for (std::size_t c = 0; c < from.size(); ++c)
      selected.data[i * from.size() + c] = raw.data[i * raw.channels.size() + from[c]];
  return selected;
}

// Where nothing else is in it, nothing is copied.
io::Image select_colour(io::Image raw, const std::vector<std::string>& names) {
  if (raw.channels != names) return select(raw, names, "");
  if (names.size() == 1) raw.channels = {"Y"};
  return raw;
}

void mark(const io::Image& colour, double highest, double lowest, LinearPicture& picture) {
  picture.clipped.assign(colour.pixels(), 0);
  picture.dark.assign(colour.data.size(), 0);
  const std::size_t channels = colour.channels.size(), values = colour.data.size();
  const float* value = colour.data.data();
  std::uint8_t* dark = picture.dark.data();
  for (std::size_t i = 0; i < values; ++i) dark[i] = value[i] < lowest;
  for (std::size_t i = 0; i < values; ++i)
    if (value[i] >= highest) picture.clipped[i / channels] = 1;
}

}  // namespace

LinearPicture read_linear(const std::filesystem::path& path, const manifest::Value& response, const std::string& place,
                          std::optional<double> saturation) {
  LinearPicture picture;
  picture.name = path.string();
  picture.code_bits = io::code_bits(path);
  if (picture.integer_codes() && response.is_null())
    throw Error(Exit::data, place, "is an 8 or 16-bit picture whose response is not stated",
                "state \"response\" (--response): \"linear\", \"srgb\" or a table");
  io::Image raw = io::read_picture(path);
  const auto names = colour_names(raw, picture.name);
  std::vector<Response> linear;
  for (const auto& name : names) linear.emplace_back(response_of_channel(response, name, place), place);
  picture.variance = select(raw, names, "variance.");
  picture.colour = select_colour(std::move(raw), names);
  mark(picture.colour, saturated_from(picture.code_bits, saturation), dark_below(picture.code_bits), picture);
  const std::size_t channels = names.size();
  for (std::size_t c = 0; c < channels; ++c) {
    if (linear[c].is_linear()) continue;
    for (std::size_t i = c; i < picture.colour.data.size(); i += channels)
      picture.colour.data[i] = linear[c](picture.colour.data[i]);
  }
  return picture;
}

}  // namespace gonio::photograph
