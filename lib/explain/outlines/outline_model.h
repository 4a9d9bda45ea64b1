// What moves rims, number by number, and where they are then. Private to outlines/.
#pragma once
#include <array>
#include <span>
#include <string>
#include <vector>

#include "explain/outlines/outlines_problem.h"

namespace gonio::explain {

// What a parameter is: a number of one of alignment's freedoms, or one of those that it does not have.
struct OutlineRole {
  enum class Part { freedom, bend, offset, ground, radius, blur, mask, apart } part = Part::freedom;
  std::size_t freedom = 0;                                       // place in OutlineModel::freedoms
  std::size_t which = 0;                                         // body, lamp, lens or group
  std::size_t index = 0;                                         // number within the freedom, or of the mechanism
  enum class Form { plain, shrinks, grows } form = Form::plain;  // of a logarithm: log(1 - value), log(1 + value)
};

class OutlineModel {
 public:
  explicit OutlineModel(const OutlinesInput& input) : input_(input) {}

  std::vector<alignment::Freedom> freedoms{};  // of the base and of candidates
  std::vector<OutlineRole> roles{};            // one per parameter

  alignment::Setting setting(std::span<const double> values) const;
  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const;

 private:
  struct Moved;
  double offset_px(const Moved& moved, const OutlineView& view, const OutlineRow& row) const;
  const OutlinesInput& input_;
};

}  // namespace gonio::explain
