// See runner.h.
#include "acquisition/run/runner.h"

#include <algorithm>
#include <cmath>
#include <set>
#include <thread>

#include "acquisition/laboratory/usual.h"
#include "acquisition/plan/planner.h"
#include "acquisition/run/arm_mover.h"
#include "acquisition/run/doubtful_pictures.h"
#include "acquisition/run/frame_record.h"
#include "acquisition/run/journal.h"
#include "acquisition/run/lamp_switch.h"
#include "acquisition/run/screen_switch.h"
#include "base/atomic_file.h"
#include "base/error.h"
#include "base/text.h"
#include "manifest/document.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/plan.h"

namespace gonio::acquisition {
namespace {

using manifest::Value;
namespace fs = std::filesystem;

constexpr double arm_stands_rad = 1e-3;  // between before and after an exposure
constexpr const char* as_dark = "it is as dark as with the lamps off";

double seconds_since(Clock::time_point zero) {
  return std::chrono::duration<double>(Clock::now() - zero).count();
}

// Ctrl-C stops the arms first: looks for an interrupt while motions block.
class StopWatch {
 public:
  explicit StopWatch(ArmMover& mover)
      : thread_([&mover](const std::stop_token& over) {
          while (!over.stop_requested()) {
            if (interrupted()) return mover.stop_all();
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
          }
        }) {}

 private:
  std::jthread thread_;
};

bool is_mosaic(const std::string& pixel_format) {
  return pixel_format.find("Bayer") != std::string::npos || pixel_format.find("Polariz") != std::string::npos;
}

class PlanRun {
 public:
  PlanRun(manifest::Document& document, const Laboratory& laboratory, const manifest::Plan& plan,
          Instrument& instrument, const RunOptions& options)
      : document_(document),
        laboratory_(laboratory),
        plan_(plan),
        instrument_(instrument),
        options_(options),
        section_(document.laboratory.entry.front()),
        surroundings_(laboratory),
        mover_(laboratory, surroundings_, instrument),
        checks_(document, plan, options.checks),
        journal_(options.out / "journal.jsonl", Value::object({{"what", "run"}, {"plan", plan.id}}), options.resume),
        lamps_(instrument, section_, options.retakes + 1,
               [this](const std::string& lamp, const std::string& why) {
                 journal_.write(Value::object({{"what", "lamp"}, {"lamp", lamp}, {"why", why}}));
               }),
        screens_(instrument, document) {
    for (const Value& event : journal_.earlier()) {
      take_over(event);
      checks_.take_over(event);
    }
    for (const manifest::PlanStep& step : plan.steps) total_ += images_of(step).size();
  }

  RunReport carry_out() {
    StopWatch watch(mover_);
    try {
      for (std::size_t i = 0; i < plan_.steps.size() && report_.stopped.empty(); ++i) {
        take_step(i);
        if (checks_.is_check(i)) check(i);
      }
      lamps_.set({});
      screens_.show({}, "plan");
      if (last_step_ && report_.stopped.empty()) mover_.go(way_home(laboratory_, plan_, *last_step_));
    } catch (...) {
      mover_.stop_all();
      if (interrupted()) throw Error(Exit::try_again, "run", "was interrupted; the arms stand", "go on with --resume");
      throw;
    }
    report_.frames = static_cast<std::int64_t>(records_.size());
    for (std::string& words : doubtful_pictures(records_, dark_)) report_.words.push_back(std::move(words));
    report_.measured = enter_frames(document_, laboratory_, plan_, records_, options_.out);
    report_.repeatability = checks_.repeatability();
    remember_checks();
    for (manifest::DriftedFrames& frames : report_.drifted)
      std::erase_if(frames.images, [this](const std::string& image) { return !records_.contains(image); });
    report_.records = records_;
    return report_;
  }

 private:
  void take_over(const Value& event) {
    const std::string what = event.find("what") == nullptr ? "" : event.find("what")->as_string();
    if (what == "frame") {
      FrameRecord record = frame_of(event);
      time_before_s_ = std::max(time_before_s_, record.time_s);
      if (file_stands(options_.out, record)) records_[record.image] = std::move(record);
    } else if (what == "retake") {
      ++report_.retaken;
      records_.erase(event.find("image") == nullptr ? "" : event.find("image")->as_string());  // it was found wanting
    } else if (what == "drift") {
      for (const Value& image : event.find("images")->as_array()) records_.erase(image.as_string());
    }
  }

  // What later runs of the plan are held against: the first of them whose views nothing calls into question.
  void remember_checks() {
    const auto plan = std::ranges::find(document_.plans, plan_.id, &manifest::Plan::id);
    if (plan != document_.plans.end() && plan->checks.empty() && report_.drifted.empty())
      plan->checks = checks_.first_views();
  }

  // Has the board's view moved? The frames that this calls into question are marked, or the run stops where it stands:
  // --resume takes them again.
  void check(std::size_t index) {
    const auto record = records_.find(checked_image(plan_.steps[index]));
    const bool there = record != records_.end();
    const auto drift = checks_.look(index, there ? options_.out / record->second.file : fs::path(),
                                    there ? record->second.sha256 : "", [this](const Value& e) { journal_.write(e); });
    if (!drift) return;
    report_.drifted.push_back(*drift);
    if (!checks_.moved()) return;
    if (options_.checks.on_drift == OnDrift::mark) return report_.words.push_back(checks_.words());
    journal_.write(Value::object({{"what", "drift"}, {"images", drift->images}}));
    report_.stopped = checks_.words();
  }

  void take_step(std::size_t index) {
    const manifest::PlanStep& step = plan_.steps[index];
    const auto images = images_of(step);
    if (std::ranges::all_of(images, [this](const auto& id) { return records_.contains(id); })) return;
    throw_if_interrupted();
    journal_.write(Value::object({{"what", "intent"}, {"step", static_cast<std::int64_t>(index)}}));
    move_to(index);
    turn_tables(instrument_, step.turntable_rad);
    screens_.show(step.screens, "plan step " + step.image);
    std::vector<BracketFrame> bracket;
    for (std::size_t k = 0; k < images.size(); ++k) {
      if (const auto kept = records_.find(images[k]); kept != records_.end()) {
        bracket.push_back({step.exposures_s[k], kept->second.figures});
        continue;
      }
      const Shot shot{step.exposures_s.empty() ? usual_exposure_s : step.exposures_s[k], camera_of(step).gain_db};
      if (options_.lamp_check && !step.lamps.empty()) know_dark(step, shot);
      keep(step, images[k], shot, &bracket);
    }
    take_stray_again(step, images, bracket);
  }

  // A bracket's frame that does not follow its neighbours is taken once more.
  void take_stray_again(const manifest::PlanStep& step, const std::vector<std::string>& images,
                        std::vector<BracketFrame>& bracket) {
    if (bracket.size() != images.size()) return;
    const auto stray = stray_of_bracket(bracket);
    if (!stray) return;
    const std::string why = "its codes do not follow the bracket's exposures";
    journal_.write(Value::object({{"what", "retake"}, {"image", images[*stray]}, {"why", why}}));
    ++report_.retaken;
    records_.erase(images[*stray]);
    std::vector<BracketFrame> again;
    keep(step, images[*stray], {step.exposures_s[*stray], camera_of(step).gain_db}, &again);
    if (again.empty()) return;
    bracket[*stray] = again.front();
    if (stray_of_bracket(bracket)) report_.words.push_back(images[*stray] + ": " + why);
  }

  const manifest::LaboratoryCamera& camera_of(const manifest::PlanStep& step) const {
    const auto found = section_.cameras.find(step.camera);
    if (found == section_.cameras.end())
      throw Error(Exit::data, "plan step " + step.image, "names no camera of the laboratory: \"" + step.camera + "\"");
    return found->second;
  }

  // Arms stand where the step wants them, by the plan's way where they stand at its beginning.
  void move_to(std::size_t index) {
    if (laboratory_.arms.empty()) return;
    const Way way = way_to(laboratory_, plan_, index);
    if (way.empty()) return;
    const State now = mover_.stands();
    const auto stands_at = [&now](const State& state) {
      for (const auto& [name, joints] : state) {
        const auto arm = now.find(name);
        if (arm == now.end()) continue;
        for (std::size_t j = 0; j < joints.size(); ++j)
          if (std::abs(joints[j] - arm->second[j]) > arm_stands_rad) return false;
      }
      return true;
    };
    last_step_ = index;
    if (stands_at(way.back())) return;
    if (!stands_at(way.front())) mover_.return_to(way.front(), options_.seed + index);
    mover_.go(way);
  }

  // The step's lamps, lit; what is wrong with one, in words. Of several at once a dead one would hide in the others'
  // light: those that cannot be asked whether they shine are lit one by one, and each has to show in the picture.
  std::string light(const manifest::PlanStep& step) {
    const std::set wanted(step.lamps.begin(), step.lamps.end());
    const auto on = lamps_.on();
    if (lit_for_ == step.image && std::set(on.begin(), on.end()) == wanted) return {};
    lit_for_ = step.image;
    if (!options_.lamp_check || wanted.size() < 2 || lamps_.all_answer(step.lamps)) return lamps_.set(step.lamps), "";
    auto exposures = step.exposures_s.empty() ? std::vector{usual_exposure_s} : step.exposures_s;
    std::ranges::sort(exposures);
    const Shot shot{exposures[exposures.size() / 2], camera_of(step).gain_db};
    know_dark(step, shot);
    const auto dark = dark_.find({step.camera, shot.exposure_s});
    lamps_.set({});
    RawFrame frame;
    FrameFigures before, now;
    std::vector<std::string> lit;
    for (const std::string& lamp : wanted) {
      lit.push_back(lamp), lamps_.set(lit);
      if (const std::string wrong = take(step, shot, frame, now); !wrong.empty()) return lit_for_.clear(), wrong;
      const bool shows = lit.size() > 1 ? looks_brighter(now, before, frame.samples.size())
                                        : dark == dark_.end() || !looks_dark(now, dark->second);
      if (!shows) return lit_for_.clear(), "lamp " + lamp + " makes no difference to the picture";
      before = now;
    }
    return {};
  }

  // One frame of `shot`; why it is none, in words.
  std::string take(const manifest::PlanStep& step, const Shot& shot, RawFrame& frame, FrameFigures& figures) {
    const manifest::LaboratoryCamera& camera = camera_of(step);
    const double asked = seconds_since(zero_);
    try {
      frame = instrument_.cameras.at(step.camera)->take(shot);
    } catch (const Error& e) {
      throw_if_interrupted();
      return e.problem();
    }
    const double came = seconds_since(zero_);
    auto& before = before_[step.camera];
    const std::string wrong = disagreement(frame, shot, camera.pixel_format, before, asked, came);
    if (!before || frame.frame_id > before->frame_id) before = {frame.frame_id, frame.camera_time_s, asked, came};
    if (!wrong.empty()) return wrong;
    figures = figures_of(frame, camera.white.value_or((1 << frame.bits) - 1), is_mosaic(frame.pixel_format));
    return {};
  }

  // As take(), with what else has to be as the step asks.
  std::string take_lit(const manifest::PlanStep& step, const Shot& shot, RawFrame& frame, FrameFigures& figures,
                       FrameRecord& record) {
    record.joints = laboratory_.arms.empty() ? State{} : mover_.stands();
    const std::string wrong = take(step, shot, frame, figures);
    if (!wrong.empty()) return wrong;
    record.lamps = lamps_.on();
    if (auto wanted = step.lamps;
        std::set(wanted.begin(), wanted.end()) != std::set(record.lamps.begin(), record.lamps.end()))
      return "other lamps are on than were asked";
    const State after = laboratory_.arms.empty() ? State{} : mover_.stands();
    for (const auto& [name, joints] : record.joints)
      for (std::size_t j = 0; j < joints.size(); ++j)
        if (std::abs(joints[j] - after.at(name)[j]) > arm_stands_rad) return "robot " + name + " moved during it";
    const auto dark = dark_.find({step.camera, shot.exposure_s});
    if (!step.lamps.empty() && dark != dark_.end() && looks_dark(figures, dark->second) &&
        figures.saturated_share < 0.5)
      return as_dark;
    return {};
  }

  // With all lamps off, once a camera and exposure.
  void know_dark(const manifest::PlanStep& step, const Shot& shot) {
    const std::pair key{step.camera, shot.exposure_s};
    if (dark_.contains(key)) return;
    lamps_.set({});
    RawFrame frame;
    FrameFigures figures;
    for (int n = 0; n <= options_.retakes; ++n)
      if (take(step, shot, frame, figures).empty()) {
        dark_[key] = figures;
        return;
      }
  }

  void keep(const manifest::PlanStep& step, const std::string& image, const Shot& shot,
            std::vector<BracketFrame>* bracket) {
    FrameRecord record;
    RawFrame frame;
    std::string why;
    std::optional<FrameFigures> doubtful;  // a good frame after a bad one waits for its like
    bool doubt = false;
    for (record.tries = 1; record.tries <= 2 * (options_.retakes + 1); ++record.tries) {
      throw_if_interrupted();
      FrameFigures figures;
      std::string wrong = light(step);
      const bool dark = !wrong.empty();
      if (!dark) wrong = take_lit(step, shot, frame, figures, record);
      if (wrong.empty() && (!doubt || (doubtful && differing(*doubtful, figures).empty()))) {
        record.figures = figures;
        write_frame(step, image, shot, frame, record);
        bracket->push_back({shot.exposure_s, figures});
        return;
      }
      if (wrong.empty()) {
        doubtful = figures;
        continue;
      }
      doubt = true, doubtful.reset(), why = wrong;
      ++report_.retaken;
      journal_.write(Value::object({{"what", "retake"}, {"image", image}, {"why", why}}));
      if (dark || why == as_dark) lamps_.set({});
    }
    ++report_.refused;
    report_.words.push_back(image + ": refused after " + std::to_string(record.tries - 1) + " tries: " + why);
    journal_.write(Value::object({{"what", "refused"}, {"image", image}, {"why", why}}));
  }

  void write_frame(const manifest::PlanStep& step, const std::string& image, const Shot& shot, const RawFrame& frame,
                   FrameRecord& record) {
    record.image = image;
    record.group = step.image;
    record.camera = step.camera;
    record.robot = section_.cameras.at(step.camera).robot;
    record.exposure_s = frame.exposure_s.value_or(shot.exposure_s);
    record.gain_db = frame.gain_db;
    record.temperature_K = frame.temperature_K;
    record.time_s = time_before_s_ + (instrument_.clock_s ? instrument_.clock_s() : seconds_since(zero_));
    record.frame_id = frame.frame_id;
    record.bits = frame.bits;
    for (const auto& [name, angle] : step.turntable_rad) record.turntables[name] = angle;
    const fs::path path = write_frame_file(options_.out, frame, record);
    journal_.write(to_event(record));
    records_[image] = record;
    if (options_.on_frame) options_.on_frame({record, records_, total_, report_});
  }

  manifest::Document& document_;
  const Laboratory& laboratory_;
  const manifest::Plan& plan_;
  Instrument& instrument_;
  const RunOptions& options_;
  const manifest::Laboratory section_;
  Surroundings surroundings_;
  ArmMover mover_;
  BoardChecks checks_;
  Journal journal_;
  LampSwitch lamps_;
  ScreenSwitch screens_;
  std::string lit_for_;  // the step whose lamps were last lit
  RunReport report_;
  std::map<std::string, FrameRecord> records_;
  std::map<std::string, std::optional<FrameBefore>> before_;
  std::map<std::pair<std::string, double>, FrameFigures> dark_;
  std::size_t total_ = 0;
  std::optional<std::size_t> last_step_;  // that the arms were moved for
  double time_before_s_ = 0;
  Clock::time_point zero_ = Clock::now();
};

}  // namespace

RunReport run_plan(manifest::Document& document, const Laboratory& laboratory, const manifest::Plan& plan,
                   Instrument& instrument, const RunOptions& options) {
  if (document.laboratory.entry.empty())
    throw Error(Exit::data, manifest::place(document, "/laboratory"), "is missing", "describe the instrument there");
  if (plan.id != plan_id(document, plan))
    throw Error(Exit::data, manifest::place(document, "/plans"), "was made for another laboratory, or changed by hand",
                "plan again");
  ask_all(instrument);  // nothing is written for a run that cannot begin
  make_folder(options.out / "frames");
  PlanRun run(document, laboratory, plan, instrument, options);
  const RunReport report = run.carry_out();
  manifest::Run entry;
  entry.plan = plan.id;
  entry.journal = manifest::add_file(document, options.out / "journal.jsonl", "journal");
  entry.frames = report.frames;
  entry.retaken = report.retaken;
  entry.refused = report.refused;
  entry.measured = report.measured;
  entry.repeatability = report.repeatability;
  entry.drifted = report.drifted;
  document.runs.push_back(entry);
  return report;
}

}  // namespace gonio::acquisition
