// A stack of lights: one static object photographed under one distant lamp after the other, without geometry
// (photometric stereo; Woodham, Optical Engineering 19, 1980). Base model: a matte surface that each lamp reaches
// directly. Unknown: normal times albedo of every site, three numbers, in colour two tints more, and of lamps whose
// watt_per_m2 is free the strength and how evenly it lies over the picture, exp(s + a X + b Y): a lamp that nobody
// measured is not aimed to the percent either.
//
// Groups are the lamps, blocks the sites: they lie many pixels apart. Blocks that no mechanism explains, such as the
// edges of cast shadows, are set aside and counted. A lamp that is left out is predicted from the patches that the
// others show. A site is a pixel with all its channels. Attached shadows are the max(0, n.l) of the model; a reading
// that stays under half of what the other lamps promise, though the patch faces the lamp, lies in a cast shadow and
// does not count (photometric_model.h: matte_patch).
#pragma once
#include <memory>

#include "explain/engine.h"
#include "explain/stacks/light_binding.h"
#include "explain/stacks/photometric_model.h"
#include "explain/stacks/stack_sites.h"

namespace gonio::explain::stacks {

class PhotometricProblem final : public Problem {
 public:
  PhotometricProblem(const manifest::Document& document, Stack stack, std::size_t sites = 66);

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override;
  void jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                std::span<double> derivatives) const override;
  std::string domain() const override { return "stacks"; }
  std::string unit() const override { return "1"; }
  std::string score_name() const override { return "relative RMSE"; }
  std::string group_noun() const override { return "light"; }
  Importance importance() const override { return Importance::share_of_signal; }
  bool scatter_is_mismatch() const override { return true; }
  bool sets_outliers_aside() const override { return true; }
  // From sites and the pixels beside them.
  std::optional<double> noise_factor(std::span<const double> residual) const override;
  // Lamps in directions that the stack lacks, and no lamp at all.
  std::vector<Proposal> proposals() const override;
  ProposedRows propose(std::span<const double> values, std::size_t proposal) const override;
  std::string remarks(const Explanation& explanation) const override;
  void apply(const Explanation& explanation, manifest::Document& document) const override;
  Illustration illustrate(const Explanation& explanation, const std::filesystem::path& out,
                          manifest::Document& document) const override;

  const Stack& stack() const { return stack_; }
  const std::vector<Site>& sites() const { return sites_; }
  std::size_t hidden() const { return hidden_; }
  PatchModel model(std::span<const double> values) const;
  // Turned, with their strengths, as pixel (x, y) sees them.
  std::vector<PatchLight> lights(std::span<const double> values, int x, int y) const;

 private:
  struct Bound {
    const LightBinding* binding = nullptr;
    std::size_t first = 0, count = 0;  // its numbers in parameters_
    std::span<const double> of(std::span<const double> values) const { return values.subspan(first, count); }
  };
  struct Proposed {
    std::string where;  // "25 degrees from the camera's axis, to the right"
    Vec3 towards;       // unit; zero: no lamp
  };
  std::vector<Proposed> proposed() const;
  void keep_shown_sites(const std::string& place);
  void start_strengths();
  void add_patches();
  void add_rows();
  void add_conditions();
  void add_lamps();
  void add_mechanisms(const manifest::Document& document);
  const Bound& bound_of(std::size_t candidate) const;
  double radius(int x, int y) const;
  Vec3 position(int x, int y) const;  // of what a pixel shows, in half widths, were the scene flat
  PatchLight light(std::span<const double> values, std::size_t group, Vec3 at) const;
  // Readings of a pixel under all lamps; `seen`: the lamps whose readings count, all by default.
  PatchReadings readings(int x, int y, std::span<const PatchLight> lights, double noise_factor,
                         const std::vector<std::size_t>* seen = nullptr) const;
  // Of a reading; where it is measured and not stated, with what the light may vary over the object: such errors are
  // in proportion and common to the channels, and would drown what is seen in a dark channel. And with what the
  // object's other parts reflect onto the patch, a share of its brightest reading, which is all that a shadow shows.
  double sigma(std::size_t image, double reading, double brightest) const;
  std::size_t unknowns() const { return stack_.channels.size() == 1 ? 3 : 5; }
  Patch patch(std::span<const double> values, std::size_t site) const;
  std::size_t first_of(std::size_t site) const { return unknowns() * site; }  // of its parameters
  double beside() const;

  Stack stack_;
  ReadingNoise noise_;
  std::vector<PatchLight> lamps_;  // by image, as the manifest says; free ones with a first estimate of their strength
  std::vector<double> stated_;     // by image: white as the manifest says
  std::vector<char> free_;
  std::vector<Site> sites_;
  std::vector<Patch> start_;                       // by site
  std::vector<std::vector<std::size_t>> rows_;     // by image: sites, ascending
  std::vector<std::size_t> strength_;              // by image: logarithm of a factor on the lamp
  std::vector<std::array<std::size_t, 2>> slope_;  // by image: of that logarithm, to the right and down
  std::vector<Bound> bound_;
  Vec3 right_, down_;       // of the picture's axes
  Vec3 eye_;                // direction from the scene to the camera
  std::size_t hidden_ = 0;  // readings in cast shadows
  double beside_ = 1;
};

// One problem for every stack of lights in the manifest.
std::vector<std::unique_ptr<Problem>> photometric_problems(const manifest::Document& document);

}  // namespace gonio::explain::stacks
