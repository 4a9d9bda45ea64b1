#include "metric/linear_picture.h"

#include <algorithm>
#include <cctype>
#include <cmath>

#include "base/error.h"
#include "io/picture.h"

namespace gonio::metric {
namespace {

constexpr float full_scale = 1.0f - 0.5f / 65535.0f;  // the highest code of 8 and of 16 bit files alike

bool is_exr(const std::filesystem::path& path) {
  std::string extension = path.extension().string();
  std::ranges::transform(extension, extension.begin(),
                         [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return extension == ".exr";
}

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

[[noreturn]] void refuse_response(const std::string& place, const std::string& problem) {
  throw Error(Exit::data, place, problem, "a response is \"linear\", \"srgb\" or a table [[code, linear], ...]");
}

// `table` from its column `from` to the other one, linear between rows, constant beyond its ends.
float looked_up(const std::vector<std::pair<double, double>>& table, float value,
                double std::pair<double, double>::*from, double std::pair<double, double>::*to) {
  const auto above = std::ranges::upper_bound(table, static_cast<double>(value), {}, from);
  if (above == table.begin()) return static_cast<float>(table.front().*to);
  if (above == table.end()) return static_cast<float>(table.back().*to);
  const auto below = above - 1;
  const double share = (value - (*below).*from) / ((*above).*from - (*below).*from);
  return static_cast<float>((*below).*to + share * ((*above).*to - (*below).*to));
}

}  // namespace

Response::Response(const manifest::Value& stated, const std::string& place) {
  if (stated.is_null() || (stated.is_string() && stated.as_string() == "linear")) return;
  if (stated.is_string() && stated.as_string() == "srgb") {
    srgb_ = true;
    return;
  }
  if (!stated.is_array() || stated.as_array().size() < 2) refuse_response(place, "states no response that is known");
  for (const auto& row : stated.as_array()) {
    if (!row.is_array() || row.as_array().size() != 2 || !row.as_array()[0].is_number() ||
        !row.as_array()[1].is_number())
      refuse_response(place, "has a row in the response table that is not a pair of numbers");
    table_.emplace_back(row.as_array()[0].as_number(), row.as_array()[1].as_number());
  }
  for (std::size_t i = 1; i < table_.size(); ++i)
    if (!(table_[i].first > table_[i - 1].first))
      refuse_response(place, "has codes that do not rise in the response table");
}

float Response::operator()(float code) const {
  if (srgb_) return io::linear_from_srgb(code);
  if (table_.empty() || std::isnan(code)) return code;
  return looked_up(table_, code, &std::pair<double, double>::first, &std::pair<double, double>::second);
}

float Response::code(float linear) const {
  if (srgb_) return io::srgb_from_linear(linear);
  if (table_.empty() || std::isnan(linear)) return linear;
  return looked_up(table_, linear, &std::pair<double, double>::second, &std::pair<double, double>::first);
}

void Response::check_invertible(const std::string& place) const {
  for (std::size_t i = 1; i < table_.size(); ++i)
    if (!(table_[i].second > table_[i - 1].second))
      throw Error(Exit::data, place, "has linear values that do not rise in the response table",
                  "write OpenEXR (--format exr), which needs no way back to codes");
}

const manifest::Value& response_of_channel(const manifest::Value& stated, const std::string& channel,
                                           const std::string& place) {
  if (!stated.is_object()) return stated;
  const manifest::Value* own = stated.find(channel);
  if (own == nullptr) refuse_response(place, "states no response for the channel " + channel);
  return *own;
}

LinearPicture read_linear(const std::filesystem::path& path, const manifest::Value& response,
                          const std::string& place) {
  LinearPicture picture;
  picture.name = path.string();
  picture.integer_codes = !is_exr(path);
  if (picture.integer_codes && response.is_null())
    throw Error(Exit::data, place, "is an 8 or 16-bit picture whose response is not stated",
                "state \"response\" (--response): \"linear\", \"srgb\" or a table");
  const io::Image raw = io::read_picture(path);
  const auto names = colour_names(raw, picture.name);
  std::vector<Response> linear;
  for (const auto& name : names) linear.emplace_back(response_of_channel(response, name, place), place);
  picture.colour = select(raw, names, "");
  picture.variance = select(raw, names, "variance.");
  picture.clipped.assign(raw.pixels(), 0);
  const std::size_t channels = names.size();
  for (std::size_t i = 0; i < picture.colour.data.size(); ++i) {
    float& value = picture.colour.data[i];
    if (picture.integer_codes && value >= full_scale) picture.clipped[i / channels] = 1;
    value = linear[i % channels](value);
  }
  return picture;
}

Mask read_mask(const std::filesystem::path& path) {
  const io::Image raw = io::read_picture(path);
  Mask mask{raw.width, raw.height, std::vector<std::uint8_t>(raw.pixels())};
  for (std::size_t i = 0; i < raw.pixels(); ++i) mask.counts[i] = raw.data[i * raw.channels.size()] > 0.5f;
  return mask;
}

}  // namespace gonio::metric
