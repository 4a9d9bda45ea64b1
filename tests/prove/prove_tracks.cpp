// scripts/proofs/explain-totem: recorded films with ground truth in the camera's frame (Sengupta et al., IJCV 2024),
// the camera believed orthographic; what explain says through the program itself, and the focal length that it finds.
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>

#include "base/atomic_file.h"
#include "explain/nrsfm/tracks/mat_file.h"
#include "manifest/value.h"

namespace gonio::prove {
namespace {

struct Recorded {
  const char* name;
  double metres;  // of one unit of the ground truth; the T-shirt's are not stated
};

bool prove(const Recorded& recorded, const std::filesystem::path& data, const std::filesystem::path& folder) {
  const std::string name = recorded.name;
  const tests::Film film = tests::read_film(data / ("data_" + name + ".mat"), data / (name + "_Initialisation.mat"));
  const std::filesystem::path in = folder / (name + ".json"), out = folder / (name + ".out.json");
  write_file(in, tests::film_manifest(film, recorded.metres));
  const std::string command =
      std::string(GONIO_BIN) + "/explain --log-level quiet -i " + in.string() + " -o " + out.string();
  const int status = std::system(command.c_str());
  if (!WIFEXITED(status) || WEXITSTATUS(status) > 2) return false;
  const manifest::Value document = manifest::parse_json(read_file(out), out.string());
  const manifest::Value& entry = document.find("explanations")->as_array().at(0);
  std::printf("%s, %zu frames of %zu points: %s\n", recorded.name, film.pixels.size(), film.pixels[0].size(),
              entry.find("sentence")->as_string().c_str());
  const auto& named = entry.find("named")->as_array();
  if (named.empty() || named[0].find("mechanism")->as_string() != "tracks.perspective") return false;
  const double focal = 1 / named[0].find("parameters")->find("inverse_focal_per_px")->as_number();
  std::printf("  located: %s; focal length %.1f px, stated %.1f px (%.1f %% off); held out %.3g px -> %.3g px\n",
              entry.find("located")->find("condition")->as_string().c_str(), focal, film.fx_px,
              100 * (focal / film.fx_px - 1), entry.find("held_out")->find("before")->as_number(),
              entry.find("held_out")->find("after")->as_number());
  return std::abs(focal / film.fx_px - 1) < 0.05;
}

}  // namespace
}  // namespace gonio::prove

int main(int argc, char** argv) {
  if (argc != 2) return 64;
  std::string folder = (std::filesystem::temp_directory_path() / "gonio-prove-XXXXXX").string();
  if (::mkdtemp(folder.data()) == nullptr) return 73;
  bool met = true;
  for (const gonio::prove::Recorded& r :
       {gonio::prove::Recorded{"cushion", 1e-3}, {"kinectPaper", 1e-3}, {"whiteCartoonTshirt", 1e-2}})
    met &= gonio::prove::prove(r, argv[1], folder);
  std::filesystem::remove_all(folder);
  std::printf("explain-totem perspective named first and focal length within 5 %% in all films: %s\n",
              met ? "met" : "NOT MET");
  return met ? 0 : 1;
}
