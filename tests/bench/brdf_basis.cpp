// bench-basis, the side of `scripts/bench brdf` that times bases and reconstructions. Prints one line per figure: name,
// value, unit. Peak memory is the process's own (VmHWM), so that each task is a process of its own.
//   bench-basis tables FOLDER N  writes N tables of full size, from models
//   bench-basis folder FOLDER    builds the basis of a folder
//   bench-basis builtin FILE     builds the built-in basis and saves it
//   bench-basis reconstruct FILE loads it and reconstructs from 20 directions
#include <algorithm>
#include <chrono>
#include <cstdio>
#include <fstream>
#include <string>

#include "base/atomic_file.h"
#include "base/random.h"
#include "goniometry/plan.h"
#include "goniometry/reconstruct/reconstruction.h"
#include "surface/half_angle.h"
#include "surface/surface.h"

namespace {

using namespace gonio;
using goniometry::Samples;

class Clock {
 public:
  double s() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

double peak_mib() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.starts_with("VmHWM:")) return std::stod(line.substr(6)) / 1024;
  return 0;
}

void tell(const char* what, double value, const char* unit) {
  std::printf("%-34s %9.3f %s\n", what, value, unit);
}

surface::Values varnish(const surface::Model& model, std::uint64_t number) {
  Random random(5, number);
  return surface::values_of(model,
                            {{"albedo", manifest::Parameter({random.uniform(), random.uniform(), random.uniform()})},
                             {"f0", manifest::Parameter(random.uniform(0.02, 0.1))},
                             {"alpha", manifest::Parameter(0.02 * std::pow(20, random.uniform()))}},
                            "varnish");
}

void write_tables(const std::filesystem::path& folder, int count) {
  const surface::Model& model = *surface::find("coated-diffuse");
  const goniometry::Cells cells(goniometry::merl_bins);
  const auto [rings, tilts, turns] = cells.bins();
  for (int i = 0; i < count; ++i) {
    const surface::Values values = varnish(model, static_cast<std::uint64_t>(i));
    std::vector<Rgb> f(cells.count());
    const auto tables =
        goniometry::tables_of({{"m", [&](Vec3 wo, Vec3 wi) { return model.evaluate(values, wo, wi); }}}, cells.bins());
    io::MerlTable table{cells.bins(), std::vector<float>(3 * rings * tilts * turns, -1)};
    std::vector<float> channel(cells.count());
    for (std::size_t band = 0; band < 3; ++band) {
      tables->read(0, band, 0, rings, channel);
      for (std::size_t place = 0; place < rings * tilts * turns; ++place) {
        const auto cell = cells.cell_of(place / turns / tilts, place / turns % tilts, place % turns);
        if (cell != goniometry::Cells::none) table.brdf_per_sr[3 * place + band] = channel[cell];
      }
    }
    io::write_merl(folder / ("material-" + std::to_string(1000 + i) + ".binary"), table);
  }
}

void build_builtin(const std::filesystem::path& file) {
  const Clock clock;
  const goniometry::Basis basis = goniometry::builtin_basis();
  tell("built-in basis: build", clock.s(), "s");
  tell("built-in basis: components", static_cast<double>(basis.components()), "");
  tell("built-in basis: share of variance", basis.kept_share(), "");
  tell("built-in basis: peak memory", peak_mib(), "MiB");
  const Clock saving;
  basis.save(file);
  tell("built-in basis: save", saving.s(), "s");
}

void build_folder(const std::filesystem::path& folder) {
  const Clock clock;
  const goniometry::Basis basis = goniometry::basis_of_folder(folder);
  tell("basis of the folder: materials", static_cast<double>(basis.materials().size()), "");
  tell("basis of the folder: build", clock.s(), "s");
  tell("basis of the folder: components", static_cast<double>(basis.components()), "");
  tell("basis of the folder: peak memory", peak_mib(), "MiB");
}

template <class Work>
double least_of_three(const Work& work) {
  double least = 1e9;
  for (int i = 0; i < 3; ++i) {
    const Clock clock;
    work();
    least = std::min(least, clock.s());
  }
  return least;
}

void time_reconstruction(const std::filesystem::path& file) {
  const Clock loading;
  const goniometry::Basis basis = goniometry::Basis::load(file);
  tell("load the basis", loading.s(), "s");
  const Clock planning;
  const goniometry::Plan plan = goniometry::plan(basis, 20);
  tell("plan of 20 directions", planning.s(), "s");
  const surface::Model& model = *surface::find("coated-diffuse");
  const surface::Values values = varnish(model, 4242);
  Samples samples{.name = "varnish", .band_name = {"r", "g", "b"}};
  for (const auto& pair : plan.pairs) {
    samples.wi.push_back(pair.wi());
    samples.wo.push_back(pair.wo());
    const Rgb f = model.evaluate(values, pair.wo(), pair.wi());
    samples.f.insert(samples.f.end(), {f.x, f.y, f.z});
  }
  goniometry::ReconstructOptions plain;
  plain.uncertainty = false;
  tell("table from 20 directions", least_of_three([&] { goniometry::reconstruct(basis, samples, plain); }), "s");
  goniometry::ReconstructOptions uncalibrated;
  uncalibrated.calibrate = false;
  tell("with uncertainty of each cell", least_of_three([&] { goniometry::reconstruct(basis, samples, uncalibrated); }),
       "s");
  tell("and materials left out in turn", least_of_three([&] { goniometry::reconstruct(basis, samples); }), "s");
  for (const std::string& note : goniometry::reconstruct(basis, samples).notes) std::printf("  %s\n", note.c_str());
  tell("reconstruction: peak memory", peak_mib(), "MiB");
}

}  // namespace

int main(int argc, char** argv) {
  const std::string task = argc > 2 ? argv[1] : "";
  if (task == "tables" && argc > 3)
    write_tables(argv[2], std::stoi(argv[3]));
  else if (task == "folder")
    build_folder(argv[2]);
  else if (task == "builtin")
    build_builtin(argv[2]);
  else if (task == "reconstruct")
    time_reconstruction(argv[2]);
  else
    return 64;
  return 0;
}
