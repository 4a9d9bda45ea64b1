// align() on the six recordings of a bunny on a table (an independent renderer's pictures, $GONIO_DATA/recordings):
// masks found by the program, three cameras, three lamps, from about 5 degrees and 10 mm off. For each: what its 15
// numbers are off, in standard deviations; how far lamps are off, in shares of their distance; the mean rim offset.
//
//   prove-align-recordings [NUMBER...]      e.g. 1 2 5; all six without
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <string>
#include <vector>

#include "alignment/align_bodies.h"
#include "alignment/alignment_input.h"
#include "alignment/found_masks.h"
#include "base/error.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/alignment.h"
#include "manifest/sections/light.h"
#include "manifest/sections/object.h"

using namespace gonio;
using namespace gonio::alignment;

namespace {

struct Off {
  std::vector<double> z;
  double lamps_share = 0, mean_px = 0;
};

manifest::Document from_aside(const manifest::Document& truth, int number) {
  manifest::Document stated = truth;
  auto& pose = *stated.objects[0].world_from_object;
  const Vec3 axis = normalized(Vec3{1, -2, 0.5 * number});
  pose.rotation = normalized(quaternion_of_rotation_vector(axis * (5 * pi / 180)) * pose.rotation);
  pose.translation_m += Vec3{0.006, -0.006, 0.005};
  int k = 0;
  for (auto& [lamp, light] : stated.lights)
    for (double& v : light.parameters.at("position_m").value) v += ++k % 2 ? 0.02 : -0.03;
  return stated;
}

Setting true_setting(const AlignmentInput& in, const manifest::Document& truth) {
  Setting s = in.stated;
  const auto& pose = *truth.objects[0].world_from_object;
  s.bodies[0].world_from_object = pose;
  for (std::size_t l = 0; l < in.lamps.size(); ++l)
    s.lamps_m[l] = truth.lights.at(in.lamps[l]).parameters.at("position_m").vector();
  return s;
}

Off off_of(const std::filesystem::path& root, int number, const std::filesystem::path& scratch) {
  const manifest::Document truth = manifest::read_document(root / format("practice-%d.json", number));
  manifest::Document stated = manifest::parse_document(manifest::print_document(from_aside(truth, number), scratch),
                                                       "stated.json", scratch, {.allow_outside = true});
  find_masks(stated, {.by = MaskWish::By::lamps}, [&](const std::string& name) { return scratch / name; }, {});
  const AlignmentInput in = read_alignment(stated, {}, {});
  const Aligned a = align_bodies(in, {}).front();
  const Fitted& f = a.fitted;
  const Setting right = true_setting(in, truth);
  const std::vector<double> error = change_between(f.setting, right, in.question.freedoms);
  Off off;
  std::printf("practice-%d: %s %s, sigma %.3f px, alike over %.1f px\n  z:", number, word_of(a.verdict).c_str(),
              a.why.c_str(), f.sigma_px, f.correlation_px);
  for (std::size_t i = 0; i < error.size(); ++i) {
    const auto k = static_cast<Eigen::Index>(i);
    off.z.push_back(error[i] / std::sqrt(f.covariance(k, k)));
    std::printf(" %5.2f", off.z.back());
  }
  std::printf("\n  turn %.2f mrad, shift %.3f mm; lamps off by", 1e3 * norm(Vec3{error[0], error[1], error[2]}),
              1e3 * norm(Vec3{error[3], error[4], error[5]}));
  for (std::size_t l = 0; l < in.lamps.size(); ++l) {
    const double distance = norm(right.lamps_m[l] - right.bodies[0].centre_m());
    const double share = norm(f.setting.lamps_m[l] - right.lamps_m[l]) / distance;
    off.lamps_share = std::max(off.lamps_share, share);
    std::printf(" %.2f %%", 100 * share);
  }
  double rims = 0;
  for (std::size_t k = 0; k < in.rims.size(); ++k)
    if (!in.question.sightings[k].subject.lamp) off.mean_px += f.sightings[k].mean_px, rims += 1;
  off.mean_px /= rims;
  std::printf(" of their distance; objects' rims off by %.3f px in the mean\n", off.mean_px);
  return off;
}

}  // namespace

int main(int argc, char** argv) {
  const char* data = std::getenv("GONIO_DATA");
  if (!data) {
    std::fprintf(stderr, "prove-align-recordings: GONIO_DATA: is not set: name the folder of recorded data\n");
    return 66;
  }
  std::vector<int> numbers;
  for (int i = 1; i < argc; ++i) numbers.push_back(std::atoi(argv[i]));
  if (numbers.empty()) numbers = {1, 2, 3, 4, 5, 6};
  const auto scratch =
      std::filesystem::temp_directory_path() / format("align-recordings-%d", static_cast<int>(::getpid()));
  for (const int number : numbers) {
    std::filesystem::create_directories(scratch);
    const Off off = off_of(std::filesystem::path(data) / "recordings", number, scratch);
    std::filesystem::remove_all(scratch);
    const auto beyond = std::count_if(off.z.begin(), off.z.end(), [](double z) { return !(std::abs(z) < 2); });
    double squares = 0;
    for (const double z : off.z) squares += z * z;
    std::printf(
        "  beyond two standard deviations: measured %d of %zu (required 1 and fewer); root mean square z %.2f\n"
        "  lamps: measured %.2f %% of their distance (required 1); mean rim offset: measured %.3f px (required 0.1)\n",
        static_cast<int>(beyond), off.z.size(), std::sqrt(squares / static_cast<double>(off.z.size())),
        100 * off.lamps_share, off.mean_px);
    std::fflush(stdout);
  }
  return 0;
}
