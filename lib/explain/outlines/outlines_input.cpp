// See outlines_problem.h: from the manifest to rims against their model.
#include <algorithm>
#include <cmath>
#include <limits>
#include <set>

#include "alignment/lamp_size.h"
#include "alignment/model_region.h"
#include "alignment/rim_bias.h"
#include "base/error.h"
#include "explain/outlines/outlines_problem.h"
#include "manifest/document.h"
#include "manifest/sections/alignment.h"
#include "manifest/sections/light.h"
#include "mechanism/mechanism.h"
#include "scene/amounts.h"
#include "stats/intervals.h"

namespace gonio::mechanism {
const Mechanism& geometry_offset();
const Mechanism& geometry_scale();
const Mechanism& ground_not_flat();
const Mechanism& light_finite_size();
}  // namespace gonio::mechanism

namespace gonio::explain {
namespace {

using alignment::AlignmentInput;
using alignment::Question;
using alignment::RimPoint;
using alignment::Setting;
using manifest::Document;

constexpr double stretch_px = 32;  // of a rim: one block
constexpr double spacing_px = 2;   // of the points that are asked
constexpr double reach_px = 12;    // of the model's rim
constexpr double usual_radius_m = 0.01;
constexpr double usual_scale = 0.05;
constexpr double least_sigma_px = 0.05;  // masks of shadows that look better are off by as much all along
constexpr double width_error = 0.1;      // of an edge's width, as a share, at least
constexpr double least_width_error_px = 0.15;

bool moves(const std::vector<double>& covariance) {
  return std::any_of(covariance.begin(), covariance.end(), [](double v) { return v != 0; });
}

// What align had left free, by what it says that it found.
alignment::InputWish wish_of(const Document& d) {
  alignment::InputWish wish;
  wish.any_start = false, wish.contact_m = 0;
  bool pose = false, light = false;
  for (const manifest::Alignment& a : d.alignments) {
    if (a.verdict != "found" && a.verdict != "ambiguous") continue;
    wish.objects.push_back(a.object);
    pose |= moves(a.covariance);
    if (!a.scale.empty()) wish.freed.insert("scale");
    for (const manifest::AlignedLight& l : a.lights) light |= moves(l.covariance_m2);
    for (const manifest::AlignedCamera& c : a.cameras) {
      if (moves(c.covariance)) wish.freed.insert("camera");
      if (c.focal_factor) wish.freed.insert("focal");
    }
  }
  if (!pose) wish.held.insert("pose");
  if (!light) wish.held.insert("light");
  return wish;
}

double radius_of(const Document& d, const std::string& lamp) {
  const manifest::Light& light = d.lights.at(lamp);
  const auto own = light.parameters.find("radius_m");
  const double radius =
      light.model == "sphere" && own != light.parameters.end() && !own->second.value.empty() ? own->second.value[0] : 0;
  const auto amounts = scene::amounts_on(d, mechanism::light_finite_size(), lamp);
  return amounts ? amounts->front() : radius;
}

// By the differences of neighbours a few pixels apart, which no smooth effect reaches. Errors of masks are alike over
// longer stretches: what the nearest fit leaves is asked beside it.
double noise_of(const std::vector<OutlineRow>& rows, bool width) {
  std::vector<double> steps;
  const OutlineRow* before = nullptr;
  for (const OutlineRow& r : rows) {
    if (r.width != width) continue;
    if (before != nullptr && before->stretch == r.stretch) steps.push_back(std::abs(r.observed - before->observed));
    before = &r;
  }
  if (steps.size() < 8) return 0.2;
  return stats::sigma_of_median * stats::median(steps) / std::sqrt(2.0);
}

std::vector<double> sizes_of(std::vector<double> values) {
  for (double& v : values) v = std::abs(v);
  return values;
}

// How many neighbours err alike: the sum of the autocorrelation. Rows whose standard deviations are larger by its root
// tell together as much as they do.
double alike_rows(const std::vector<double>& left) {
  constexpr std::size_t farthest = 24;
  double square = 0;
  for (const double v : left) square += v * v;
  double sum = 1;
  for (std::size_t lag = 1; lag <= farthest && lag < left.size() && square > 0; ++lag) {
    double product = 0;
    for (std::size_t i = lag; i < left.size(); ++i) product += left[i] * left[i - lag];
    if (product < 0.1 * square) break;
    sum += 2 * product / square;
  }
  return sum;
}

class RimReader {
 public:
  explicit RimReader(OutlinesInput& input) : input_(input), in_(input.in) {}

  void read() {
    anchor_ = nearest_fit();
    const Setting& anchor = anchor_;
    const std::vector<alignment::LampSize> sizes = alignment::lamp_sizes(in_, anchor);
    std::vector<double> larger = input_.radii_m;
    for (std::size_t l = 0; l < larger.size(); ++l)
      if (larger[l] == 0) larger[l] = sizes[l].told() ? sizes[l].radius_m : usual_radius_m;
    const Question plain = alignment::without_bias(in_, anchor, input_.radii_m);
    const Question wide = alignment::without_bias(in_, anchor, larger);
    input_.lit.resize(anchor.lamps_m.size());
    for (std::size_t k = 0; k < in_.rims.size(); ++k) {
      const alignment::RimSubject& subject = in_.question.sightings[k].subject;
      if (!subject.lamp && !seen_.insert({subject.station, subject.body}).second) continue;  // under another lamp
      const std::string& image = in_.rims[k].image;
      OutlineView view{image + " " + in_.bodies[subject.body] + (subject.lamp ? " shadow" : ""), image, subject};
      const double radius = subject.lamp ? larger[*subject.lamp] : 0;
      add_rows(k, plain, wide, radius, sizes, view);
      if (view.rows.size() >= 8) input_.views.push_back(std::move(view));
    }
  }

 private:
  // With poses, lamps and sizes along all axes free, whatever is asked later: so near to what was seen that every point
  // meets the place of the mesh that is its own.
  Setting nearest_fit() const {
    Question q = alignment::without_bias(in_, in_.stated, input_.radii_m);
    q.freedoms = in_.question.freedoms;
    const auto free_as_well = [&q](alignment::Block block, std::size_t which, double prior = 0) {
      const auto same = [&](const alignment::Freedom& f) { return f.block == block && f.which == which; };
      if (std::none_of(q.freedoms.begin(), q.freedoms.end(), same)) q.freedoms.push_back({block, which, prior});
    };
    for (std::size_t b = 0; b < in_.bodies.size(); ++b) {
      free_as_well(alignment::Block::body_turn, b), free_as_well(alignment::Block::body_shift, b);
      free_as_well(alignment::Block::body_scale, b, usual_scale);
    }
    for (std::size_t l = 0; l < in_.lamps.size(); ++l) free_as_well(alignment::Block::lamp_shift, l);
    return alignment::settle_rims(in_.stated, q,
                                  {{.reach_px = reach_px, .width_px = 2, .both_ways = true, .most_steps = 20},
                                   {.reach_px = 5, .width_px = 0, .most_steps = 15}});
  }
  void add_rows(std::size_t k, const Question& plain, const Question& wide, double radius,
                const std::vector<alignment::LampSize>& sizes, OutlineView& view) {
    const alignment::RimSubject& subject = view.subject;
    const Setting& anchor = anchor_;
    const alignment::ModelRim rim(anchor, subject);
    const auto& points = plain.sightings[k].points;
    std::vector<double> levers(points.size(), std::numeric_limits<double>::quiet_NaN());
    const bool asked = subject.lamp && input_.radii_m[*subject.lamp] == 0;
    if (subject.lamp && !in_.rims[k].spread_px.empty())
      levers = alignment::edge_levers(in_, anchor, k, sizes[*subject.lamp].told() || !asked ? radius : 0);
    std::vector<float> covered;
    if (subject.lamp) covered = alignment::model_region(in_, anchor, subject);
    std::vector<double> left;  // beside the nearest fit
    double arc = -1e9;
    std::uint32_t loop = 0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const RimPoint& p = points[i];
      if (!p.counts) continue;
      const auto place = rim.nearest(p.pixel, p.outward, reach_px);
      if (subject.lamp) count_lit(k, i, place.has_value() && std::abs(place->distance_px) < 4, covered);
      if (!place) continue;
      const bool measured = std::isfinite(levers[i]) && std::isfinite(in_.rims[k].spread_px[i]);
      if (!measured && loop == p.loop && std::abs(p.arc_px - arc) < spacing_px) continue;
      loop = p.loop, arc = p.arc_px;
      OutlineRow row = row_of(subject, *place, p);
      left.push_back(place->distance_px);
      row.observed = dot(p.pixel - row.pixel, row.outward);
      if (asked && radius > 0)
        row.penumbra = -dot(wide.sightings[k].points[i].pixel - p.pixel, p.outward) / (radius * radius);
      view.rows.push_back(row);
      if (!measured) continue;
      row.width = true, row.lever = levers[i], row.observed = in_.rims[k].spread_px[i];
      view.rows.push_back(row);
    }
    const double offset = std::max({least_sigma_px, noise_of(view.rows, false),
                                    stats::sigma_of_median * stats::median(sizes_of(left))}),
                 width = noise_of(view.rows, true);
    const double alike = std::sqrt(alike_rows(left));
    for (OutlineRow& r : view.rows)
      r.sigma = alike * (r.width ? std::max({width, least_width_error_px, width_error * r.observed}) : offset);
  }

  OutlineRow row_of(const alignment::RimSubject& subject, const alignment::RimPlace& place, const RimPoint& p) {
    OutlineRow row;
    row.mesh_point = place.mesh_point, row.outward = place.outward;
    const Vec3 world = in_.stated.bodies[subject.body].place_m(place.mesh_point);
    row.pixel = subject.lamp ? alignment::project_shadow(in_.stated, subject.station, *subject.lamp, world).pixel
                             : alignment::project(in_.stated, subject.station, world).pixel;
    std::array<double, 3> g{};
    alignment::slopes_of(anchor_, {{alignment::Block::body_shift, subject.body}}, {}, subject.station, subject.body,
                         subject.lamp, place.mesh_point, place.outward, g.data());
    row.outside = normalized(Vec3{g[0], g[1], g[2]});
    row.stretch = stretch_of(p);
    return row;
  }
  static std::uint32_t stretch_of(const RimPoint& p) {
    return p.loop * 10000 + static_cast<std::uint32_t>(p.arc_px / stretch_px);
  }

  // Points without a rim of the model's, a pixel from which the shadow is whole, or where none is.
  void count_lit(std::size_t k, std::size_t i, bool met, const std::vector<float>& covered) {
    const alignment::RimSubject& subject = in_.question.sightings[k].subject;
    LitInside& lit = input_.lit[*subject.lamp];
    lit.lamp = *subject.lamp, ++lit.points;
    if (met) return;
    const camera_size size = size_of(anchor_lens(subject));
    const Vec2 at = in_.rims[k].in_picture[i].pixel;
    const auto x = static_cast<long>(std::lround(at.x)), y = static_cast<long>(std::lround(at.y));
    if (x < 0 || y < 0 || x >= size.first || y >= size.second) return;
    const bool inside = covered[static_cast<std::size_t>(y * size.first + x)] > 0.99F;
    lit.inside += inside;
    const RimPoint& p = in_.rims[k].in_picture[i];
    const auto stretch = std::pair{k, p.loop * 10000 + static_cast<std::uint32_t>(p.arc_px / (0.5 * stretch_px))};
    if (stretches_.insert(stretch).second) ++(inside ? lit.stretches_inside : lit.stretches_outside);
  }
  using camera_size = std::pair<long, long>;
  camera_size size_of(std::size_t lens) const { return {in_.models[lens].width_px(), in_.models[lens].height_px()}; }
  std::size_t anchor_lens(const alignment::RimSubject& subject) const {
    return in_.stated.stations[subject.station].lens;
  }

  OutlinesInput& input_;
  AlignmentInput& in_;
  Setting anchor_;
  std::set<std::pair<std::size_t, std::size_t>> seen_;
  std::set<std::pair<std::size_t, std::uint32_t>> stretches_;
};

// The blur that the narrowest edges of each lens have.
std::vector<double> blurs_of(const OutlinesInput& input) {
  std::vector<std::vector<double>> widths(input.in.stated.lenses.size());
  for (const OutlineView& v : input.views)
    for (const OutlineRow& r : v.rows)
      if (r.width) widths[input.in.stated.stations[v.subject.station].lens].push_back(r.observed);
  std::vector<double> blur;
  for (std::vector<double>& w : widths) {
    std::sort(w.begin(), w.end());
    blur.push_back(w.empty() ? 0 : w[w.size() / 5]);
  }
  return blur;
}

}  // namespace

bool has_outlines(const Document& document) {
  return !document.outlines.empty() &&
         std::any_of(document.alignments.begin(), document.alignments.end(),
                     [](const manifest::Alignment& a) { return a.verdict == "found" || a.verdict == "ambiguous"; });
}

void outlines_within_reach(const Document& document) {
  // The aligned model does not have these: what they do would be named once more.
  for (const mechanism::Mechanism* m :
       {&mechanism::geometry_offset(), &mechanism::geometry_scale(), &mechanism::ground_not_flat()})
    if (document.mechanisms.contains(m->id))
      throw Error(Exit::data, manifest::place(document, "/mechanisms/" + m->id),
                  "is switched on, and rims of models are made without it", "ask rims without it, or pictures with it");
  if (document.outlines.size() >= fewest_rims) return;
  throw Error(
      Exit::data, manifest::place(document, "/outlines"),
      "has " + std::to_string(document.outlines.size()) + " rims (at least " + std::to_string(fewest_rims) + ")",
      "add views or lamps: what was left out is judged on rims that the fit never saw");
}

OutlinesInput outlines_of(alignment::AlignmentInput in, std::vector<double> radii_m) {
  OutlinesInput input;
  input.in = std::move(in), input.radii_m = std::move(radii_m);
  input.scales_free = std::any_of(input.in.question.freedoms.begin(), input.in.question.freedoms.end(),
                                  [](const alignment::Freedom& f) { return f.block == alignment::Block::body_scale; });
  RimReader(input).read();
  input.blur_px = blurs_of(input);
  return input;
}

OutlinesInput outlines_input(const Document& document) {
  outlines_within_reach(document);
  alignment::AlignmentInput in = alignment::read_alignment(document, wish_of(document), {});
  std::vector<double> radii;
  for (const std::string& lamp : in.lamps) radii.push_back(radius_of(document, lamp));
  OutlinesInput input = outlines_of(std::move(in), std::move(radii));
  if (input.views.size() < fewest_rims)
    throw Error(Exit::data, manifest::place(document, "/outlines"),
                "have " + std::to_string(input.views.size()) + " rims beside the aligned model (at least " +
                    std::to_string(fewest_rims) + "; an object's under several lamps is one)",
                "add views, or align them first");
  return input;
}

}  // namespace gonio::explain
