// See page.h.
#include "tools/calib-charuco/page.h"

#include <algorithm>
#include <cmath>
#include <cstdio>

#include "base/atomic_file.h"
#include "io/picture.h"
#include "manifest/document.h"
#include "manifest/sections/camera.h"
#include "report/colour_map.h"
#include "report/number_text.h"
#include "report/page.h"
#include "stats/intervals.h"

namespace gonio::tools::calib_charuco {

using namespace gonio::camera;

namespace {

using report::number_text;
using report::Page;

struct Residuals {
  std::vector<Vec2> at, arrow;
  std::vector<double> radius, outward;  // px from the principal point, and the residual along it
};

Residuals residuals_of(const CameraResult& camera) {
  Residuals r;
  for (std::size_t v = 0; v < camera.views.size(); ++v) {
    if (!camera.uses(v)) continue;
    const CalibratedView& view = camera.calibration.views[v];
    for (std::size_t k = 0; k < view.residuals.size(); ++k) {
      const Vec2 residual = view.residuals[k], at = camera.views[v].corners[k].pixel;
      const Vec2 from_centre = at - residual - Vec2{camera.lens().cx_px, camera.lens().cy_px};
      if (norm(residual) > 8 * std::max(camera.noise_px(), 1e-3)) continue;  // mistakes, listed apart
      r.at.push_back(at);
      r.arrow.push_back(residual);
      r.radius.push_back(norm(from_centre));
      r.outward.push_back(dot(residual, from_centre) / std::max(norm(from_centre), 1e-9));
    }
  }
  return r;
}

report::Plot radial_plot(const Residuals& r) {
  std::vector<std::size_t> order(r.radius.size());
  for (std::size_t k = 0; k < order.size(); ++k) order[k] = k;
  std::ranges::sort(order, {}, [&](std::size_t k) { return r.radius[k]; });
  report::Series points{report::Series::Kind::points, "", {}, {}, {}, {}, 0}, line = points;
  constexpr std::size_t bins = 12;
  for (std::size_t b = 0; b < bins; ++b) {
    std::vector<double> x, y;
    for (std::size_t k = b * order.size() / bins; k < (b + 1) * order.size() / bins; ++k)
      x.push_back(r.radius[order[k]]), y.push_back(r.outward[order[k]]);
    if (x.size() < 3) continue;
    points.x.push_back(stats::mean(x));
    points.y.push_back(stats::mean(y));
    points.sigma.push_back(stats::standard_error(y));
  }
  line.kind = report::Series::Kind::line;
  line.x = points.x, line.y = points.y;
  report::Plot plot;
  plot.title = "Residuals along the image radius";
  plot.caption =
      "Means over bins of equal counts with their standard errors. What the lens model cannot follow shows as a curve.";
  plot.x_label = "distance from the principal point / px";
  plot.y_label = "mean residual outwards / px";
  plot.zero_y = true;
  plot.series = {line, points};
  return plot;
}

void key_numbers(Page& page, const CameraResult& camera, const Quality& q) {
  const CalibratedCamera& c = camera.calibration.cameras[camera.camera];
  const bool tested = q.halves.refused.empty();
  std::vector<report::KeyNumber> numbers = {{"predicts within, at 95 % over 95 % of the image",
                                             number_text(q.within_px, 2), "px", "widened by how photographs scatter",
                                             report::Tone::neutral}};
  if (tested)
    numbers.push_back({"halves of the views differ by", number_text(q.halves.differ_px, 2), "px",
                       number_text(q.halves.expected_px, 2) + " px expected, p = " + number_text(q.halves.p, 2),
                       q.halves.agree ? report::Tone::good : report::Tone::bad});
  numbers.push_back({"corners miss by (rms)", number_text(c.rms_px, 3), "px",
                     "noise of a coordinate " + number_text(c.noise_px, 2) + " px", report::Tone::neutral});
  numbers.push_back(
      {"of the image is reached by boards", report::percent_text(q.coverage.share, 0), "", "", report::Tone::neutral});
  page.key_numbers(numbers);
}

double value_of(const Intrinsics& lens, const std::string& name) {
  if (name == "fx_px") return lens.fx_px;
  if (name == "fy_px") return lens.fy_px;
  if (name == "cx_px") return lens.cx_px;
  if (name == "cy_px") return lens.cy_px;
  return lens.distortion[distortion_index(name, "calibration")];
}

void numbers(Page& page, const CameraResult& camera) {
  const Calibration& c = camera.calibration;
  report::TableText table{"Fitted numbers", {{"parameter", "", false}, {"value", ""}, {"sigma", ""}}, {}};
  for (std::size_t k = 0; k < c.shared.size(); ++k) {
    const SharedParameter& p = c.shared[k];
    if (p.kind == SharedParameter::Kind::rig || (p.kind == SharedParameter::Kind::lens && p.of != camera.camera))
      continue;
    const bool board = p.kind == SharedParameter::Kind::board;
    const BoardWarp warp = board ? c.boards[p.of].warp : BoardWarp{};
    const double value = !board ? value_of(camera.lens(), p.name) : p.name == "sag_x_m" ? warp.sag_x_m : warp.sag_y_m;
    const double sigma = std::sqrt(c.covariance[k * c.shared.size() + k]);
    table.rows.push_back({board ? camera.setup.boards[p.of].name + ": " + p.name : p.name,
                          report::value_for_sigma(value, sigma), report::sigma_text(value, sigma)});
  }
  page.table(table);
}

void prediction(Page& page, const Quality& q) {
  page.section("Where it predicts well");
  page.paragraph(
      "How far the predicted pixel of a point that is fixed in the world may be off (95 % radius), when the "
      "calibration is "
      "repeated with other noise.");
  const auto [lower, upper] = radius_range(q.maps);
  std::vector<report::Figure> figures;
  for (const ProjectionMap& map : q.maps) {
    report::Figure figure;
    figure.png = io::encode_png(picture_of(map, lower, upper));
    figure.title = "At " + number_text(map.distance_m, 3) + " m";
    figure.caption = "Within " + number_text(map.within_px, 2) + " px over 95 % of the image.";
    figure.width_px = map.grid.columns;
    figures.push_back(figure);
  }
  report::Figure coverage;
  coverage.png = io::encode_png(picture_of(q.coverage));
  coverage.title = "Reached by boards";
  coverage.caption =
      "The darker, the more views; white: none. " + report::percent_text(q.coverage.share, 0) + " of the image.";
  coverage.width_px = q.coverage.grid.columns;
  figures.push_back(coverage);
  page.figures(figures);
  report::ColourScale scale{"95 % radius", "px", {}, {}};
  for (int k = 0; k <= 16; ++k) scale.colours.push_back(report::hex(report::magnitude_colour(k / 16.0)));
  for (int k = 0; k <= 4; ++k) scale.ticks.push_back(number_text(lower * std::pow(upper / lower, k / 4.0), 2));
  page.colour_scale(scale);
}

void halves(Page& page, const CameraResult& camera, const Halves& h) {
  page.section("Do halves of the views agree?");
  if (!h.refused.empty()) {
    page.paragraph("Not tested: " + h.refused + ".");
    return;
  }
  page.paragraph(
      "Every other view calibrates one camera, the rest another; the arrows are the difference of their predictions "
      "after "
      "the rigid motion between their frames. Differences beyond what the corners' noise lets expect mean that the "
      "model "
      "lacks something, or that single views are wrong.");
  std::vector<Vec2> at;
  for (int j = 0; j < h.grid.rows; ++j)
    for (int i = 0; i < h.grid.columns; ++i) at.push_back(h.grid.pixel(i, j));
  const double scale = arrow_scale(camera.width_px(), h.difference_px);
  report::Figure figure;
  figure.svg = arrows(camera.width_px(), camera.height_px(), at, h.difference_px, scale);
  figure.title = "One half against the other, " + number_text(scale, 3) + " times enlarged";
  figure.caption =
      "Root mean square " + number_text(h.differ_px, 2) + " px; expected " + number_text(h.expected_px, 2) + " px.";
  page.figures({figure});
}

void residuals(Page& page, const CameraResult& camera) {
  page.section("Residuals");
  const Residuals r = residuals_of(camera);
  if (r.at.empty()) return;
  const double scale = arrow_scale(camera.width_px(), r.arrow);
  report::Figure figure;
  figure.svg = arrows(camera.width_px(), camera.height_px(), r.at, r.arrow, scale);
  figure.title = "All corners, found minus predicted, " + number_text(scale, 3) + " times enlarged";
  page.figures({figure});
  page.plot(radial_plot(r));
}

void views(Page& page, const CameraResult& camera) {
  page.section("Views");
  const Calibration& c = camera.calibration;
  report::HeatStrip strip{"Misses per view", "", "rms / px", {}, {"rms"}, {}};
  report::TableText table{"",
                          {{"view", "", false},
                           {"corners", ""},
                           {"rms", "px"},
                           {"weight", ""},
                           {"tilt", "deg"},
                           {"distance", "m"},
                           {"note", "", false}},
                          {}};
  for (std::size_t v = 0; v < camera.views.size(); ++v) {
    if (camera.views[v].camera != camera.camera || camera.views[v].corners.empty()) continue;
    const CalibratedView& view = c.views[v];
    const Vec2 middle = camera.board(v).extent().middle_m;
    strip.columns.push_back(camera.views[v].name);
    strip.values.push_back(view.rms_px);
    const Vec3 at = view.camera_from_board * Vec3{middle.x, middle.y, 0},
               normal = view.camera_from_board.rotate({0, 0, 1});
    const double tilt = std::acos(std::clamp(dot(at, normal) / std::max(norm(at), 1e-12), -1.0, 1.0)) * 180 / pi;
    table.rows.push_back({camera.views[v].name, std::to_string(camera.views[v].corners.size()),
                          number_text(view.rms_px, 3), number_text(view.weight, 2), number_text(tilt, 2),
                          number_text(norm(at), 3), view.note});
  }
  page.heat_strip(strip);
  page.table(table);
}

}  // namespace

double arrow_scale(int width_px, const std::vector<Vec2>& arrow_px) {
  std::vector<double> lengths;
  for (const Vec2 a : arrow_px)
    if (std::isfinite(norm(a))) lengths.push_back(norm(a));
  const double typical = lengths.empty() ? 1 : std::max(1e-9, stats::quantile(lengths, 0.95));
  const double wanted = 0.05 * width_px / typical, decade = std::pow(10, std::floor(std::log10(wanted)));
  return wanted < 2 * decade ? decade : wanted < 5 * decade ? 2 * decade : 5 * decade;
}

std::string arrows(int width_px, int height_px, const std::vector<Vec2>& at, const std::vector<Vec2>& arrow_px,
                   double scale) {
  std::string dots, lines;
  const double dot = 0.002 * width_px;
  char text[160];
  for (std::size_t k = 0; k < at.size(); ++k) {
    if (!std::isfinite(norm(arrow_px[k]))) continue;
    const Vec2 to = at[k] + arrow_px[k] * scale;
    std::snprintf(text, sizeof text, "<circle cx=\"%.1f\" cy=\"%.1f\" r=\"%.1f\"/>", at[k].x, at[k].y, dot);
    dots += text;
    std::snprintf(text, sizeof text, "M%.1f %.1fL%.1f %.1f", at[k].x, at[k].y, to.x, to.y);
    lines += text;
  }
  std::snprintf(text, sizeof text, "<svg viewBox=\"%.0f %.0f %.0f %.0f\" role=\"img\" ", -0.02 * width_px,
                -0.02 * width_px, 1.04 * width_px, height_px + 0.04 * width_px);
  std::string svg = text;
  svg += "style=\"background:#fff;min-width:min(40rem,85vw)\">";
  std::snprintf(text, sizeof text,
                "<rect x=\"-0.5\" y=\"-0.5\" width=\"%d\" height=\"%d\" fill=\"none\" stroke=\"#888\" ", width_px,
                height_px);
  svg += text;
  std::snprintf(text, sizeof text, "stroke-width=\"%.1f\"/><g fill=\"#999\">", 0.5 * dot);
  svg += text + dots;
  std::snprintf(text, sizeof text, "\" stroke=\"#b3261e\" stroke-width=\"%.1f\" fill=\"none\"/></svg>", 0.9 * dot);
  return svg + "</g><path d=\"" + lines + text;
}

std::string calibration_page(const CameraResult& camera, const Quality& quality) {
  const CameraSetup& setup = camera.setup.cameras[camera.camera];
  std::size_t used = 0;
  for (std::size_t v = 0; v < camera.views.size(); ++v) used += camera.uses(v);
  const Halves& h = quality.halves;
  Page page("calib-charuco: " + setup.name, quality.verdict,
            setup.name + ": model " + setup.model + ", " + std::to_string(used) + " views, " +
                std::to_string(camera.calibration.cameras[camera.camera].corners) + " corners",
            !h.refused.empty() ? report::Tone::neutral
            : h.agree          ? report::Tone::good
                               : report::Tone::bad);
  page.section("How good it is");
  key_numbers(page, camera, quality);
  if (!camera.calibration.complaints.empty()) page.list(camera.calibration.complaints);
  if (!quality.next.empty()) {
    page.subsection("What to photograph next");
    std::vector<std::string> items;
    for (const NextView& view : quality.next) items.push_back(view.sentence + ".");
    page.list(items);
  }
  numbers(page, camera);
  prediction(page, quality);
  halves(page, camera, h);
  residuals(page, camera);
  views(page, camera);
  page.footer("Written by gonio calib-charuco. Sigmas are of the corners' noise as the residuals show it.");
  return page.html();
}

void write_quality(const CameraResult& camera, const Quality& quality,
                   const std::function<std::filesystem::path(const std::string&)>& path_of, const std::string& suffix,
                   manifest::Document& document) {
  manifest::CameraQuality& section =
      document.cameras.at(camera.setup.cameras[camera.camera].name).quality.emplace(section_of(quality));
  const auto enter = [&](const std::string& name, const std::filesystem::path& path) {
    section.files[name] = manifest::add_file(document, path, name + suffix);
  };
  const auto [lower, upper] = radius_range(quality.maps);
  for (std::size_t k = 0; k < quality.maps.size(); ++k) {
    const ProjectionMap& map = quality.maps[k];
    const std::string name = k == 0 ? "projection-sigma" : "projection-sigma-" + std::to_string(k + 1);
    const std::filesystem::path exr = path_of(name + suffix + ".exr"), png = path_of(name + suffix + ".png");
    io::write_picture(exr, values_of(map));
    io::write_picture(png, picture_of(map, lower, upper));
    enter(name, exr);
    enter(name + "-picture", png);
  }
  const std::filesystem::path coverage = path_of("coverage" + suffix + ".png");
  io::write_picture(coverage, picture_of(quality.coverage));
  enter("coverage", coverage);
  write_file(path_of("calibration" + suffix + ".html"), calibration_page(camera, quality));
}

}  // namespace gonio::tools::calib_charuco
