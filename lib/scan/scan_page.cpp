// See scan_page.h.
#include "scan/scan_page.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>

#include "base/text.h"
#include "io/picture.h"
#include "manifest/sections/cloud.h"
#include "report/colour_map.h"
#include "report/mesh_view.h"
#include "report/number_text.h"
#include "stats/intervals.h"

namespace gonio::scan {
namespace {

constexpr int widest = 640, finest_grid = 160,
              residual_cells = 120;  // pixels of a picture; cells of the surface along the longer side
constexpr float torn = 6;            // times the usual step in depth between two cells: no surface there

// Colours that the colour-blind tell apart (Okabe & Ito 2008), in the order of Refusal.
struct RefusalColour {
  report::Colour colour;
  const char* name;
};
constexpr std::array<RefusalColour, refusal_names.size()> refusal_colours{{{{0.88f, 0.88f, 0.88f}, "light grey"},
                                                                           {{0, 0, 0}, "black"},
                                                                           {{0.27f, 0.27f, 0.27f}, "dark grey"},
                                                                           {{0.90f, 0.62f, 0}, "orange"},
                                                                           {{0.34f, 0.71f, 0.91f}, "light blue"},
                                                                           {{0.84f, 0.37f, 0}, "vermilion"},
                                                                           {{0.80f, 0.47f, 0.65f}, "pink"},
                                                                           {{0.94f, 0.89f, 0.26f}, "yellow"},
                                                                           {{0, 0.62f, 0.45f}, "green"},
                                                                           {{0.45f, 0.30f, 0.15f}, "brown"},
                                                                           {{0, 0.45f, 0.70f}, "blue"}}};

// Of the refusals that occur.
std::string refusals_in_words(const Codes& codes) {
  std::string text;
  for (std::size_t r = 0; r < refusal_colours.size(); ++r)
    if (std::ranges::count(codes.refusal, static_cast<Refusal>(r)) > 0)
      text += (text.empty() ? "" : "; ") + std::string(refusal_colours[r].name) + ": " +
              (r == 0 ? "told" : std::string(refusal_names[r]));
  return text;
}

// A smaller picture of sRGB codes; `colour` of a pixel of the camera.
template <class ColourOf>
std::string png_of(int width, int height, const ColourOf& colour) {
  const int stride = std::max(1, (width + widest - 1) / widest);
  io::Image picture((width + stride - 1) / stride, (height + stride - 1) / stride, {"R", "G", "B"});
  for (int y = 0; y < picture.height; ++y)
    for (int x = 0; x < picture.width; ++x) {
      const report::Colour c = colour(static_cast<std::size_t>(y * stride) * static_cast<std::size_t>(width) +
                                      static_cast<std::size_t>(x * stride));
      for (int k = 0; k < 3; ++k) picture.at(x, y, k) = c[static_cast<std::size_t>(k)];
    }
  return io::encode_png(picture);
}

report::Colour grey(double v) {
  const auto code = static_cast<float>(std::sqrt(std::clamp(v, 0.0, 1.0)));
  return {code, code, code};
}

std::vector<report::Figure> figures_of(const Codes& codes, const Sequence& sequence) {
  std::vector<report::Figure> figures;
  float brightest = 0;
  for (const float v : codes.reflected) brightest = std::max(brightest, v);
  figures.push_back(
      {.png = png_of(codes.width, codes.height,
                     [&](std::size_t i) { return grey(codes.reflected[i] / std::max(1e-9f, brightest)); }),
       .title = "What the projector's white adds"});
  constexpr const char* names[] = {"Columns of the projector", "Rows of the projector"};
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (codes.place[axis].empty()) continue;
    const double size = sequence.size(static_cast<Axis>(axis));
    figures.push_back({.png = png_of(codes.width, codes.height,
                                     [&](std::size_t i) {
                                       return codes.told(i) ? report::magnitude_colour(codes.place[axis][i] / size)
                                                            : report::Colour{0.88f, 0.88f, 0.88f};
                                     }),
                       .title = names[axis],
                       .caption = format("from 0, dark, to %g, yellow; grey where they are not told", size)});
  }
  figures.push_back(
      {.png = png_of(codes.width, codes.height,
                     [&](std::size_t i) { return refusal_colours[static_cast<std::size_t>(codes.refusal[i])].colour; }),
       .title = "Pixels that are not told",
       .caption = refusals_in_words(codes)});
  return figures;
}

// Beyond them lie single points that are wrong, and everything else would be small: a fifth beyond 98 % of all.
std::pair<double, double> usual_depths(const Cloud& cloud, const Rigid<frame::Camera, frame::Rig>& camera_from_rig) {
  std::vector<double> depths;
  for (const ScanPoint& p : cloud.points) depths.push_back((camera_from_rig * p.position_m).z);
  std::ranges::sort(depths);
  if (depths.empty()) return {};
  const auto at = [&](double share) {
    return depths[static_cast<std::size_t>(share * static_cast<double>(depths.size() - 1))];
  };
  const double spread = at(0.99) - at(0.01);
  return {at(0.01) - 0.2 * spread, at(0.99) + 0.2 * spread};
}

// Points on a grid of the first camera's pixels, neighbours joined where no depth is torn.
report::ViewedMesh surface_of(const Cloud& cloud, const Station& first, int width, int height) {
  const int cell = std::max(1, (std::max(width, height) + finest_grid - 1) / finest_grid),
            across = (width + cell - 1) / cell, down = (height + cell - 1) / cell;
  std::vector<int> at(static_cast<std::size_t>(across * down), -1);
  report::ViewedMesh mesh;
  mesh.name = "points";
  const auto camera_from_rig = inverse(first.rig_from_camera);
  std::vector<float> depth;
  const auto [nearest, farthest] = usual_depths(cloud, camera_from_rig);
  for (const ScanPoint& p : cloud.points) {
    const double z = (camera_from_rig * p.position_m).z;
    if (z < nearest || z > farthest) continue;
    const int x = static_cast<int>(p.pixel.x + 0.5) / cell, y = static_cast<int>(p.pixel.y + 0.5) / cell;
    if (x < 0 || y < 0 || x >= across || y >= down) continue;
    int& place = at[static_cast<std::size_t>(y * across + x)];
    if (place >= 0) continue;
    place = static_cast<int>(mesh.positions.size());
    const Vec3 c = camera_from_rig * p.position_m;
    mesh.positions.push_back({static_cast<float>(c.x), static_cast<float>(-c.y), static_cast<float>(-c.z)});
    mesh.value.push_back(static_cast<float>(1e3 * p.sigma_m));
    depth.push_back(static_cast<float>(c.z));
  }
  const auto vertex = [&](int x, int y) { return at[static_cast<std::size_t>(y * across + x)]; };
  std::vector<double> steps;
  for (int y = 0; y < down; ++y)
    for (int x = 0; x + 1 < across; ++x)
      if (vertex(x, y) >= 0 && vertex(x + 1, y) >= 0)
        steps.push_back(std::abs(depth[static_cast<std::size_t>(vertex(x, y))] -
                                 depth[static_cast<std::size_t>(vertex(x + 1, y))]));
  const float most = steps.empty() ? 0 : torn * static_cast<float>(stats::median(steps));
  const auto join = [&](int a, int b, int c) {
    if (a < 0 || b < 0 || c < 0) return;
    const float za = depth[static_cast<std::size_t>(a)], zb = depth[static_cast<std::size_t>(b)],
                zc = depth[static_cast<std::size_t>(c)];
    if (std::max({za, zb, zc}) - std::min({za, zb, zc}) > most) return;
    mesh.triangles.push_back(
        {static_cast<std::uint32_t>(a), static_cast<std::uint32_t>(b), static_cast<std::uint32_t>(c)});
  };
  for (int y = 0; y + 1 < down; ++y)
    for (int x = 0; x + 1 < across; ++x) {
      join(vertex(x, y), vertex(x, y + 1), vertex(x + 1, y));
      join(vertex(x + 1, y), vertex(x, y + 1), vertex(x + 1, y + 1));
    }
  return mesh;
}

// What a point's pictures contradict each other by, cell by cell of the first camera's picture: the mean.
report::Figure residuals_of(const Cloud& cloud, int width, int height) {
  const int cell = std::max(1, (width + residual_cells - 1) / residual_cells), across = (width + cell - 1) / cell,
            down = (height + cell - 1) / cell;
  std::vector<double> sum(static_cast<std::size_t>(across * down)), count(sum.size()), sizes;
  for (const ScanPoint& p : cloud.points) {
    if (p.across_px == 0 || p.camera != 0) continue;
    const int x = static_cast<int>(p.pixel.x + 0.5) / cell, y = static_cast<int>(p.pixel.y + 0.5) / cell;
    if (x < 0 || y < 0 || x >= across || y >= down) continue;
    const auto i = static_cast<std::size_t>(y * across + x);
    sum[i] += double{p.across_px}, ++count[i], sizes.push_back(std::abs(double{p.across_px}));
  }
  if (sizes.empty()) return {};
  const double full = std::max(1e-6, 2 * stats::median(sizes));
  io::Image picture(across, down, {"R", "G", "B"});
  for (std::size_t i = 0; i < sum.size(); ++i) {
    const report::Colour c =
        count[i] > 0 ? report::signed_colour(sum[i] / count[i] / full) : report::Colour{0.88f, 0.88f, 0.88f};
    for (std::size_t k = 0; k < 3; ++k) picture.data[3 * i + k] = c[k];
  }
  return {.png = io::encode_png(picture),
          .title = "What should meet and does not",
          .caption =
              "How far the first camera saw points off where all pictures together put them, mean of a cell: red "
              "on one side, blue on the other, full colour at " +
              report::number_text(full, 2) +
              " px. Noise is speckle; what goes smoothly over the picture is the rig, or a lens."};
}

report::Figure points_of(const Cloud& cloud, const Station& first, int width, int height, const std::string& name,
                         double largest_mm) {
  report::MeshView view;
  view.name = "Points of " + name + " as the first camera sees them";
  view.meshes = {surface_of(cloud, first, width, height)};
  view.label = "standard deviation", view.unit = "mm", view.low = 0, view.high = largest_mm;
  view.turn = {1, 0, 0, 0, 1, 0, 0, 0, 1};
  return {
      .svg = report::html(view),
      .title = "Points",
      .caption = "One for each few pixels of the first camera; turn it by dragging. Dark is exact, yellow least so."};
}

// Of every camera; reasons that nowhere occur are left out. Ambiguous pixels were told, and refused with the points.
report::TableText refusals_of(const std::vector<std::string>& cameras, const std::vector<Codes>& codes,
                              const Cloud& cloud) {
  report::TableText table;
  table.caption = "Pixels by what became of them.";
  table.columns = {{"Camera", "", false}};
  for (const std::string& name : cameras) table.rows.push_back({name});
  const auto ambiguous = cloud.refused.find(std::string(refusal_names[static_cast<std::size_t>(Refusal::ambiguous)]));
  for (std::size_t r = 0; r < refusal_names.size(); ++r) {
    std::vector<std::size_t> counts;
    for (const Codes& own : codes)
      counts.push_back(static_cast<std::size_t>(std::ranges::count(own.refusal, static_cast<Refusal>(r))));
    if (ambiguous != cloud.refused.end() && static_cast<Refusal>(r) == Refusal::ambiguous)
      counts[0] = ambiguous->second;
    if (ambiguous != cloud.refused.end() && r == 0) counts[0] -= ambiguous->second;
    if (std::ranges::count(counts, 0u) == static_cast<std::ptrdiff_t>(counts.size())) continue;
    table.columns.push_back({r == 0 ? "told" : std::string(refusal_names[r])});
    for (std::size_t c = 0; c < counts.size(); ++c) table.rows[c].push_back(std::to_string(counts[c]));
  }
  return table;
}

}  // namespace

void ScanPage::add(const std::string& view, const std::vector<std::string>& cameras, const std::vector<Codes>& codes,
                   const Sequence& sequence, const Station& first, const Cloud& cloud, const manifest::Cloud& entry) {
  View v;
  v.name = view;
  v.headline = format("%zu points", cloud.points.size());
  v.numbers = {{"points", std::to_string(cloud.points.size()), "", ""}};
  std::vector<double> sigmas;
  for (const ScanPoint& p : cloud.points) sigmas.push_back(1e3 * p.sigma_m);
  if (entry.sigma_m) {
    v.headline += ", half of them to " + report::number_text(1e3 * *entry.sigma_m, 2) + " mm or better";
    v.numbers.push_back(
        {"standard deviation", report::number_text(1e3 * *entry.sigma_m, 3), "mm", "median, the worst direction"});
  }
  if (entry.reprojection_px && *entry.reprojection_px > 0)
    v.numbers.push_back({"reprojection", report::number_text(*entry.reprojection_px, 3), "px", "median"});
  if (entry.epipolar_chi_square)
    v.numbers.push_back({"what should meet misses by", report::number_text(std::sqrt(*entry.epipolar_chi_square), 2),
                         "times its noise", "1: all is as stated",
                         *entry.epipolar_chi_square > 9 ? report::Tone::bad : report::Tone::neutral});
  v.refused = refusals_of(cameras, codes, cloud);
  for (const Codes& own : codes) v.figures.push_back(figures_of(own, sequence));
  std::ranges::sort(sigmas);
  const double largest =
      sigmas.empty() ? 1 : sigmas[static_cast<std::size_t>(0.95 * static_cast<double>(sigmas.size() - 1))];
  if (!cloud.points.empty()) v.points = points_of(cloud, first, codes[0].width, codes[0].height, view, largest);
  v.residuals = residuals_of(cloud, codes[0].width, codes[0].height);
  views_.push_back(std::move(v));
}

std::string ScanPage::html() const {
  std::string headline;
  for (const View& v : views_)
    headline += (headline.empty() ? "" : "; ") + (views_.size() > 1 ? v.name + ": " : "") + v.headline;
  report::Page page(
      "Structured light", headline + ".",
      "Points from what cameras saw of a projector's patterns; standard deviations are those of the points' own "
      "covariances.");
  for (const View& v : views_) {
    page.section(v.name);
    page.key_numbers(v.numbers);
    if (!v.points.svg.empty()) page.figures({v.points}, 700);
    if (!v.residuals.png.empty()) page.figures({v.residuals}, 420);
    page.table(v.refused);
    for (std::size_t c = 0; c < v.figures.size(); ++c) {
      page.subsection("Camera " + v.refused.rows[c][0]);
      page.figures(v.figures[c], 420);
    }
  }
  return page.html();
}

}  // namespace gonio::scan
