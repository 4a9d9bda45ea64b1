#include "acquisition/plan/asked_steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <optional>
#include <sstream>

#include "acquisition/plan/view_steps.h"
#include "base/error.h"
#include "base/text.h"
#include "manifest/codec.h"
#include "manifest/document.h"
#include "manifest/explanation_tables.h"
#include "manifest/sections/explanation.h"
#include "manifest/sections/image.h"
#include "manifest/sections/laboratory.h"

namespace gonio::acquisition {
namespace {

using manifest::PlanStep;
using manifest::Value;

const manifest::ImageEntry* image_of(const manifest::Document& document, const std::string& id) {
  const auto at = std::ranges::find(document.images, id, &manifest::ImageEntry::id);
  return at == document.images.end() ? nullptr : &*at;
}

// Where pictures say that the board lies: as the first of them says it.
std::optional<Rigid<frame::World, frame::Board>> world_from_board(const manifest::Document& document,
                                                                  const std::string& board) {
  for (const manifest::ImageEntry& image : document.images)
    if (image.board == board && image.world_from_camera && image.camera_from_board)
      return *image.world_from_camera * *image.camera_from_board;
  return {};
}

// The laboratory's lamps that are these lights; a light that is no lamp stands for itself.
std::vector<std::string> lamps_of(const manifest::Document& document, const Value& lights) {
  std::vector<std::string> lamps;
  for (const Value& v : lights.as_array()) {
    std::string name = v.as_string();
    for (const manifest::Laboratory& laboratory : document.laboratory.entry)
      for (const auto& [lamp, entry] : laboratory.lamps)
        if (entry.light == v.as_string()) name = lamp;
    lamps.push_back(name);
  }
  return lamps;
}

struct Asking {
  const manifest::Document& document;
  const PatternScene& scene;
  const SampleDistances& distances;
  AskedSteps& asked;

  std::string next_image() const { return image_name("next", asked.steps.size()); }

  // Why not, in words; empty: done.
  std::string board_views(const Value& images) {
    for (const Value& entry : images.as_array()) {
      const auto view = manifest::Codec<manifest::PlannedView>::read(entry, "next_measurement");
      const auto board = world_from_board(document, view.board);
      if (!board || !view.camera_from_board) return "no picture says where board " + view.board + " lies in the world";
      PlanStep step = view_step(scene, next_image());
      step.camera = view.camera, step.purpose = "board";
      step.world_from_camera.emplace();
      static_cast<Rigid<frame::World, frame::Camera>&>(*step.world_from_camera) =
          *board * inverse(*view.camera_from_board);
      asked.steps.push_back(std::move(step));
    }
    return {};
  }

  std::string picture_again(const Value& setup) {
    const manifest::ImageEntry* image = image_of(document, setup.find("image")->as_string());
    if (image == nullptr) return "no picture \"" + setup.find("image")->as_string() + "\"";
    PlanStep step = view_step(scene, next_image());
    step.purpose = "view";
    if (!image->camera.empty()) step.camera = image->camera;
    step.world_from_camera = image->world_from_camera;
    if (image->exposure_s) step.exposures_s = {*image->exposure_s};
    if (const Value* exposure = setup.find("exposure_s")) step.exposures_s = {exposure->as_number()};
    if (const Value* scale = setup.find("exposure_scale")) {
      if (step.exposures_s.empty()) return "the exposure of picture \"" + image->id + "\" is not known";
      for (double& s : step.exposures_s) s *= scale->as_number();
    }
    if (const Value* light = setup.find("light")) {
      step.lamps = lamps_of(document, *light);
      if (step.lamps.empty()) step.purpose = "dark";
    }
    if (const Value* place = setup.find("light_position_m")) {
      const Vec3 at = manifest::Codec<Vec3>::read(*place, "next_measurement");
      step.light_m = {at.x, at.y, at.z};
    } else if (const Value* towards = setup.find("light_towards")) {
      const Vec3 direction = manifest::Codec<Vec3>::read(*towards, "next_measurement");
      if (!(norm(direction) > 0)) return "light_towards is no direction";
      const Vec3 at = scene.target_m + normalized(direction) * distances.lamp_m;
      step.light_m = {at.x, at.y, at.z};
    }
    asked.steps.push_back(std::move(step));
    return {};
  }

  // One pair of directions; of an incidence alone a scan in its plane and one across, as explain foresees it.
  std::string pairs(const Value& setup) {
    const auto angle = [&](const char* name) -> std::optional<double> {
      if (const Value* v = setup.find(std::string(name) + "_rad")) return v->as_number();
      if (const Value* v = setup.find(std::string(name) + "_deg")) return v->as_number() * degree;
      return {};
    };
    const auto ti = angle("theta_i"), phi_i = angle("phi_i"), to = angle("theta_o"), po = angle("phi_o");
    std::vector<SamplePair> list;
    if (to)
      list.push_back({*ti, phi_i.value_or(0), *to, po.value_or(pi)});
    else
      for (const double plane : {phi_i.value_or(0), phi_i.value_or(0) + pi / 2})
        for (int t = -80; t <= 80; t += 4)
          list.push_back({*ti, phi_i.value_or(0), std::abs(t) * degree, plane + (t < 0 ? pi : 0)});
    for (PlanStep& step : pair_steps(scene, list, distances)) {
      step.image = next_image();
      asked.steps.push_back(std::move(step));
    }
    return {};
  }

  std::string add(const Value& setup) {
    if (const Value* images = setup.find("images")) return board_views(*images);
    if (setup.find("image") != nullptr) return picture_again(setup);
    if (setup.find("theta_i_rad") != nullptr || setup.find("theta_i_deg") != nullptr) return pairs(setup);
    return "not a matter of views and lamps";
  }
};

}  // namespace

std::vector<PlanStep> pair_steps(const PatternScene& scene, const std::vector<SamplePair>& pairs,
                                 const SampleDistances& distances) {
  std::vector<PlanStep> steps;
  for (const SamplePair& p : pairs) {
    PlanStep step = view_step(scene, image_name("pair", steps.size()));
    step.world_from_camera = camera_at(scene, {p.theta_o_rad, p.phi_o_rad}, distances.camera_m);
    const Vec3 light = place_at(scene, {p.theta_i_rad, p.phi_i_rad}, distances.lamp_m);
    step.light_m = {light.x, light.y, light.z};
    steps.push_back(std::move(step));
  }
  return steps;
}

std::vector<SamplePair> read_pairs(const std::string& csv, const std::string& place) {
  const std::array<std::string, 4> names{"theta_i_rad", "phi_i_rad", "theta_o_rad", "phi_o_rad"};
  std::istringstream lines(csv);
  std::string line;
  std::array<std::size_t, 4> column{};
  std::vector<SamplePair> pairs;
  for (std::size_t number = 1; std::getline(lines, line); ++number) {
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line[0] == '#') continue;
    std::vector<std::string> cells;
    std::istringstream parts(line);
    for (std::string cell; std::getline(parts, cell, ',');) cells.push_back(cell);
    if (column == std::array<std::size_t, 4>{}) {  // four names cannot all stand in the first column
      for (std::size_t k = 0; k < names.size(); ++k) {
        const auto at = std::ranges::find(cells, names[k]);
        if (at == cells.end())
          throw Error(Exit::data, place + format(":%zu", number), "no column " + names[k],
                      "a table as brdf-fit --plan prints it");
        column[k] = static_cast<std::size_t>(at - cells.begin());
      }
      continue;
    }
    std::array<double, 4> value{};
    for (std::size_t k = 0; k < names.size(); ++k) {
      const std::string text = column[k] < cells.size() ? cells[column[k]] : "";
      char* end = nullptr;
      value[k] = std::strtod(text.c_str(), &end);
      if (text.empty() || *end != '\0' || !std::isfinite(value[k]))
        throw Error(Exit::data, place + format(":%zu", number), names[k] + " is \"" + text + "\"", "a number");
    }
    pairs.push_back({value[0], value[1], value[2], value[3]});
  }
  return pairs;
}

AskedSteps next_steps(const manifest::Document& document, const PatternScene& scene, const SampleDistances& distances) {
  AskedSteps asked;
  Asking asking{document, scene, distances, asked};
  for (const Value& written : document.explanations) {
    const auto entry =
        manifest::Codec<manifest::ExplanationEntry>::read(written, manifest::place(document, "/explanations"));
    for (const manifest::PlannedMeasurement& measurement : entry.next_measurement.plan) {
      const std::string why = asking.add(measurement.setup);
      if (!why.empty()) asked.left.push_back(measurement.sentence + ": " + why);
    }
  }
  return asked;
}

}  // namespace gonio::acquisition
