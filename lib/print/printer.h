// A printer as a simulation of it needs it: pixels, layers, how voxels grow, where light goes.
#pragma once
#include <optional>
#include <string>
#include <vector>

#include "manifest/sections/forward.h"
#include "print/bleed.h"
#include "print/coverage.h"
#include "print/growth.h"

namespace gonio::print {

// Height of a voxel by its grey value: in proportion to it, by the law, or, where the law fails, by a table.
class Growth {
 public:
  Growth() = default;
  explicit Growth(const GrowthLaw& law) : law_(law) {}
  Growth(const GrowthLaw& law, GrowthTable table) : law_(law), table_(std::move(table)) {}
  // Of light that may exceed 1 (several layers' together): beyond the table its law. At least 0, not cut at the layer.
  double height_m(double light, double layer_m) const;
  double slope_m(double light, double layer_m) const;  // of height_m by the light
  // The grey value for a height of at most `layer_m`; white where white does not reach it.
  double grey(double height_m, double layer_m) const;
  double reach_m(double layer_m) const { return height_m(1, layer_m); }  // of white
  double threshold() const;                                              // the darkest grey that cures
  bool proportional() const { return !law_; }
  const std::optional<GrowthLaw>& law() const { return law_; }
  const std::optional<GrowthTable>& table() const { return table_; }

 private:
  std::optional<GrowthLaw> law_;
  std::optional<GrowthTable> table_;
};

struct Printer {
  std::string name, place;  // in prints; for messages
  int width_px = 0, height_px = 0;
  Vec2 pixel_m{};
  double layer_m = 0;
  std::vector<double> layers_m;  // thickness of each, where they differ; the last goes on
  Growth growth;
  Bleed bleed;
  std::optional<double> overcure_m;  // depth in which light falls to 1/e

  PixelGrid grid() const;  // the origin at its centre
  double thickness_m(std::size_t layer) const;
};

// Of the print `name`. Error(data) at its place where numbers contradict each other.
Printer printer_of(const manifest::Document& document, const std::string& name);
manifest::PrintGrowth growth_entry(const GrowthFit& fit, double significance = 0.01);  // its table where the law fails

}  // namespace gonio::print
