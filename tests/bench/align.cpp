// How the time of align() grows with faces and views: the other side of scripts/bench align.
//   bench-align
// prints, for a body of so many faces in so many photographs of 1 megapixel, the seconds to prepare the mesh, of one
// rim, of a fit from 5 degrees and 10 mm, and of a search from nothing with the fit that follows.
#include <chrono>
#include <cmath>
#include <cstdio>

#include "alignment/align_bodies.h"
#include "alignment/coverage.h"

namespace {

using namespace gonio;
using namespace gonio::alignment;

double now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

Shape blob(int around) {
  const int down = around / 2;
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (int i = 0; i <= down; ++i)
    for (int j = 0; j < around; ++j) {
      const double t = pi * i / down, p = 2 * pi * j / around;
      const double r = 0.05 * (1 + 0.25 * std::sin(t) * std::cos(p + 0.4) * std::sin(2 * t) +
                               0.18 * std::sin(3 * p + 1) * std::pow(std::sin(t), 3) + 0.22 * std::cos(2 * t + 0.7) +
                               0.01 * std::sin(40 * p) * std::sin(30 * t));
      positions.push_back(
          {r * std::sin(t) * std::cos(p), 1.2 * r * std::sin(t) * std::sin(p), 0.9 * r * std::cos(t) + 0.07});
    }
  const auto at = [&](int i, int j) { return static_cast<std::uint32_t>(i * around + j % around); };
  for (int i = 0; i < down; ++i)
    for (int j = 0; j < around; ++j) {
      triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
      triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
    }
  return {std::move(positions), triangles};
}

void time_of(int around, int views, int lamps) {
  AlignmentInput in;
  double begin = now();
  in.shapes.push_back(blob(around));
  const double prepared = now() - begin;
  Setting truth;
  truth.ground = Ground{};
  truth.bodies = {{&in.shapes.back(), {}, {1, 1, 1}}};
  truth.lenses = {{2000, 2000, 511.5, 511.5}};
  in.models.emplace_back(camera::Intrinsics{2000, 2000, 511.5, 511.5, {}}, 1024, 1024);
  for (int v = 0; v < views; ++v) {
    const double a = 2 * pi * v / views;
    const Vec3 eye{0.45 * std::cos(a), 0.45 * std::sin(a), 0.35}, z = normalized(Vec3{0, 0, 0.06} - eye),
                                                                  x = normalized(cross(z, {0, 0, 1})), y = cross(z, x);
    truth.stations.push_back({{quaternion_of(Mat3{{x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z}}), eye}, 0});
    in.images_of_station.push_back({"v"});
  }
  for (int l = 0; l < lamps; ++l)
    truth.lamps_m.push_back({0.3 * std::cos(1 + 2.0 * l), 0.3 * std::sin(1 + 2.0 * l), 0.5}), in.lamps.push_back("l");
  in.bodies = {"blob"}, in.cameras = {"c"};
  for (std::size_t v = 0; v < truth.stations.size(); ++v)
    for (std::size_t l = 0; l <= truth.lamps_m.size(); ++l) {
      RimSubject subject{v, 0, {}};
      if (l > 0) subject.lamp = l - 1;
      std::vector<Side> sides;
      const ModelRim rim(truth, subject);
      for (const RimPiece& p : rim.pieces()) sides.push_back({p.from, p.to});
      SeenRim seen{0, "v", 0.6, rim_points({1024, 1024, coverage_of(sides, 1024, 1024), {}, 0}, 0.6, 12)};
      in.question.sightings.push_back({subject, seen.in_picture, {}});
      in.rims.push_back(std::move(seen));
    }
  in.question.freedoms = {{Block::body_turn, 0}, {Block::body_shift, 0}};
  for (std::size_t l = 0; l < truth.lamps_m.size(); ++l) in.question.freedoms.push_back({Block::lamp_shift, l});
  std::vector<double> off(numbers_of(in.question.freedoms), 0);
  off[0] = 0.05, off[1] = -0.06, off[2] = 0.04, off[3] = 0.006, off[4] = -0.006, off[5] = 0.005;
  in.stated = in.question.stated = moved(truth, in.question.freedoms, off);
  begin = now();
  for (int k = 0; k < 20; ++k) ModelRim(truth, {0, 0, {}});
  const double rim = (now() - begin) / 20;
  begin = now();
  const Fitted fitted = fit_rims(in.stated, in.question, stages_from(60));
  const double near = now() - begin;
  begin = now();
  const auto starts = search_body(in.stated, in.question, 0, {});
  if (!starts.empty()) fit_rims(starts.front().setting, in.question, stages_from(12));
  const double nothing = now() - begin;
  std::printf(
      "%7zu faces, %2d views, %d lamps (%2zu rims, %5zu points): mesh %6.3f s, one rim %7.2f ms, from near %6.2f s, "
      "from nothing %6.2f s; off %.4f px\n",
      in.shapes.back().triangles(), views, lamps, in.rims.size(),
      in.question.sightings[0].points.size() * in.rims.size(), prepared, 1e3 * rim, near, nothing, fitted.rms_px);
}

}  // namespace

int main() {
  for (const int around : {60, 130, 265, 530, 1000}) time_of(around, 1, 0);
  for (const int views : {1, 2, 4, 8, 16}) time_of(265, views, 0);
  time_of(265, 4, 4);
  return 0;
}
