// scripts/proofs/explain-nrsfm: what explain says of films of shapes that deform, drawn anew for every seed: how often
// it names what was left out, how often what was not, and how often its 95 % interval of the focal length holds.
#include <algorithm>
#include <cstdio>
#include <cstdlib>

#include "../explain/nrsfm/tracks_world.h"

namespace gonio::explain {
namespace {

using testing::Answer;
using testing::Film;
using testing::Sequence;

struct Tally {
  int films = 0, right = 0, other = 0, covered = 0, estimated = 0;
  std::vector<double> error;
};

// `name`: what has to be named; empty: nothing.
void count(const Answer& a, const std::string& name, double inverse_focal, Tally& t) {
  ++t.films;
  const auto is_right = [&](const std::string& n) { return n == name; };
  const bool named = std::ranges::any_of(a.named, is_right);
  t.right += name.empty() ? a.named.empty() : named;
  t.other += !std::ranges::all_of(a.named, is_right);
  const Estimate* kappa = a.estimate("inverse_focal_per_px");
  if (!named || kappa == nullptr || inverse_focal == 0) return;
  ++t.estimated;
  const double sign = kappa->value < 0 ? -1 : 1;  // of the depths
  t.covered += std::min(sign * kappa->lower_95, sign * kappa->upper_95) <= inverse_focal &&
               inverse_focal <= std::max(sign * kappa->lower_95, sign * kappa->upper_95);
  t.error.push_back(std::abs(sign * kappa->value / inverse_focal - 1));
}

void slip(Sequence& s, double size, std::uint64_t seed) {
  Random random(seed);
  for (Eigen::Index k = 0; k < 8; ++k) {
    const double angle = 2 * M_PI * random.uniform();
    const Eigen::Index f = random.below(static_cast<std::uint32_t>(s.frames())), p = 2 * k + 1;
    s.tracks.block<2, 1>(2 * f, p) += size * Eigen::Vector2d(std::cos(angle), std::sin(angle));
  }
}

Tally study(const char* title, const Film& kind, const std::string& name, Eigen::Index rank, int films, double slips) {
  Tally t;
  for (int k = 0; k < films; ++k) {
    Film f = kind;
    f.seed = 50000 + static_cast<std::uint64_t>(k);
    Sequence s = testing::film(f);
    if (slips > 0) slip(s, slips, f.seed);
    count(testing::explained(testing::solved(s, "pta", {{"terms", static_cast<double>(rank)}})), name, f.inverse_focal,
          t);
  }
  std::printf("%-34s %3d films: right %3d, something else named %2d", title, t.films, t.right, t.other);
  if (t.estimated > 0) {
    std::nth_element(t.error.begin(), t.error.begin() + t.estimated / 2, t.error.end());
    std::printf(", interval holds %d of %d, median error %.1f %%", t.covered, t.estimated,
                100 * t.error[static_cast<std::size_t>(t.estimated / 2)]);
  }
  std::printf("\n");
  std::fflush(stdout);
  return t;
}

}  // namespace
}  // namespace gonio::explain

int main(int argc, char** argv) {
  using gonio::explain::Film;
  const int films = argc > 1 ? std::atoi(argv[1]) : 100;
  using gonio::explain::study;
  const auto clean = study("nothing left out", {}, "", 2, films, 0);
  const auto near =
      study("perspective, 3 % of the distance", {.inverse_focal = 1e-4}, "tracks.perspective", 2, films, 0);
  const auto zoomed = study("scales, 2 %", {.zoom = 0.02}, "tracks.scale", 2, films, 0);
  const auto slipped = study("eight slips of ten noise widths", {}, "tracks.outliers", 2, films, 3);
  const auto shapes = study("a shape too few", {.shapes = 3, .deformation = 0.1}, "", 2, films / 4, 0);
  // 2 % false names, 90 % right ones, and a 95 % interval that holds in 90 to 98 %, each with the scatter of so few.
  const double n = films, scatter = 3 * std::sqrt(n);
  const bool met = clean.right >= 0.98 * n - 0.14 * scatter && near.right >= 0.9 * n && zoomed.right >= 0.9 * n &&
                   slipped.right >= 0.9 * n && shapes.other <= 0.02 * n + 0.07 * scatter &&
                   near.covered >= 0.9 * near.estimated - 0.3 * std::sqrt(near.estimated);
  std::printf("explain-nrsfm: %s\n", met ? "met" : "NOT MET");
  return met ? 0 : 1;
}
