// What the refinement found, as pictures.
#include "report/page.h"

#include <algorithm>

#include "base/text.h"
#include "glass/layer_pictures.h"
#include "glass/refine/view.h"
#include "io/picture.h"
#include "render/preview.h"
#include "tools/glass-refine/call.h"

namespace gonio::tools::glass_refine {

using namespace gonio::glass;

namespace {

using Plane = std::vector<float>;

constexpr double degrees = 180 / pi;

// One beside the other under one white, a line of black between them.
io::Image beside(const std::vector<Plane>& planes, int width, int height) {
  constexpr int gap = 1;
  const int count = static_cast<int>(planes.size());
  io::Image all(count * width + (count - 1) * gap, height, {"Y"});
  for (int k = 0; k < count; ++k)
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        all.at(k * (width + gap) + x, y, 0) =
            planes[static_cast<std::size_t>(k)][static_cast<std::size_t>(y * width + x)];
  return render::preview(all);
}

void add_held_out(report::Page& page, const View& view, const Rendered& hull, const Rendered& body) {
  page.section(view.id + ", kept out of the fit");
  if (hull.picture.data.empty()) {
    page.paragraph("It was not rendered (--spp 0).");
    return;
  }
  std::vector<Plane> planes{view.stokes[0]};
  for (const Rendered* rendered : {&hull, &body})
    planes.push_back(
        reduced(stokes_planes(rendered->picture)[0], rendered->picture.width, rendered->picture.height, view.reduced));
  page.figures({{.png = io::encode_png(beside(planes, view.width, view.height)),
                 .title = "photograph, hull, answer",
                 .caption = "Light before the polarizers under one white. The renderings follow all paths; the fit "
                            "knew two refractions.",
                 .width_px = 3 * view.width + 2}},
               900);
  page.score_bars({{"hull", format("%.3f", hull.difference), hull.difference, report::Tone::neutral},
                   {"answer", format("%.3f", body.difference), body.difference,
                    body.difference < hull.difference ? report::Tone::good : report::Tone::bad}});
  page.note("Root of the mean square difference of s0, s1, s2 within the mask, as a share of the screen's mean.");
}

void add_stages(report::Page& page, const Refined& refined) {
  page.section("Stages");
  report::TableText table{
      .caption = "Share of the light through the object that each stage leaves unexplained",
      .columns = {
          {"stage", "", false}, {"unexplained"}, {"in the view kept out"}, {"index"}, {"how it ended", "", false}}};
  for (std::size_t s = 0; s < refined.stages.size(); ++s) {
    const Stage& stage = refined.stages[s];
    table.rows.push_back({stage.name + (s == refined.answer ? " (answer)" : ""), format("%.3f", stage.unexplained),
                          format("%.3f", stage.unexplained_held_out), format("%.3f", stage.glass.index), stage.how});
  }
  page.table(table);
}

void add_maps(report::Page& page, const View& view, const io::Image& maps) {
  page.subsection(view.id);
  std::vector<report::Figure> figures;
  const auto add = [&](const std::string& title, const io::Image& picture) {
    figures.push_back({.png = io::encode_png(picture), .title = title, .width_px = picture.width});
  };
  for (const auto& [layer, picture] : render::layer_previews(maps)) add(layer, picture);
  for (const auto& [title, channel] : {std::pair{"thickness", "thickness"},
                                       {"normal +-", "uncertainty.normal"},
                                       {"back-normal +-", "uncertainty.back_normal"}})
    if (maps.channel(channel) >= 0) add(title, grey_layer(maps, channel));
  page.figures(figures, 200);
}

}  // namespace

std::string page_of(const Refined& refined, std::span<const View> views, std::size_t held_out,
                    const std::vector<io::Image>& maps, const Rendered& hull, const Rendered& body) {
  const bool by_light = refined.index_sigma > 0;
  report::Page page(
      "glass-refine",
      format(by_light ? "The body explains %.0f %% of the light in a view that the fit never saw"
                      : "A body by outlines and normals alone: %.0f %% of the light in a view that the fit never saw",
             100 * (1 - refined.best().unexplained_held_out)),
      format("%zu views, %s kept out", views.size(), views[held_out].id.c_str()));
  std::vector<report::KeyNumber> numbers;
  numbers.push_back(
      {"index of refraction",
       format("%.3f", refined.best().glass.index) + (by_light ? format(" \u00b1 %.3f", refined.index_sigma) : ""), "",
       by_light ? "" : "as given"});
  for (const auto& [name, channel] : {std::pair{"normals of the front, to", "uncertainty.normal"},
                                      {"normals of the back, to", "uncertainty.back_normal"}})
    if (maps[held_out].channel(channel) >= 0)
      numbers.push_back({name, format("%.2g", middle_of(values_within(maps[held_out], channel)) * degrees), "\u00b0",
                         "median; 68.3 % err by less"});
  numbers.push_back({"thickness", format("%.2g", 1e3 * middle_of(values_within(maps[held_out], "thickness"))), "mm",
                     "median along lines of sight"});
  page.key_numbers(numbers);
  add_held_out(page, views[held_out], hull, body);
  add_stages(page, refined);
  page.section("Maps");
  page.note(
      "Normals: 0.5 + 0.5 n, x red, y green, z blue; depth from the nearest (dark) to the farthest; thickness and "
      "uncertainties from none (black) to the largest hundredth (white).");
  for (std::size_t v = 0; v < views.size(); ++v) add_maps(page, views[v], maps[v]);
  return page.html();
}

}  // namespace gonio::tools::glass_refine
