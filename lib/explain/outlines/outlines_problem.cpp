// See outlines_problem.h.
#include "explain/outlines/outlines_problem.h"

#include <algorithm>
#include <cmath>

#include "explain/outlines/outline_model.h"
#include "explain/outlines/outline_parameters.h"
#include "explain/outlines/outlines_outcome.h"
#include "inference/estimable.h"
#include "inference/wording.h"
#include "manifest/document.h"

namespace gonio::explain {
namespace {

constexpr double fall = 1e-6;
constexpr double never = 2;                // a share: by what is left of a usual change over the noise alone
constexpr double trusted_px = 0.05;        // of masks
constexpr double trusted_width_px = 0.15;  // of edges in photographs
constexpr double far_off = 100;            // times a free number's size: 1 cm, 0.1 rad, a tenth
constexpr double estimable = 0.02;  // share of a parameter's signature that free and earlier parameters must leave

class OutlinesProblem final : public Problem {
 public:
  explicit OutlinesProblem(OutlinesInput input) : input_(std::move(input)), model_(input_) {
    declared_ = outline_parameters(input_, model_);
    parameters_ = declared_.parameters;
    observe();
    keep_estimable();
  }

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override {
    model_.predict(values, group, prediction);
  }
  std::string domain() const override { return "outlines"; }
  std::string unit() const override { return "px"; }
  std::string score_name() const override { return "RMS offset of rims"; }
  std::string group_noun() const override { return "rim"; }
  double fit_tolerance() const override { return fall; }
  bool noise_is_known() const override { return true; }
  bool sets_outliers_aside() const override { return true; }
  Importance importance() const override { return Importance::share_of_residual; }

  std::vector<std::size_t> tested_apart() const override {
    return lit_inside_ ? std::vector{*lit_inside_} : std::vector<std::size_t>{};
  }
  void conclude(Explanation& e) const override {
    if (lit_inside_) conclude_lit(*this, input_, *lit_inside_, e);
  }
  std::string remarks(const Explanation& e) const override { return outlines_remarks(*this, input_, e); }
  void apply(const Explanation& e, manifest::Document& document) const override {
    upgrade_outlines(*this, model_, input_, e, document);
  }
  Illustration illustrate(const Explanation& e, const std::filesystem::path&, manifest::Document&) const override {
    return illustrate_outlines(input_, observations_, e);
  }

  std::optional<Testimony> objection(const Explanation& e, std::size_t candidate) const {
    if (lit_inside_ == candidate) return {};
    Testimony t{.by = "the accuracy of masks, " + quantity(trusted_px, "px") + ",",
                .quantity = "the change of rims",
                .unit = "px"};
    const Change change = change_by(*this, input_, e, candidate);
    t.after = std::max(change.offset_px, change.width_px);
    t.refuted = change.offset_px < trusted_px && change.width_px < trusted_width_px;
    return t;
  }

 private:
  void observe() {
    Observations& o = observations_;
    o.first.push_back(0);
    std::uint32_t blocks = 0;
    for (const OutlineView& view : input_.views) {
      o.group.push_back(view.name);
      std::uint32_t last = static_cast<std::uint32_t>(-1), within = 0;
      for (const OutlineRow& row : view.rows) {
        if (row.stretch != last && last != static_cast<std::uint32_t>(-1)) ++within;
        last = row.stretch;
        o.value.push_back(row.observed), o.sigma.push_back(row.sigma), o.norm.push_back(1);
        o.block.push_back(blocks + within);
      }
      blocks += within + 1;
      o.first.push_back(o.value.size());
    }
    observe_conditions();
  }

  void observe_conditions() {
    Condition along_x{"rim.direction-x", "1", "geometry", {}, {}, "px"},
        along_y{"rim.direction-y", "1", "geometry", {}, {}, "px"}, x{"mesh.x", "m", "geometry", {}, {}, "px"},
        y{"mesh.y", "m", "geometry", {}, {}, "px"}, z{"mesh.z", "m", "geometry", {}, {}, "px"},
        ground_x{"ground.x", "m", "geometry", {}, {}, "px"}, ground_y{"ground.y", "m", "geometry", {}, {}, "px"},
        depth{"scene.depth", "m", "pose", {}, {}, "px"}, edge{"light.shadow-edge-distance", "m", "light", {}, {}, "px"};
    const double none = std::numeric_limits<double>::quiet_NaN();
    const alignment::Setting& s = input_.in.stated;
    for (const OutlineView& view : input_.views)
      for (const OutlineRow& row : view.rows) {
        const Vec3 world = s.bodies[view.subject.body].place_m(row.mesh_point);
        along_x.values.push_back(row.width ? none : row.outward.x);
        along_y.values.push_back(row.width ? none : row.outward.y);
        x.values.push_back(row.width ? none : row.mesh_point.x),
            y.values.push_back(row.width ? none : row.mesh_point.y);
        z.values.push_back(row.width ? none : row.mesh_point.z);
        depth.values.push_back((inverse(s.stations[view.subject.station].world_from_camera) * world).z);
        Vec3 fallen{none, none, none};
        if (view.subject.lamp) {
          const Vec3 lamp = s.lamps_m[*view.subject.lamp];
          const double a = s.ground->height_m(lamp), b = s.ground->height_m(world);
          fallen = (world * a - lamp * b) / (a - b);
        }
        const Vec3 on_plane = inverse(input_.in.world_from_ground) * fallen;
        ground_x.values.push_back(row.width ? none : on_plane.x);
        ground_y.values.push_back(row.width ? none : on_plane.y);
        edge.values.push_back(row.width ? norm(fallen - world) : none);
      }
    for (Condition* c : {&along_x, &along_y, &x, &y, &z, &ground_x, &ground_y, &depth, &edge}) {
      std::vector<double> known;
      for (const double v : c->values)
        if (std::isfinite(v)) known.push_back(v);
      const auto [low, high] = std::ranges::minmax_element(known);
      if (known.size() > 20 && *low < *high) observations_.conditions.push_back(std::move(*c));
    }
  }

  // What no rim holds stays where align left it, and of what is asked those numbers remain that these rims can tell.
  void keep_estimable() {
    std::vector<double> values, usual;
    std::vector<Estimable::Column> columns;
    for (const Parameter& p : parameters_) values.push_back(p.neutral);
    for (const std::size_t p : declared_.base) {
      columns.push_back(whitened_slopes(*this, p, values)), usual.push_back(parameters_[p].size * far_off);
    }
    std::vector<Estimable::Column> held;
    for (const std::size_t k : Estimable({}).kept(columns, never, usual))
      base_.push_back(declared_.base[k]), held.push_back(columns[k]);
    const Estimable beside(held);
    for (std::size_t n = 0; n < declared_.candidates.size(); ++n) {
      Candidate c = declared_.candidates[n];
      if (declared_.lit_inside == n) {
        lit_inside_ = candidates_.size();
        candidates_.push_back(std::move(c));
        continue;
      }
      std::vector<Estimable::Column> own;
      std::vector<double> sizes;
      for (const std::size_t p : c.parameters) {
        std::vector<double> begun = values;  // a radius has no slope at nothing
        begun[p] = parameters_[p].start;
        own.push_back(whitened_slopes(*this, p, begun)), sizes.push_back(parameters_[p].size / of_typical);
      }
      std::vector<std::size_t> kept;
      for (const std::size_t k : beside.kept(own, estimable, sizes)) kept.push_back(c.parameters[k]);
      c.parameters = kept;
      if (!kept.empty()) candidates_.push_back(std::move(c));
    }
  }

  OutlinesInput input_;
  OutlineModel model_;
  OutlineParameters declared_;
  std::optional<std::size_t> lit_inside_;
};

}  // namespace

std::optional<Testimony> outlines_objection(const Problem& problem, const Explanation& e, std::size_t candidate) {
  const auto* outlines = dynamic_cast<const OutlinesProblem*>(&problem);
  return outlines == nullptr ? std::nullopt : outlines->objection(e, candidate);
}

std::unique_ptr<Problem> outlines_problem(OutlinesInput input) {
  return std::make_unique<OutlinesProblem>(std::move(input));
}

}  // namespace gonio::explain
