// acquire behind its description: what is asked for, and its parts in the order in which they are taken.
#pragma once
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "acquisition/laboratory/laboratory.h"
#include "acquisition/plan/planner.h"
#include "acquisition/plan/view_pattern.h"
#include "acquisition/run/board_checks.h"
#include "acquisition/run/runner.h"
#include "base/error.h"
#include "cli/program.h"

namespace gonio::tools::acquire {

std::vector<cli::Option> options();

// What is looked at and lit, by which camera; checked against the laboratory. Error(usage) at the option.
acquisition::PatternScene scene_of(const cli::Invocation& call);
acquisition::PatternScene board_scene_of(const cli::Invocation& call);  // of --plan board
// --drift-limit, --on-drift, and the board of the document.
acquisition::CheckOptions check_options_of(const cli::Invocation& call);
acquisition::PlanOptions plan_options_of(const cli::Invocation& call);
double wait_of(const cli::Invocation& call);  // s

// --plan: enters a plan into the document.
const manifest::Plan& plan(cli::Invocation& call, const acquisition::Laboratory& laboratory);
// The plan that is to be carried out: --plan-id, or the document's last.
const manifest::Plan& chosen_plan(const cli::Invocation& call);
// --go: exit 2 where frames were refused.
Exit go(cli::Invocation& call, const acquisition::Laboratory& laboratory, const manifest::Plan& plan);

// --gltf names a file of a known kind.
void check_drawings(const cli::Invocation& call);
// --picture, --html, --gltf: the laboratory; the plan, where there is one.
void draw(const cli::Invocation& call, const acquisition::Laboratory& laboratory, const manifest::Plan* plan);
// --go --html: written after the first frame, then every few seconds, and at the end. Nothing without --html. Keeps
// references.
class LivePage {
 public:
  LivePage(const cli::Invocation& call, const acquisition::Laboratory& laboratory, const manifest::Plan& plan);
  ~LivePage();
  void show(const acquisition::RunNews& news);
  void finish(const acquisition::RunReport& report);
  void stop(const std::string& why);

 private:
  struct Parts;
  std::unique_ptr<Parts> parts_;
};

// --serve: the servers, and the description that reaches them in the document; they go on once it has been written.
Exit serve(cli::Invocation& call);

std::string summary(const manifest::Plan& plan);  // of a plan, for people

}  // namespace gonio::tools::acquire
