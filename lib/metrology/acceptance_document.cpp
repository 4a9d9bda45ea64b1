#include "metrology/acceptance_document.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <set>

#include "base/progress.h"
#include "base/quantity.h"
#include "io/ply.h"
#include "manifest/document.h"
#include "manifest/sections/acceptance.h"
#include "metrology/figures.h"

namespace gonio::metrology {
namespace {

constexpr std::size_t positions_asked_for = 10;  // by the guideline, for the probing error
constexpr double too_many_beyond = 0.005;        // normal deviations: 0.27 %

std::string millimetres(double metres) {
  char text[40];
  std::snprintf(text, sizeof text, "%.4g mm", metres * 1e3);
  return text;
}

std::vector<Vec3> points_of(const std::filesystem::path& path, double metres_per_unit) {
  std::vector<Vec3> points = io::read_ply(path).positions_m;
  for (Vec3& p : points) p *= metres_per_unit;
  return points;
}

std::vector<Vec3> inside(const std::vector<Vec3>& points, const Region& region) {
  std::vector<Vec3> found;
  std::ranges::copy_if(points, std::back_inserter(found),
                       [&](const Vec3& p) { return norm(p - region.centre_m) <= region.radius_m; });
  return found;
}

void tell(const std::string& place, const Deviations& deviations) {
  if (deviations.still_beyond <= too_many_beyond) return;
  char share[40];
  std::snprintf(share, sizeof share, "%.1f %%", 100 * deviations.still_beyond);
  log(LogLevel::warning, place + ": " + share +
                             " of the points lie beyond three sigmas and count, because only 0.3 % may " +
                             "be left out; cut away what is not the artefact (--region)");
}

void check_size(const SphereFit& sphere, const AcceptanceRequest& request, const std::string& place) {
  if (!request.radius_m || request.hold_radius) return;
  const double ratio = sphere.radius_m / *request.radius_m;
  if (ratio > 0.2 && ratio < 5) return;
  throw Error(Exit::data, place,
              "holds a sphere of radius " + millimetres(sphere.radius_m) + ", not " + millimetres(*request.radius_m),
              "say what the coordinates count (--unit mm), or where the sphere is (--region)");
}

struct Measured {
  std::vector<manifest::AcceptanceResult> results;
  std::vector<SphereFit> spheres;  // of one cloud
};

void measure_spheres(const std::vector<Vec3>& points, const AcceptanceRequest& request, const std::string& place,
                     Measured& measured) {
  std::vector<std::vector<Vec3>> parts;
  for (const Region& region : request.regions) parts.push_back(inside(points, region));
  if (request.regions.empty()) parts.push_back(points);
  measured.spheres.clear();
  for (const auto& part : parts) {
    const SphereFit sphere = fit_sphere(part, request.hold_radius ? request.radius_m : std::nullopt, place);
    check_size(sphere, request, place);
    tell(place, sphere.deviations);
    measured.results.push_back(probing_form(sphere, request.radius_m, request.seed));
    if (request.radius_m && !request.hold_radius) measured.results.push_back(probing_size(sphere, *request.radius_m));
    measured.spheres.push_back(sphere);
  }
}

bool within_limits(std::vector<manifest::AcceptanceResult>& results, const AcceptanceRequest& request) {
  bool within = true;
  std::set<std::string> seen;
  for (auto& r : results) {
    seen.insert(r.quantity);
    const auto limit = request.limits_m.find(r.quantity);
    if (limit == request.limits_m.end()) continue;
    r.limit = limit->second;
    if (std::abs(r.value) <= limit->second) continue;
    within = false;
    log(LogLevel::error, (r.file.empty() ? "all clouds" : r.file) + ": " + r.quantity + " is " + millimetres(r.value) +
                             ", above the limit of " + millimetres(limit->second));
  }
  for (const auto& [quantity, limit] : request.limits_m)
    if (!seen.contains(quantity))
      throw Error(Exit::usage, "--limit", quantity + " is not among what was measured", "see --shape and --distance");
  return within;
}

}  // namespace

Region region_of(const std::string& text) {
  std::vector<double> numbers;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    numbers.push_back(parse_quantity(text.substr(from, comma - from), Dimension::length, "--region"));
    from = comma + 1;
  }
  if (numbers.size() != 4 || !(numbers[3] > 0))
    throw Error(Exit::usage, "--region", "\"" + text + "\" is no centre and radius",
                "write X,Y,Z,R: 0mm,20mm,400mm,30mm");
  return {{numbers[0], numbers[1], numbers[2]}, numbers[3]};
}

void check_acceptance(const AcceptanceRequest& request) {
  if (request.clouds.empty()) throw Error(Exit::usage, "CLOUD", "is missing", "name point clouds in PLY files");
  if (request.planes && (request.distance_m || request.radius_m || !request.regions.empty()))
    throw Error(Exit::usage, "--shape", "plane has no radius, distance or region", "leave them out");
  if (!request.distance_m) return;
  if (request.regions.size() == 1 || request.regions.size() > 2)
    throw Error(Exit::usage, "--distance", "is between two spheres", "give two regions, or none and two clouds");
  if (request.regions.empty() && request.clouds.size() % 2 != 0)
    throw Error(Exit::usage, "--distance", "is between two spheres, and the number of clouds is odd",
                "name the clouds in pairs, or give two regions");
}

Exit measure_acceptance(manifest::Document& document, const AcceptanceRequest& request) {
  check_acceptance(request);
  Measured measured;
  std::optional<SphereFit> partner;  // the first cloud of a pair
  Progress progress("clouds", request.clouds.size());
  for (const auto& path : request.clouds) {
    const std::vector<Vec3> points = points_of(path, request.metres_per_unit);
    if (request.note_input) request.note_input(path);
    const std::string file = manifest::add_file(document, path, path.stem().string());
    const std::size_t first = measured.results.size();
    if (request.planes) {
      const PlaneFit plane = fit_plane(points, path.string());
      tell(path.string(), plane.deviations);
      measured.results.push_back(flatness(plane, request.seed));
    } else {
      measure_spheres(points, request, path.string(), measured);
      if (request.distance_m && measured.spheres.size() == 2)
        measured.results.push_back(sphere_distance(measured.spheres[0], measured.spheres[1], *request.distance_m));
      if (request.distance_m && measured.spheres.size() == 1) {
        if (partner) measured.results.push_back(sphere_distance(*partner, measured.spheres[0], *request.distance_m));
        partner = partner ? std::nullopt : std::optional(measured.spheres[0]);
      }
    }
    for (std::size_t i = first; i < measured.results.size(); ++i) measured.results[i].file = file;
    progress.advance();
  }
  for (auto& summary : summaries(measured.results)) measured.results.push_back(std::move(summary));
  if (!request.planes && request.clouds.size() < positions_asked_for)
    log(LogLevel::info,
        "the guideline asks for the sphere in at least ten places; there are " + std::to_string(request.clouds.size()));
  const bool within = within_limits(measured.results, request);
  document.acceptance = std::move(measured.results);
  return within ? Exit::done : Exit::negative;
}

}  // namespace gonio::metrology
