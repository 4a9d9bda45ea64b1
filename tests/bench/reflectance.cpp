// The program's side of `scripts/bench brdf`: samples of a coated matte surface with noise, the table of energy that
// its model needs, and the time of one fit from one start.
//   bench-brdf make FOLDER ROWS BANDS   samples.bin (per row wi, wo, f of each band), energy.bin (alpha, f0, cosine)
//   bench-brdf fit ROWS BANDS           least seconds of nine fits, iterations, rms, alpha, f0
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "goniometry/fit/fit_candidates.h"
#include "goniometry/fit/fit_problem.h"
#include "surface/interface_albedo.h"

namespace gonio {
namespace {

goniometry::Samples samples_of(std::size_t rows, std::size_t bands) {
  const surface::Model& model = *surface::find("coated-diffuse");
  surface::Values truth;
  truth.v[0] = {0.3, 0.2, 0.1}, truth.v[1] = {}, truth.v[2] = {0.05, 0.05, 0.05}, truth.v[3] = {0.15, 0.15, 0.15};
  goniometry::Samples s;
  s.name = "bench";
  s.band_name.assign(bands, "");
  Random random(1, 1);
  const auto direction = [&](double least) {
    const double z = random.uniform(least, 1), phi = random.uniform(-pi, pi), r = std::sqrt(1 - z * z);
    return Vec3{r * std::cos(phi), r * std::sin(phi), z};
  };
  while (s.wi.size() < rows) {
    const Vec3 wi = direction(0.2);
    Vec3 wo = direction(0.2);
    if (s.wi.size() % 2 == 0) {  // half of them about the mirror direction
      wo = normalized(Vec3{-wi.x + 0.3 * random.normal(), -wi.y + 0.3 * random.normal(), wi.z});
      if (wo.z < 0.2) continue;
    }
    s.wi.push_back(wi), s.wo.push_back(wo);
    const Rgb f = model.evaluate(truth, wo, wi);
    for (std::size_t b = 0; b < bands; ++b) s.f.push_back(f[static_cast<int>(b)] * (1 + 0.02 * random.normal()));
  }
  return s;
}

void write(const std::string& path, const std::vector<double>& numbers) {
  std::ofstream out(path, std::ios::binary);
  out.write(reinterpret_cast<const char*>(numbers.data()),
            static_cast<std::streamsize>(numbers.size() * sizeof(double)));
}

void make(const std::string& folder, std::size_t rows, std::size_t bands) {
  const goniometry::Samples s = samples_of(rows, bands);
  std::vector<double> numbers;
  for (std::size_t r = 0; r < rows; ++r) {
    for (const Vec3 w : {s.wi[r], s.wo[r]}) numbers.insert(numbers.end(), {w.x, w.y, w.z});
    for (std::size_t b = 0; b < bands; ++b) numbers.push_back(s.f[r * bands + b]);
  }
  write(folder + "/samples.bin", numbers);
  std::vector<double> energy;  // nodes as in surface/interface_albedo.cpp
  for (int a = 0; a < 32; ++a)
    for (int f = 0; f < 17; ++f) {
      const double alpha = surface::min_alpha * std::pow(50.0, a / 31.0), f0 = 0.2 * std::pow(f / 16.0, 4);
      energy.push_back(surface::dielectric_albedo_mean(alpha, f0));
      for (int c = 0; c < 49; ++c) energy.push_back(surface::dielectric_albedo(c * c / 2304.0, alpha, f0));
    }
  write(folder + "/energy.bin", energy);
}

int fit(std::size_t rows, std::size_t bands) {
  const goniometry::Samples s = samples_of(rows, bands);
  goniometry::FitOptions options;
  options.models = {"coated-diffuse"};
  std::vector<goniometry::Refusal> refusals;
  const goniometry::Candidate candidate = goniometry::candidates(options, false, 1e-3, s.name, refusals).at(0);
  std::vector<double> start{0.02, 0.4};  // f0, alpha
  start.resize(2 + bands, 0.5);
  double least = 1e9;
  goniometry::Solution solution;
  for (int k = 0; k < 9; ++k) {
    const auto begun = std::chrono::steady_clock::now();
    const goniometry::Problem problem(s, goniometry::Scale::log1p);
    solution = goniometry::solve(problem, candidate, start, problem.rows(), 60);
    least = std::min(least, std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count());
  }
  std::printf("%.6f %d %.8f %.6f %.6f\n", least, solution.iterations,
              std::sqrt(solution.at.cost / static_cast<double>(solution.at.observations)), solution.x[1],
              solution.x[0]);
  return solution.converged ? 0 : 1;
}

}  // namespace
}  // namespace gonio

int main(int argc, char** argv) {
  const std::string task = argc > 1 ? argv[1] : "";
  if (task == "make" && argc == 5) return gonio::make(argv[2], std::stoul(argv[3]), std::stoul(argv[4])), 0;
  if (task == "fit" && argc == 4) return gonio::fit(std::stoul(argv[2]), std::stoul(argv[3]));
  std::fprintf(stderr, "usage: bench-brdf make FOLDER ROWS BANDS | fit ROWS BANDS\n");
  return 64;
}
