// What the table model "probe" takes from its rows and from the manifest: cameras where the photographs have them,
// balls where their outlines put them, lamps where the manifest or their highlights say that they are.
#pragma once
#include <array>
#include <string>
#include <vector>

#include "explain/tables/image_views.h"
#include "explain/tables/table_model.h"
#include "geom/vector.h"
#include "probe/mirror_ball.h"

namespace gonio::explain::tables {

struct ProbeBall {
  std::string name;
  gonio::probe::Ball stated;
  bool uncertain = false;
  std::array<Vec3, 3> root{};  // of the centre's covariance: centre + sum of root[k] times a standard normal number
};
struct ProbeLamp {
  std::string name;
  Basis frame{Vec3{0, 0, 1}};         // n: where it is looked for first, from the balls' middle
  double inverse_distance_per_m = 0;  // by the manifest's light
  bool in_manifest = false;           // as a direction or a place
};
struct ProbeCamera {
  std::string name;
  camera::CameraModel camera;
};
struct ProbeRow {
  std::size_t view = 0, camera = 0, ball = 0, lamp = 0;
};
struct ProbeScene {
  std::vector<ImageView> views;
  std::vector<ProbeCamera> cameras;
  std::vector<ProbeBall> balls;
  std::vector<ProbeLamp> lamps;
  std::vector<ProbeRow> rows;  // as the table's
  Vec3 middle_m{};             // of the balls
  std::string place;           // for messages
};
// Error(data) at the table for images and cameras that the manifest does not have, and for balls whose place, radius or
// uncertainty differ between rows or are none.
ProbeScene probe_scene(const manifest::Document& document, const std::string& name, const Table& table);

struct FittedLamp {
  Vec3 middle_m, towards;
  Vec3 sigma_1, sigma_2;  // of `towards`, across it
  double inverse_distance_per_m = 0, inverse_distance_sigma = 0;
};
// A light of the model directional keeps its irradiance at the balls' middle and becomes a point where it has a
// distance.
void write_back(const FittedLamp& lamp, manifest::Light& light);

}  // namespace gonio::explain::tables
