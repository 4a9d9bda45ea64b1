// See page.h.
#include "tools/relief/page.h"

#include "report/number_text.h"
#include "report/page.h"

namespace gonio::tools::relief {

using namespace gonio::relief;

namespace {

constexpr double micro = 1e6;

}  // namespace

std::string ground_page(const GroundNoise& ground, const std::vector<std::string>& files) {
  std::string lead = "Fitted to the spectra of " + std::to_string(ground.tiles) + " tiles of";
  for (const std::string& file : files) lead += " " + file;
  report::Page page("Ground noise", "The surface is a sum of " + std::to_string(ground.parts.size()) + " noises.",
                    lead + ".");
  report::TableText table;
  table.columns = {{"Part", "", false}, {"Sq", "um"}, {"cells", "um"}};
  for (std::size_t i = 0; i < ground.parts.size(); ++i) {
    const GroundPart& p = ground.parts[i];
    table.rows.push_back({std::to_string(i + 1), report::with_sigma(p.sq_m * micro, p.sigma_sq_m * micro),
                          report::with_sigma(p.cell_m * micro, p.sigma_cell_m * micro)});
  }
  table.rows.push_back({"white", report::with_sigma(ground.white_m * micro, ground.sigma_white_m * micro), ""});
  table.caption = "The bands of the spectrum differ from the model by " + report::percent_text(ground.log_rms, 0) +
                  " (root mean square of the logarithm).";
  page.section("Parts");
  page.table(table);
  report::Plot plot{.title = "Spectrum", .x_label = "frequency / (1/um)", .y_label = "power / m^4"};
  report::Series measured{.kind = report::Series::Kind::points, .name = "measured"}, modelled{.name = "model"};
  for (std::size_t b = 0; b < ground.band_per_m.size(); ++b) {
    measured.x.push_back(ground.band_per_m[b] / micro), modelled.x.push_back(ground.band_per_m[b] / micro);
    measured.y.push_back(ground.measured_m4[b]), modelled.y.push_back(ground.modelled_m4[b]);
  }
  plot.series = {measured, modelled};
  plot.log_x = plot.log_y = true;
  page.plot(plot);
  return page.html();
}

}  // namespace gonio::tools::relief
