// The report: what is sent, what stands where, what will come out.
#include "report/page.h"

#include <algorithm>
#include <cmath>

#include "base/text.h"
#include "io/raster.h"
#include "report/number_text.h"
#include "tools/dlp-slice/work.h"

namespace gonio::tools::dlp_slice {
namespace {

using report::number_text;

constexpr double um = 1e6, mm = 1e3, ml = 1e6;

constexpr int widest_px = 400;  // of a picture on the page

// Means over squares of pixels, so that a picture is no wider than that.
Section shrunk(const Section& section) {
  const int by = (section.width + widest_px - 1) / widest_px;
  if (by <= 1) return section;
  Section small{section.title, section.width / by, std::max(1, section.height / by), {}};
  for (int y = 0; y < small.height; ++y)
    for (int x = 0; x < small.width; ++x) {
      int sum = 0, n = 0;
      for (int j = y * by; j < std::min(section.height, (y + 1) * by); ++j)
        for (int i = x * by; i < (x + 1) * by; ++i, ++n)
          sum += section.greys[static_cast<std::size_t>(j) * static_cast<std::size_t>(section.width) +
                               static_cast<std::size_t>(i)];
      small.greys.push_back(static_cast<std::uint8_t>(sum / std::max(1, n)));
    }
  return small;
}

// In a dark frame, as the rest of the platform is: a full layer alone would be a white picture on a white page.
report::Figure figure_of(const Section& whole, const std::string& title, const std::string& caption) {
  const Section section = shrunk(whole);
  constexpr int frame = 4;
  io::Image image(section.width + 2 * frame, section.height + 2 * frame, {"Y"});
  for (int y = 0; y < section.height; ++y)
    for (int x = 0; x < section.width; ++x)
      image.at(x + frame, y + frame, 0) =
          section.greys[static_cast<std::size_t>(y) * static_cast<std::size_t>(section.width) +
                        static_cast<std::size_t>(x)] /
          255.0f;
  return {.png = io::encode_raster_png(image), .title = title, .caption = caption, .width_px = image.width};
}

std::string duration(double s) {
  const auto minutes = static_cast<long>(std::lround(s / 60));
  return minutes < 60 ? number_text(s / 60, 2) + " min" : format("%ld h %02ld min", minutes / 60, minutes % 60);
}

void add_numbers(report::Page& page, const Work& work) {
  std::vector<report::KeyNumber> numbers;
  const auto add = [&](std::string label, std::string value, std::string unit, std::string note,
                       report::Tone tone = report::Tone::neutral) {
    numbers.push_back({std::move(label), std::move(value), std::move(unit), std::move(note), tone});
  };
  if (work.totals.layers > 0) {
    add("Layers", std::to_string(work.totals.layers), "",
        number_text(work.printer.layer_m * um, 4) + " um each, where they do not vary");
    add("Resin", number_text(work.totals.solid_m3 * ml, 4), "ml", "what is solid in the end");
    if (work.totals.time_s > 0) add("Time", duration(work.totals.time_s), "", "exposures and lifts");
  }
  if (work.totals.after.voxels > 0)
    add("Misfit of heights", number_text(work.totals.after.rms_m() * um, 3), "um",
        number_text(work.totals.before.rms_m() * um, 3) + " um without compensation",
        work.totals.after.rms_m() < work.totals.before.rms_m() ? report::Tone::good : report::Tone::bad);
  if (work.growth) {
    const auto sigma = work.growth->sigma();
    add("alpha", report::with_sigma(work.growth->law.alpha_m * um, sigma[0] * um), "um", "height at grey 1 + gamma");
    add("beta", report::with_sigma(work.growth->law.beta_m * um, sigma[1] * um), "um", "depth of penetration");
    add("gamma", report::with_sigma(work.growth->law.gamma, sigma[2]), "", "grey that does nothing");
    add("Lack of fit", "p " + number_text(work.growth->lack_of_fit_p, 2), "",
        "chance of such a misfit where the law is right",
        work.growth->lack_of_fit_p < 0.01 ? report::Tone::bad : report::Tone::good);
  }
  page.key_numbers(numbers);
}

void add_parts(report::Page& page, const Work& work) {
  const std::vector<manifest::PrintedPart>& parts = work.call.document.prints.at(work.printer.name).parts;
  if (work.bodies.empty()) return;
  page.section("Parts");
  report::TableText table;
  table.columns = {{"Part", "", false},    {"volume", "mm^3"},       {"faces the projector", "mm^2"},
                   {"faces away", "mm^2"}, {"structure", "", false}, {"mended", "", false}};
  for (const manifest::PrintedPart& p : parts) {
    std::string mended, structure = p.microstructure;
    for (const std::string& what : p.repaired) mended += (mended.empty() ? "" : "; ") + what;
    for (const auto& [label, name] : p.labels)
      structure += (structure.empty() ? "" : ", ") + name + " on label " + label;
    table.rows.push_back({p.mesh, number_text(p.volume_m3.value_or(0) * 1e9, 5),
                          number_text(p.facing_m2.value_or(0) * 1e6, 4),
                          number_text(p.hidden_m2.value_or(0) * 1e6, 4) + (p.hidden_printed_m2 ? " (structured)" : ""),
                          structure.empty() ? "none" : structure, mended.empty() ? "nothing" : mended});
  }
  table.caption =
      "Faces that look away from the projector cure without a layer to hold on to; structures leave them as they are "
      "unless asked for.";
  page.table(table);
  constexpr std::size_t most = 200000;  // triangles that a reader may turn
  const report::MeshView view = view_of(work);
  const bool small = view.meshes.front().triangles.size() <= most;
  if (small)
    page.figures({{.svg = report::html(view), .title = "Parts", .caption = "Drag to turn."}}, 560);
  else
    page.figures({{.png = report::still_png(view, 0, 560, 420), .title = "Parts"}}, 560);
}

void add_layers(report::Page& page, const Work& work) {
  if (work.sections.empty()) return;
  page.section("Layers");
  std::vector<report::Figure> layers;
  for (const Section& section : work.sections) layers.push_back(figure_of(section, section.title, ""));
  page.figures(layers);
}

void add_growth(report::Page& page, const Work& work) {
  if (!work.growth) return;
  const print::GrowthFit& fit = *work.growth;
  page.section("Growth");
  report::Plot plot{.title = "Height by grey value", .x_label = "grey value", .y_label = "height / um"};
  report::Series means{.kind = report::Series::Kind::points, .name = "measured"}, law{.name = "law"},
      band{.kind = report::Series::Kind::band, .name = "its sigma"};
  for (std::size_t k = 0; k < fit.means_m.size(); ++k) {
    means.x.push_back(fit.table.greys()[k]), means.y.push_back(fit.means_m[k] * um),
        means.sigma.push_back(fit.mean_sigmas_m[k] * um);
  }
  for (int k = 0; k <= 200; ++k) {
    const double grey = k / 200.0;
    for (report::Series* s : {&law, &band}) s->x.push_back(grey), s->y.push_back(fit.law.height_m(grey) * um);
    band.sigma.push_back(fit.height_sigma_m(grey) * um);
  }
  plot.series = {band, law, means};
  page.plot(plot);
  page.list(work.notes);
}

// Heights from dark to light.
Section shaded(const print::CuredSurface& surface) {
  float low = std::numeric_limits<float>::infinity(), high = -low;
  for (const float z : surface.top_m)
    if (std::isfinite(z)) low = std::min(low, z), high = std::max(high, z);
  Section section{"", surface.width, surface.height, std::vector<std::uint8_t>(surface.top_m.size())};
  for (int y = 0; y < surface.height; ++y)
    for (int x = 0; x < surface.width; ++x) {
      const float z = surface.top_m[static_cast<std::size_t>(y) * static_cast<std::size_t>(surface.width) +
                                    static_cast<std::size_t>(x)];
      if (std::isfinite(z) && high > low)
        section.greys[static_cast<std::size_t>(surface.height - 1 - y) * static_cast<std::size_t>(surface.width) +
                      static_cast<std::size_t>(x)] =
            static_cast<std::uint8_t>(std::lround(30 + 225 * (z - low) / (high - low)));
    }
  section.title = format("Heights, black nothing, from %.4g to %.4g mm", static_cast<double>(low) * mm,
                         static_cast<double>(high) * mm);
  return section;
}

void add_design(report::Page& page, const Work& work) {
  if (!work.design) return;
  page.section("Wish");
  page.list(work.notes);
  report::Plot plot{
      .title = "Figure by what was moved", .x_label = work.design->moved, .y_label = work.call.text("wish")};
  plot.log_x = work.design->tried.front().strength > 0 && work.design->tried.back().strength > 0 &&
               work.design->use.model == "noise";
  report::Series tried{.kind = report::Series::Kind::points, .name = "simulated prints"};
  for (const print::DesignStep& step : work.design->tried)
    tried.x.push_back(step.strength), tried.y.push_back(step.figure);
  plot.series = {tried};
  page.plot(plot);
}

void add_prediction(report::Page& page, const Work& work) {
  if (!work.predicted) return;
  page.section("What will be printed");
  const print::CuredSurface& surface = *work.predicted;
  const Section heights = shaded(surface);
  const io::TriangleMesh mesh = print::mesh_of(surface);
  const report::MeshView view = view_of("predicted surface", mesh.positions_m, mesh.triangles);
  page.figures({figure_of(heights, "From the projector", heights.title),
                {.png = report::still_png(view, 0, 560, 420), .title = "Lit from the left"}},
               480);
}

}  // namespace

std::string page(const Work& work) {
  const std::string what = work.growth   ? "Growth of " + work.printer.name
                           : work.sample ? "Calibration sample of " + work.printer.name
                           : work.design ? "A wished surface on " + work.printer.name
                                         : "Print on " + work.printer.name;
  std::string lead = format("%d x %d pixels of %.4g x %.4g um.", work.printer.width_px, work.printer.height_px,
                            work.printer.pixel_m.x * um, work.printer.pixel_m.y * um);
  report::Page page("dlp-slice", what, lead);
  add_numbers(page, work);
  add_growth(page, work);
  add_design(page, work);
  add_parts(page, work);
  add_layers(page, work);
  add_prediction(page, work);
  return page.html();
}

}  // namespace gonio::tools::dlp_slice
