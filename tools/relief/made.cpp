// See made.h.
#include "tools/relief/made.h"

#include "base/error.h"
#include "tools/relief/options.h"

namespace gonio::tools::relief {

using namespace gonio::relief;

namespace {

double length(const cli::Invocation& call, const char* option, double otherwise) {
  return call.given(option) ? call.number(option) : otherwise;
}

double needed(const cli::Invocation& call, const char* option) {
  if (!call.given(option))
    throw Error(Exit::usage, std::string("--") + option, "is missing", "relief " + call.text("ACTION") + " needs it");
  return call.number(option);
}

Made ridges_made(const RidgeShape& s, int points_across) {
  std::map<std::string, std::vector<double>> design{
      {"ridge_rad", {s.ridge_rad}}, {"pitch_m", {s.pitch_m}}, {"ridges", {static_cast<double>(s.ridges)}}};
  const auto add = [&design](const char* name, double value) {
    if (value > 0) design[name] = {value};
  };
  add("crest_radius_m", s.crest_radius_m), add("trough_radius_m", s.trough_radius_m), add("length_m", s.length_m);
  if (s.burr_share > 0) {
    add("burr_share", s.burr_share), add("burr_height_m", s.burr_height_m);
    add("burr_width_m", s.burr_width_m), add("burr_length_m", s.burr_length_m);
  }
  return {ridges(s, {points_across, 0}), std::move(design)};
}

}  // namespace

RidgeShape ridge_asked(const cli::Invocation& call) {
  RidgeShape shape;
  shape.ridge_rad = needed(call, "angle"), shape.pitch_m = needed(call, "pitch");
  shape.crest_radius_m = length(call, "crest-radius", 0), shape.trough_radius_m = length(call, "trough-radius", 0);
  if (call.given("burr-share")) {
    shape.burr_share = call.number("burr-share");
    shape.burr_height_m = needed(call, "burr-height"), shape.burr_width_m = needed(call, "burr-width");
    shape.burr_length_m = length(call, "burr-length", shape.burr_width_m);
  }
  shape.ridges = static_cast<int>(call.integer("ridges"));
  shape.length_m = length(call, "length", 0);
  shape.seed = call.seed;
  return shape;
}

NoiseField noise_asked(const cli::Invocation& call) {
  NoiseField field;
  field.parts = parts_asked(call), field.seed = call.seed, field.periodic = call.flag("periodic");
  field.nx = field.ny = static_cast<int>(call.integer("points"));
  field.step_m = needed(call, "step");
  return field;
}

Made made(const cli::Invocation& call) {
  const std::string& action = call.text("ACTION");
  if (action == "ridges") return ridges_made(ridge_asked(call), static_cast<int>(call.integer("points-across")));
  if (action == "sinusoid") {
    const double amplitude = needed(call, "amplitude"), x = length(call, "wave-x", 0), y = length(call, "wave-y", 0);
    std::map<std::string, std::vector<double>> design{{"amplitude_m", {amplitude}}};
    if (x > 0) design["wave_x_m"] = {x};
    if (y > 0) design["wave_y_m"] = {y};
    return {sinusoid(amplitude, x, y, static_cast<int>(call.integer("points-per-wave"))), std::move(design)};
  }
  const NoiseField field = noise_asked(call);
  std::map<std::string, std::vector<double>> design;
  for (const NoisePart& part : field.parts)
    design["sq_m"].push_back(part.sq_m), design["cell_m"].push_back(part.cell_m);
  return {noise_relief(field), std::move(design)};
}

Made noise_like(const GroundNoise& ground, const io::HeightMap& map, std::uint64_t seed, bool periodic) {
  NoiseField field;
  field.step_m = map.step_x_m, field.seed = seed, field.periodic = periodic;
  field.nx = static_cast<int>(map.width), field.ny = static_cast<int>(map.height);
  std::map<std::string, std::vector<double>> design;
  for (const GroundPart& part : ground.parts) {
    field.parts.push_back({part.sq_m, part.cell_m});
    design["sq_m"].push_back(part.sq_m), design["cell_m"].push_back(part.cell_m);
  }
  return {noise_relief(field), std::move(design)};
}

}  // namespace gonio::tools::relief
