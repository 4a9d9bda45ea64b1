#include "photograph/response.h"

#include <algorithm>
#include <cmath>

#include "base/error.h"
#include "io/picture.h"

namespace gonio::photograph {
namespace {

[[noreturn]] void refuse_response(const std::string& place, const std::string& problem) {
  throw Error(Exit::data, place, problem, "a response is \"linear\", \"srgb\" or a table [[code, linear], ...]");
}

// `table` from its column `from` to the other one, linear between rows, constant beyond its ends.
double looked_up(const std::vector<std::pair<double, double>>& table, double value,
                 double std::pair<double, double>::*from, double std::pair<double, double>::*to) {
  const auto above = std::ranges::upper_bound(table, value, {}, from);
  if (above == table.begin()) return table.front().*to;
  if (above == table.end()) return table.back().*to;
  const auto below = above - 1;
  const double share = (value - (*below).*from) / ((*above).*from - (*below).*from);
  return (*below).*to + share * ((*above).*to - (*below).*to);
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
  return srgb_ ? io::linear_from_srgb(code) : static_cast<float>(linear_of(code));
}

float Response::code(float linear) const {
  return srgb_ ? io::srgb_from_linear(linear) : static_cast<float>(code_of(linear));
}

double Response::linear_of(double code) const {
  if (srgb_) return io::linear_from_srgb(static_cast<float>(code));
  if (table_.empty() || !std::isfinite(code)) return code;
  return looked_up(table_, code, &std::pair<double, double>::first, &std::pair<double, double>::second);
}

double Response::code_of(double linear) const {
  if (srgb_) return io::srgb_from_linear(static_cast<float>(linear));
  if (table_.empty() || !std::isfinite(linear)) return linear;
  return looked_up(table_, linear, &std::pair<double, double>::second, &std::pair<double, double>::first);
}

bool Response::is_rising_table() const {
  for (std::size_t i = 1; i < table_.size(); ++i)
    if (!(table_[i].second > table_[i - 1].second)) return false;
  return !table_.empty();
}

void Response::check_invertible(const std::string& place) const {
  if (!table_.empty() && !is_rising_table())
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

}  // namespace gonio::photograph
