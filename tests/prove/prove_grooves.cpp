// Grooves of two walls that light each other, rendered by lib/render and decoded: which of the wrong pixels are
// refused, and which of the right ones with them. Pixels are those that a decoder tells which looks for nothing of the
// kind (light from elsewhere, contradictions). One is wrong where its place is off by more than three of its stated
// standard deviations and by more than 1.5 pixels of the projector, as many as a pixel of the camera covers here at
// most.
//   prove-grooves   prints one claim a line
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <initializer_list>

#include "base/text.h"
#include "scan/rendered_world.h"

namespace {

using namespace gonio;
using tests::Pinhole;
using tests::RenderedWorld;

constexpr double degree = pi / 180, wrong_px = 1.5;
constexpr scan::Axis both[] = {scan::Axis::column, scan::Axis::row};

struct Kind {
  const char* name;
  std::vector<double> periods;  // none: a Gray code
};

scan::Sequence sequence_of(const Kind& kind, const Pinhole& projector) {
  if (kind.periods.empty()) return scan::gray_sequence(projector.width, projector.height, both);
  return scan::cosine_sequence(projector.width, projector.height, std::span(both).first(1), kind.periods, 4);
}

struct Counts {
  int wrong = 0, wrong_refused = 0, right = 0, right_refused = 0, to_interreflection = 0;
  void operator+=(const Counts& o) {
    wrong += o.wrong, wrong_refused += o.wrong_refused, right += o.right, right_refused += o.right_refused;
  }
};

Counts counted(const RenderedWorld& world, const Kind& kind) {
  const Pinhole camera{200, 60, 640, {-0.06, 0, 0}, 0.0873};
  scan::DecodeRequest request;
  request.sequence = sequence_of(kind, world.projector);
  const tests::RenderedFrames frames(world, camera, request.sequence);
  const scan::Codes told = decoded(frames, world, camera, request);
  request.indirect = false, request.contradictions = false;
  const scan::Codes plain = decoded(frames, world, camera, request);
  Counts counts;
  for (int y = 0; y < camera.height; ++y)
    for (int x = 0; x < camera.width; ++x) {
      const auto i = static_cast<std::size_t>(y * camera.width + x);
      const auto truth = lit_by(world, camera, x, y);
      if (!truth || !plain.told(i)) continue;
      bool wrong = false;
      for (std::size_t axis = 0; axis < 2; ++axis) {
        if (plain.place[axis].empty()) continue;
        const double off = std::abs(plain.place[axis][i] - (axis == 0 ? truth->x : truth->y));
        wrong = wrong || (off > 3 * plain.sigma[axis][i] && off > wrong_px);
      }
      ++(wrong ? counts.wrong : counts.right);
      counts.to_interreflection += !wrong && told.refusal[i] == scan::Refusal::interreflection ? 1 : 0;
      if (!told.told(i)) ++(wrong ? counts.wrong_refused : counts.right_refused);
    }
  return counts;
}

void print(const std::string& what, const Counts& c) {
  if (c.wrong > 0)
    std::printf("structured-light %s, wrong pixels refused: measured %.1f %% required >= 90 %% (%d of %d)\n",
                what.c_str(), 100.0 * c.wrong_refused / c.wrong, c.wrong_refused, c.wrong);
  else
    std::printf("structured-light %s: no pixel is wrong\n", what.c_str());
  std::printf("structured-light %s, right pixels lost: measured %.2f %% required <= 5 %% (%d of %d)\n", what.c_str(),
              100.0 * c.right_refused / c.right, c.right_refused, c.right);
}

void print_plane(const std::string& what, const Counts& c) {
  std::printf("structured-light %s, pixels lost to interreflection: measured %.2f %% required <= 0.1 %% (%d of %d)\n",
              what.c_str(), 100.0 * c.to_interreflection / c.right, c.to_interreflection, c.right);
}

}  // namespace

int main() {
  const Kind kinds[] = {{"Gray code", {}},
                        {"cosines 1, 8, 64", {1, 8, 64}},
                        {"heterodyne 59, 64, 70", {59, 64, 70}},
                        {"micro phase shifting 64, 67, 71, 75", {64, 67, 71, 75}}};
  for (const Kind& kind : kinds) {
    std::uint64_t seed = 100;
    for (const double opening : {60.0, 90.0, 120.0}) {
      Counts all;
      // Straight, turned, and so that one wall lies almost along the light.
      for (const double turn : {0.0, 0.3, -0.6, -0.8}) {
        RenderedWorld world = tests::groove(opening * degree, turn * 0.5 * opening * degree, {0.003, 0, 0.69});
        world.white = 0.35, world.spp = 128, world.seed = ++seed;
        all += counted(world, kind);
      }
      print(format("groove of %.0f degrees, %s", opening, kind.name), all);
    }
    RenderedWorld plane = tests::rendered(tests::ScanWorld{});
    plane.white = 0.35, plane.spp = 128, plane.seed = ++seed;
    print_plane(format("plane, %s", kind.name), counted(plane, kind));
    plane.lens_radius_m = 0.01, plane.focus_m = 1, plane.seed = ++seed;  // pixels blurred over discs of 3 px radius
    print_plane(format("plane out of focus, %s", kind.name), counted(plane, kind));
  }
  return 0;
}
