// Highlights of lamps on mirror balls as a table, one row for each lamp on each ball in each photograph: what
// light-probe writes and what the table model "probe" of `explain` reads (lib/explain/tables/models/probe.cpp). Both
// take the columns from here. The cameras and their poses are the manifest's images. World frame; metres, pixels.
#pragma once
#include <span>
#include <string>
#include <vector>

#include "geom/vector.h"
#include "manifest/sections/table.h"
#include "probe/metals.h"
#include "probe/mirror_ball.h"

namespace gonio::probe {

struct HighlightRow {
  std::string image, ball, lamp;  // image: id in the manifest's images; lamp: name in its lights, or any other
  Ball stated;                    // as its outline has it
  Mat3 covariance_m2{{}};         // of the centre; zero: known exactly
  Vec2 seen_px, sigma_px;         // where the ball mirrors the middle of the lamp
  // The lamp's irradiance at the balls' middle times what the metal reflects of it at this incidence.
  Rgb reflected{}, reflected_sigma{};
  double theta_i = 0;
  bool clipped = false;
};

struct HighlightColumn {
  std::string name, unit, meaning;
  bool needed = true;  // by the model
};
const std::vector<HighlightColumn>& highlight_columns();

// Fewer rows, or fewer values of the column that holds them together, `explain` does not take.
constexpr std::size_t fewest_rows = 12, fewest_groups = 3;
// By which column rows are held out together: "view" where there are enough of them, else "lamp"; empty where there is
// nothing that explain could hold out.
std::string highlight_group(std::span<const HighlightRow> rows);

std::string highlight_csv(std::span<const HighlightRow> rows);  // with its header line
// The manifest's section for it. `file`: id in the manifest's files; `group`: "view" or "lamp".
manifest::Table highlight_table(const std::string& file, const std::string& group);

// The same highlights' light as a table of the model "probe-radiance" (models/probe_radiance.cpp), three channels each;
// saturated ones are left out. Empty where there are too few.
std::string reflected_csv(std::span<const HighlightRow> rows, const Metal& metal);
manifest::Table reflected_table(const std::string& file, const Metal& metal);

}  // namespace gonio::probe
