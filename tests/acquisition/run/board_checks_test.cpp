// A run that comes back to a board: what has moved is said, what was measured serves the plan again, and a run that was
// cut off anywhere ends as if it had not been.
#include "acquisition/run/board_checks.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <functional>

#include "acquisition/plan/planner.h"
#include "acquisition/run/faulty_instrument.h"
#include "acquisition/run/runner.h"
#include "base/error.h"
#include "camera/board_place.h"
#include "camera/synthetic_board.h"
#include "data.h"
#include "manifest/document.h"
#include "manifest/sections/board.h"
#include "manifest/sections/file.h"
#include "manifest/sections/frame_link.h"
#include "manifest/sections/image.h"
#include "manifest/sections/laboratory.h"
#include "manifest/sections/object.h"

namespace gonio::acquisition {
namespace {

namespace fs = std::filesystem;

constexpr double first_s = 0.01, each_s = 1e-5;  // a step's exposure tells the camera which one it is

// Where the camera stands off at a step, in its own axes.
using Drift = std::function<Vec3(int)>;

class BoardCamera : public CameraDevice {
 public:
  BoardCamera(LampDevice& lamp, Drift drift, std::uint64_t seed) : lamp_(lamp), drift_(std::move(drift)), seed_(seed) {}
  std::string identity() override { return "camera of a test"; }
  RawFrame take(const Shot& shot) override {
    RawFrame f;
    f.width_px = 200, f.height_px = 150, f.bits = 12, f.pixel_format = "Mono12";
    f.frame_id = ++count_, f.chunk_frame_id = count_, f.exposure_s = shot.exposure_s;
    const int step = static_cast<int>(std::lround((shot.exposure_s - first_s) / each_s));
    Random noise(seed_, static_cast<std::uint64_t>(step));
    std::vector<float> light(30000, 0.0F);
    if (lamp_.is_on()) {
      camera::Board board;
      board.corner_columns = 6, board.corner_rows = 4, board.square_m = 0.02;
      camera::BoardPose pose = camera::pose_at(board, {0.2, -0.3, 0.1}, 0.3);
      pose.translation_m = pose.translation_m - drift_(step);
      const camera::Pattern pattern(board);
      light = camera::expose([&](Vec2 at) { return pattern.reflectance(at); }, {260, 260, 99, 74}, pose, 200, 150,
                             {.blur_px = 0.5, .side = 2});
    }
    for (const float v : light)
      f.samples.push_back(static_cast<std::uint16_t>(std::lround(64 + 3000 * v + 10 * noise.normal())));
    return f;
  }

 private:
  LampDevice& lamp_;
  Drift drift_;
  std::uint64_t seed_;
  std::uint64_t count_ = 0;
};

struct World {
  Drift drift = [](int) { return Vec3{}; };
  std::uint64_t seed = 1;
  Instrument instrument() const {
    Instrument made =
        testing::faulty_instrument({}, {"l"}, {"t"}, {}, testing::same_noise, std::make_shared<testing::Book>());
    made.cameras["c"] = std::make_unique<BoardCamera>(*made.lamps.at("l"), drift, seed);
    made.clock_s = [] { return 0.0; };
    return made;
  }
};

// Views on a turntable, the board every two of them: steps 0, 3, 6, ... are check views.
manifest::Document laboratory(const fs::path& folder, int checks = 4) {
  manifest::Document d = manifest::parse_document(R"({"gonio": 1,
    "boards": {"b": {"kind": "checkerboard", "inner_corners": [6, 4], "square_m": 0.02}},
    "cameras": {"c": {"width_px": 200, "height_px": 150, "fx_px": 260, "fy_px": 260, "cx_px": 99, "cy_px": 74}},
    "lights": {"l": {"model": "point", "position_m": [0, 0, 1], "watt_per_sr": [1, 1, 1]}},
    "laboratory": {"cameras": {"c": {"url": "sim://", "world_from_camera": {"translation_m": [0, 0, 1]}}},
                   "lamps": {"l": {"url": "sim://"}}, "turntables": {"t": {"url": "sim://"}}}})",
                                                  "lab.json", folder);
  manifest::Plan plan;
  for (int i = 0; i < 3 * checks - 2; ++i) {
    manifest::PlanStep step;
    step.image = (i % 3 == 0 ? "board-take-" : "v") + std::to_string(i);
    step.purpose = i % 3 == 0 ? "board" : "view";
    step.camera = "c", step.lamps = {"l"}, step.exposures_s = {first_s + each_s * i};
    step.turntable_rad["t"] = i % 3 == 0 ? 0 : 0.1 * i;
    plan.steps.push_back(step);
  }
  plan.id = plan_id(d, plan);
  d.plans.push_back(plan);
  return d;
}

RunOptions options_for(const fs::path& out, const std::string& limit, OnDrift on_drift = OnDrift::stop) {
  RunOptions options;
  options.out = out;
  options.checks.board = "b", options.checks.on_drift = on_drift;
  if (!limit.empty()) options.checks.limit = parse_drift_limit(limit, "--drift-limit");
  return options;
}

RunReport run(manifest::Document& d, const World& world, const RunOptions& options) {
  const manifest::Plan plan = d.plans.front();
  Instrument instrument = world.instrument();
  return run_plan(d, believed_laboratory(d), plan, instrument, options);
}

// The mount slips by a millimetre after step 4, along the picture's rows.
Vec3 slipped(int step) {
  return step > 4 ? Vec3{1e-3, 0, 0} : Vec3{};
}

TEST(BoardChecks, WithoutDriftNothingIsReportedAndRepeatabilityIsThatOfTheCorners) {
  const tests::ScratchFolder folder;
  manifest::Document d = laboratory(folder.path());
  const RunReport report = run(d, {}, options_for(folder.path(), "0.3mm"));
  EXPECT_TRUE(report.stopped.empty()) << report.stopped;
  EXPECT_TRUE(report.drifted.empty());
  ASSERT_TRUE(report.repeatability);
  EXPECT_EQ(report.repeatability->views, 4);
  EXPECT_LT(report.repeatability->position_interval_m[0], 1e-6);
  EXPECT_LT(*report.repeatability->position_m, *report.repeatability->corners_m);
  EXPECT_EQ(d.plans.front().checks.size(), 1U);  // what later runs are held against
}

TEST(BoardChecks, AMillimetreStopsTheRunAndResumedItTakesTheFramesAgain) {
  const tests::ScratchFolder folder;
  manifest::Document d = laboratory(folder.path());
  RunOptions options = options_for(folder.path(), "0.3mm");
  const RunReport report = run(d, {.drift = slipped}, options);
  EXPECT_NE(report.stopped.find("board-take-6"), std::string::npos) << report.stopped;
  EXPECT_NE(report.stopped.find("limit 0.3 mm"), std::string::npos) << report.stopped;
  EXPECT_EQ(report.frames, 7);
  ASSERT_EQ(d.runs.back().drifted.size(), 1U);
  const manifest::DriftedFrames& marked = d.runs.back().drifted.front();
  EXPECT_EQ(marked.images, (std::vector<std::string>{"v4", "v5", "board-take-6"}));
  EXPECT_NEAR(*marked.value, 1e-3, 4 * *marked.sigma);
  EXPECT_TRUE(d.plans.front().checks.empty());
  // Fastened where it was: the rest follows, and the frames in question are others.
  manifest::Document again = laboratory(folder.path());
  options.resume = true;
  const RunReport rest = run(again, {}, options);
  EXPECT_TRUE(rest.stopped.empty()) << rest.stopped;
  EXPECT_EQ(rest.frames, 10);
  EXPECT_TRUE(rest.drifted.empty());
  const auto sha = [](const manifest::Document& doc, const std::string& image) {
    const auto at = std::ranges::find(doc.images, image, &manifest::ImageEntry::id);
    return doc.files.at(at->file).sha256;
  };
  EXPECT_EQ(sha(again, "v2"), sha(d, "v2"));
  EXPECT_NE(sha(again, "v5"), sha(d, "v5"));
}

TEST(BoardChecks, MarkedFramesAreThoseBetweenChecksOfWhichOneHadMoved) {
  const tests::ScratchFolder folder;
  manifest::Document d = laboratory(folder.path());
  const World bumped{.drift = [](int step) { return step == 6 ? Vec3{0, 2e-3, 0} : Vec3{}; }};
  const RunReport report = run(d, bumped, options_for(folder.path(), "0.3mm", OnDrift::mark));
  EXPECT_EQ(report.frames, 10);
  std::vector<std::string> marked;
  for (const auto& frames : d.runs.back().drifted)
    marked.insert(marked.end(), frames.images.begin(), frames.images.end());
  EXPECT_EQ(marked, (std::vector<std::string>{"v4", "v5", "board-take-6", "v7", "v8"}));
}

TEST(BoardChecks, ABoardThatIsNotSeenIsNoGoodCheck) {
  const tests::ScratchFolder folder;
  manifest::Document d = laboratory(folder.path());
  const World away{.drift = [](int step) { return step == 3 ? Vec3{1, 0, 0} : Vec3{}; }};
  const RunReport report = run(d, away, options_for(folder.path(), "0.3mm"));
  EXPECT_NE(report.stopped.find("board-take-3"), std::string::npos) << report.stopped;
  ASSERT_EQ(report.drifted.size(), 1U);
  EXPECT_FALSE(report.drifted.front().value);
}

// A later run of the plan is held against what its first run saw.
TEST(BoardChecks, AMountThatMovedBetweenRunsIsFound) {
  const tests::ScratchFolder folder;
  manifest::Document d = laboratory(folder.path());
  run(d, {}, options_for(folder.path() / "one", ""));
  const World moved{.drift = [](int) { return Vec3{0, 0, 2e-3}; }, .seed = 2};
  manifest::Document same = d;
  EXPECT_TRUE(run(same, {.seed = 2}, options_for(folder.path() / "two", "0.5mm")).stopped.empty());
  const RunReport report = run(d, moved, options_for(folder.path() / "three", "0.5mm"));
  EXPECT_NE(report.stopped.find("an earlier run of this plan"), std::string::npos) << report.stopped;
  EXPECT_EQ(report.frames, 1);
}

std::string entered(const manifest::Document& d) {
  std::string out;
  for (const manifest::ImageEntry& image : d.images) out += image.id + " " + d.files.at(image.file).sha256 + "\n";
  for (const char* section : {"plans", "runs"}) {
    manifest::Document only;
    (section[0] == 'p' ? only.plans = d.plans : only.plans = {});
    only.runs = section[0] == 'r' ? d.runs : decltype(d.runs){};
    for (manifest::Run& r : only.runs) r.journal.clear();
    out += manifest::print_document(only, d.folder);
  }
  return out;
}

// Cut off after any frame, with the journal torn: its check views are read from there, or sought again.
TEST(BoardChecks, CutOffAnywhereItEndsAsIfItHadNot) {
  const tests::ScratchFolder whole;
  const World bumped{.drift = [](int step) { return step == 6 ? Vec3{0, 2e-3, 0} : Vec3{}; }};
  manifest::Document expected = laboratory(whole.path());
  run(expected, bumped, options_for(whole.path(), "0.3mm", OnDrift::mark));
  Random random(29);
  for (int cut = 1; cut <= 10; cut += 3) {
    const tests::ScratchFolder folder;
    manifest::Document first = laboratory(folder.path()), again = first;
    RunOptions options = options_for(folder.path(), "0.3mm", OnDrift::mark);
    int kept = 0;
    options.on_frame = [&](const RunNews&) {
      if (++kept == cut) throw Error(Exit::io, "power", "is cut");
    };
    EXPECT_THROW(run(first, bumped, options), Error);
    const fs::path journal = folder.path() / "journal.jsonl";
    fs::resize_file(journal, fs::file_size(journal) - random.below(2500) % fs::file_size(journal));
    options.on_frame = {}, options.resume = true;
    run(again, bumped, options);
    EXPECT_EQ(entered(again), entered(expected)) << cut;
  }
}

TEST(BoardChecks, ALimitWithoutCheckViewsIsRefusedBeforeAnythingIsWritten) {
  const tests::ScratchFolder folder;
  manifest::Document d = laboratory(folder.path(), 1);
  EXPECT_THROW(run(d, {}, options_for(folder.path(), "0.3mm")), Error);
  EXPECT_FALSE(fs::exists(folder.path() / "journal.jsonl"));
}

// Where a calibration found the camera belongs to the plan: its next run says so, another plan's does not.
TEST(MeasuredViews, ServeTheSamePlanAndNoOther) {
  const tests::ScratchFolder folder;
  manifest::Document d = laboratory(folder.path());
  run(d, {}, options_for(folder.path() / "one", ""));
  const auto image_of = [](manifest::Document& doc, const std::string& id) -> manifest::ImageEntry& {
    return *std::ranges::find(doc.images, id, &manifest::ImageEntry::id);
  };
  // A calibration saw the board on an object of the scene in one of the views, and in one that a check calls in
  // question.
  d.objects.push_back({.id = "table", .mesh = "", .surface = ""});
  d.frames.push_back({"table", "b", {}, {0.1, 0, 0}, {}});
  for (const char* id : {"v4", "v5"}) {
    manifest::ImageEntry& image = image_of(d, id);
    image.board = "b";
    image.camera_from_board.emplace().translation_m = {0, 0, 0.7};
  }
  d.runs.back().drifted.push_back({.check = "board-take-6", .limit = 1, .unit = "px", .images = {"v5"}});
  camera::place_images(d, "calib-charuco");
  ASSERT_EQ(d.plans.front().measured.size(), 1U);
  EXPECT_EQ(d.plans.front().measured.front().image, "v4");
  d.images.clear();
  manifest::Document other = d;
  const RunReport report = run(d, {.seed = 2}, options_for(folder.path() / "two", ""));
  EXPECT_EQ(report.measured, 1);
  EXPECT_EQ(d.runs.back().measured, 1);
  EXPECT_NEAR(image_of(d, "v4").world_from_camera->translation_m.z, -0.7, 1e-12);
  EXPECT_NEAR(image_of(d, "v4").world_from_camera->translation_m.x, 0.1, 1e-12);
  EXPECT_NE(image_of(d, "v7").world_from_camera->translation_m.z, -0.7);
  manifest::Plan& changed = other.plans.emplace_back(other.plans.front());
  changed.steps.back().exposures_s = {0.02}, changed.measured.clear(), changed.checks.clear();
  changed.id = plan_id(other, changed);
  std::swap(other.plans.front(), other.plans.back());
  EXPECT_EQ(run(other, {.seed = 2}, options_for(folder.path() / "three", "")).measured, 0);
}

}  // namespace
}  // namespace gonio::acquisition
