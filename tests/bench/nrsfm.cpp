// The program's side of `scripts/bench nrsfm`: sequences of shapes that deform, reconstructions with noise, outliers
// and a similarity between, and the time of their robust errors.
//   bench-nrsfm make FILE FRAMES POINTS COUNT          per sequence the reconstruction, then the truth: frames x points
//   x 3 bench-nrsfm run FILE FRAMES POINTS COUNT THREADS   seconds a sequence, mean value, iterations a sequence
#include <Eigen/Geometry>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "base/parallel.h"
#include "base/random.h"
#include "nrsfm/evaluate/errors.h"

namespace gonio {
namespace {

using nrsfm::Shapes;

Shapes truth_of(Eigen::Index frames, Eigen::Index points, Random& random) {
  Eigen::MatrixXd rest(3, points), modes(9, points);
  for (Eigen::Index i = 0; i < rest.size(); ++i) rest.data()[i] = 0.1 * random.normal();
  for (Eigen::Index i = 0; i < modes.size(); ++i) modes.data()[i] = 0.03 * random.normal();
  Shapes s(3 * frames, points);
  for (Eigen::Index f = 0; f < frames; ++f) {
    const double t = 6.283185307179586 * static_cast<double>(f) / static_cast<double>(frames);
    nrsfm::shape_of(s, f) = rest + std::sin(t) * modes.topRows<3>() + std::cos(2 * t) * modes.middleRows<3>(3) +
                            std::sin(3 * t) * modes.bottomRows<3>();
  }
  return s;
}

Shapes reconstruction_of(const Shapes& truth, double sigma, Random& random) {
  Shapes x = truth;
  for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] += sigma * random.normal();
  for (Eigen::Index f = 0; f < x.rows() / 3; ++f)
    for (Eigen::Index p = 0; p < x.cols(); ++p)
      if (random.uniform() < 0.05)
        for (int i = 0; i < 3; ++i) x(3 * f + i, p) += 0.1 * random.normal();
  const Eigen::Vector3d axis(random.normal(), random.normal(), random.normal());
  const Eigen::Matrix3d r =
      Eigen::AngleAxisd(2, axis.normalized()).toRotationMatrix() * (random.uniform() < 0.5 ? 3.0 : -3.0);
  for (Eigen::Index f = 0; f < x.rows() / 3; ++f)
    nrsfm::shape_of(x, f) = ((r * nrsfm::shape_of(x, f)).colwise() + axis).eval();
  return x;
}

void make(const std::string& file, Eigen::Index frames, Eigen::Index points, int count) {
  std::ofstream out(file, std::ios::binary);
  for (int k = 0; k < count; ++k) {
    Random random(7, static_cast<std::uint64_t>(k));
    const Shapes q = truth_of(frames, points, random), x = reconstruction_of(q, 0.005 * (1 + k % 6), random);
    for (const Shapes* s : {&x, &q})
      for (Eigen::Index f = 0; f < frames; ++f) {
        const Eigen::Matrix3Xd shape = nrsfm::shape_of(*s, f);
        out.write(reinterpret_cast<const char*>(shape.data()), static_cast<std::streamsize>(8 * shape.size()));
      }
  }
}

int run(const std::string& file, Eigen::Index frames, Eigen::Index points, int count, int threads) {
  std::ifstream in(file, std::ios::binary);
  std::vector<std::pair<Shapes, Shapes>> all;
  Eigen::Matrix3Xd shape(3, points);
  while (in.peek() != EOF) {
    all.emplace_back(Shapes(3 * frames, points), Shapes(3 * frames, points));
    for (Shapes* s : {&all.back().first, &all.back().second})
      for (Eigen::Index f = 0; f < frames; ++f) {
        in.read(reinterpret_cast<char*>(shape.data()), static_cast<std::streamsize>(8 * shape.size()));
        nrsfm::shape_of(*s, f) = shape;
      }
  }
  set_threads(threads);
  std::vector<double> value(static_cast<std::size_t>(count)), iterations(value.size());
  const auto begun = std::chrono::steady_clock::now();
  parallel_for(0, value.size(), [&](std::size_t k) {
    const auto& [x, q] = all[k % all.size()];
    const nrsfm::RobustError e = nrsfm::robust_error(x, q);
    value[k] = e.value, iterations[k] = e.iterations;
  });
  const double took = std::chrono::duration<double>(std::chrono::steady_clock::now() - begun).count();
  double mean = 0, steps = 0;
  for (std::size_t k = 0; k < value.size(); ++k) mean += value[k] / count, steps += iterations[k] / count;
  std::printf("%.6f %.9f %.1f\n", took / count, mean, steps);
  return 0;
}

}  // namespace
}  // namespace gonio

int main(int argc, char** argv) {
  const std::string task = argc > 1 ? argv[1] : "";
  const auto number = [&](int i) { return std::stoi(argv[i]); };
  if (task == "make" && argc == 6) return gonio::make(argv[2], number(3), number(4), number(5)), 0;
  if (task == "run" && argc == 7) return gonio::run(argv[2], number(3), number(4), number(5), number(6));
  std::fprintf(stderr, "usage: bench-nrsfm make FILE FRAMES POINTS COUNT | run FILE FRAMES POINTS COUNT THREADS\n");
  return 64;
}
