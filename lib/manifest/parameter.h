// Numbers that a fit may move, with their sigmas: what sections of the manifest are made of.
#pragma once
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "geom/vector.h"

namespace gonio::manifest {

// A number or a short list of numbers which a fit may be allowed to move: `0.5`, `[0.5, 0.3, 0.2]` or
// `{"value": 0.5, "free": true, "min": 0, "max": 1, "sigma": 0.1, "share": "name"}`. `sigma` is a prior's width. Free
// parameters that bear the same `share` are one parameter.
struct Parameter {
  std::vector<double> value;
  bool free = false;
  std::optional<double> min, max, sigma;
  std::string share;

  Parameter() = default;
  Parameter(double v) : value{v} {}
  Parameter(std::vector<double> v) : value(std::move(v)) {}
  bool given() const { return !value.empty(); }
  double scalar() const { return value.at(0); }
  Rgb rgb() const {
    return value.size() == 3 ? Rgb{value[0], value[1], value[2]} : Rgb{value.at(0), value.at(0), value.at(0)};
  }
  Vec3 vector() const { return {value.at(0), value.at(1), value.at(2)}; }
  bool operator==(const Parameter&) const = default;
};
using Parameters = std::map<std::string, Parameter>;
using Sigmas = std::map<std::string, std::vector<double>>;  // one standard deviation beside a fitted value, same key

}  // namespace gonio::manifest
