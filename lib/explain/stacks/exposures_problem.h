// A stack of exposures: one static scene recorded for different times. Base model: readings are radiance times
// exposure, for integer files up to half a code of rounding. Unknown: the radiance of every site (stack_sites.h),
// stated as the reading that it would give in the one of its pictures that shows it best. So stated it hardly moves
// when a response is put in, and the readings in the other pictures are nearly linear in it, whatever the response.
//
// Groups are the pictures, blocks parts of a picture. A picture that is left out is predicted from the radiances that
// the others show and the response that was fitted to them. Sites are few (a hundred and fifty) because their
// radiances belong to all pictures. Regions of single pictures in which something moved (moved.h) are left out.
#pragma once
#include <memory>

#include "explain/engine.h"
#include "explain/stacks/exposure_binding.h"
#include "explain/stacks/stack_sites.h"

namespace gonio::explain::stacks {

class ExposuresProblem final : public Problem {
 public:
  ExposuresProblem(const manifest::Document& document, Stack stack, const SiteOptions& options = {});

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override;
  void jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                std::span<double> derivatives) const override;
  std::string domain() const override { return "stacks"; }
  std::string unit() const override { return "1"; }
  std::string score_name() const override { return "relative RMSE"; }
  std::string group_noun() const override { return "exposure"; }
  Importance importance() const override { return Importance::share_of_signal; }
  bool scatter_is_mismatch() const override { return true; }
  // From pairs of sites of nearly the same brightness in one picture: what bends the response is the same for both.
  std::optional<double> noise_factor(std::span<const double> residual) const override;
  // Another exposure, beyond the longest and the shortest and in the widest gap, and the longest without any light.
  std::vector<Proposal> proposals() const override;
  ProposedRows propose(std::span<const double> values, std::size_t proposal) const override;
  // What moved, what flowed over and which pixels are hot was found before anything is fitted.
  std::vector<std::size_t> tested_apart() const override;
  void conclude(Explanation& explanation) const override;
  std::string remarks(const Explanation& explanation) const override;
  void apply(const Explanation& explanation, manifest::Document& document) const override;
  Illustration illustrate(const Explanation& explanation, const std::filesystem::path& out,
                          manifest::Document& document) const override;

  const Stack& stack() const { return stack_; }
  const std::vector<Site>& sites() const { return sites_; }
  ReadingChain chain(std::span<const double> values) const;

 private:
  struct Bound {
    const ExposureBinding* binding = nullptr;
    std::size_t first = 0, count = 0;  // its numbers in parameters_
  };
  struct Proposed {
    std::size_t like = 0;  // the image beside which it would stand
    double exposure_s = 0;
    bool dark = false;
  };
  std::vector<Proposed> proposed() const;
  std::string response_remark(const Explanation& explanation) const;
  void add_radiances();
  void add_rows();
  void add_conditions();
  void add_mechanisms(const manifest::Document& document);
  double radiance(const ReadingChain& chain, std::span<const double> values, std::size_t site) const;
  Taken taken_at(std::size_t image, std::size_t site) const;
  Written written(std::size_t candidate) const;  // of the mechanism that it is of

  Stack stack_;
  ReadingNoise noise_;
  Moved moved_;
  Overflow overflow_;
  HotPixels hot_;
  std::vector<Site> sites_;
  std::vector<std::size_t> shown_in_;           // by site: the image that its radiance is stated in
  std::vector<std::vector<std::size_t>> rows_;  // by image: sites, ascending
  std::vector<Taken> taken_;                    // by image
  std::vector<Bound> bound_;
  std::array<double, 3> mean_radiance_{};
};

// One problem for every stack of exposures in the manifest.
std::vector<std::unique_ptr<Problem>> exposures_problems(const manifest::Document& document);

}  // namespace gonio::explain::stacks
