// The image domain of explain: linear recordings of a scene whose geometry is known, simulated with direct light, light
// between surfaces and the registered mechanisms.
//
// Rows: sampled pixels (a fixed number per tile of 8 x 8, drawn at random with a fixed seed), three channels each.
// Groups: images, one for each camera pose and light; of one or two images alone their cells (relighting/cells.h), so
// that of these too something can be left out. Blocks: tiles. The score is the relative RMSE. Noise of a row: the
// recording's, at the local mean of the picture, plus the simulator's own variance.
#pragma once
#include <memory>
#include <set>
#include <utility>

#include "explain/engine.h"
#include "explain/images/bindings.h"
#include "explain/images/cell_memo.h"
#include "explain/images/model.h"
#include "relighting/recordings.h"
#include "render/ray_caster.h"

namespace gonio::explain::images {

struct Options {
  std::size_t pixels = 6000;                   // sampled over all images together
  std::vector<std::filesystem::path> repeats;  // further takes, from which noise is measured
  CacheOptions cache;
};

class ImagesProblem final : public Problem {
 public:
  explicit ImagesProblem(const manifest::Document& document, const Options& options = {});
  ~ImagesProblem() override;

  void predict(std::span<const double> values, std::size_t group, std::span<double> prediction) const override;
  // Central differences; direct light is shaded anew only where the parameter reaches it.
  void jacobian(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                std::span<double> derivatives) const override;
  // By the path tracer at the sampled pixels.
  std::optional<inference::Bias> bias(std::span<const double> values,
                                      std::span<const std::size_t> candidates) const override;
  // Two mechanisms of one surface that no scene can have together.
  bool excludes(std::size_t candidate, std::size_t other) const override;
  std::string domain() const override { return "images"; }
  std::string unit() const override { return "1"; }
  std::string score_name() const override { return "relative RMSE"; }
  std::string group_noun() const override { return groups_.size() > recordings_.images.size() ? "cell" : "image"; }
  Importance importance() const override { return Importance::share_of_signal; }
  bool outliers_are_effects() const override { return true; }
  inference::Simulator simulator() const override { return inference::Simulator::errs; }
  double fit_tolerance() const override { return 1e-6; }  // of some ten thousand squares
  // Each of the first images again at four times and a quarter of its exposure, and with the lamps off.
  std::vector<Proposal> proposals() const override;
  ProposedRows propose(std::span<const double> values, std::size_t proposal) const override;
  void apply(const Explanation& explanation, manifest::Document& document) const override;
  Illustration illustrate(const Explanation& explanation, const std::filesystem::path& out,
                          manifest::Document& document) const override;

  // Files that belong to other pictures: found before anything is fitted.
  void conclude(Explanation& explanation) const override;

  const Recordings& recordings() const { return recordings_; }
  const Bindings& bindings() const { return bindings_; }
  const std::vector<std::uint32_t>& picked(std::size_t image) const { return picked_[image]; }
  const ImageModel& model() const { return *model_; }
  // The scene that the values amount to, as one image is simulated with it.
  SceneState state(std::span<const double> values, std::size_t image = 0) const;

 private:
  struct Group {  // an image or one of its cells: rows first ... end - 1 of the image's
    std::size_t image = 0, first = 0, end = 0;
    bool whole = true;
  };
  SceneState raw_state(std::span<const double> values) const;
  void slopes_of_image(std::span<const double> values, std::size_t group, std::span<const std::size_t> columns,
                       std::span<double> derivatives) const;
  void bind(const manifest::Document& document);
  void find_exclusions();
  std::vector<std::array<int, 2>> pixels_of(std::size_t view, std::size_t pixels) const;
  std::vector<std::array<int, 2>> in_cells(std::size_t view, const std::vector<std::array<int, 2>>& chosen);
  void fill_rows();
  void open_groups(std::size_t image);
  void numbers_act_on_cells();

  std::unique_ptr<manifest::Document> document_;  // as it was given
  Recordings recordings_;
  SceneLayout layout_;
  std::unique_ptr<render::Monomials> monomials_;
  Bindings bindings_;
  std::set<std::pair<std::size_t, std::size_t>> exclusions_;  // places in candidates(), the smaller first
  CacheOptions cache_options_;
  std::unique_ptr<scene::Scene> scene_;
  std::unique_ptr<render::RayCaster> caster_;
  std::unique_ptr<ImageModel> model_;
  Shared shared_;
  std::vector<std::vector<std::uint32_t>> picked_;   // per image: places in its view's cache, ascending
  std::vector<std::vector<std::uint32_t>> cell_of_;  // per view and place in its cache; empty: views are not cut
  std::vector<Group> groups_;
  CellMemo whole_predictions_, whole_slopes_;
  Misplaced misplaced_;
};

}  // namespace gonio::explain::images
