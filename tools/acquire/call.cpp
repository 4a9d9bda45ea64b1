// See call.h.
#include "tools/acquire/call.h"

#include <algorithm>
#include <chrono>

#include "acquisition/desk/true_laboratory.h"
#include "acquisition/plan/asked_steps.h"
#include "acquisition/plan/parse_pattern.h"
#include "acquisition/plan/shown_frames.h"
#include "acquisition/run/frame_record.h"
#include "acquisition/run/instrument_lock.h"
#include "acquisition/run/runner.h"
#include "base/atomic_file.h"
#include "base/progress.h"
#include "base/text.h"
#include "cli/board_options.h"
#include "geom/angle.h"
#include "manifest/sections/comparison.h"
#include "manifest/sections/image.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/light.h"
#include "manifest/sections/plan.h"
#include "manifest/sections/rendering.h"
#include "manifest/sections/table.h"

namespace gonio::tools::acquire {
namespace {

using namespace gonio::acquisition;

struct Asked {
  std::vector<manifest::PlanStep> steps;
  std::string words;
};

// The pattern's views, as frames of `purpose` where one is given; their ids stay apart from those that are there.
void add_pattern(const cli::Invocation& call, const std::string& text, const std::string& place,
                 const std::string& purpose, Asked& asked) {
  const PatternCall pattern = parse_pattern(text, place);
  asked.words += (asked.words.empty() ? "" : "; ") + (purpose.empty() ? "" : purpose + " ") + pattern.words;
  const auto taken = [&asked](const std::string& image) {
    return std::ranges::find(asked.steps, image, &manifest::PlanStep::image) != asked.steps.end();
  };
  std::vector<manifest::PlanStep> steps =
      pattern.pattern->make(pattern.pattern->name == "board" ? board_scene_of(call) : scene_of(call), pattern.numbers);
  int copy = 1;
  const auto ending = [&copy, &purpose] {
    return (purpose.empty() ? "" : "-" + purpose) + (copy > 1 ? "-" + std::to_string(copy) : "");
  };
  while (std::ranges::any_of(steps, [&](const manifest::PlanStep& s) { return taken(s.image + ending()); })) ++copy;
  for (manifest::PlanStep& step : steps) {
    step.image += ending();
    if (!purpose.empty()) step.purpose = purpose;
    asked.steps.push_back(std::move(step));
  }
}

Asked asked_of(cli::Invocation& call) {
  const PatternScene scene = scene_of(call);
  if (call.flag("next")) {
    AskedSteps next = next_steps(call.document, scene);
    for (const std::string& left : next.left) log(LogLevel::warning, left);
    if (next.steps.empty())
      throw Error(Exit::data, manifest::place(call.document, "/explanations"),
                  "propose no measurement that a plan can hold", "run explain first");
    return {std::move(next.steps), "next measurements"};
  }
  if (call.given("pairs")) {
    const std::string file = call.text("pairs");
    call.note_input(file);
    return {pair_steps(scene, read_pairs(read_file(file), file), {}), "pairs of directions"};
  }
  Asked asked;
  for (const std::string& text : call.texts("plan")) add_pattern(call, text, "--plan", "", asked);
  if (call.given("reference")) add_pattern(call, call.text("reference"), "--reference", "reference", asked);
  return asked;
}

bool all_simulated(const manifest::Document& document) {
  const auto urls = urls_of(document);
  const auto simulated = [](const std::string& url) { return url.starts_with("sim:"); };
  if (std::ranges::none_of(urls, simulated)) return false;
  if (std::ranges::all_of(urls, simulated)) return true;
  throw Error(Exit::data, manifest::place(document, "/laboratory"), "has simulated devices beside others",
              "give all of them sim://, or none");
}

Instrument instrument_of(cli::Invocation& call) {
  if (!all_simulated(call.document)) {
    if (call.given("truth")) throw Error(Exit::usage, "--truth", "is for sim:// devices", "leave it out");
    return open_instrument(call.document);
  }
  DeskOptions options;
  options.seed = call.seed;
  options.spp = static_cast<int>(call.integer("spp"));
  if (!call.given("truth")) return desk_instrument(call.document, nullptr, options);
  call.note_input(call.text("truth"));
  const manifest::Document truth = manifest::read_document(call.text("truth"));
  return desk_instrument(call.document, &truth, options);
}

// What was measured from the pictures stays, the pictures of another thing do not.
void start_fresh(manifest::Document& d) {
  d.images.clear();
  d.tables.clear();
  d.renderings.clear();
  d.comparisons.clear();
  d.plans.clear();
  d.runs.clear();
  d.explanations.clear();
  for (const auto& [name, lamp] : d.laboratory.entry.front().lamps)
    std::erase_if(d.lights,
                  [&](const auto& e) { return is_light_at_step(e.first, lamp.light.empty() ? name : lamp.light); });
  for (const auto& [name, screen] : d.laboratory.entry.front().screens)
    std::erase_if(d.lights, [&](const auto& e) { return is_light_at_step(e.first, name); });
}

}  // namespace

const manifest::Plan& plan(cli::Invocation& call, const Laboratory& laboratory) {
  const std::vector<manifest::Plan> before = call.document.plans;
  if (call.flag("fresh")) start_fresh(call.document);
  Asked asked = asked_of(call);
  if (call.given("show")) {
    const ShownProjection shown = shown_projection(call.text("show"), "--show", call.document);
    asked.steps = with_frames(asked.steps, shown, call.given("board-every"), call.document);
    asked.words += "; " + shown.screen + " shows " + shown.projection;
  }
  Progress progress("planning", asked.steps.size());
  manifest::Plan made =
      make_plan(call.document, laboratory, asked.steps, asked.words, plan_options_of(call), &progress);
  if (made.steps.empty()) {
    log(LogLevel::info, summary(made));
    throw Error(Exit::data, manifest::place(call.document, "/laboratory"),
                format("lets no view be taken of the %zu that are asked", asked.steps.size()),
                "move what is looked at (--target), come nearer, or ask for other views; each one's reason is above");
  }
  // What was measured belongs to the id, and what has the same id is the same plan.
  if (const auto known = std::ranges::find(before, made.id, &manifest::Plan::id); known != before.end())
    made.measured = known->measured, made.checks = known->checks;
  const auto same = std::ranges::find(call.document.plans, made.id, &manifest::Plan::id);
  if (same != call.document.plans.end()) {
    *same = std::move(made);
    return *same;
  }
  return call.document.plans.emplace_back(std::move(made));
}

const manifest::Plan& chosen_plan(const cli::Invocation& call) {
  const auto& plans = call.document.plans;
  const std::string at = manifest::place(call.document, "/plans");
  if (plans.empty()) throw Error(Exit::data, at, "is empty", "plan first: acquire --plan hemisphere lab.json");
  if (!call.given("plan-id")) return plans.back();
  const auto found =
      std::ranges::find_if(plans, [&call](const manifest::Plan& p) { return p.id.starts_with(call.text("plan-id")); });
  if (found == plans.end()) {
    std::string ids;
    for (const manifest::Plan& one : plans) ids += (ids.empty() ? "" : ", ") + one.id.substr(0, 12);
    throw Error(Exit::usage, "--plan-id", "no plan's id begins with " + call.text("plan-id"), "there is " + ids);
  }
  return *found;
}

std::string summary(const manifest::Plan& plan) {
  std::string out = plan.id.substr(0, 12) + ": " + plan.pattern + "; " + std::to_string(plan.steps.size()) + " steps";
  if (!plan.unreachable.empty()) out += ", " + std::to_string(plan.unreachable.size()) + " views out of reach";
  for (const auto& [name, value] : plan.figures) out += format("\n  %s %.4g", name.c_str(), value);
  for (const auto& view : plan.unreachable) out += "\n  " + view.image + ": " + view.why;
  return out;
}

namespace {

// What a run found out about itself, for people.
void tell(const RunReport& report) {
  for (const std::string& words : report.words) log(LogLevel::warning, words);
  log(LogLevel::info, format("%lld frames, %lld retaken, %lld refused", static_cast<long long>(report.frames),
                             static_cast<long long>(report.retaken), static_cast<long long>(report.refused)));
  if (report.measured > 0)
    log(LogLevel::info, format("%lld of them stand where earlier runs of the plan were measured",
                               static_cast<long long>(report.measured)));
  if (report.repeatability) {
    const auto& r = *report.repeatability;
    log(LogLevel::info,
        format("repeatability over %lld views of the board: %.3g mm (%.3g to %.3g at 95 %%), %.3g deg (%.3g to %.3g)",
               static_cast<long long>(r.views), 1e3 * *r.position_m, 1e3 * r.position_interval_m[0],
               1e3 * r.position_interval_m[1], *r.rotation_rad / degree, r.rotation_interval_rad[0] / degree,
               r.rotation_interval_rad[1] / degree));
  }
  std::size_t marked = 0;
  for (const manifest::DriftedFrames& frames : report.drifted) marked += frames.images.size();
  if (!report.stopped.empty())
    log(LogLevel::error,
        report.stopped + format("; fasten what moved, then --resume: %zu frames are taken again", marked));
  else if (marked > 0)
    log(LogLevel::warning, format("%zu frames are marked in runs: nobody knows from where they were taken", marked));
}

}  // namespace

Exit go(cli::Invocation& call, const Laboratory& laboratory, const manifest::Plan& chosen) {
  if (cli::describes_board(call)) cli::enter_described_board(call);
  if (call.flag("measure-anew"))
    if (const auto known = std::ranges::find(call.document.plans, chosen.id, &manifest::Plan::id);
        known != call.document.plans.end())
      known->measured.clear(), known->checks.clear();
  const manifest::Plan plan = chosen;  // the document changes while it is carried out
  std::vector<std::string> urls;
  for (const std::string& url : urls_of(call.document))
    if (!url.starts_with("sim:")) urls.push_back(url);
  const InstrumentLock lock(urls, std::chrono::duration<double>(wait_of(call)));
  Instrument instrument = instrument_of(call);
  RunOptions options;
  options.out = call.out;
  options.resume = call.resume;
  options.retakes = static_cast<int>(call.integer("retakes"));
  options.seed = call.seed;
  options.checks = check_options_of(call);
  std::optional<Progress> progress;
  LivePage page(call, laboratory, plan);
  options.on_frame = [&](const RunNews& news) {
    if (!progress) progress.emplace("frames", news.total - news.records.size() + 1);
    progress->advance();
    log(LogLevel::debug, words_of(news.frame));
    page.show(news);
  };
  RunReport report;
  try {
    report = run_plan(call.document, laboratory, plan, instrument, options);
  } catch (const Error& error) {
    page.stop(error.what());
    throw;
  }
  page.finish(report);
  tell(report);
  return report.refused > 0 || !report.drifted.empty() ? Exit::quality : Exit::done;
}

}  // namespace gonio::tools::acquire
