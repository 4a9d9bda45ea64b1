// The check views of a run: frames of a board that a plan comes back to (planner.h: board_every).
//
// After each of them the board is sought (camera/corner_detection.h: the calibration's own detector) and held against
// the first take of that view in this run and against what the plan's first run saw ("plans": checks). What is found
// goes into the journal, so that a run that is resumed judges by the same numbers. Frames between a view that has moved
// beyond the limit and the checks before and after it are called into question.
#pragma once
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/run/board_shift.h"
#include "manifest/sections/forward.h"
#include "manifest/sections/plan.h"
#include "manifest/value.h"

namespace gonio::acquisition {

enum class OnDrift { stop, mark };
struct CheckOptions {
  std::string board{};                // name in the manifest's boards; empty: nothing is checked
  std::optional<DriftLimit> limit{};  // left out: repeatability is measured, and nothing more
  OnDrift on_drift = OnDrift::stop;
};

// Chance that a run in which nothing has moved beyond the limit reports one: shared out evenly over its checks.
inline constexpr double drift_false_alarms = 0.001;

// Steps that are check views: board frames at a place that the plan visits more than once.
std::vector<std::size_t> check_steps(const manifest::Plan& plan);
std::string checked_image(
    const manifest::PlanStep& step);  // the one in which the board is sought: of the middle exposure

class BoardChecks {
 public:
  // Error(data) where a limit is given and the plan has no check views, or one of pose and no lens is known.
  BoardChecks(const manifest::Document& document, const manifest::Plan& plan, const CheckOptions& options);

  void take_over(const manifest::Value& event);  // of the journal: "check", "drift"
  bool is_check(std::size_t step) const;
  // Judges check view `step`, whose frame is `file` (empty: it was refused). `write`: into the journal. What it calls
  // into question; nothing where all is well.
  std::optional<manifest::DriftedFrames> look(std::size_t step, const std::filesystem::path& file,
                                              const std::string& sha256,
                                              const std::function<void(const manifest::Value&)>& write);
  std::string words() const;             // of the last look that found a drift: how far, since when, what to do
  bool moved() const { return moved_; }  // the last look itself found one, and not just the one before it

  std::optional<manifest::Repeatability> repeatability() const;
  std::vector<manifest::CheckView> first_views() const;  // of this run, for the plan

 private:
  struct Seen {
    std::string sha256, problem;
    std::vector<camera::Corner> corners;
  };
  struct View {  // one place: its first take, and all takes' shifts from it
    std::string image;
    std::vector<camera::Corner> first;
    std::vector<Moved> position, rotation;
  };
  Seen seen_in(const std::string& image, const std::filesystem::path& file, const std::string& sha256,
               const std::function<void(const manifest::Value&)>& write);
  std::optional<manifest::DriftedFrames> judged(const Seen& seen, const std::string& image, View& view,
                                                const std::vector<camera::Corner>* stored,
                                                const std::optional<camera::Intrinsics>& lens);
  std::vector<std::string> images_between(std::size_t before, std::size_t last) const;

  const manifest::Plan& plan_;
  CheckOptions options_;
  camera::Board board_;
  std::vector<std::size_t> steps_;
  std::map<std::string, std::optional<camera::Intrinsics>> lenses_;  // by camera
  std::map<std::string, std::vector<camera::Corner>> stored_;        // by place
  std::map<std::string, View> views_;                                // by place
  std::map<std::string, Seen> seen_;                                 // by image, of the journal
  std::size_t after_ = 0;                                            // the step behind the last check
  std::optional<manifest::DriftedFrames> last_drift_;                // of the last check
  bool moved_ = false;
  std::string words_;
};

}  // namespace gonio::acquisition
