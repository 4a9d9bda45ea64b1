// What a file's codes mean: from the code (stored value over full scale, 0 to 1) to a linear value and back.
//
// A response is "linear", "srgb" (IEC 61966-2-1), or a table [[code, linear], ...], interpolated linearly, constant
// beyond its ends, or an object with one of these for each channel, {"R": ..., "G": ..., "B": ...}.
#pragma once
#include <string>
#include <utility>
#include <vector>

#include "manifest/value.h"

namespace gonio::photograph {

class Response {
 public:
  explicit Response(const manifest::Value& stated, const std::string& place);  // null: linear
  bool is_linear() const { return !srgb_ && table_.empty(); }
  float operator()(float code) const;
  float code(float linear) const;       // the inverse
  double linear_of(double code) const;  // the same two, to the last digit where a table is stated
  double code_of(double linear) const;
  bool is_rising_table() const;                           // it has an inverse
  void check_invertible(const std::string& place) const;  // Error(data) for a table whose linear values do not rise

 private:
  bool srgb_ = false;
  std::vector<std::pair<double, double>> table_;  // empty: linear
};

// What is stated for `channel`: the response itself, or the object's entry. Error(data) where the object has none.
const manifest::Value& response_of_channel(const manifest::Value& stated, const std::string& channel,
                                           const std::string& place);

}  // namespace gonio::photograph
